//! A fixed number of steps, for `callgrind` to count the instructions: see `.ci/instructions`.
//!
//! The arguments are `instructions INTEGRATOR PHASE SCENE STEPS`. `SCENE` is a number of points,
//! `round` for a rim without points, `thick` for two of them, `box` for a body with three different
//! moments of inertia, `own` for 120 points on a user's ground and friction law, whose values every
//! step tests, `session` for the steps of a session by `EnergyMomentum`, `events` for a run with
//! events, or the name of a part that is added to 120 points.
//! The instructions of a step are the difference of two counts over the difference of their numbers
//! of steps.

// A benchmark that fails ends with a panic.
#![allow(clippy::unwrap_used, clippy::panic)]

mod scenes;

use core::hint::black_box;
use scenes::{Advance, Part, Phase, TIME_STEP, own_laws, ring, round, stepper};
use tumble::{
    EnergyMomentum, ForwardEuler, Integrator, Nystrom, Rk4, State, StrangSplitting, SymplecticEuler,
};

fn main() {
    let arguments = Vec::from_iter(std::env::args().skip(1));
    // `cargo bench` and `cargo test --all-targets` start it with options of their own.
    let [integrator, phase, scene, steps] = &arguments[..] else {
        println!("instructions INTEGRATOR PHASE SCENE STEPS");
        return;
    };
    let phase = Phase::ALL.into_iter().find(|p| p.name() == phase).unwrap();
    let steps = steps.parse().unwrap();
    let time_step = TIME_STEP;
    match &integrator[..] {
        "ForwardEuler" => run(ForwardEuler { time_step }, phase, scene, steps),
        "SymplecticEuler" => run(SymplecticEuler { time_step }, phase, scene, steps),
        "StrangSplitting" => run(StrangSplitting { time_step }, phase, scene, steps),
        "Rk4" => run(Rk4 { time_step }, phase, scene, steps),
        "Nystrom" => run(Nystrom { time_step }, phase, scene, steps),
        "EnergyMomentum" if scene == "session" => {
            let stepper = stepper(ring(120), EnergyMomentum { time_step });
            let start = black_box(phase.state());
            black_box(scenes::steps_of_session(&stepper, &start, steps));
        }
        "EnergyMomentum" => run(EnergyMomentum { time_step }, phase, scene, steps),
        other => panic!("no integrator {other}"),
    }
}

fn run(integrator: impl Integrator, phase: Phase, scene: &str, steps: u32) {
    if let Some(part) = Part::named(scene) {
        return run_with(part, integrator, &phase.state(), steps);
    }
    match scene {
        "round" => measure(&stepper(round(), integrator), &phase.state(), steps),
        "thick" => {
            let start = scenes::on_one_rim(phase);
            measure(&stepper(scenes::thick(), integrator), &start, steps);
        }
        "box" => measure(
            &stepper(scenes::cuboid(), integrator),
            &phase.state(),
            steps,
        ),
        "own" => {
            let (stepper, start) = (own_laws(integrator), black_box(phase.state()));
            black_box(scenes::steps_of_run(&stepper, &start, steps));
        }
        "events" => {
            let (stepper, start) = (stepper(ring(120), integrator), black_box(phase.state()));
            black_box(scenes::steps_with_events(&stepper, &start, steps));
        }
        _ => {
            let points = scene.parse().unwrap();
            measure(&stepper(ring(points), integrator), &phase.state(), steps);
        }
    }
}

fn run_with(part: Part, integrator: impl Integrator, start: &State, steps: u32) {
    let plain = stepper(ring(120), integrator);
    match part {
        Part::Tilt => measure(&plain.with_ground(scenes::tilted()).unwrap(), start, steps),
        Part::HuntCrossley => {
            let stepper = plain.with_ground(scenes::hunt_crossley()).unwrap();
            measure(&stepper, start, steps);
        }
        Part::Patch => measure(&plain.with_friction(scenes::patch()).unwrap(), start, steps),
        Part::Field => measure(&plain.with_friction(scenes::field()).unwrap(), start, steps),
        Part::Walls => measure(&plain.with_ground(scenes::walls()).unwrap(), start, steps),
        Part::Belt => measure(&plain.with_ground(scenes::belt()).unwrap(), start, steps),
        Part::Resistance => {
            let stepper = plain.with_friction(scenes::resistance()).unwrap();
            measure(&stepper, start, steps);
        }
        Part::Drag => measure(&plain.with_force(scenes::drag()).unwrap(), start, steps),
        Part::Air => measure(&plain.with_force(scenes::air()).unwrap(), start, steps),
        Part::Wind => measure(&plain.with_force(scenes::wind()).unwrap(), start, steps),
    }
}

fn measure(stepper: &impl Advance, start: &State, steps: u32) {
    black_box(scenes::steps(stepper, black_box(start), steps));
}
