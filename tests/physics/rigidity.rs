//! The body stays rigid (promise G2): distances between its points and the length of its quaternion
//! stay at rounding, however long the run. `tests/limits/long_rigid.rs` takes as many steps as are
//! asked.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use crate::kit::erased::Stepper;
use crate::kit::rigid::{DISTANCE, LENGTH, deformation};
use crate::kit::{
    self, AnyBody, bodies, directions, each_method, log_uniform, orientations, zero_or,
};
use proptest::prelude::*;
use tumble::glam::DVec3;
use tumble::{Coulomb, FlatGround, RigidPointBody, State, StepError, UniformGravity};

/// Angular momentum that rotates the body at about `spin` rad/s, as far as possible: a rod does not
/// spin about itself, and a point not about any axis.
fn momentum_for(body: &AnyBody, spin: DVec3) -> DVec3 {
    body.inertia() * spin
}

proptest! {
    #![proptest_config(kit::cases(200))]

    /// From no spin to 1e4 rad/s, with steps from 1 µs to 1 s: up to a thousand revolutions a step.
    /// The result of Runge-Kutta is then wrong, but the body is still rigid.
    #[test]
    fn a_body_in_flight_keeps_its_shape_at_any_spin_and_step(
        body in bodies(),
        orientation in orientations(),
        axis in directions(),
        spin in zero_or(1e-12, 1e4),
        dt in log_uniform(1e-6, 1.0),
    ) {
        let points = body.places();
        let start = State::default().with_orientation(orientation);
        each_method!(dt, |integrator, method| {
            let stepper = Stepper::new(&*body).unwrap().with_integrator(integrator).unwrap();
            let mut state = start.with_angular_momentum(momentum_for(&body, axis * spin));
            for _ in 0..300 {
                stepper.step(&mut state).unwrap();
                let (length, distance) = deformation(&points, state.orientation);
                prop_assert!(length <= LENGTH, "{method}, {body:?}: length {length:e}");
                prop_assert!(distance <= DISTANCE, "{method}, {body:?}: distance {distance:e}");
            }
        });
    }

    /// Also with steps that are far too long for the ground: the body stays rigid until numbers
    /// overflow.
    #[test]
    fn a_body_on_the_ground_keeps_its_shape_also_where_the_step_is_unstable(
        body in bodies(),
        orientation in orientations(),
        axis in directions(),
        spin in zero_or(1e-6, 1e3),
        stiffness in log_uniform(1.0, 1e9),
        damping in zero_or(1e-3, 1e4),
        coefficient in zero_or(1e-2, 1e2),
        dt in log_uniform(1e-5, 0.1),
    ) {
        let points = body.places();
        let start = State::at(DVec3::Z * (0.9 * body.bounding_radius())).with_orientation(orientation);
        each_method!(dt, |integrator, method| {
            let stepper = Stepper::new(&*body).unwrap()
                .with_gravity(UniformGravity::down(9.8)).unwrap()
                .with_ground(FlatGround::level(stiffness, damping)).unwrap()
                .with_friction(Coulomb { coefficient, slip_speed: 1e-4 }).unwrap()
                .with_integrator(integrator).unwrap();
            let mut state = start.with_angular_momentum(momentum_for(&body, axis * spin));
            for _ in 0..200 {
                match stepper.step(&mut state) {
                    Ok(_) => {}
                    Err(StepError::Diverged(_)) => break,
                    Err(other) => prop_assert!(false, "{other}"),
                }
                let (length, distance) = deformation(&points, state.orientation);
                prop_assert!(length <= LENGTH, "{method}, {body:?}: length {length:e}");
                prop_assert!(distance <= DISTANCE, "{method}, {body:?}: distance {distance:e}");
            }
        });
    }
}

/// Largest deformation in 10,000 steps.
fn worst_of_a_window(
    points: &[DVec3],
    state: &mut State,
    mut step: impl FnMut(&mut State),
) -> (f64, f64) {
    (0..10_000).fold((0.0, 0.0), |(length, distance), _| {
        step(state);
        let (l, d) = deformation(points, state.orientation);
        (f64::max(length, l), f64::max(distance, d))
    })
}

/// `steps` steps of a body with three different moments that tumbles freely: no worse at the end
/// than at the beginning.
fn tumbles_without_stretching(integrator: impl tumble::Integrator, steps: u32) {
    let points = [
        DVec3::new(0.5, 0.0, 0.1),
        DVec3::new(-0.3, 0.4, 0.0),
        DVec3::new(0.1, -0.2, -0.6),
        DVec3::new(-0.2, -0.1, 0.3),
    ];
    let body = tumble::PointCloud::new(points, [1.0, 0.7, 0.4, 1.3]).unwrap();
    let points = body.contacts().iter().map(|contact| contact.position);
    let points: Vec<_> = points.collect();
    let stepper = Stepper::new(body)
        .unwrap()
        .with_integrator(integrator)
        .unwrap();
    let mut state = State::default().with_angular_momentum(DVec3::new(3.0, -2.0, 4.0));
    let step = |state: &mut State| {
        stepper.step(state).unwrap();
    };
    let first = worst_of_a_window(&points, &mut state, step);
    for _ in 0..steps - 20_000 {
        step(&mut state);
    }
    let last = worst_of_a_window(&points, &mut state, step);
    assert!(last.0 <= LENGTH && first.0 <= LENGTH, "{first:?} {last:?}");
    assert!(
        last.1 <= DISTANCE && first.1 <= DISTANCE,
        "{first:?} {last:?}"
    );
    // The worst of 10,000 rounding errors differs from window to window by a unit or two (2.22e-16
    // each); a drift over millions of steps would not stop there.
    assert!(last.0 <= first.0 + 2.2e-16, "{first:?} {last:?}");
    assert!(last.1 <= first.1 + 4.45e-16, "{first:?} {last:?}");
}

// At 0.01 s and some 10 rad/s a step rotates the body by a tenth of a radian: no number is too
// small to be rounded.
#[test]
fn five_million_steps_of_forward_euler_stretch_no_distance() {
    tumbles_without_stretching(tumble::ForwardEuler { time_step: 0.01 }, 5_000_000);
}

#[test]
fn five_million_steps_of_symplectic_euler_stretch_no_distance() {
    tumbles_without_stretching(tumble::SymplecticEuler { time_step: 0.01 }, 5_000_000);
}

#[test]
fn ten_million_steps_of_strang_splitting_stretch_no_distance() {
    tumbles_without_stretching(tumble::StrangSplitting { time_step: 0.01 }, 10_000_000);
}

// Three different moments: Newton's method in each step.
#[test]
fn two_million_steps_of_energy_momentum_stretch_no_distance() {
    tumbles_without_stretching(tumble::EnergyMomentum { time_step: 0.01 }, 2_000_000);
}

#[test]
fn five_million_steps_of_runge_kutta_stretch_no_distance() {
    tumbles_without_stretching(tumble::Rk4 { time_step: 0.01 }, 5_000_000);
}

/// The report rotated its points a little further in each step, and they drifted apart. Here a coin
/// rolls and spins down for half a million steps.
#[test]
fn half_a_million_steps_on_the_ground_stretch_no_distance() {
    let trial = tumble::Trial::<f64>::report(1).unwrap();
    let coin = trial.coin();
    let points: Vec<_> = coin
        .contacts()
        .iter()
        .map(|contact| contact.position)
        .collect();
    let stepper = trial
        .stepper(tumble::SymplecticEuler { time_step: 1e-4 })
        .unwrap();
    let mut state = trial.state();
    let first = worst_of_a_window(&points, &mut state, |state| {
        stepper.step(state).unwrap();
    });
    for _ in 0..480_000 {
        stepper.step(&mut state).unwrap();
    }
    let last = worst_of_a_window(&points, &mut state, |state| {
        stepper.step(state).unwrap();
    });
    for (length, distance) in [first, last] {
        assert!(
            length <= LENGTH && distance <= DISTANCE,
            "{length:e} {distance:e}"
        );
    }
}
