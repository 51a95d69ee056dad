//! A fixed number of steps of eight states, together in lanes or one after the other: see
//! `.ci/lanes.sh`.
//!
//! The arguments are `lanes INTEGRATOR SCENE HOW STEPS`. `HOW` is `many` for `advance_many`, or
//! `one` for `advance` of each state. The instructions of a step of a state are the difference of
//! two counts over eight times the difference of their numbers of steps. With `time` for `HOW`, the
//! program prints the times of both, the least of several runs.

// A benchmark that fails ends with a panic.
#![allow(clippy::unwrap_used, clippy::panic)]

mod scenes;

use core::hint::black_box;
use std::time::Instant;

use scenes::{Phase, TIME_STEP, own_laws, ring, stepper};
use tumble::glam::DVec3;
use tumble::{
    Force, Gravity, Integrator, Nystrom, RigidPointBody, Rk4, SlidingFriction, SpringDamperGround,
    State, Stepper, StrangSplitting, SymplecticEuler, Trial,
};

fn main() {
    let arguments = Vec::from_iter(std::env::args().skip(1));
    // `cargo bench` and `cargo test --all-targets` start it with options of their own.
    let [integrator, scene, how, steps] = &arguments[..] else {
        println!("lanes INTEGRATOR SCENE one|many|time STEPS");
        return;
    };
    let (how, steps) = (&how[..], steps.parse().unwrap());
    let time_step = TIME_STEP;
    match &integrator[..] {
        "SymplecticEuler" => run(SymplecticEuler { time_step }, scene, how, steps),
        "StrangSplitting" => run(StrangSplitting { time_step }, scene, how, steps),
        "Rk4" => run(Rk4 { time_step }, scene, how, steps),
        "Nystrom" => run(Nystrom { time_step }, scene, how, steps),
        other => panic!("no integrator {other}"),
    }
}

fn run(integrator: impl Integrator, scene: &str, how: &str, steps: u32) {
    let states = eight(scene);
    match scene {
        "own" => measure(&own_laws(integrator), &states, how, steps),
        "12" => measure(&stepper(ring(12), integrator), &states, how, steps),
        _ => measure(&stepper(ring(120), integrator), &states, how, steps),
    }
}

/// Eight coins that roll on their rims, at different speeds and 14 to 22 degrees from upright. In
/// some scenes several of them are elsewhere.
fn eight(scene: &str) -> [State; 8] {
    core::array::from_fn(|i| {
        let rolls = rolling(f64::from(u8::try_from(i).unwrap()));
        let in_the_air = State {
            position: DVec3::new(0.0, 0.0, 3.0),
            ..rolls
        };
        match scene {
            "flight" => in_the_air,
            "half" if i % 2 == 0 => in_the_air,
            "tumbling" if i % 2 == 0 => Phase::Tumbling.state(),
            "flat" if i == 0 => Phase::Rest.state(),
            _ => rolls,
        }
    })
}

/// Coin that rolls straight ahead, in circles at first.
fn rolling(number: f64) -> State {
    let (radius, lean) = (Trial::<f64>::RADIUS, 0.25 + 0.02 * number);
    let spin = 6.0 + 0.2 * number;
    // 2 mm deep in the ground. The coin's normal is x, which the lean turns down about y.
    let state = State::at(DVec3::Z * (radius * lean.cos() - 2e-3))
        .with_rotation_vector(DVec3::Y * lean)
        .with_linear_velocity(DVec3::Y * (-radius * spin));
    let inertia = Trial::<f64>::MASS * radius * radius;
    state.with_angular_momentum(state.orientation * DVec3::X * (inertia * spin))
}

fn measure<B, G, F, A, I, E>(
    stepper: &Stepper<B, G, F, A, I, f64, E>,
    states: &[State; 8],
    how: &str,
    steps: u32,
) where
    B: RigidPointBody,
    G: SpringDamperGround,
    F: SlidingFriction,
    A: Gravity,
    I: Integrator,
    E: Force,
{
    let seconds = f64::from(steps) * TIME_STEP;
    let many = || {
        let mut states = black_box(*states);
        stepper.advance_many(&mut states, seconds).unwrap();
        black_box(states);
    };
    let one = || {
        let mut states = black_box(*states);
        for state in &mut states {
            stepper.advance(state, seconds).unwrap();
        }
        black_box(states);
    };
    match how {
        "many" => many(),
        "one" => one(),
        _ => {
            let (mut fastest_one, mut fastest_many) = (f64::MAX, f64::MAX);
            for _ in 0..30 {
                fastest_one = fastest_one.min(nanoseconds(one));
                fastest_many = fastest_many.min(nanoseconds(many));
            }
            let per_state = 8.0 * f64::from(steps);
            println!(
                "{:.1} {:.1}",
                fastest_one / per_state,
                fastest_many / per_state
            );
        }
    }
}

fn nanoseconds(run: impl Fn()) -> f64 {
    let start = Instant::now();
    run();
    start.elapsed().as_secs_f64() * 1e9
}
