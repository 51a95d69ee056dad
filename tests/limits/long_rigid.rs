//! A body that tumbles freely is rigid after as many steps as are asked (promise G2).
//!
//! `TUMBLE_RIGID_STEPS` is the number of steps; a plain `cargo test` takes two hundred thousand.
//! `.ci/long.sh rigid` takes a thousand million. `TUMBLE_RIGID_RECORD` names the file to which each
//! run appends a line.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use std::env;
use std::fs::OpenOptions;
use std::io::Write;

use crate::kit::rigid::{DISTANCE, LENGTH, deformation};
use tumble::glam::{DQuat, DVec3};
use tumble::real::{Quaternion, Vector};
use tumble::{
    EnergyMomentum, Integrator, PointCloud, Real, RigidPointBody, State, Stepper, StrangSplitting,
};

/// Steps in which the body is measured, at the start of each part of a run.
const WINDOW: u64 = 10_000;

/// Parts of a run.
const PARTS: u64 = 20;

/// Largest error of the quaternion's length, and largest change of a distance relative to the arm.
type Worst = (f64, f64);

fn larger(one: Worst, other: Worst) -> Worst {
    (one.0.max(other.0), one.1.max(other.1))
}

fn asked_steps() -> u64 {
    let asked = env::var("TUMBLE_RIGID_STEPS").ok();
    asked.map_or(PARTS * WINDOW, |steps| steps.parse().unwrap())
}

/// A body with three different moments.
fn body<R: Real>() -> (PointCloud<R, [tumble::ContactPoint<R>; 4]>, Vec<DVec3>) {
    let places = [
        DVec3::new(0.5, 0.0, 0.1),
        DVec3::new(-0.3, 0.4, 0.0),
        DVec3::new(0.1, -0.2, -0.6),
        DVec3::new(-0.2, -0.1, 0.3),
    ];
    let points = places.map(vector::<R>);
    let masses = [1.0, 0.7, 0.4, 1.3].map(R::from_f64);
    let body = PointCloud::new(points, masses).unwrap();
    let arms = body.contacts().iter().map(|contact| {
        let position = contact.position;
        let [x, y, z] = [position.x(), position.y(), position.z()].map(R::to_f64);
        DVec3::new(x, y, z)
    });
    let arms = arms.collect();
    (body, arms)
}

fn vector<R: Real>(vector: DVec3) -> R::Vec3 {
    let [x, y, z] = vector.to_array().map(R::from_f64);
    R::Vec3::new(x, y, z)
}

/// The stored quaternion in double precision, which is exact.
fn orientation<R: Real>(state: &State<R>) -> DQuat {
    DQuat::from_array(state.orientation.xyzw().map(R::to_f64))
}

/// Appends the largest deformations in the first, any and the last window to the record, if one is
/// asked for.
fn record(name: &str, steps: u64, windows: [Worst; 3]) {
    let Some(path) = env::var_os("TUMBLE_RIGID_RECORD") else {
        return;
    };
    let figures = windows.map(|(length, distance)| format!("{length:.2e},{distance:.2e}"));
    let mut file = OpenOptions::new().create(true).append(true).open(path);
    let line = format!("\"{name}\",{steps},{}\n", figures.join(","));
    file.as_mut().unwrap().write_all(line.as_bytes()).unwrap();
}

/// Takes the steps and measures the body in windows over the whole run: no window is worse than
/// rounding allows, and the last is no worse than the first.
fn stays_rigid<R: Real, I: Integrator<R>>(integrator: I, name: &str) {
    let (body, arms) = body::<R>();
    let stepper = Stepper::new(body)
        .unwrap()
        .with_integrator(integrator)
        .unwrap();
    let momentum = vector::<R>(DVec3::new(3.0, -2.0, 4.0));
    let mut session = stepper.session(State::default().with_angular_momentum(momentum));
    let steps = asked_steps();
    let windows: Vec<Worst> = (0..PARTS)
        .map(|_| {
            let worst = (0..WINDOW).fold((0.0, 0.0), |worst, _| {
                session.step().unwrap();
                larger(worst, deformation(&arms, orientation(session.state())))
            });
            for _ in WINDOW..steps / PARTS {
                session.step().unwrap();
            }
            worst
        })
        .collect();
    let (first, last) = (windows[0], windows[windows.len() - 1]);
    let any = windows.iter().copied().fold((0.0, 0.0), larger);
    record(name, steps, [first, any, last]);
    let unit = R::EPSILON.to_f64() / f64::EPSILON;
    assert!(any.0 <= LENGTH * unit, "{name}: {windows:?}");
    assert!(any.1 <= DISTANCE * unit, "{name}: {windows:?}");
    // As in `tests/physics/rigidity.rs`: windows differ by a unit or two, a drift would not stop.
    assert!(last.0 <= first.0 + 2.2e-16 * unit, "{name}: {windows:?}");
    assert!(last.1 <= first.1 + 4.45e-16 * unit, "{name}: {windows:?}");
}

fn steps_of_both_precisions_stretch_no_distance<I: Integrator<f64>, J: Integrator<f32>>(
    (integrator, single): (I, J),
    name: &str,
) {
    stays_rigid::<f64, _>(integrator, &format!("{name}, f64"));
    stays_rigid::<f32, _>(single, &format!("{name}, f32"));
}

// At 0.01 s and some 10 rad/s a step rotates the body by a tenth of a radian: no number is too
// small to be rounded.
#[test]
fn strang_splitting_stretches_no_distance_in_as_many_steps_as_are_asked() {
    let methods = (
        StrangSplitting { time_step: 0.01 },
        StrangSplitting { time_step: 0.01 },
    );
    steps_of_both_precisions_stretch_no_distance(methods, "StrangSplitting");
}

#[test]
fn energy_momentum_stretches_no_distance_in_as_many_steps_as_are_asked() {
    let methods = (
        EnergyMomentum { time_step: 0.01 },
        EnergyMomentum { time_step: 0.01 },
    );
    steps_of_both_precisions_stretch_no_distance(methods, "EnergyMomentum");
}
