//! Group E, blocks and coins that rock on edges, and when they topple.

use core::f64::consts::{FRAC_PI_2, PI};
use core::ops::ControlFlow;

use proptest::prelude::prop_assert;
use tumble::glam::{DMat3, DVec3};
use tumble::{
    Coin, ContactPoint, Coulomb, Cuboid, EnergyMomentum, FlatGround, Plane, RigidPointBody, Sample,
    State, UniformGravity,
};

use crate::kit::erased::Stepper;
use crate::kit::{Solid, log_uniform};
use crate::table::{Case, figure, random};

pub(crate) const CASES: &[&Case] = &[&HOUSNER, &FLAT_RING, &TIPPING];

const GRAVITY: f64 = 9.8;

/// A block of 1 kg, `2b` wide along x and y, `2h` high, on its corners.
fn block([b, h]: [f64; 2]) -> Cuboid {
    Cuboid::solid(1.0, DVec3::new(b, b, h) * 2.0)
}

/// Angle (rad) by which the block's own z leans towards +x.
fn lean(state: &State) -> f64 {
    let up = state.orientation * DVec3::Z;
    up.x.atan2(up.z)
}

// -----------------------------------------------------------------------------------------------
// E1: a rocking block
// -----------------------------------------------------------------------------------------------

/// Time (in 1/p) from rest at a lean θ₀ of `share` of the block's own angle to upright:
/// `θ'' = -p² sin(α - θ)`, so `θ'² = 2p² (cos(α - θ₀) - cos(α - θ))`. The integral of `dθ/θ'`, by
/// Simpson's rule in s with `θ = θ₀ (1 - s²)`, which takes the root at the start away.
fn fall(alpha: f64, share: f64) -> f64 {
    let first = share * alpha;
    // The difference of cosines as a product, so that nothing cancels.
    let rate = |s: f64| {
        let (sum, difference) = (2.0 * (alpha - first) + first * s * s, first * s * s);
        (4.0 * (0.5 * sum).sin() * (0.5 * difference).sin()).sqrt()
    };
    let integrand = |s: f64| match s {
        0.0 => 2.0 * first / (2.0 * first * (alpha - first).sin()).sqrt(),
        s => 2.0 * first * s / rate(s),
    };
    let parts = 200;
    let sum: f64 = (0..=parts)
        .map(|i| {
            let weight = match i {
                0 => 1.0,
                i if i == parts => 1.0,
                i if i % 2 == 1 => 4.0,
                _ => 2.0,
            };
            weight * integrand(f64::from(i) / f64::from(parts))
        })
        .sum();
    sum / (3.0 * f64::from(parts))
}

/// A block of `b` = 0.1 m and an angle that leans at rest by `first` (rad) over its corner +x: the
/// time until it is upright, the fraction of the rate that the impact leaves, and the depth at
/// which it stands.
fn rock(alpha: f64, first: f64) -> [f64; 3] {
    let (b, h) = (0.1, 0.1 / alpha.tan());
    // Hard, and so strongly damped that a corner leaves with a thousandth of its speed (ζ = 16).
    let (stiffness, damping) = (1e7, 1e5);
    let stepper = Stepper::new(block([b, h]))
        .unwrap()
        .with_gravity(UniformGravity::down(GRAVITY))
        .unwrap()
        .with_ground(FlatGround::level(stiffness, damping))
        .unwrap()
        .with_friction(Coulomb {
            coefficient: 20.0,
            slip_speed: 1e-5,
        })
        .unwrap()
        // The step in which the corners change places counts for both: of order 1 in it.
        .with_integrator(EnergyMomentum { time_step: 2e-5 })
        .unwrap();
    // Two corners carry it.
    let depth = 0.5 * GRAVITY / stiffness;
    let radius = b.hypot(h);
    let mut state = State::at(DVec3::Z * (radius * (alpha - first).cos() - depth))
        .with_rotation_vector(DVec3::Y * first);
    // Down, up on the other side, and a tenth of that.
    let p = (3.0 * GRAVITY / (4.0 * radius)).sqrt();
    let seconds = 2.1 * fall(alpha, first / alpha) / p;
    let (mut upright, mut other) = (0.0, 0.0);
    let mut before = (0.0, first);
    stepper
        .run(&mut state, seconds, &mut |sample: &Sample<'_>| {
            let now = (sample.time, lean(sample.state));
            if upright == 0.0 && now.1 <= 0.0 {
                upright = before.0 + (now.0 - before.0) * before.1 / (before.1 - now.1);
            }
            other = f64::max(other, -now.1);
            before = now;
            ControlFlow::Continue(())
        })
        .unwrap();
    // Each side's energy: (2/3) m R² θ'² = m g R (cos(α - θ) - cos α) at the turning point θ.
    let energy = |angle: f64| (alpha - angle).cos() - alpha.cos();
    [upright, (energy(other) / energy(first)).sqrt(), depth]
}

static HOUSNER: Case = Case::new(
    "E1",
    "`p² = 3g/4R`, `θ'' = -p² sin(α - θ)`, impact `θ'₁/θ'₀ = 1 - (3/2) sin² α`",
    "Housner, Bull. Seism. Soc. Am. 53, 403 (1963)",
    || {
        let alpha = 15.0_f64.to_radians();
        let [upright, left, depth] = rock(alpha, alpha / 2.0);
        // It stands with four corners in the ground, half as deep as on two: upright comes earlier
        // by that angle, at 1 rad/s. The lean is known to the slip of the corner, ε for a while.
        let late = 4.0 * (depth / 0.2 + 1e-5);
        // The corner leaves with (2ζ)^-2 of its speed and adds as much to the impact; the corners'
        // depth changes the turning point's height.
        let lost = 1.5 * alpha.sin().powi(2);
        vec![
            figure(
                "block, α = 15°, from α/2: period before a loss, s",
                1.210_218,
                4.0 * upright,
                late,
            ),
            figure(
                "rate after the impact",
                0.899_519,
                left,
                lost * 2e-3 + depth / 0.1,
            ),
        ]
    },
)
.and(&[&ANY_HOUSNER]);

#[test]
fn a_rocking_block_keeps_housners_time_and_loses_his_share() {
    HOUSNER.holds();
    // The printed time is four times the integral of the pendulum equation.
    let p = (3.0 * 9.8 / (4.0 * 0.1_f64.hypot(0.1 / 15.0_f64.to_radians().tan()))).sqrt();
    let period = 4.0 * fall(15.0_f64.to_radians(), 0.5) / p;
    assert!((period - 1.210_218).abs() < 5e-7, "{period}");
}

random! {
    ANY_HOUSNER = new(12, "block of α = 8° to 25°, let go at 0.3 α to 0.7 α");
    fn blocks_of_any_slenderness_rock_by_the_pendulum_equation_and_housners_loss(
        degrees in 8.0..25.0_f64,
        share in 0.3..0.7_f64,
    ) |misses| {
        let alpha = degrees.to_radians();
        let [upright, left, depth] = rock(alpha, share * alpha);
        let p = (3.0 * GRAVITY * alpha.sin() / (4.0 * 0.1)).sqrt();
        // It passes upright with a rate of at least p α √share.
        let late = (depth / 0.2 + 1e-5) / (p * alpha * share.sqrt());
        misses.near("time", [upright, fall(alpha, share) / p], 2.0 * late)?;
        let lost = 1.5 * alpha.sin().powi(2);
        // The corner comes down at 2 b θ', θ'² = p² α² (1 - (1 - share)²): it goes on for a step,
        // 20 µs, and for m/4D, 2.5 µs, as deep as that.
        let speed = 0.2 * p * alpha * (share * (2.0 - share)).sqrt();
        let deeper = depth + 2.25e-5 * speed;
        misses.near("rate left", [left, 1.0 - lost], lost * 2e-3 + deeper / (0.1 * share * alpha))?;
    }
}

// -----------------------------------------------------------------------------------------------
// E3: a flat coin does not rock in a plane
// -----------------------------------------------------------------------------------------------

/// Largest tilt (rad) to the other side, and out of the plane, of a flat body of 1 kg and a radius
/// (m), its normal along body x, that is released at `first` (rad) over its point at +z.
fn tilts(
    body: impl RigidPointBody,
    ground: FlatGround,
    radius: f64,
    first: f64,
    [seconds, time_step]: [f64; 2],
) -> [f64; 2] {
    let stepper = Stepper::new(body)
        .unwrap()
        .with_gravity(UniformGravity::down(GRAVITY))
        .unwrap()
        .with_ground(ground)
        .unwrap()
        .with_integrator(EnergyMomentum { time_step })
        .unwrap();
    let tilt = |state: &State| {
        let normal = state.orientation * DVec3::X;
        normal.x.atan2(normal.z.abs())
    };
    let mut state = State::at(DVec3::Z * radius * first.sin())
        .with_rotation_vector(DVec3::Y * (FRAC_PI_2 - first));
    let side = tilt(&state).signum();
    let (mut other, mut aside): (f64, f64) = (0.0, 0.0);
    stepper
        .run(&mut state, seconds, &mut |sample: &Sample<'_>| {
            other = other.max(-tilt(sample.state) * side);
            aside = aside.max((sample.state.orientation * DVec3::X).y.abs());
            ControlFlow::Continue(())
        })
        .unwrap();
    [other, aside]
}

/// A flat body of 1 kg, its normal along body x, with a moment of `moment r²` about y and z.
fn flat_body(radius: f64, moment: f64, contacts: Vec<ContactPoint>) -> Solid {
    let inertia = DVec3::new(2.0 * moment, moment, moment) * (radius * radius);
    Solid {
        mass: 1.0,
        inertia: DMat3::from_diagonal(inertia),
        contacts,
    }
}

random! {
    /// Checks moments from a hub (k_d = 0.1) to a ring (1/2). After the first impact the rate would
    /// have to be negative, so it stays down, but for the bed, which gives way as in the printed
    /// case: by the depth at which a whole arc, half of the points, stops a rim at √(2 g r ε (k_d +
    /// 1))/(k_d + 1), that of a fall from the tilt ε: `v/ω`, and half as much for the arc's ends,
    /// over the radius.
    ANY_FLAT_RING = new(12, "moment k_d of 0.1 to 1/2, 8 to 200 points, tilt of 0.02 to 0.2 rad: no rocking");
    fn flat_bodies_with_less_than_a_rings_moment_do_not_rock(
        pairs in 4..100_usize,
        moment in 0.1..0.5_f64,
        first in log_uniform(0.02, 0.2),
        ratio in 1.0..5.0_f64,
    ) |misses| {
        let (radius, count) = (0.5, 2 * pairs);
        let contacts = Coin::ring_with_storage(vec![ContactPoint::default(); count], 1.0, radius).contacts().to_vec();
        // As stiff together as the printed ring.
        let stiffness = 1.2e6 / count as f64;
        let damping = 2.0 * ratio * stiffness.sqrt();
        let ground = FlatGround::level(stiffness, damping);
        let [other, aside] = tilts(flat_body(radius, moment, contacts), ground, radius, first, [1.0, 5e-4]);
        let speed = (2.0 * GRAVITY * radius * first / (moment + 1.0)).sqrt();
        let soft = 1.5 * speed / 6e5_f64.sqrt() / radius;
        misses.within("opposite tilt", other, soft)?;
        misses.within("out of the plane", aside, 1e-7)?;
    }
}

random! {
    /// A dumbbell with more than that does rock, and with the fraction that the formula says: two
    /// opposite points, k_d > 1. About a point on the ground `ε'² = 2 g sin ε/((k_d + 1) r)`, so
    /// that the fraction is the root of the sines' ratio.
    ///
    /// The dampers (1e5 N s/m under 1 kg) stop a point within 10 µs: it penetrates by `v m/D`,
    /// which the springs (1e7 N/m) hand back at 100/s; and the step, 20 µs, decides to its first
    /// order when the points change places. Each counts as `v m/D` or `v dt` of the height `r ε` of
    /// an oscillation.
    FLAT_ROCKER = new(12, "dumbbell, k_d of 1.5 to 6, on two points: `(k_d - 1)/(k_d + 1)`");
    fn flat_bodies_with_more_than_a_pairs_moment_rock_and_lose_their_share(
        moment in 1.5..6.0_f64,
        first in log_uniform(0.05, 0.3),
    ) |misses| {
        let (radius, dt) = (0.1, 2e-5);
        let contacts = vec![ContactPoint::bare(DVec3::Z * radius), ContactPoint::bare(DVec3::Z * -radius)];
        let fall = (2.0 * first * (moment + 1.0) * radius / GRAVITY).sqrt();
        let ground = FlatGround::level(1e7, 1e5);
        let [other, _] = tilts(flat_body(radius, moment, contacts), ground, radius, first, [2.1 * fall, dt]);
        let expected = (moment - 1.0) / (moment + 1.0);
        let speed = (2.0 * GRAVITY * radius * first / (moment + 1.0)).sqrt();
        let miss = 2.0 * speed * (1e-5 + dt) / (radius * first) / expected;
        misses.near("share", [(other.sin() / first.sin()).sqrt(), expected], miss)?;
    }
}

static FLAT_RING: Case = Case::new(
    "E3",
    "impact of opposite points `θ'₁/θ'₀ = (k_d - 1)/(k_d + 1) < 0`",
    "plastic impact of a rigid ring",
    || {
        // A ring of 120 points on 1e4 N/m a point, ζ = 3 a point of the mass, released at a tilt of
        // 0.1 rad.
        let ground = FlatGround::level(1e4, 600.0);
        let [other, aside] = tilts(Coin::ring(1.0, 0.5), ground, 0.5, 0.1, [2.0, 5e-4]);
        // It stays in its plane, to rounding and what a second of falling makes of it.
        assert!(aside < 1e-7, "{aside:e} rad out of the plane");
        // The bed gives way by the depth of a whole arc that stops 0.5 m/s: v √(m/(N S)) with the
        // damper's help, over the radius.
        let soft = 0.7 * f64::sqrt(1.0 / 1.2e6) / 0.5;
        vec![figure(
            "ring let go at 0.1 rad: largest opposite tilt, rad",
            0.0,
            other,
            soft,
        )]
    },
)
.and(&[&ANY_FLAT_RING, &FLAT_ROCKER]);

#[test]
fn a_flat_ring_does_not_rock_from_side_to_side() {
    FLAT_RING.holds();
}

// -----------------------------------------------------------------------------------------------
// E4: toppling on a slope
// -----------------------------------------------------------------------------------------------

/// Returns true if a block that is set down on a slope of tangent `t` topples within some seconds.
fn topples(half: [f64; 2], coefficient: f64, tangent: f64, longest: f64) -> bool {
    let (sin, cos) = tangent.atan().sin_cos();
    let normal = DVec3::new(sin, 0.0, cos);
    let ground = FlatGround::level(1e6, 1e3).on(Plane::through(DVec3::ZERO, normal));
    let stepper = Stepper::new(block(half))
        .unwrap()
        .with_gravity(UniformGravity::down(GRAVITY))
        .unwrap()
        .with_ground(ground)
        .unwrap()
        .with_friction(Coulomb {
            coefficient,
            slip_speed: 1e-4,
        })
        .unwrap();
    // About to topple it stands on its two lower corners, and leans by their depth over its width.
    let depth = 0.5 * GRAVITY * cos / 1e6;
    let mut state = State::at(normal * (half[1] - 0.5 * depth))
        .with_rotation_vector(DVec3::Y * (tangent.atan() + depth / (2.0 * half[0])));
    let seconds = stepper
        .run(&mut state, longest, &mut |sample: &Sample<'_>| {
            if lean(sample.state) > 0.25 * PI + tangent.atan() {
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        })
        .unwrap();
    seconds < 0.97 * longest
}

/// Tangent of the steepest slope on which a block stands, by bisection.
fn steepest(half: [f64; 2], coefficient: f64, bounds: [f64; 2], halvings: u32) -> f64 {
    // 18 times the time 1/p of its fall, or as long as the printed case's.
    let p = (3.0 * GRAVITY / (4.0 * half[0].hypot(half[1]))).sqrt();
    let [mut low, mut high] = bounds;
    for _ in 0..halvings {
        let middle = 0.5 * (low + high);
        if topples(half, coefficient, middle, 18.0 / p) {
            high = middle;
        } else {
            low = middle;
        }
    }
    low
}

random! {
    /// Tolerance as in the printed case: the sag, by `1 + (b/h)²` of it, what the bisection leaves,
    /// and e^-18 of the excess. With less friction than that it slides, at any slope, and stands.
    ANY_TIPPING = new(8, "block, `b/h` of 0.2 to 1, `μ` on both sides of it");
    fn blocks_of_any_shape_topple_on_a_slope_steeper_than_their_diagonal_unless_they_slide(
        ratio in 0.2..1.0_f64,
        grip in 1.25..3.0_f64,
    ) |misses| {
        let half = [0.1, 0.1 / ratio];
        let bounds = [0.9 * ratio, 1.1 * ratio];
        let found = steepest(half, grip * ratio, bounds, 8);
        let sag = GRAVITY / 2e6 / 0.2;
        misses.near("tangent", [found, ratio], (1.0 + ratio * ratio) * sag * 2.0 + 0.2 * ratio / 256.0)?;
        prop_assert!(!topples(half, 0.8 * ratio, 1.1 * ratio, 1.0));
    }
}

static TIPPING: Case = Case::new(
    "E4",
    "topples iff `tan θ > b/h`, where `μ > b/h`",
    "statics of a block, e.g. Lamb, Statics (1912)",
    || {
        let half = [0.1, 0.2];
        let low = steepest(half, 1.0, [0.4, 0.6], 10);
        // The corners stand in 5 µm; the block rotates by as much over its width, b/h moves by 1 +
        // (b/h)² of it. Then what is left of the bisection, and what needs more than 3 s: the fall
        // begins as e^{pt} of the excess, p = 6/s, e^-18 of it.
        let sag = GRAVITY / 2e6 / 0.2;
        vec![figure(
            "block twice as high as wide: tangent of the slope",
            0.5,
            low,
            1.25 * sag * 2.0 + 2e-4,
        )]
    },
)
.and(&[&ANY_TIPPING]);

#[test]
fn a_block_topples_on_a_slope_steeper_than_its_diagonal_unless_it_slides() {
    TIPPING.holds();
    // With less friction than b/h it slides at any slope, and stands.
    assert!(!topples([0.1, 0.2], 0.3, 0.6, 3.0));
}
