//! Group D, a hoop or a disc on its rim: steady tumbling and rolling, and small oscillations about
//! it.
//!
//! `α`: between the plane of the disc and the ground, 90 degrees upright. `w`: spin about the
//! normal. `Ω`: rate at which the normal goes round the vertical. `k_a`, `k_d`: moments about the
//! normal and a diameter, in `M r²` (1 and 1/2 of a hoop, 1/2 and 1/4 of a disc).
//!
//! **Steady motion** (Routh, Dynamics of a System of Rigid Bodies II, 1905, art. 244; McDonald &
//! McDonald, arXiv physics/0008227). With the normal `n = (sin α, 0, cos α)` and
//! `e = (-cos α, 0, sin α)` up in the disc, `ω = w n + Ω sin α e` and
//! `L = M r² (k_a w n + k_d Ω sin α e)`. Rolling, the centre moves at `-r w ŷ`, and friction is
//! what keeps it on its circle, `M r w Ω x̂`. `dL/dt = Ω ẑ × L` is the torque of friction and
//! weight at the contact `-r e`:
//!
//! `(k_a + 1) w Ω sin α - k_d Ω² sin α cos α + (g/r) cos α = 0`.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

use proptest::prelude::{prop, prop_assume};
use tumble::glam::{DMat3, DMat4, DVec3, DVec4};
use tumble::{
    Coin, ContactPoint, ContactRange, Coulomb, FlatGround, RigidPointBody, Rk4, State,
    StrangSplitting, UniformGravity,
};

use crate::b_normal_contact::contact_arc;
use crate::kit::erased::Stepper;
use crate::kit::log_uniform;
use crate::table::{Case, figure, random};

pub(crate) const CASES: &[&Case] = &[
    &TUMBLE,
    &STEADY,
    &UPRIGHT,
    &NUTATION_ROLLING,
    &NUTATION_SLIDING,
    &SLIDING_UPRIGHT,
    &DAMPED_BED,
    &NUTATION_OF_ANY,
];

/// A disc of 1 kg and 0.5 m with 8000 points on its rim, which penetrates so little that it is one.
struct Disc {
    rim: Coin<f64, Vec<ContactPoint>>,
    moments: [f64; 2],
}

/// Radius, m.
const RADIUS: f64 = 0.5;
const GRAVITY: f64 = 9.8;
/// `k_a` and `k_d`.
const HOOP: [f64; 2] = [1.0, 0.5];
const DISC: [f64; 2] = [0.5, 0.25];

impl Disc {
    fn new(moments: [f64; 2]) -> Self {
        let points = vec![ContactPoint::default(); 8000];
        Self {
            rim: Coin::ring_with_storage(points, 1.0, RADIUS),
            moments,
        }
    }
}

impl RigidPointBody for Disc {
    fn mass(&self) -> f64 {
        1.0
    }
    fn inertia(&self) -> DMat3 {
        let [axial, diametral] = self.moments;
        DMat3::from_diagonal(DVec3::new(axial, diametral, diametral) * (RADIUS * RADIUS))
    }
    fn contacts(&self) -> &[ContactPoint] {
        self.rim.contacts()
    }
    fn contacts_below(&self, normal: DVec3, offset: f64) -> ContactRange {
        self.rim.contacts_below(normal, offset)
    }
}

/// Springs that let a rim of 8000 points sink over half an arc of 0.01 rad upright: 25 points, 25
/// µm.
const STIFFNESS: f64 = 2.32e4;

/// Half of the arc on which the rim rests at `α`.
fn arc(alpha: f64) -> f64 {
    contact_arc(8000, STIFFNESS * alpha.sin(), RADIUS, GRAVITY)
}

/// A disc at `α` with a spin and a rate about the vertical, at the depth of rest.
fn start(moments: [f64; 2], alpha: f64, spin: f64, rate: f64) -> State {
    let (sin, cos) = alpha.sin_cos();
    let [axial, diametral] = moments;
    let (normal, up) = (DVec3::new(sin, 0.0, cos), DVec3::new(-cos, 0.0, sin));
    State::at(DVec3::Z * (RADIUS * sin * arc(alpha).cos()))
        .with_rotation_vector(DVec3::Y * (alpha - FRAC_PI_2))
        .with_linear_velocity(-DVec3::Y * (RADIUS * spin))
        .with_angular_momentum(
            (normal * (axial * spin) + up * (diametral * rate * sin)) * (RADIUS * RADIUS),
        )
}

/// A moment of a run.
#[derive(Clone, Copy)]
struct Moment {
    time: f64,
    alpha: f64,
    /// Angle of the normal about the vertical, including whole revolutions.
    azimuth: f64,
    /// Position of the centre, m.
    place: DVec3,
}

/// A coefficient of 0.
const ICE: [f64; 2] = [0.0, 1e-3];

fn grip(rate: f64) -> [f64; 2] {
    [1.0, GRAVITY / rate]
}

/// A disc under gravity, on springs and dampers with `damping` over stiffness (s), under a
/// coefficient and slip speed of friction.
fn scene(
    moments: [f64; 2],
    [coefficient, slip_speed]: [f64; 2],
    damping: f64,
) -> Stepper<'static, StrangSplitting> {
    // In stick the splitting is stable up to 2 ε/(3 μ g).
    let time_step = f64::min(2e-4, 0.5 * slip_speed / (coefficient * GRAVITY));
    Stepper::new(Disc::new(moments))
        .unwrap()
        .with_gravity(UniformGravity::down(GRAVITY))
        .unwrap()
        .with_ground(FlatGround::level(STIFFNESS, damping * STIFFNESS))
        .unwrap()
        .with_friction(Coulomb {
            coefficient,
            slip_speed,
        })
        .unwrap()
        .with_integrator(StrangSplitting { time_step })
        .unwrap()
}

/// The longest step up to `limit` (s) that meets the points of a rim in all of their phases, where
/// they pass the contact at this rate (rad/s): a golden share of the time from one to the next, or
/// of that.
///
/// A step that meets them in a few phases only sees a few places of the patch, and one that nearly
/// does so sees a ripple of the force go by slowly, which shakes the disc: steps of 2e-4 s, which
/// 3300 points a second pass two by three, put the nodding of a disc at 67° off by 1.4e-4 of its
/// rate, and these by 2e-5.
fn golden_step(passing: f64, limit: f64) -> f64 {
    let mut share = 0.618_034;
    let next = TAU / 8000.0 / passing.abs();
    while share * next > limit {
        share *= 0.618_034;
    }
    (share * next).min(limit)
}

/// The path of a disc on springs.
fn path(moments: [f64; 2], friction: [f64; 2], start: State, seconds: f64) -> Vec<Moment> {
    let stepper = scene(moments, friction, 0.0);
    let [_, passing] = passing(moments, &start);
    let time_step = golden_step(passing, stepper.integrator().time_step);
    let stepper = stepper
        .with_integrator(StrangSplitting { time_step })
        .unwrap();
    let mut path = Vec::<Moment>::new();
    let mut state = start;
    stepper
        .run(&mut state, seconds, &mut |sample: &tumble::Sample<'_>| {
            let normal = sample.state.orientation * DVec3::X;
            let azimuth = normal.y.atan2(normal.x);
            let turns = path
                .last()
                .map_or(0.0, |last| ((last.azimuth - azimuth) / TAU).round() * TAU);
            path.push(Moment {
                time: sample.time,
                alpha: normal.z.clamp(-1.0, 1.0).acos(),
                azimuth: azimuth + turns,
                place: sample.state.position,
            });
            core::ops::ControlFlow::Continue(())
        })
        .unwrap();
    path
}

fn mean_alpha(path: &[Moment]) -> f64 {
    path.iter().map(|moment| moment.alpha).sum::<f64>() / path.len() as f64
}

fn mean_rate(path: &[Moment]) -> f64 {
    let (first, last) = (path[0], path[path.len() - 1]);
    (last.azimuth - first.azimuth) / (last.time - first.time)
}

/// Angular frequency (rad/s) of the oscillations of `α` near `guess`: of the sine that, with a
/// constant and a steady drift, fits best.
fn frequency(path: &[Moment], guess: f64) -> f64 {
    let (mut low, mut high) = (0.8 * guess, 1.2 * guess);
    // Golden section.
    let part = 0.5 * (5.0_f64.sqrt() - 1.0);
    for _ in 0..40 {
        let [left, right] = [high - part * (high - low), low + part * (high - low)];
        if misfit(path, left) < misfit(path, right) {
            high = right;
        } else {
            low = left;
        }
    }
    0.5 * (low + high)
}

/// Remainder that a constant, a drift and an oscillation of one frequency leave of the squares of
/// `α`, by the normal equations.
fn misfit(path: &[Moment], frequency: f64) -> f64 {
    let last = path[path.len() - 1].time;
    let mut products = DMat4::ZERO;
    let (mut sums, mut squares) = (DVec4::ZERO, 0.0);
    for moment in path.iter().step_by(10) {
        let (sin, cos) = (frequency * moment.time).sin_cos();
        let terms = DVec4::new(1.0, moment.time / last - 0.5, sin, cos);
        let alpha = moment.alpha - path[0].alpha;
        products += DMat4::from_cols(
            terms * terms.x,
            terms * terms.y,
            terms * terms.z,
            terms * terms.w,
        );
        sums += terms * alpha;
        squares += alpha * alpha;
    }
    squares - sums.dot(products.inverse() * sums)
}

fn extremes(path: &[Moment]) -> (f64, f64) {
    path.iter().fold((f64::MAX, 0.0), |(low, high), moment| {
        (low.min(moment.alpha), high.max(moment.alpha))
    })
}

static TUMBLE: Case = Case::new(
    "D1",
    "`Ω² sin α = g/(k_d r)`",
    "Moffatt, Nature 404, 833 (2000)",
    || {
        let mut figures = Vec::new();
        for (name, moments) in [("hoop", HOOP), ("disc", DISC)] {
            for degrees in [15.0_f64, 45.0, 75.0] {
                let alpha = degrees.to_radians();
                let rate = (GRAVITY / (moments[1] * RADIUS * alpha.sin())).sqrt();
                let path = path(moments, ICE, start(moments, alpha, 0.0, rate), 2.0);
                let got = mean_rate(&path) * (mean_alpha(&path).sin() / alpha.sin()).sqrt();
                // The load on the arc, 1 - (x/φ)², has its centre at 1 - φ²/10 of the radius: so
                // much shorter is the lever, and half as much lower the rate; a fifth of that for
                // what follows in turn.
                let share = arc(alpha).powi(2) / 20.0;
                figures.push(figure(
                    format!("{name}, {degrees}°: rate, rad/s"),
                    rate,
                    got,
                    1.2 * share * rate,
                ));
            }
        }
        figures
    },
)
.and(&[&ANY_TUMBLE]);

static STEADY: Case = Case::new(
    "D2",
    "`(k_a+1) w Ω sin α - k_d Ω² sin α cos α + (g/r) cos α = 0`, b = r w/Ω",
    "Routh (1905), art. 244; arXiv physics/0008227",
    || {
        let alpha = 75.0_f64.to_radians();
        let mut figures = Vec::new();
        for (name, moments, spin, rate, radius) in [
            ("hoop at 75°, w = 4", HOOP, 4.0, -0.649_648, 3.078_588),
            ("hoop, w = 6", HOOP, 6.0, -0.435_604, 6.886_988),
            ("disc, w = 4", DISC, 4.0, -0.867_191, 2.306_297),
        ] {
            let path = path(
                moments,
                grip(1000.0),
                start(moments, alpha, spin, rate),
                1.0,
            );
            // In one second.
            let turned = mean_rate(&path);
            let chord = (path[path.len() - 1].place - path[0].place)
                .with_z(0.0)
                .length();
            let found = chord / (2.0 * (0.5 * turned).sin()).abs();
            // The friction that holds it on its circle, r w Ω/g of the load, slips at ε r w Ω/(μg)
            // and a little more, outwards: so fast does it lean over, by u/r; Ω goes with cot α. On
            // average over the run, half of it.
            let share = RADIUS * spin * f64::abs(rate) / GRAVITY;
            let slip = grip(1000.0)[1] * share / (1.0 - share);
            let miss = slip / RADIUS * (alpha.tan() + 1.0 / alpha.tan()) / 2.0;
            figures.push(figure(
                format!("{name}: rate, rad/s"),
                rate,
                turned,
                miss * f64::abs(rate),
            ));
            figures.push(figure(
                "radius of the circle, m",
                radius,
                found,
                miss * radius,
            ));
        }
        figures
    },
)
.and(&[&ANY_STEADY]);

/// Rate about the vertical of a disc that rolls steadily at `α` with a spin: the slow root, which
/// friction can hold.
fn steady_rate([axial, diametral]: [f64; 2], alpha: f64, spin: f64) -> f64 {
    let (sin, cos) = alpha.sin_cos();
    let half = 0.5 * (axial + 1.0) * spin * sin;
    let weight = GRAVITY / RADIUS * cos;
    -weight / (half + half.signum() * (half * half + diametral * sin * cos * weight).sqrt())
}

/// Rate (rad/s) at which a disc that rolls steadily under friction of the rate γ (1/s) leans over.
/// The friction that holds it on its circle, a share of the load, slips outwards at ε share/(1 -
/// share), over the radius; and the patch resists the rotation about the vertical,
/// `Ω + (w - Ω cos α) cos α` there, with a torque of `γ M r² φ²/5` of it, which turns the spin's
/// angular momentum, `(k_a + 1) w M r²` with that of the rolling.
fn leans(moments: [f64; 2], alpha: f64, [spin, rate]: [f64; 2], friction: f64) -> f64 {
    let (sin, cos) = alpha.sin_cos();
    let share = (RADIUS * spin * rate / GRAVITY).abs();
    let slip = GRAVITY / friction * share / (1.0 - share);
    let spinning = rate * sin * sin + spin * cos;
    let turn = friction * arc(alpha).powi(2) / 5.0 * spinning / ((moments[0] + 1.0) * spin * sin);
    slip / RADIUS + turn.abs()
}

random! {
    /// Effect of the lean on the rate. As the disc leans over, Ω changes with `cot α`; on average
    /// over the second, half of it. The start, which knows nothing of that, makes it nod besides,
    /// by the rate of leaning over the nod's ω. The radius is known by Ω.
    ANY_STEADY = new(16, "moments, 40° to 85° and spin whose circle is stable");
    fn discs_of_any_moments_roll_round_the_circle_of_routh(
        diametral in 0.15..0.6_f64,
        degrees in 40.0..85.0_f64,
        spin in 3.0..10.0_f64,
    ) |misses| {
        let (moments, alpha) = ([2.0 * diametral, diametral], degrees.to_radians());
        let rate = steady_rate(moments, alpha, spin);
        let nods = nutation(moments, alpha, [spin, rate]);
        prop_assume!(nods > 10.0);
        prop_assume!(RADIUS * spin * rate.abs() < 0.6 * GRAVITY);
        let path = path(moments, grip(1000.0), start(moments, alpha, spin, rate), 1.0);
        let turned = mean_rate(&path);
        let leans = leans(moments, alpha, [spin, rate], 1000.0) * (0.5 + 1.0 / nods.sqrt());
        let miss = leans * (alpha.tan() + 1.0 / alpha.tan());
        misses.near("rate", [turned, rate], miss * rate.abs())?;
        let chord = (path[path.len() - 1].place - path[0].place).with_z(0.0).length();
        let radius = RADIUS * spin / rate.abs();
        misses.near("radius", [chord / (2.0 * (0.5 * turned).sin()).abs(), radius], miss * radius)?;
    }
}

/// Relative effect of friction of the rate γ, 1/s, on the square of an oscillation's
/// frequency ω. The force that holds the contact slips by 1/γ of its acceleration, out of phase:
/// (ω/γ)². The patch resists the rotation about the vertical: `γ φ²/(5 k_d)` of it a second, a
/// fraction of ω.
fn softness(moments: [f64; 2], alpha: f64, frequency: f64, friction: f64) -> f64 {
    let spinning = friction * arc(alpha).powi(2) / (5.0 * moments[1]);
    (frequency / friction).powi(2) + spinning / frequency
}

static UPRIGHT: Case = Case::new(
    "D3",
    "`ω² = k_a(k_a+1)/(k_d(k_d+1)) w² - g/(r(k_d+1))`",
    "Routh (1905)",
    || {
        let mut figures = Vec::new();
        for (name, moments, square) in [("hoop", HOOP, 53.6_f64), ("disc", DISC, 44.32)] {
            let path = path(
                moments,
                grip(100.0),
                start(moments, FRAC_PI_2 - 0.002, 5.0, 0.0),
                4.0,
            );
            let got = frequency(&path, square.sqrt()).powi(2);
            figures.push(figure(
                format!("{name} at w = 5 rad/s: ω², 1/s²"),
                square,
                got,
                square * softness(moments, FRAC_PI_2, square.sqrt(), 100.0),
            ));
        }
        figures
    },
)
.and(&[&ANY_UPRIGHT]);

random! {
    /// `(3/2) (0.002)²` and less for what is not linear.
    ANY_UPRIGHT = new(16, "moments, 1.2 to 4 times the least spin");
    fn upright_discs_of_any_moments_swing_from_side_to_side(
        diametral in 0.15..0.6_f64,
        excess in 1.2..4.0_f64,
    ) |misses| {
        let moments = [2.0 * diametral, diametral];
        let [axial, _] = moments;
        let least = (GRAVITY / RADIUS * diametral / (axial * (axial + 1.0))).sqrt();
        let spin = excess * least;
        let square = (axial * (axial + 1.0) / diametral * spin * spin - GRAVITY / RADIUS) / (diametral + 1.0);
        let path = path(moments, grip(300.0), start(moments, FRAC_PI_2 - 0.002, spin, 0.0), 4.0);
        let got = frequency(&path, square.sqrt()).powi(2);
        // The weight's part of the square is a difference: what moves the spin's part is larger by
        // that.
        let spins = square + GRAVITY / (RADIUS * (diametral + 1.0));
        let miss = softness(moments, FRAC_PI_2, square.sqrt(), 300.0) + 1e-5;
        misses.near("square", [got, square], spins * miss)?;
    }
}

static NUTATION_ROLLING: Case = Case::new(
    "D6",
    "`ω²/Ω² = (1 + (3k_d - 1) cos² α)/(1 + k_d)`",
    "linearised about D1, rolling",
    || {
        let mut figures = Vec::new();
        for (name, moments, degrees, square) in [
            ("hoop", HOOP, 15.0_f64, 0.977_671_f64),
            ("hoop", HOOP, 45.0, 0.833_333),
            ("disc", DISC, 15.0, 0.613_397),
            ("disc", DISC, 45.0, 0.700_000),
        ] {
            let alpha = degrees.to_radians();
            let rate = (GRAVITY / (moments[1] * RADIUS * alpha.sin())).sqrt();
            let rolling_start = swinging(moments, alpha, [0.0, rate]);
            let path = path(moments, grip(100.0), rolling_start, 2.0);
            let got = (frequency(&path, rate * square.sqrt()) / mean_rate(&path)).powi(2);
            // The patch resists the rotation about the vertical: in the run it takes γ φ² t/(5 k_d)
            // of it.
            let spinning = 100.0 * arc(alpha).powi(2) * 2.0 / (5.0 * moments[1]);
            figures.push(figure(
                format!("{name}, {degrees}°: ω²/Ω²"),
                square,
                got,
                spinning * square,
            ));
        }
        figures
    },
)
.and(&[&ANY_NUTATION_ROLLING]);

random! {
    /// Tolerance as in the printed cases, with the softness of friction in addition to the
    /// spinning.
    ANY_NUTATION_ROLLING = new(16, "moments, 15° to 75°");
    fn discs_of_any_moments_that_tumble_rolling_nod_at_the_rate_of_small_swings(
        diametral in 0.15..0.6_f64,
        degrees in 15.0..75.0_f64,
    ) |misses| {
        let (moments, alpha) = ([2.0 * diametral, diametral], degrees.to_radians());
        let rate = (GRAVITY / (diametral * RADIUS * alpha.sin())).sqrt();
        let square = rate * rate * (1.0 + (3.0 * diametral - 1.0) * alpha.cos().powi(2)) / (1.0 + diametral);
        let path = path(moments, grip(200.0), swinging(moments, alpha, [0.0, rate]), 2.0);
        let turned = mean_rate(&path);
        let got = (frequency(&path, square.sqrt()) / turned).powi(2);
        let spinning = 200.0 * arc(alpha).powi(2) * 2.0 / (5.0 * diametral);
        let miss = spinning + (square.sqrt() / 200.0).powi(2);
        let expected = square / (rate * rate);
        misses.near("ω²/Ω²", [got, expected], miss * expected)?;
    }
}

/// Contribution of the bed under the rim to `ω²/Ω²` of small oscillations about tumbling on ice, as
/// a fraction of it: `φ² (1/45 + X (1 - X)/9 - tan² α k_d/(15 (k_d + cos² α)))` with
/// `X = ω² r sin α/g`.
///
/// In units of M and r, with `z = sin α (1 - ψ/2)`, `ψ = φ²`, the springs hold
/// `V = B sin² α ψ^(5/2)` and the energy of the motion is
/// `z'²/2 + k_d α'²/2 + p²/(2 k_d sin² α) + g z + V`. At rest in ψ, `V = g sin α ψ/5`; in α,
/// `k_d Ω² sin α = g (1 - ψ/10)`, the lever of the load's centre. About that, with s and c for sine
/// and cosine:
///
/// `W_αα = 3 g c²/s (1 + ψ/30)`, `W_αψ = g c/2`, `W_ψψ = 3 g s/(4ψ)`; `M_αα = k_d + c² (1 - ψ)`,
/// `M_αψ = -s c/2`,
///
/// and without ψ, which follows:
/// `ω² (k_d + c²) = 3 g c²/s (1 + ψ/30) + ω² c² ψ - c² ψ (g + ω² s)²/(3 g s)`. So X is changed by
/// `-7/90 + X/9 - X²/9` of ψ, and `1/Ω²` by 1/10. All that is about the angle that belongs to p,
/// which is `tan α ψ/30` above the one without a bed: `sin³ α` goes as `1 + ψ/10`.
fn of_bed(diametral: f64, square: f64, alpha: f64) -> f64 {
    let x = square / diametral;
    let steeper = diametral / (diametral + alpha.cos().powi(2)) * alpha.tan().powi(2) / 15.0;
    arc(alpha).powi(2) * (1.0 / 45.0 + x * (1.0 - x) / 9.0 - steeper)
}

/// Relative error of a measured `ω²/Ω²`: Ω oscillates by 2δ cot α, and the mean over some
/// oscillations and a part misses up to 2/ωt of that; and what follows in turn of the bed's share,
/// twice its square.
fn misses_of_swing(aside: f64, alpha: f64, of_bed: f64) -> f64 {
    8.0 * aside / alpha.tan() / (3.2 * TAU) + 2.0 * of_bed * of_bed
}

static NUTATION_SLIDING: Case = Case::new(
    "D7",
    "`ω²/Ω² = 3k_d cos² α/(k_d + cos² α)`",
    "linearised about D1, frictionless",
    || {
        let mut figures = Vec::new();
        for (name, moments, degrees, square) in [
            ("hoop", HOOP, 15.0_f64, 0.976_627_f64),
            ("hoop", HOOP, 75.0, 0.177_219),
            ("disc", DISC, 15.0, 0.591_506),
            ("disc", DISC, 75.0, 0.158_494),
        ] {
            let alpha = degrees.to_radians();
            let rate = (GRAVITY / (moments[1] * RADIUS * alpha.sin())).sqrt();
            // The angular momentum about the vertical stays, k_d Ω sin² α: so it swings about α
            // itself.
            let aside = 5e-4;
            let faster = rate * (alpha.sin() / (alpha - aside).sin()).powi(2);
            let sliding_start = start(moments, alpha - aside, 0.0, faster);
            let path = path(
                moments,
                ICE,
                sliding_start,
                3.2 * TAU / (rate * square.sqrt()),
            );
            let got = (frequency(&path, rate * square.sqrt()) / mean_rate(&path)).powi(2);
            let of_bed = of_bed(moments[1], square, alpha);
            let miss = misses_of_swing(aside, alpha, of_bed) + of_bed.abs();
            figures.push(figure(
                format!("{name}, {degrees}°: ω²/Ω²"),
                square,
                got,
                miss * square,
            ));
        }
        figures
    },
)
.and(&[&ANY_NUTATION_SLIDING]);

random! {
    /// Tolerance as in the printed cases.
    ANY_NUTATION_SLIDING = new(16, "moments, 15° to 75°");
    fn discs_of_any_moments_that_tumble_on_ice_nod_at_the_rate_of_small_swings(
        diametral in 0.15..0.6_f64,
        degrees in 15.0..75.0_f64,
    ) |misses| {
        let (moments, alpha) = ([2.0 * diametral, diametral], degrees.to_radians());
        let rate = (GRAVITY / (diametral * RADIUS * alpha.sin())).sqrt();
        let square = 3.0 * diametral * alpha.cos().powi(2) / (diametral + alpha.cos().powi(2));
        let aside = 5e-4;
        let faster = rate * (alpha.sin() / (alpha - aside).sin()).powi(2);
        let swing = rate * square.sqrt();
        let path = path(moments, ICE, start(moments, alpha - aside, 0.0, faster), 3.2 * TAU / swing);
        let got = (frequency(&path, swing) / mean_rate(&path)).powi(2);
        let of_bed = of_bed(diametral, square, alpha);
        let miss = misses_of_swing(aside, alpha, of_bed);
        misses.near("ω²/Ω²", [got, square * (1.0 + of_bed)], miss * square)?;
    }
}

static SLIDING_UPRIGHT: Case = Case::new(
    "D8",
    "`ω² = (k_a/k_d)² w² - g/(k_d r)`, lean to `2 (k_a/k_d)² w²/ω² - 1` of the first",
    "linearised upright, frictionless",
    || {
        let mut figures = Vec::new();
        for (spin, grown) in [(3.5, 9.0), (4.0, 4.161_290)] {
            let start = start(HOOP, FRAC_PI_2 - 1e-3, spin, 0.0);
            let path = path(HOOP, ICE, start, 4.0);
            let (low, _) = extremes(&path);
            // Not quite linear, by the square of the lean, and the load's centre, φ²/10 up, on
            // g/(k_d r), which is almost all of what the spin must overcome.
            let pull = GRAVITY / (HOOP[1] * RADIUS);
            let share = pull / (4.0 * spin * spin - pull);
            let miss = (1e-3_f64 * grown).powi(2) + arc(FRAC_PI_2).powi(2) / 5.0;
            figures.push(figure(
                format!("hoop, w = {spin} rad/s: largest lean by first"),
                grown,
                (FRAC_PI_2 - low) / 1e-3,
                (grown + 1.0) * share * miss,
            ));
        }
        figures
    },
)
.and(&[&ANY_SLIDING_UPRIGHT]);

random! {
    /// Tolerance as in the printed cases; half an oscillation is observed as a whole.
    ANY_SLIDING_UPRIGHT = new(16, "moments, 1.05 to 2 times the least spin");
    fn spin_alone_keeps_discs_of_any_moments_on_ice_upright(
        diametral in 0.15..0.6_f64,
        excess in 1.05..2.0_f64,
    ) |misses| {
        // k_a/k_d = 2.
        let moments = [2.0 * diametral, diametral];
        let pull = GRAVITY / (diametral * RADIUS);
        let spin = excess * pull.sqrt() / 2.0;
        let square = 4.0 * spin * spin - pull;
        let grown = 8.0 * spin * spin / square - 1.0;
        let first = 1e-3;
        let path = path(moments, ICE, start(moments, FRAC_PI_2 - first, spin, 0.0), 1.2 * PI / square.sqrt());
        let (low, _) = extremes(&path);
        let miss = (first * grown).powi(2) + arc(FRAC_PI_2).powi(2) / 5.0;
        misses.near("largest lean by first", [(FRAC_PI_2 - low) / first, grown], (grown + 1.0) * pull / square * miss)?;
    }
}

// -----------------------------------------------------------------------------------------------
// D9, D10: what the dampers under a rim take
// -----------------------------------------------------------------------------------------------

/// Springs S and dampers D under a rim whose points pass the contact at σ. A point at θ from the
/// lowest is `r sin α (φ² - θ²)/2` deep and sinks at `r sin α σ θ`: with `x = θ/φ` and `δ = τσ/φ`,
/// τ = D/S, it supports `(1 - x²)/2 + δx`, from where it comes in, x = 1, to where that is 0, x =
/// -1 + δ. The balance of the load gives φ, as without dampers; the moment of the force,
/// `2δ/3 - δ²/2` for an arc cut at -1 + δ, the power:
///
/// `P = τ M g r sin α σ² (1 - 3δ/4)`, for any number of points and any springs.
///
/// Steady motion with a spin w and a rate Ω has `σ = w - Ω cos α`: a coin that tumbles (w = 0)
/// loses `τ M g² cos² α/k_d`, and one that rolls upright slows down as `v' = -τ (g/r) v/(1 + k_a)`.
///
/// Those two are for δ to 0. Against them a leaning disc of 45° with τ = 10 µs is 0.45 % short in
/// half a second, at 75° 0.04 to 0.2 %: that is 3δ/4 (δ = 0.0066 and 0.0023), the points that let
/// go before they are out, and the change of α. With the angle and the rates of each moment, and
/// 3δ/4, 7e-6 and 3e-5 are left at τ = 10 µs, 6e-4 at δ = 0.1.
fn damped_power(alpha: f64, passing: f64, damping: f64) -> [f64; 2] {
    let delta = damping * passing.abs() / arc(alpha);
    let power = damping * GRAVITY * RADIUS * alpha.sin() * passing * passing;
    [power * (1.0 - 0.75 * delta), delta]
}

/// Energy that a disc loses in half a second, J, and the formula's with the angle and the rates of
/// each moment, with its tolerance.
///
/// Of the next order in δ, 2δ². The damper's force begins with a jump, at x = 1: as points come in
/// one by one, the sum over h/φ of x differs from the integral by up to δh/2φ of 2δ/3, to and fro,
/// a fraction of the time between two points of the run at its end. The heave that is left over
/// from the start, a thousandth of the sag, is an energy of `M g r φ²/2 · 1e-3` at most.
fn loss(moments: [f64; 2], alpha: f64, [spin, rate]: [f64; 2], damping: f64) -> [f64; 3] {
    let friction = if spin == 0.0 { ICE } else { grip(1000.0) };
    let steady = spin - rate * alpha.cos();
    // The splitting's own error in the energy, of order 2, is as large as what these dampers take.
    let next = TAU / 8000.0 / steady.abs();
    let time_step = golden_step(steady, 2e-4);
    let stepper = scene(moments, friction, damping)
        .with_integrator(Rk4 { time_step })
        .unwrap();
    let mut state = start(moments, alpha, spin, rate);
    // Until the patch has settled.
    stepper.advance(&mut state, 0.2).unwrap();
    let (seconds, mut expected, mut before) = (0.5, 0.0, 0.0);
    let sums = |sample: &tumble::Sample<'_>| {
        let [alpha, passing] = passing(moments, sample.state);
        expected += damped_power(alpha, passing, damping)[0] * (sample.time - before);
        before = sample.time;
        core::ops::ControlFlow::Continue(())
    };
    let mut watchers = (tumble::f64::Ledger::new(), sums);
    stepper.run(&mut state, seconds, &mut watchers).unwrap();
    let (ledger, _) = watchers;
    // A point that lifts off before its spring is slack leaves what is in it: the clamp's.
    let lost = -(ledger.work().damper + ledger.work().clamp);
    let [_, delta] = damped_power(alpha, steady, damping);
    let heave = GRAVITY * RADIUS * arc(alpha).powi(2) / 2.0 * 1e-3;
    let come_in = next / seconds;
    [
        lost,
        expected,
        expected * (2.0 * delta * delta + come_in) + heave,
    ]
}

/// `α` of a disc, and the rate `w - Ω cos α` at which its rim passes the contact.
fn passing([axial, diametral]: [f64; 2], state: &State) -> [f64; 2] {
    let normal = state.orientation * DVec3::X;
    let up = (DVec3::Z - normal * normal.z).normalize();
    let momentum = state.angular_momentum / (RADIUS * RADIUS);
    let alpha = normal.z.acos();
    let rate = momentum.dot(up) / (diametral * alpha.sin());
    [alpha, momentum.dot(normal) / axial - rate * normal.z]
}

static DAMPED_BED: Case = Case::new(
    "B10, D9, D10",
    "`P = τ M g r sin α σ² (1 - 3τσ/4φ)`, σ = w - Ω cos α, τ = D/S",
    "the moment of springs and dampers under a rim: derived here",
    || {
        let alpha = 45.0_f64.to_radians();
        let rate = (GRAVITY / (0.5 * RADIUS * alpha.sin())).sqrt();
        let tumbles = loss(HOOP, alpha, [0.0, rate], 1e-5);
        let disc_rate = (GRAVITY / (0.25 * RADIUS * alpha.sin())).sqrt();
        let disc = loss(DISC, alpha, [0.0, disc_rate], 1e-5);
        let rolls = loss(HOOP, FRAC_PI_2, [5.0, 0.0], 2e-5);
        vec![
            figure(
                "hoop that tumbles at 45°, τ = 10 µs: taken in 0.5 s, J",
                tumbles[1],
                tumbles[0],
                tumbles[2],
            ),
            figure(
                "disc that tumbles at 45°, τ = 10 µs: J",
                disc[1],
                disc[0],
                disc[2],
            ),
            figure(
                "hoop that rolls upright at 5 rad/s, τ = 20 µs: J",
                rolls[1],
                rolls[0],
                rolls[2],
            ),
        ]
    },
)
.and(&[&ANY_DAMPED_BED]);

#[test]
fn the_dampers_under_a_rim_take_what_its_points_press_out_of_them() {
    DAMPED_BED.holds();
}

random! {
    ANY_DAMPED_BED = new(24, "moments, tumbling at 20° to 85° or rolling upright, τσ/φ of 0.002 to 0.1");
    fn the_dampers_under_any_rim_take_what_its_points_press_out_of_them(
        diametral in 0.15..0.6_f64,
        degrees in 20.0..85.0_f64,
        tumbles in prop::bool::ANY,
        spin in 4.0..10.0_f64,
        delta in log_uniform(2e-3, 0.1),
    ) |misses| {
        let moments = [2.0 * diametral, diametral];
        let alpha = if tumbles { degrees.to_radians() } else { FRAC_PI_2 };
        let turning = if tumbles {
            [0.0, (GRAVITY / (diametral * RADIUS * alpha.sin())).sqrt()]
        } else {
            [spin, 0.0]
        };
        let damping = delta * arc(alpha) / (turning[0] - turning[1] * alpha.cos()).abs();
        let [got, expected, miss] = loss(moments, alpha, turning, damping);
        misses.near("work", [got, expected], miss)?;
    }
}

// -----------------------------------------------------------------------------------------------
// D11: swings about any steady rolling
// -----------------------------------------------------------------------------------------------

/// Square of the frequency of small oscillations about steady rolling. With
/// `(k_a + 1) w' = Ω α' sin α` and `k_d (Ω' sin α + 2 Ω α' cos α) = k_a w α'` in
/// `(1 + k_d) α'' = -(g/r) cos α + k_d Ω² sin α cos α - (k_a + 1) w Ω sin α`, a small change of α
/// obeys
/// `(1 + k_d) ω² = k_a (k_a + 1) w²/k_d - (3 k_a + 1) w Ω cos α + Ω² (sin² α + k_d (1 + 2 cos² α)) - (g/r) sin α`.
/// Upright it is D3, without spin D6.
fn nutation([axial, diametral]: [f64; 2], alpha: f64, [spin, rate]: [f64; 2]) -> f64 {
    let (sin, cos) = alpha.sin_cos();
    let gyroscopic =
        axial * (axial + 1.0) * spin * spin / diametral - (3.0 * axial + 1.0) * spin * rate * cos;
    let centrifugal = rate * rate * (sin * sin + diametral * (1.0 + 2.0 * cos * cos));
    (gyroscopic + centrifugal - GRAVITY / RADIUS * sin) / (1.0 + diametral)
}

/// Rolling, at the end of an oscillation of 5 mrad about steady motion: spin and rate as they are
/// there.
fn swinging(moments: [f64; 2], alpha: f64, [spin, rate]: [f64; 2]) -> State {
    let [axial, diametral] = moments;
    let (sin, cos) = alpha.sin_cos();
    let aside = -0.005;
    let more_spin = rate * sin / (axial + 1.0) * aside;
    let more_rate = (axial * spin - 2.0 * diametral * rate * cos) / (diametral * sin) * aside;
    start(moments, alpha + aside, spin + more_spin, rate + more_rate)
}

/// The square of the frequency of a disc's swings about steady rolling, and the formula's, with its
/// tolerance: the softness of friction, of the spin's part; how α changes meanwhile, half of it on
/// average; and what is not linear, some squares of 5 mrad.
fn swings(moments: [f64; 2], alpha: f64, spin: f64) -> [f64; 3] {
    let (friction, seconds) = (300.0, 2.0);
    let rate = steady_rate(moments, alpha, spin);
    let square = nutation(moments, alpha, [spin, rate]);
    let path = path(
        moments,
        grip(friction),
        swinging(moments, alpha, [spin, rate]),
        seconds,
    );
    let got = frequency(&path, square.sqrt()).powi(2);
    let leaning = 0.5 * seconds * leans(moments, alpha, [spin, rate], friction);
    let leant = alpha - leaning;
    let there = nutation(moments, leant, [spin, steady_rate(moments, leant, spin)]);
    let spins = square + GRAVITY / RADIUS * alpha.sin() / (1.0 + moments[1]);
    let soft = softness(moments, alpha, square.sqrt(), friction) + 4.0 * 0.005_f64.powi(2);
    [got, square, (there - square).abs() + spins * soft]
}

static NUTATION_OF_ANY: Case = Case::new(
    "D11",
    "`(1+k_d) ω² = k_a(k_a+1) w²/k_d - (3k_a+1) wΩ cos α + Ω² (sin² α + k_d (1 + 2cos² α)) - (g/r) sin α`",
    "Routh (1905), art. 244; Stanislavsky & Weron, Physica D 156, 247 (2001)",
    || {
        [("hoop", HOOP), ("disc", DISC)]
            .map(|(name, moments)| {
                let [got, square, miss] = swings(moments, 60.0_f64.to_radians(), 5.0);
                figure(format!("{name} that rolls round at 60°, w = 5 rad/s: ω², 1/s²"), square, got, miss)
            })
            .to_vec()
    },
)
.and(&[&ANY_NUTATION]);

#[test]
fn a_disc_that_rolls_round_a_circle_nods() {
    NUTATION_OF_ANY.holds();
    // The formula's own limits.
    let upright = nutation(HOOP, FRAC_PI_2, [5.0, 0.0]);
    assert!((upright - 53.6).abs() < 1e-9, "{upright}");
    let (alpha, rate) = (
        TAU / 8.0,
        (2.0 * GRAVITY / (RADIUS * (TAU / 8.0).sin())).sqrt(),
    );
    let tumbling = nutation(HOOP, alpha, [0.0, rate]) / (rate * rate);
    assert!((tumbling - 2.5 / 3.0).abs() < 1e-12, "{tumbling}");
}

random! {
    ANY_NUTATION = new(16, "moments, 45° to 85° and spin whose circle is stable");
    fn discs_of_any_moments_that_roll_round_a_circle_nod(
        diametral in 0.15..0.6_f64,
        degrees in 45.0..85.0_f64,
        spin in 3.0..10.0_f64,
    ) |misses| {
        let (moments, alpha) = ([2.0 * diametral, diametral], degrees.to_radians());
        let rate = steady_rate(moments, alpha, spin);
        prop_assume!(nutation(moments, alpha, [spin, rate]) > 20.0);
        prop_assume!(RADIUS * spin * rate.abs() < 0.5 * GRAVITY);
        let [got, square, miss] = swings(moments, alpha, spin);
        misses.near("square", [got, square], miss)?;
    }
}

/// Largest lean (rad) of a hoop that starts upright but for a thousandth of a radian, in 4 s.
fn largest_lean(spin: f64, friction: [f64; 2]) -> f64 {
    let path = path(
        HOOP,
        friction,
        start(HOOP, FRAC_PI_2 - 1e-3, spin, 0.0),
        4.0,
    );
    FRAC_PI_2 - extremes(&path).0
}

#[test]
fn a_hoop_that_rolls_slower_than_half_the_root_of_gr_falls_over() {
    // Case D3: v² > gr/4. The oscillation about the mean lean grows without end on one side of it
    // only; how fast it grows, √|ω²| = 1.3/s, tells within 4 s 5 % below the limit.
    let limit = (GRAVITY / (4.0 * RADIUS)).sqrt();
    assert!(largest_lean(1.1 * limit, grip(1000.0)) < 0.05);
    assert!(largest_lean(0.9 * limit, grip(1000.0)) > 0.2);
}

#[test]
fn a_hoop_on_ice_falls_over_below_the_root_of_g_over_2r() {
    // Case D8: w² > g/2r: 3.130 rad/s.
    assert!(largest_lean(3.2, ICE) < 0.05);
    assert!(largest_lean(3.05, ICE) > 0.2);
}

random! {
    /// Case D1 for any moments, from a heavy hub to a heavy rim.
    ANY_TUMBLE = new(30, "moments, from a heavy hub to a heavy rim, 15° to 75°");
    fn discs_of_any_moments_tumble_at_moffatts_rate(
        diametral in 0.1..0.6_f64,
        degrees in 15.0..75.0_f64,
    ) |misses| {
        let (moments, alpha) = ([2.0 * diametral, diametral], degrees.to_radians());
        let rate = (GRAVITY / (diametral * RADIUS * alpha.sin())).sqrt();
        let path = path(moments, ICE, start(moments, alpha, 0.0, rate), 1.0);
        let got = mean_rate(&path) * (mean_alpha(&path).sin() / alpha.sin()).sqrt();
        // As there, in half the time: the mean over an oscillation and a part is less good.
        misses.near("rate", [got, rate], arc(alpha).powi(2) / 10.0 * rate)?;
    }
}

#[test]
fn a_coin_whose_centre_stays_tumbles_at_moffatts_rate() {
    TUMBLE.holds();
}

#[test]
fn a_coin_rolls_round_the_circle_of_routh() {
    STEADY.holds();
}

#[test]
fn an_upright_hoop_that_rolls_swings_from_side_to_side() {
    UPRIGHT.holds();
}

#[test]
fn a_coin_that_tumbles_nods_at_the_rate_of_small_swings() {
    NUTATION_ROLLING.holds();
    NUTATION_SLIDING.holds();
}

#[test]
fn spin_alone_keeps_a_hoop_on_ice_upright() {
    SLIDING_UPRIGHT.holds();
}
