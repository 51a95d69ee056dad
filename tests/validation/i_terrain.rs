//! Group I, grounds that are not level: bowls, valleys, and where a body rests on them.

use core::f64::consts::{PI, TAU};
use core::ops::ControlFlow;

use proptest::prelude::*;
use tumble::glam::DVec3;
use tumble::{
    Bowl, Coulomb, Elevation, EnergyMomentum, Frictionless, Ground, RigidPointBody, Rk4, Sample,
    Shape, SlidingFriction, SmoothCoulomb, SpringDamper, State, Stepper, StrangSplitting, Surface,
    Terrain, UniformGravity,
};

use crate::kit::{self, point_mass};
use crate::scenes::ball;
use crate::table::{Case, figure};

pub(crate) const CASES: &[&Case] = &[&SPHERE_IN_BOWL, &GOLF_BALL, &CYCLOID, &REST_IN_A_TROUGH];

const GRAVITY: f64 = 9.8;

/// Mean time (s) from passage to passage of x = 0 towards -x, of a body that starts at rest.
fn swing(
    body: impl RigidPointBody,
    shape: impl Shape,
    friction: impl SlidingFriction,
    start: DVec3,
    law: SpringDamper,
) -> f64 {
    let stepper = Stepper::new(body)
        .unwrap()
        .with_gravity(UniformGravity::down(GRAVITY))
        .unwrap()
        .with_ground(Ground { law, shape })
        .unwrap()
        .with_friction(friction)
        .unwrap()
        .with_integrator(StrangSplitting { time_step: 1e-4 })
        .unwrap();
    let (mut passages, mut before) = (Vec::new(), (0.0, start.x));
    stepper
        .run(&mut State::at(start), 6.0, &mut |sample: &Sample<'_>| {
            let now = (sample.time, sample.state.position.x);
            if before.1 > 0.0 && now.1 <= 0.0 {
                passages.push(before.0 + (now.0 - before.0) * before.1 / (before.1 - now.1));
            }
            before = now;
            ControlFlow::Continue(())
        })
        .unwrap();
    let swings = passages.len() - 1;
    (passages[swings] - passages[0]) / swings as f64
}

// ---------------------------------------------------------------------------------------------------------------------
// I1: a ball in a spherical bowl
// ---------------------------------------------------------------------------------------------------------------------

/// The inside of a sphere about the origin.
struct SphericalBowl {
    radius: f64,
}

impl Shape for SphericalBowl {
    fn surface(&self, point: DVec3) -> Surface {
        let distance = point.length();
        Surface {
            gap: self.radius - distance,
            normal: point / -distance,
        }
    }
}

const FIRM: SpringDamper = SpringDamper {
    stiffness: 1e5,
    damping: 20.0,
};

/// Friction enough to roll: 3000/s of slip.
const GRIP: Coulomb = Coulomb {
    coefficient: 1.0,
    slip_speed: GRAVITY / 3000.0,
};

/// Time of a swing of 0.05 rad of a ball in a bowl of 1 m.
fn swing_in_bowl(moment: f64, radius: f64, friction: impl SlidingFriction) -> f64 {
    let arm = 1.0 - radius + GRAVITY / FIRM.stiffness;
    let (sin, cos) = 0.05_f64.sin_cos();
    let start = DVec3::new(sin, 0.0, -cos) * arm;
    let bowl = SphericalBowl { radius: 1.0 };
    swing(ball(moment, radius), bowl, friction, start, FIRM)
}

/// What a swing in a bowl may miss of its period: the swing's own `θ²/16`, the ground's depth `m g/k` of the arm's length by half, and the slip's phase.
const MISS: f64 = 1.5 * (0.05 * 0.05 / 16.0 + 0.5 * GRAVITY / 1e5);

static SPHERE_IN_BOWL: Case = Case::new(
    "I1",
    "rolling `2π √((1+β)(R - r)/g)`, on ice `2π √((R - r)/g)`",
    "Routh, Dynamics of a System of Rigid Bodies (1905)",
    || {
        let period = |share: f64| TAU * (share * 0.9 / GRAVITY).sqrt();
        let (sphere, hoop, ice) = (period(1.4), period(2.0), period(1.0));
        vec![
            figure(
                "sphere of 0.1 m in a bowl of 1 m: period, s",
                sphere,
                swing_in_bowl(0.4, 0.1, GRIP),
                MISS * sphere,
            ),
            figure("hoop", hoop, swing_in_bowl(1.0, 0.1, GRIP), MISS * hoop),
            figure(
                "on ice",
                ice,
                swing_in_bowl(0.4, 0.1, Frictionless),
                MISS * ice,
            ),
        ]
    },
);

#[test]
fn a_ball_that_rolls_in_a_bowl_swings_slower_than_one_that_slides() {
    SPHERE_IN_BOWL.holds();
}

proptest! {
    #![proptest_config(kit::cases(20))]

    #[test]
    fn balls_of_any_moment_and_size_swing_in_a_bowl_by_the_closed_form(
        moment in 0.1..1.0_f64,
        radius in 0.02..0.5_f64,
    ) {
        let expected = TAU * ((1.0 + moment) * (1.0 - radius) / GRAVITY).sqrt();
        let got = swing_in_bowl(moment, radius, GRIP);
        // The arm is 1 - r: the ground's depth is a larger share of it.
        prop_assert!((got / expected - 1.0).abs() < MISS / (1.0 - radius), "{got}, not {expected} s");
    }
}

// ---------------------------------------------------------------------------------------------------------------------
// I2: a golf ball in the hole
// ---------------------------------------------------------------------------------------------------------------------

/// The inside of an upright cylinder about the z axis.
struct Hole {
    radius: f64,
}

impl Shape for Hole {
    fn surface(&self, point: DVec3) -> Surface {
        let level = point.with_z(0.0);
        Surface {
            gap: self.radius - level.length(),
            normal: -level.normalize(),
        }
    }
}

/// A ball that rolls round the wall of a hole at Ω, let go without a vertical speed: rolling turns its spin about the radius into a vertical force, `z'' = -g/(1 + β) - k² z` with
/// `k = Ω √(β/(1 + β))`. So it sinks by `2g/(β Ω²)` and comes up again.
///
/// Returns k over Ω, and the depth of the lowest place (m).
fn dip(moment: f64) -> [f64; 2] {
    let (hole, radius, rate) = (0.5, 0.1, 10.0);
    let arm = hole - radius;
    let law = SpringDamper {
        stiffness: 1e6,
        damping: 200.0,
    };
    // The wall carries arm Ω² = 40 m/s²: 3e4/s of slip.
    let friction = Coulomb {
        coefficient: 1.0,
        slip_speed: arm * rate * rate / 3e4,
    };
    let stepper = Stepper::new(ball(moment, radius))
        .unwrap()
        .with_gravity(UniformGravity::down(GRAVITY))
        .unwrap()
        .with_ground(Ground {
            law,
            shape: Hole { radius: hole },
        })
        .unwrap()
        .with_friction(friction)
        .unwrap()
        .with_integrator(Rk4 { time_step: 2e-5 })
        .unwrap();
    let speed = arm * rate;
    let depth = speed * rate / law.stiffness;
    let mut state = State::at(DVec3::X * (arm + depth))
        .with_linear_velocity(DVec3::Y * speed)
        .with_angular_momentum(DVec3::Z * (-moment * radius * speed));
    let expected = rate * (moment / (1.0 + moment)).sqrt();
    let (mut lowest, mut turn, mut before) = (0.0, 0.0, (0.0, 0.0));
    stepper
        .run(&mut state, 1.2 * PI / expected, &mut |sample: &Sample<
            '_,
        >| {
            let now = (sample.time, sample.state.linear_velocity.z);
            // Half a swing: it is lowest where the vertical speed changes sign.
            if before.1 < 0.0 && now.1 >= 0.0 {
                let time = before.0 + (now.0 - before.0) * before.1 / (before.1 - now.1);
                let place = sample.state.position;
                lowest = place.z;
                let angle = place.y.atan2(place.x) - rate * (now.0 - time);
                turn = angle + ((rate * time - angle) / TAU).round() * TAU;
            }
            before = now;
            ControlFlow::Continue(())
        })
        .unwrap();
    [PI / turn, -lowest]
}

static GOLF_BALL: Case = Case::new(
    "I2",
    "`k = Ω √(β/(1+β))`, dips by `2g/(β Ω²)`",
    "Littlewood, A Mathematician's Miscellany (1953); Gualtieri et al., Am. J. Phys. 74, 497 (2006)",
    || {
        let ([sphere, lowest], [shell, lowest_of_shell]) = (dip(0.4), dip(2.0 / 3.0));
        let depth = |moment: f64| 2.0 * GRAVITY / (moment * 100.0);
        // Friction carries the weight, g of the wall's 40 m/s² on average: for half a swing it slips by so much of ε, a tenth more as the load comes and goes. The wall's depth is 4e-5 m of 0.4 m.
        let sunk = |moment: f64| {
            let (share, rate) = (GRAVITY / 40.0, 10.0 * (moment / (1.0 + moment)).sqrt());
            1.1 * 40.0 / 3e4 * share / (1.0 - share) * PI / rate + 1e-4 * depth(moment)
        };
        // Of the time as of the way, a share of 2.5e-4 m in 0.5 m.
        let miss = 6e-4;
        vec![
            figure(
                "ball in a hole: swings up and down by turns round",
                (2.0_f64 / 7.0).sqrt(),
                sphere,
                miss,
            ),
            figure("dip, m", depth(0.4), lowest, sunk(0.4)),
            figure("shell: swings by turns", (0.4_f64).sqrt(), shell, miss),
            figure("dip, m", depth(2.0 / 3.0), lowest_of_shell, sunk(2.0 / 3.0)),
        ]
    },
);

#[test]
fn a_ball_that_rolls_round_a_hole_comes_up_again() {
    GOLF_BALL.holds();
}

// ---------------------------------------------------------------------------------------------------------------------
// I3: Huygens' cycloid
// ---------------------------------------------------------------------------------------------------------------------

/// m
const WHEEL: f64 = 0.1;

/// The valley `x = a (φ + sin φ)`, `z = a (1 - cos φ)`: slope `tan(φ/2)`, bend `1/(4a cos⁴(φ/2))`.
fn cycloid(x: f64, _y: f64) -> Elevation {
    let mut angle = x / (2.0 * WHEEL);
    for _ in 0..30 {
        let miss = angle + angle.sin() - x / WHEEL;
        angle -= miss / (1.0 + angle.cos());
        if miss.abs() < 1e-15 {
            break;
        }
    }
    let (height, half) = (WHEEL * (1.0 - angle.cos()), 0.5 * angle);
    let bend = 1.0 / (4.0 * WHEEL * half.cos().powi(4));
    Elevation::new(height, [half.tan(), 0.0]).with_bend([bend, 0.0, 0.0])
}

/// Time of a swing of a point in the cycloid that starts at rest at φ.
fn swing_in_cycloid(angle: f64) -> f64 {
    let law = SpringDamper {
        stiffness: 1e6,
        damping: 200.0,
    };
    let half = 0.5 * angle;
    let normal = DVec3::new(-half.sin(), 0.0, half.cos());
    let place = DVec3::new(angle + angle.sin(), 0.0, 1.0 - angle.cos()) * WHEEL;
    let start = place - normal * (GRAVITY * half.cos() / law.stiffness);
    swing(
        point_mass(1.0),
        Terrain::of(cycloid),
        Frictionless,
        start,
        law,
    )
}

/// The point runs below the curve, by its weight and its centripetal force, 2 m g at most, over the stiffness, of a radius of curvature of `4 a cos(φ/2)`.
fn miss_in_cycloid(angle: f64) -> f64 {
    2.0 * GRAVITY / 1e6 / (4.0 * WHEEL * (0.5 * angle).cos())
}

static CYCLOID: Case = Case::new(
    "I3",
    "`4π √(a/g)` at every amplitude",
    "Huygens, Horologium Oscillatorium (1673)",
    || {
        [0.2, 1.0, 2.0]
            .map(|angle| {
                let got = swing_in_cycloid(angle);
                // Half a unit of the last printed place.
                let tolerance = 1.269_395 * miss_in_cycloid(angle) + 5e-7;
                figure(
                    format!("cycloid of 0.1 m, from φ = {angle}: period, s"),
                    1.269_395,
                    got,
                    tolerance,
                )
            })
            .to_vec()
    },
);

#[test]
fn a_point_in_a_cycloid_swings_at_one_rate_at_every_amplitude() {
    CYCLOID.holds();
    let period = 4.0 * PI * (WHEEL / GRAVITY).sqrt();
    assert!((period - 1.269_395).abs() < 5e-7);
}

// ---------------------------------------------------------------------------------------------------------------------
// I5: rest on a slope
// ---------------------------------------------------------------------------------------------------------------------

/// The trough `z = x²/2`, in metres: its slope is x.
const TROUGH: Terrain<Bowl> = Terrain {
    relief: Bowl {
        curvatures: [1.0, 0.0],
    },
};

/// Where a point is (x, m) some seconds after it has been let go in the trough at x, moving along it.
fn after(x: f64, speed: f64, coefficient: f64, seconds: f64) -> State {
    let law = SpringDamper {
        stiffness: 1e5,
        damping: 300.0,
    };
    let stepper = Stepper::new(point_mass(1.0))
        .unwrap()
        .with_gravity(UniformGravity::down(GRAVITY))
        .unwrap()
        .with_ground(Ground { law, shape: TROUGH })
        .unwrap()
        .with_friction(SmoothCoulomb {
            coefficient,
            slip_speed: 1e-6,
        })
        .unwrap()
        .with_integrator(EnergyMomentum { time_step: 1e-3 })
        .unwrap();
    let normal = DVec3::new(-x, 0.0, 1.0).normalize();
    let depth = GRAVITY * normal.z / law.stiffness;
    let mut state = State::at(DVec3::new(x, 0.0, 0.5 * x * x) - normal * depth)
        .with_linear_velocity(DVec3::new(normal.z, 0.0, -normal.x) * speed);
    stepper.advance(&mut state, seconds).unwrap();
    state
}

static REST_IN_A_TROUGH: Case = Case::new(
    "I5",
    "rests where `|∇h| ≤ μ`",
    "Coulomb (1785)",
    || {
        let (mut low, mut high) = (0.2, 0.4);
        for _ in 0..9 {
            let middle = 0.5 * (low + high);
            if middle - after(middle, 0.0, 0.3, 1.0).position.x < 1e-3 {
                low = middle;
            } else {
                high = middle;
            }
        }
        // An excess of slope d is 1 mm in a second at d = 2 mm/(g s²) = 2e-4; then what the bisection leaves.
        vec![figure(
            "trough z = x²/2, μ = 0.3: farthest rest, m",
            0.3,
            low,
            2e-4 + 0.2 / 512.0,
        )]
    },
);

#[test]
fn a_point_in_a_trough_stays_where_the_slope_is_below_the_coefficient() {
    REST_IN_A_TROUGH.holds();
}

proptest! {
    #![proptest_config(kit::cases(20))]

    /// From anywhere, at any speed along the trough.
    #[test]
    fn whatever_slides_in_a_trough_comes_to_rest_within_the_coefficient(
        x in -0.9..0.9_f64,
        speed in -2.0..2.0_f64,
        coefficient in 0.1..0.6_f64,
    ) {
        let state = after(x, speed, coefficient, 8.0);
        prop_assert!(state.linear_velocity.length() < 1e-5, "{}", state.linear_velocity);
        // It is let go by the ground's depth, m g/k.
        prop_assert!(state.position.x.abs() < coefficient + 1e-4, "{} m", state.position.x);
    }
}
