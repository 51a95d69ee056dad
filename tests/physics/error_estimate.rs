//! Test of the error that a step of an adaptive method states, by a run of that step to rounding.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use crate::kit::erased::Stepper;
use crate::kit::{log_uniform, orientations};
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;
use tumble::glam::DVec3;
use tumble::{
    BogackiShampine32, Coulomb, Cuboid, DormandPrince54, FlatGround, Integrator, Radau5, State,
    UniformGravity,
};

/// A box that is thrown onto level ground, as a strategy draws it.
#[derive(Clone, Debug)]
struct Throw {
    body: Cuboid,
    size: f64,
    ground: FlatGround,
    friction: Coulomb,
    start: State,
    /// Tolerance as a fraction of the size.
    tolerance: f64,
}

fn throws() -> impl Strategy<Value = Throw> {
    let size = log_uniform(0.01, 1.0);
    let material = (
        log_uniform(1e2, 1e5),
        0.0..0.5,
        0.1..0.7,
        log_uniform(1e-3, 1.0),
    );
    let velocity = || prop::array::uniform3(-3.0..3.0_f64).prop_map(DVec3::from);
    let tolerance = log_uniform(1e-7, 1e-2);
    (
        size,
        material,
        orientations(),
        velocity(),
        velocity(),
        tolerance,
    )
        .prop_map(|(size, material, orientation, velocity, spin, tolerance)| {
            let (stiffness, damping, coefficient, slip) = material;
            Throw {
                body: Cuboid::solid(1.0, DVec3::new(1.0, 0.7, 0.4) * size), // kg, m
                size,
                ground: FlatGround::level(stiffness, stiffness.sqrt() * damping),
                friction: Coulomb {
                    coefficient,
                    slip_speed: slip * size,
                },
                start: State {
                    orientation,
                    linear_velocity: velocity * size.sqrt(),
                    angular_momentum: spin * (0.1 * size * size.sqrt()),
                    ..State::at(DVec3::Z * (1.2 * size))
                },
                tolerance,
            }
        })
}

impl Throw {
    fn stepper<I: Integrator>(&self, by: I) -> Stepper<'_, I> {
        Stepper::builder(self.body)
            .ground(self.ground)
            .friction(self.friction)
            .gravity(UniformGravity::down(9.8))
            .integrator(by)
            .build()
            .unwrap()
    }

    /// Displacement by which two states of the body are apart, m. Velocities count for a second, as
    /// in the estimates.
    fn distance<I: Integrator>(&self, by: &Stepper<'_, I>, a: &State, b: &State) -> f64 {
        let radius = 0.65 * self.size;
        let turn = 2.0 * (a.orientation.conjugate() * b.orientation).xyz().length();
        let spin = (by.angular_velocity(a) - by.angular_velocity(b)).length();
        let speed = (a.linear_velocity - b.linear_velocity).length();
        (a.position - b.position).length() + radius * turn + speed + radius * spin
    }

    /// Measures each step whose true error is above a hundredth of the tolerance.
    fn measure<I: Integrator>(&self, of: fn(f64) -> I, errors: &mut Vec<ErrorOfStep>) {
        let tolerance = self.size * self.tolerance;
        let stepper = self.stepper(of(tolerance));
        let reference = self.stepper(Radau5::new(1e-11 * self.size));
        let mut session = stepper.session(self.start);
        while session.time() < 1.5 * self.size.sqrt() && session.step_count() < 200 {
            let mut truth = *session.state();
            let step = session.step().unwrap();
            reference.advance(&mut truth, step.elapsed).unwrap();
            let error = self.distance(&stepper, session.state(), &truth);
            if error > 0.01 * tolerance {
                errors.push(ErrorOfStep {
                    in_estimates: error / step.error_estimate.unwrap(),
                    in_tolerances: error / tolerance,
                });
            }
        }
    }
}

/// True error of a step.
struct ErrorOfStep {
    in_estimates: f64,
    in_tolerances: f64,
}

/// The number that 99 of 100 do not exceed.
fn percentile_99(numbers: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = numbers.collect();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() * 99 / 100]
}

/// Random throws of a box onto springs and dampers, with contacts that close, slip and stick.
///
/// The estimate of a step is that of its formula where the forces are smooth. It indicates what a
/// discontinuity leaves, and can miss the error of a discontinuity that is located to the
/// tolerance. The errors of a run are what the tolerance is chosen for (`adaptive.rs`).
#[test]
fn the_error_of_a_step_in_contact_is_some_tolerances_and_many_estimates_at_most() {
    fn check<I: Integrator>(name: &str, of: fn(f64) -> I, [estimates, tolerances]: [f64; 2]) {
        let mut runner = TestRunner::deterministic();
        let strategy = throws();
        let mut errors = Vec::new();
        for _ in 0..40 {
            let throw = strategy.new_tree(&mut runner).unwrap().current();
            throw.measure(of, &mut errors);
        }
        let in_estimates = percentile_99(errors.iter().map(|error| error.in_estimates));
        let in_tolerances = percentile_99(errors.iter().map(|error| error.in_tolerances));
        let count = errors.len();
        println!(
            "{name}: {count} steps, {in_estimates:.1} estimates, {in_tolerances:.1} tolerances"
        );
        assert!(count > 2000, "{name}: {count} steps");
        assert!(in_estimates < estimates, "{name}: {in_estimates} estimates");
        assert!(
            in_tolerances < tolerances,
            "{name}: {in_tolerances} tolerances"
        );
    }
    check("BogackiShampine32", BogackiShampine32::new, [10.0, 3.0]);
    check("DormandPrince54", DormandPrince54::new, [40.0, 15.0]);
    check("Radau5", Radau5::new, [200.0, 5.0]);
}
