//! Functions of one number of single precision, over the bit patterns of all finite numbers,
//! against double precision.
//!
//! A plain `cargo test` takes every 19,937th pattern, a prime, so that all exponents and all
//! residues of the low bits are met. `TUMBLE_PATTERN_STEP=1 cargo test --release --test limits
//! patterns:: -- --nocapture` takes all of them, and prints the largest errors.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]
// The tests need a newer compiler than the library.
#![allow(clippy::incompatible_msrv)]

use crate::kit::erased::Stepper;
use tumble::glam::Vec3;
use tumble::real::Quaternion;
use tumble::{EnergyMomentum, FlatGround, PointCloud, Real, Rotation, State, UniformGravity};

/// Patterns of the finite numbers from 0 on.
fn patterns() -> impl Iterator<Item = f32> {
    let asked = std::env::var("TUMBLE_PATTERN_STEP").ok();
    let step = asked.map_or(19_937, |step| step.parse().unwrap());
    (0..0x7f80_0000).step_by(step).map(f32::from_bits)
}

/// Difference in units in the last place of the nearest `f32`.
fn units_apart(ours: f32, truth: f64) -> f64 {
    #[allow(clippy::cast_possible_truncation)] // The unit is that of the nearest f32.
    let nearest = (truth as f32).abs();
    let unit = f64::from(nearest.next_up()) - f64::from(nearest);
    (f64::from(ours) - truth).abs() / unit
}

/// The largest error over all patterns, and where it is.
#[derive(Debug, Default)]
struct Worst {
    units: f64,
    at: f32,
    patterns: u64,
}

impl Worst {
    fn meet(&mut self, at: f32, units: f64) {
        self.patterns += 1;
        // A number that is not finite has no error, and no comparison with it holds.
        let is_within = units <= self.units;
        if !is_within {
            (self.units, self.at) = (units, at);
        }
    }

    fn is_below(&self, bound: f64, name: &str) {
        let Self {
            units,
            at,
            patterns,
        } = self;
        println!("{name}: {units:.4} units at {at:e}, {patterns} patterns");
        assert!(
            *units < bound,
            "{name}: {units} units at {at:e}, not {bound}"
        );
    }
}

#[test]
fn sine_and_cosine_are_within_a_unit_in_the_last_place() {
    let [mut sines, mut cosines] = [Worst::default(), Worst::default()];
    for angle in patterns() {
        let (sin, cos) = Real::sin_cos(angle);
        let (true_sin, true_cos) = Real::sin_cos(f64::from(angle));
        sines.meet(angle, units_apart(sin, true_sin));
        cosines.meet(angle, units_apart(cos, true_cos));
        assert_eq!(Real::sin_cos(-angle), (-sin, cos), "{angle:e}");
    }
    sines.is_below(1.0, "sine");
    cosines.is_below(1.0, "cosine");
}

/// The square root is rounded to nearest, by the processor as by `libm`: half a unit.
#[test]
fn square_roots_are_within_half_a_unit() {
    let mut worst = Worst::default();
    for number in patterns() {
        worst.meet(
            number,
            units_apart(Real::sqrt(number), f64::from(number).sqrt()),
        );
    }
    worst.is_below(0.500_001, "square root");
}

/// Error of a quaternion `cos + sin i` in units of 2⁻²³, the last place of numbers from 1 to 2: the
/// larger one of both components.
fn error_of(rotation: Rotation<f32>, [cos, sin]: [f64; 2]) -> f64 {
    let [x, _, _, w] = rotation.to_quat().xyzw();
    let differences = [f64::from(w) - cos, f64::from(x) - sin];
    let per_unit = 1.0 / f64::from(f32::EPSILON);
    // `max` drops a NaN.
    let [a, b] = differences.map(|difference| difference.abs() * per_unit);
    if a.is_nan() || b.is_nan() {
        f64::INFINITY
    } else {
        a.max(b)
    }
}

/// A rotation vector whose square is representable, as far as 2 rad: 1 unit for the sine or cosine
/// of a number up to 1, half a unit for the division and for the product. The half angle is the
/// root of a rounded square: its error is one part in 2²⁴ of up to 1, half a unit of the result.
#[test]
fn rotation_increments_are_within_two_units_of_one() {
    let mut worst = Worst::default();
    for angle in patterns().take_while(|&angle| angle <= 2.0) {
        let rotation = Rotation::<f32>::from_rotation_vector(Vec3::new(angle, 0.0, 0.0));
        let (sin, cos) = Real::sin_cos(0.5 * f64::from(angle));
        worst.meet(angle, error_of(rotation, [cos, sin]));
    }
    worst.is_below(2.0, "rotation increment");
}

/// The Cayley map of any vector along an axis: a square, a sum, a root, a division and a product,
/// each within half a unit of numbers up to 1.
#[test]
fn cayley_rotations_are_within_two_units_of_one() {
    let mut worst = Worst::default();
    // The square of a larger one is not finite.
    for tangent in patterns().take_while(|&tangent| tangent < 1.8e19) {
        let rotation = Rotation::<f32>::cayley(Vec3::new(tangent, 0.0, 0.0));
        let wide = f64::from(tangent);
        let cos = 1.0 / (1.0 + wide * wide).sqrt();
        worst.meet(tangent, error_of(rotation, [cos, wide * cos]));
    }
    worst.is_below(2.0, "Cayley map");
}

/// One step of a body of one point, in flight and into the ground, at each speed: what the energy
/// limiter computes with.
#[test]
fn a_step_at_any_speed_does_not_increase_the_energy() {
    let body = PointCloud::new([Vec3::ZERO], [0.3]).unwrap();
    let stepper = Stepper::new(body)
        .and_then(|stepper| stepper.with_gravity(UniformGravity::down(9.8)))
        .and_then(|stepper| stepper.with_ground(FlatGround::level(700.0, 0.0)))
        .and_then(|stepper| stepper.with_integrator(EnergyMomentum { time_step: 3e-3 }))
        .unwrap();
    let (mut patterns_met, mut refused) = (0_u64, 0_u64);
    // m v² is finite.
    for speed in patterns().take_while(|&speed| speed < 1e19) {
        for (height, velocity) in [(0.7, speed), (0.7, -speed), (-0.01, -speed)] {
            let start =
                State::at(Vec3::Z * height).with_linear_velocity(Vec3::new(0.0, 0.0, velocity));
            let mut state = start;
            let before = stepper.energy(&start).total();
            patterns_met += 1;
            if stepper.step(&mut state).is_err() {
                refused += 1;
                assert_eq!(state, start, "{velocity:e}");
                continue;
            }
            let after = stepper.energy(&state).total();
            assert!(after <= before, "{height} {velocity:e}: {before} {after}");
        }
    }
    println!("limiter: {patterns_met} steps, {refused} refused");
    assert!(
        refused * 100 <= patterns_met,
        "{refused} of {patterns_met} refused"
    );
}
