//! Error against processor time of every integrator with a sequence of step sizes and tolerances,
//! on six scenes, and on trial 1 with one parameter changed at a time.
//!
//! `cargo bench --bench work_precision` prints the tables (some minutes) and draws them into
//! `target/work_precision`. A word after `--` selects the scenes whose names contain it.
//!
//! `cargo bench --bench work_precision -- --all` combines all parameters: every integrator and step
//! or tolerance, `f64` and `f32`, 12, 120 and 1200 points, both friction laws, three slip speeds,
//! on the six scenes. It takes ten to twenty minutes, and a word selects here, too:
//! `-- --all trial1`. It prints the cheapest setting for an error, one line for each combination,
//! and writes every row into `target/work_precision/rows.csv`.
//!
//! `cargo bench --bench work_precision -- --robust` finds the largest robust setting on eight
//! trials and eight tosses: every smaller setting of a grid keeps the error, too. It also measures
//! the cost, relative to a Rk4 written by hand. This takes some minutes, and a word selects scenes.
//! With `--write` it writes the tables of README and guide.
//!
//! `cargo bench --bench work_precision -- --readme` measures trial 1 only, and draws the diagram of
//! `guide::choosing`, assets/work_precision.svg. The times are the shortest of three runs: compare
//! rows, not machines.

// A benchmark that fails ends with a panic.
#![allow(clippy::unwrap_used)]
// The numbers of the scenes are small.
#![allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss
)]

#[path = "work_precision/grid.rs"]
mod grid;
#[path = "../examples/choose_accuracy/picture.rs"]
mod picture;
#[path = "../examples/common/plain_rk4.rs"]
mod plain_rk4;
#[path = "work_precision/robust.rs"]
mod robust;
#[path = "work_precision/robust_scenes.rs"]
mod robust_scenes;
#[path = "../examples/choose_accuracy/scenes.rs"]
mod scenes;

use core::hint::black_box;
use std::path::{Path, PathBuf};
use std::time::Instant;

use scenes::{Friction, Start};
use tumble::glam::DVec3;
use tumble::work_precision::Setting;
use tumble::{Flight, State, StrangSplitting, Trial};

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    // `cargo test --all-targets` starts it without `--bench`, to check that it runs.
    let whole = arguments.iter().any(|argument| argument == "--bench");
    let wanted = arguments
        .iter()
        .find(|argument| !argument.starts_with("--"));
    if arguments.iter().any(|argument| argument == "--all") {
        let wanted = wanted.map_or("", String::as_str);
        grid::run(wanted, &folder()).unwrap();
        return;
    }
    if arguments.iter().any(|argument| argument == "--robust") {
        let write = arguments.iter().any(|argument| argument == "--write");
        let wanted = wanted.map_or("", String::as_str);
        assert!(
            !write || wanted.is_empty(),
            "--write stores all scenes, and not those of '{wanted}'"
        );
        robust::run(wanted, write, &folder()).unwrap();
        return;
    }
    if arguments.iter().any(|argument| argument == "--readme") {
        draw_for_the_guide();
        return;
    }
    flight(if whole { 200 } else { 1 });
    for (name, start, single) in table() {
        if wanted.is_some_and(|wanted| !name.contains(wanted.as_str())) {
            continue;
        }
        measure(&name, &start, single, whole);
        if !whole {
            return;
        }
    }
}

/// Measures the cost of a whole flight in closed form and step by step, and the cost on the ground
/// of the search for a flight.
fn flight(turns: u32) {
    let toss = State::at(DVec3::Z)
        .with_linear_velocity(DVec3::new(0.4, -0.2, 6.0))
        .with_rotation_vector(DVec3::new(0.3, 0.8, -0.2))
        .with_angular_momentum(DVec3::new(0.4, 1.1, -0.7));
    let trial = Trial::report(1).unwrap();
    let plain = trial.stepper(StrangSplitting { time_step: 1e-3 }).unwrap();
    let flying = plain.with_integrator(Flight(*plain.integrator())).unwrap();
    let mut elapsed = 0.0;
    let whole = fastest(turns, || {
        let mut state = black_box(toss);
        elapsed = flying.step(&mut state).unwrap().elapsed;
        black_box(state);
    });
    let steps = fastest(turns, || {
        let mut state = black_box(toss);
        plain.advance(&mut state, elapsed).unwrap();
        black_box(state);
    });
    println!(
        "a flight of {elapsed} s: {whole:.0} ns in one step, {steps:.0} ns in steps of 1 ms, {:.0} times as much",
        steps / whole
    );
    let rolls = trial.state();
    let on_ground = |advance: &dyn Fn(&mut State)| {
        fastest(turns, || {
            let mut state = black_box(rolls);
            advance(&mut state);
            black_box(state);
        }) / 100.0
    };
    let without = on_ground(&|state| plain.advance(state, 0.1).unwrap());
    let with = on_ground(&|state| flying.advance(state, 0.1).unwrap());
    println!("a step on the ground: {without:.0} ns, with a look for a flight {with:.0} ns");
}

/// Least time of `turns` repetitions, ns.
fn fastest(turns: u32, mut program: impl FnMut()) -> f64 {
    (0..turns).fold(f64::INFINITY, |least, _| {
        let clock = Instant::now();
        program();
        least.min(clock.elapsed().as_secs_f64() * 1e9)
    })
}

/// Returns name and scene, and whether it is in single precision.
fn table() -> Vec<(String, Start, bool)> {
    let mut table = Vec::new();
    for name in ["trial1", "trial8", "toss", "smooth", "stiff", "rest"] {
        let start = Start::named(name).unwrap();
        table.push((name.to_owned(), start.clone(), false));
        table.push((format!("{name} in f32"), start, true));
    }
    let trial_1 = || Start::named("trial1").unwrap();
    for points in [12, 1200] {
        let start = Start {
            points,
            ..trial_1()
        };
        table.push((format!("trial1 with {points} points"), start, false));
    }
    let coefficient = 0.3;
    for slip_speed in [1e-2, 1e-3, 1e-6] {
        for smooth in [false, true] {
            let (law, friction) = if smooth {
                (
                    "SmoothCoulomb",
                    Friction::Smooth {
                        coefficient,
                        slip_speed,
                    },
                )
            } else {
                (
                    "Coulomb",
                    Friction::Coulomb {
                        coefficient,
                        slip_speed,
                    },
                )
            };
            let start = Start {
                friction,
                ..trial_1()
            };
            table.push((format!("trial1 with {law} at {slip_speed:e}"), start, false));
        }
    }
    for stiffness in [1e4, 1e6] {
        let start = Start {
            stiffness,
            ..trial_1()
        };
        table.push((format!("trial1 on {stiffness:e} N per m"), start, false));
    }
    table
}

fn measure(name: &str, start: &Start, single: bool, whole: bool) {
    let mut settings = Setting::built_in();
    if !whole {
        settings.retain(|setting| (setting.parameter - 1e-3).abs() < 1e-12);
    }
    println!(
        "\n## {name}: {} s, {} points\n",
        start.seconds, start.points
    );
    let curve = match start.curve(&settings, single) {
        Ok(curve) => curve,
        Err(error) => {
            println!("no reference: {error}");
            return;
        }
    };
    print!("{curve}");
    println!("the reference is good to {:.0e} m", curve.resolution);
    // An error below that of the reference has no meaning.
    let known = |&error: &f64| curve.resolution <= error;
    for error in [1e-2, 1e-4, 1e-6, 1e-8].into_iter().filter(known) {
        if let Some(row) = curve.cheapest(error) {
            let micros = row.time.as_secs_f64() * 1e6;
            println!("cheapest for {error:e} m: {}, {micros:.1} µs", row.setting);
        }
    }
    if whole {
        let file = name.replace(' ', "_");
        let title = format!("{name}: error after {} s over cost", start.seconds);
        picture::write(&curve, &title, &folder(), &file).unwrap();
    }
}

/// Draws trial 1, like every other scene, into assets/work_precision.svg.
fn draw_for_the_guide() {
    measure("trial1", &Start::named("trial1").unwrap(), false, true);
    let picture = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/work_precision.svg");
    std::fs::copy(folder().join("trial1.svg"), &picture).unwrap();
    println!("picture: {}", picture.display());
}

/// Folder for pictures and tables.
fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("target/work_precision")
}
