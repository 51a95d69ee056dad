//! A fixed number of steps, for `callgrind` to count the instructions: see `.ci/instructions`.
//!
//! The arguments are `instructions INTEGRATOR PHASE POINTS STEPS`. `POINTS` is a number, `round` for
//! a rim without points, or `own` for 120 points on a user's ground and friction law, whose values
//! every step tests. The instructions of a step are the difference of two counts over the
//! difference of their numbers of steps.

// A benchmark that fails ends with a panic.
#![allow(clippy::unwrap_used, clippy::panic)]

mod scenes;

use core::hint::black_box;
use scenes::{Advance, Phase, TIME_STEP, own_laws, ring, round, stepper};
use tumble::{
    EnergyMomentum, ForwardEuler, Integrator, Nystrom, Rk4, StrangSplitting, SymplecticEuler,
};

fn main() {
    let arguments = Vec::from_iter(std::env::args().skip(1));
    // `cargo bench` and `cargo test` start every benchmark with their own options.
    let [integrator, phase, points, steps] = &arguments[..] else {
        println!("instructions INTEGRATOR PHASE POINTS STEPS");
        return;
    };
    let phase = Phase::ALL.into_iter().find(|p| p.name() == phase).unwrap();
    let steps = steps.parse().unwrap();
    let time_step = TIME_STEP;
    match &integrator[..] {
        "ForwardEuler" => run(ForwardEuler { time_step }, phase, points, steps),
        "SymplecticEuler" => run(SymplecticEuler { time_step }, phase, points, steps),
        "StrangSplitting" => run(StrangSplitting { time_step }, phase, points, steps),
        "Rk4" => run(Rk4 { time_step }, phase, points, steps),
        "Nystrom" => run(Nystrom { time_step }, phase, points, steps),
        "EnergyMomentum" => run(EnergyMomentum { time_step }, phase, points, steps),
        other => panic!("no integrator {other}"),
    }
}

fn run(integrator: impl Integrator, phase: Phase, points: &str, steps: u32) {
    match points {
        "round" => measure(&stepper(round(), integrator), phase, steps),
        "own" => measure(&own_laws(integrator), phase, steps),
        _ => {
            let points = points.parse().unwrap();
            measure(&stepper(ring(points), integrator), phase, steps);
        }
    }
}

fn measure(stepper: &impl Advance, phase: Phase, steps: u32) {
    black_box(scenes::steps(stepper, &black_box(phase.state()), steps));
}
