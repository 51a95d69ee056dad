//! Group E, blocks and coins that rock on edges, and when they topple.

use core::f64::consts::{FRAC_PI_2, PI};
use core::ops::ControlFlow;

use proptest::prelude::*;
use tumble::glam::DVec3;
use tumble::{
    Coin, Coulomb, Cuboid, EnergyMomentum, FlatGround, Plane, Sample, State, Stepper,
    UniformGravity,
};

use crate::kit;
use crate::table::{Case, figure};

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

// ---------------------------------------------------------------------------------------------------------------------
// E1: a rocking block
// ---------------------------------------------------------------------------------------------------------------------

/// Time (in 1/p) from rest at a lean θ₀ of `share` of the block's own angle to upright: `θ'' = -p² sin(α - θ)`, so `θ'² = 2p² (cos(α - θ₀) - cos(α - θ))`. The integral of `dθ/θ'`, by Simpson's rule in s with
/// `θ = θ₀ (1 - s²)`, which takes the root at the start away.
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

/// A block of `b` = 0.1 m and an angle that leans at rest by `first` (rad) over its corner +x: the time until it is upright, the share of the rate that the impact leaves, and the
/// depth at which it stands.
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
    let mut state =
        State::at(DVec3::Z * (radius * (alpha - first).cos() - depth)).turned_by(DVec3::Y * first);
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
        // It stands with four corners in the ground, half as deep as on two: upright comes earlier by that angle, at 1 rad/s. The lean is known to the slip of the corner, ε for a while.
        let late = 4.0 * (depth / 0.2 + 1e-5);
        // The corner leaves with (2ζ)^-2 of its speed and adds as much to the impact; the corners' depth changes the turning point's height.
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
);

#[test]
fn a_rocking_block_keeps_housners_time_and_loses_his_share() {
    HOUSNER.holds();
    // The printed time is four times the integral of the pendulum equation.
    let p = (3.0 * 9.8 / (4.0 * 0.1_f64.hypot(0.1 / 15.0_f64.to_radians().tan()))).sqrt();
    let period = 4.0 * fall(15.0_f64.to_radians(), 0.5) / p;
    assert!((period - 1.210_218).abs() < 5e-7, "{period}");
}

proptest! {
    #![proptest_config(kit::cases(12))]

    #[test]
    fn blocks_of_any_slenderness_rock_by_the_pendulum_equation_and_housners_loss(
        degrees in 8.0..25.0_f64,
        share in 0.3..0.7_f64,
    ) {
        let alpha = degrees.to_radians();
        let [upright, left, depth] = rock(alpha, share * alpha);
        let p = (3.0 * GRAVITY * alpha.sin() / (4.0 * 0.1)).sqrt();
        // It passes upright with a rate of at least p α √share.
        let late = (depth / 0.2 + 1e-5) / (p * alpha * share.sqrt());
        prop_assert!((upright - fall(alpha, share) / p).abs() < 2.0 * late, "{upright} s");
        let lost = 1.5 * alpha.sin().powi(2);
        prop_assert!((left - (1.0 - lost)).abs() < lost * 2e-3 + depth / (0.1 * share * alpha), "{left}, not {}", 1.0 - lost);
    }
}

// ---------------------------------------------------------------------------------------------------------------------
// E3: a flat coin does not rock in a plane
// ---------------------------------------------------------------------------------------------------------------------

static FLAT_RING: Case = Case::new(
    "E3",
    "impact of opposite points `θ'₁/θ'₀ = (k_d - 1)/(k_d + 1) < 0`",
    "plastic impact of a rigid ring",
    || {
        // A ring of 120 points on 1e4 N/m a point, ζ = 3 a point of the mass, let go at a tilt of 0.1 rad.
        let stepper = Stepper::new(Coin::ring(1.0, 0.5))
            .unwrap()
            .with_gravity(UniformGravity::down(GRAVITY))
            .unwrap()
            .with_ground(FlatGround::level(1e4, 600.0))
            .unwrap()
            .with_integrator(EnergyMomentum { time_step: 5e-4 })
            .unwrap();
        let tilt = |state: &State| {
            let normal = state.orientation * DVec3::X;
            normal.x.atan2(normal.z.abs())
        };
        let mut state =
            State::at(DVec3::Z * 0.5 * 0.1_f64.sin()).turned_by(DVec3::Y * (FRAC_PI_2 - 0.1));
        let first = tilt(&state);
        let (mut other, mut aside): (f64, f64) = (0.0, 0.0);
        stepper
            .run(&mut state, 2.0, &mut |sample: &Sample<'_>| {
                other = other.max(-tilt(sample.state) * first.signum());
                aside = aside.max((sample.state.orientation * DVec3::X).y.abs());
                ControlFlow::Continue(())
            })
            .unwrap();
        // It stays in its plane, to rounding and what a second of falling makes of it.
        assert!(aside < 1e-7, "{aside:e} rad out of the plane");
        // The bed gives way by the depth of a whole arc that stops 0.5 m/s: v √(m/(N S)) with the damper's help, over the radius.
        let soft = 0.7 * f64::sqrt(1.0 / 1.2e6) / 0.5;
        vec![figure(
            "ring let go at 0.1 rad: largest opposite tilt, rad",
            0.0,
            other,
            soft,
        )]
    },
);

#[test]
fn a_flat_ring_does_not_rock_from_side_to_side() {
    FLAT_RING.holds();
}

// ---------------------------------------------------------------------------------------------------------------------
// E4: toppling on a slope
// ---------------------------------------------------------------------------------------------------------------------

/// Whether a block that is set down on a slope of tangent `t` topples within 3 s.
fn topples(half: [f64; 2], coefficient: f64, tangent: f64) -> bool {
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
        .turned_by(DVec3::Y * (tangent.atan() + depth / (2.0 * half[0])));
    let seconds = stepper
        .run(&mut state, 3.0, &mut |sample: &Sample<'_>| {
            if lean(sample.state) > 0.25 * PI + tangent.atan() {
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        })
        .unwrap();
    seconds < 2.9
}

static TIPPING: Case = Case::new(
    "E4",
    "topples iff `tan θ > b/h`, where `μ > b/h`",
    "statics of a block, e.g. Lamb, Statics (1912)",
    || {
        let half = [0.1, 0.2];
        let (mut low, mut high) = (0.4, 0.6);
        for _ in 0..10 {
            let middle = 0.5 * (low + high);
            if topples(half, 1.0, middle) {
                high = middle;
            } else {
                low = middle;
            }
        }
        // The corners stand in 5 µm; the block turns by as much over its width, b/h moves by 1 + (b/h)² of it. Then what is left of the bisection, and what needs more than 3 s: the fall
        // begins as e^{pt} of the excess, p = 6/s, e^-18 of it.
        let sag = GRAVITY / 2e6 / 0.2;
        vec![figure(
            "block twice as high as wide: tangent of the slope",
            0.5,
            low,
            1.25 * sag * 2.0 + 2e-4,
        )]
    },
);

#[test]
fn a_block_topples_on_a_slope_steeper_than_its_diagonal_unless_it_slides() {
    TIPPING.holds();
    // With less friction than b/h it slides at any slope, and stands.
    assert!(!topples([0.1, 0.2], 0.3, 0.6));
}
