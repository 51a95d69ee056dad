//! Group G, a ball that bounces with spin, as of tennis.

use tumble::glam::DVec3;
use tumble::{Coulomb, EnergyMomentum, FlatGround, State};

use crate::b_normal_contact::{clamped_restitution, ratio_for};
use crate::kit::erased::Stepper;
use crate::kit::log_uniform;
use crate::scenes::ball;
use crate::table::{Case, figure, random};

pub(crate) const CASES: &[&Case] = &[&BRODY, &PACE, &REBOUND, &GRIP];

/// m
const RADIUS: f64 = 0.033;

/// A bounce without gravity: contacts of a millisecond transmit thousands of m/s².
struct Bounce {
    moment: f64,
    coefficient: f64,
    restitution: f64,
}

impl Bounce {
    /// The slip speed is far below every slip: 1e-6 m/s.
    const SLIP_SPEED: f64 = 1e-6;
    /// 1/s
    const FREQUENCY: f64 = 1e3;
    /// Part of the contact's radian.
    const STEP: f64 = 2e-3;

    /// Speed along x (m/s), speed of the rim `R w` with the way of rolling above 0, and speed
    /// upwards after a bounce, from the same before with the last downwards.
    fn after(&self, [along, rim, down]: [f64; 3]) -> [f64; 3] {
        let ratio = ratio_for(self.restitution);
        let stiffness = Self::FREQUENCY * Self::FREQUENCY;
        let time_step = Self::STEP / Self::FREQUENCY;
        let stepper = Stepper::new(ball(self.moment, RADIUS))
            .unwrap()
            .with_ground(FlatGround::level(stiffness, 2.0 * ratio * Self::FREQUENCY))
            .unwrap()
            .with_friction(Coulomb {
                coefficient: self.coefficient,
                slip_speed: Self::SLIP_SPEED,
            })
            .unwrap()
            .with_integrator(EnergyMomentum { time_step })
            .unwrap();
        let inertia = self.moment * RADIUS;
        let mut state = State::at(DVec3::Z * RADIUS)
            .with_linear_velocity(DVec3::new(along, 0.0, -down))
            .with_angular_momentum(DVec3::Y * (inertia * rim));
        let seconds = 1.5 * clamped_restitution(ratio)[1] / Self::FREQUENCY;
        stepper.advance(&mut state, seconds).unwrap();
        let velocity = state.linear_velocity;
        [velocity.x, state.angular_momentum.y / inertia, velocity.z]
    }
}

/// A rigid ball by Coulomb's law: it slides throughout, or it grips and leaves rolling.
fn rigid(bounce: &Bounce, [along, rim, down]: [f64; 3]) -> [f64; 3] {
    let Bounce {
        moment,
        coefficient,
        restitution,
    } = *bounce;
    let up = restitution * down;
    let slip = along - rim;
    let impulse = coefficient * (1.0 + restitution) * down * slip.signum();
    if impulse.abs() * (1.0 + 1.0 / moment) < slip.abs() {
        [along - impulse, rim + impulse / moment, up]
    } else {
        let rolling = (along + moment * rim) / (1.0 + moment);
        [rolling, rolling, up]
    }
}

/// The pace of a court for the speeds before and after a bounce.
fn pace(before: [f64; 3], after: [f64; 3]) -> f64 {
    let e = after[2] / before[2];
    let apparent = (before[0] - after[0]) / (before[2] * (1.0 + e));
    100.0 * (1.0 - apparent) + 150.0 * (0.81 - e)
}

/// 30 m/s at 16 degrees below level, without spin.
fn serve() -> [f64; 3] {
    let (sin, cos) = 16.0_f64.to_radians().sin_cos();
    [30.0 * cos, 0.0, 30.0 * sin]
}

/// Parts of a speed by which a step of `STEP` misses: (ω dt)²/12 in the restitution, a few times
/// that for first touch and parting.
const MISS: f64 = Bounce::STEP * Bounce::STEP / 3.0;

static BRODY: Case = Case::new(
    "G1",
    "slides `v - μ(1+e)v_y`, or grips `(v + β R w)/(1+β)`",
    "Brody, Phys. Teach. 22, 494 (1984); Cross, Am. J. Phys. 70, 1093 (2002)",
    || {
        let after = |coefficient: f64| {
            let bounce = Bounce {
                moment: 2.0 / 3.0,
                coefficient,
                restitution: 0.81,
            };
            bounce.after(serve())
        };
        let ([slides, spin, _], [grips, rolling, _]) = (after(0.5), after(0.8));
        // Sliding, the friction passes on what the restitution misses, and is short by ε/u; half a
        // unit of the last printed digit.
        let miss = MISS * 30.0 + 5e-7;
        vec![
            figure(
                "tennis ball, 30 m/s at 16°, e = 0.81, μ = 0.5: speed, m/s",
                21.354_297,
                slides,
                miss,
            ),
            figure("rim, m/s", 11.225_331, spin, 1.5 * miss),
            figure("μ = 0.8: speed, m/s", 17.302_711, grips, 2e-6),
            figure("rim, m/s", 17.302_711, rolling, 2e-6),
        ]
    },
)
.and(&[&ANY_BRODY]);

#[test]
fn a_tennis_ball_slides_or_grips_as_a_rigid_ball_does() {
    BRODY.holds();
}

random! {
    /// Checks topspin, backspin and no spin, on ice and on clay.
    ANY_BRODY = new(100, "ball, μ, e, speeds and spin");
    fn balls_of_any_spin_bounce_as_rigid_ones_with_coulombs_law(
        moment in 0.3..0.7_f64,
        coefficient in log_uniform(0.05, 2.0),
        restitution in 0.2..0.95_f64,
        along in -40.0..40.0_f64,
        rim in -40.0..40.0_f64,
        down in 1.0..20.0_f64,
    ) |misses| {
        let bounce = Bounce { moment, coefficient, restitution };
        let before = [along, rim, down];
        let (got, expected) = (bounce.after(before), rigid(&bounce, before));
        // A bounce that is just about to grip keeps some slip speeds; and the damping is larger
        // than a tennis ball's: up to four times the miss.
        let miss = 4.0 * MISS * (along.abs() + rim.abs() + (1.0 + coefficient) * 2.0 * down) / moment + 1e-4;
        for (got, expected) in got.into_iter().zip(expected) {
            misses.near("speed", [got, expected], miss)?;
        }
    }
}

random! {
    /// Within the test's rules: 28 to 32 m/s at 14 to 18 degrees, at most 3 revolutions a second
    /// either way. What the restitution misses counts 150 times, and again 100 times through the
    /// apparent coefficient, by some `1 + 1/e`; a bounce that is about to grip keeps some slip
    /// speeds, as there.
    ANY_PACE = new(48, "court (μ and e), speed, angle and spin that the test allows");
    fn any_court_has_the_pace_that_a_rigid_ball_would_find(
        coefficient in 0.1..1.2_f64,
        restitution in 0.6..0.9_f64,
        speed in 28.0..32.0_f64,
        degrees in 14.0..18.0_f64,
        turns in -3.0..3.0_f64,
    ) |misses| {
        let bounce = Bounce { moment: 2.0 / 3.0, coefficient, restitution };
        let (sin, cos) = degrees.to_radians().sin_cos();
        let before = [speed * cos, core::f64::consts::TAU * turns * RADIUS, speed * sin];
        let [got, expected] = [pace(before, bounce.after(before)), pace(before, rigid(&bounce, before))];
        misses.near("rating", [got, expected], 3.0 * 250.0 * MISS + 100.0 * 1e-4)?;
    }
}

random! {
    /// The fraction of the height is the restitution's square, from any height: the speed is the
    /// only length or time there is.
    ANY_REBOUND = new(48, "restitution of 0.3 to 0.95, height of 1 cm to 100 m: `e² h`");
    fn balls_of_any_restitution_rebound_to_its_square_of_any_height(
        restitution in 0.3..0.95_f64,
        height in log_uniform(0.01, 100.0),
    ) |misses| {
        let bounce = Bounce { moment: 2.0 / 3.0, coefficient: 0.6, restitution };
        let down = (2.0 * 9.8 * height).sqrt();
        let [_, _, up] = bounce.after([0.0, 0.0, down]);
        // Twice that of the speed; the damping is up to four times a tennis ball's, as there.
        let expected = restitution * restitution;
        misses.near("share of the height", [(up / down).powi(2), expected], 8.0 * MISS * expected)?;
    }
}

random! {
    /// Checks bounces that are long enough to end the slip, `μ (1 + e) v (1 + 1/β) > r w`, by some
    /// margin.
    ANY_GRIP = new(48, "ball, spin and speed that grips: `β/(1 + β)` of the spin is left, **never** the other sense");
    fn any_ball_that_grips_leaves_with_the_rolling_share_of_its_spin(
        moment in 0.3..0.7_f64,
        coefficient in 0.3..2.0_f64,
        restitution in 0.5..0.95_f64,
        rim in 0.5..30.0_f64,
        margin in 1.2..5.0_f64,
    ) |misses| {
        let down = margin * rim / (coefficient * (1.0 + restitution) * (1.0 + 1.0 / moment));
        let bounce = Bounce { moment, coefficient, restitution };
        let [along, after, _] = bounce.after([0.0, rim, down]);
        let expected = moment / (1.0 + moment);
        // Momentum about the contact is kept, and what slip is left dies at μ N/(m ε), a million
        // times in the rest of the bounce: the iteration's tolerance and rounding.
        let left = 1e-9;
        misses.near("spin left", [after / rim, expected], left)?;
        misses.near("speed", [along / rim, expected], left)?;
    }
}

static PACE: Case = Case::new(
    "G2",
    "`100 (1 - μ) + 150 (0.81 - e)`, `μ = (v - v')/(v_y (1 + e))`",
    "ITF CS 01/02, court pace rating",
    || {
        let rating = |coefficient: f64| {
            let bounce = Bounce {
                moment: 2.0 / 3.0,
                coefficient,
                restitution: 0.81,
            };
            pace(serve(), bounce.after(serve()))
        };
        // 250 times what the restitution misses; half a unit of the last printed digit.
        let miss = 250.0 * MISS;
        vec![
            figure("μ = 0.6: rating", 40.0, rating(0.6), miss),
            figure(
                "μ = 0.8, where the ball grips: rating",
                22.93,
                rating(0.8),
                miss + 5e-3,
            ),
        ]
    },
)
.and(&[&ANY_PACE]);

#[test]
fn a_court_has_the_pace_of_its_friction_until_the_ball_grips() {
    PACE.holds();
}

static REBOUND: Case = Case::new(
    "G3",
    "`e² h` within 53 to 58 in of 100 in",
    "Cross, Sports Eng. 2, 1 (1999)",
    || {
        let bounce = Bounce {
            moment: 2.0 / 3.0,
            coefficient: 0.6,
            restitution: 0.75,
        };
        let down = (2.0_f64 * 9.8 * 2.54).sqrt();
        let [_, _, up] = bounce.after([0.0, 0.0, down]);
        let rebound = 100.0 * (up / down).powi(2);
        assert!((53.0..58.0).contains(&rebound), "{rebound} in");
        // Half a unit of the last printed digit.
        vec![
            figure(
                "damping ratio for e = 0.75",
                0.097_157_8,
                ratio_for(0.75),
                5e-8,
            ),
            figure("rebound of 100 in, in", 56.25, rebound, 2.0 * 56.25 * MISS),
        ]
    },
)
.and(&[&ANY_REBOUND]);

#[test]
fn a_tennis_ball_is_approved_with_the_damping_of_the_closed_form() {
    REBOUND.holds();
}

/// The limit of the model. Real balls grip: they store energy sideways, and a superball that is
/// dropped with a spin leaves with the opposite one (Garwin, Am. J. Phys. 37, 88, 1969; Cross, Am.
/// J. Phys. 70, 1093, 2002): a solid ball with `-0.428571` of it. This ground has no spring along
/// the surface, and Coulomb's law can only end the slip: `β/(1 + β)` is left, and never turns.
static GRIP: Case = Case::new(
    "G4",
    "`w'/w = β/(1+β)`; **not** a superball's -0.4286",
    "the limit of the model: Garwin, Am. J. Phys. 37, 88 (1969)",
    || {
        let bounce = Bounce {
            moment: 0.4,
            coefficient: 1.0,
            restitution: 0.9,
        };
        let [_, rim, _] = bounce.after([0.0, 5.0, 5.0]);
        vec![figure(
            "solid ball dropped with spin: spin left",
            0.285_714,
            rim / 5.0,
            1e-6,
        )]
    },
)
.and(&[&ANY_GRIP]);

#[test]
fn a_ball_with_spin_never_leaves_with_the_opposite_spin_as_a_superball_does() {
    GRIP.holds();
    for coefficient in [0.1, 0.5, 2.0] {
        for spin in [1.0, 5.0, 30.0] {
            let bounce = Bounce {
                moment: 0.4,
                coefficient,
                restitution: 0.9,
            };
            let [_, rim, _] = bounce.after([0.0, spin, 5.0]);
            assert!(rim > 0.28 * spin, "{rim} m/s of {spin}");
        }
    }
}
