//! Error against price: each integrator on trial 1 of the report, against the truth of its equations. Prints the README's table.
//!
//! `cargo run --release --example accuracy`, on a machine with nothing else to do.

use core::error::Error;
use std::time::Instant;

use tumble::glam::{DQuat, DVec3};
use tumble::{
    EnergyMomentum, ForwardEuler, Integrator, Rk4, State, StrangSplitting, SymplecticEuler, Trial,
};

/// Simulated time, s.
const DURATION: f64 = 1.0;
/// m/s; the truth is known for this one, which an explicit method resolves.
const SLIP_SPEED: f64 = 1e-3;
/// The price is the least of so many runs: whatever else the machine does only adds to it.
const RUNS: usize = 20;

fn main() -> Result<(), Box<dyn Error>> {
    let truth = truth()?;
    println!("| integrator | order | time step | error | price of 1 s |");
    println!("|---|---|---|---|---|");
    // The report's method is stable below damping/stiffness = 0.5 ms.
    row(
        "`ForwardEuler`, the report's",
        1e-4,
        |time_step| ForwardEuler { time_step },
        &truth,
    )?;
    for time_step in [1e-3, 1e-4] {
        row(
            "`EnergyMomentum`, the default",
            time_step,
            |time_step| EnergyMomentum { time_step },
            &truth,
        )?;
        row(
            "`SymplecticEuler`",
            time_step,
            |time_step| SymplecticEuler { time_step },
            &truth,
        )?;
        row(
            "`StrangSplitting`",
            time_step,
            |time_step| StrangSplitting { time_step },
            &truth,
        )?;
        row("`Rk4`", time_step, |time_step| Rk4 { time_step }, &truth)?;
    }
    Ok(())
}

/// Prints the row of one integrator with one step (s).
fn row<I: Integrator>(
    name: &str,
    time_step: f64,
    with: impl Fn(f64) -> I,
    truth: &State,
) -> Result<(), Box<dyn Error>> {
    let trial = Trial {
        slip_speed: SLIP_SPEED,
        ..Trial::report(1).ok_or("the report has a trial 1")?
    };
    let integrator = with(time_step);
    let order = integrator.order();
    let stepper = trial.stepper(integrator)?;
    let (mut end, mut price) = (trial.state(), f64::INFINITY);
    for _ in 0..RUNS {
        end = trial.state();
        let start = Instant::now();
        stepper.advance(&mut end, DURATION)?;
        price = price.min(start.elapsed().as_secs_f64());
    }
    let error = distance(&end, truth);
    println!(
        "| {name} | {order} | {} ms | {error:.1e} m | {:.0} µs |",
        time_step * 1e3,
        price * 1e6
    );
    Ok(())
}

/// How far apart two states of the coin are, m: the centres' distance, and how far the turn between them moves the rim (to 1e-8 m, because of the arc cosine).
fn distance(a: &State, b: &State) -> f64 {
    let angle = a.orientation.angle_between(b.orientation);
    (a.position - b.position)
        .length()
        .hypot(Trial::<f64>::RADIUS * angle)
}

/// The state of trial 1 at the end, to 13 digits.
fn truth() -> Result<State, Box<dyn Error>> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/truth_table.csv");
    let mut table = csv::Reader::from_path(path)?;
    let headings = table.headers()?.clone();
    for line in table.records() {
        let line = line?;
        let number = |name: &str| -> Result<f64, Box<dyn Error>> {
            let column = headings
                .iter()
                .position(|heading| heading == name)
                .ok_or("the table lacks a column")?;
            Ok(line[column].parse()?)
        };
        if (number("trial")?, number("v_eps")?, number("t")?) == (1.0, SLIP_SPEED, DURATION) {
            let turn = DQuat::from_xyzw(number("qx")?, number("qy")?, number("qz")?, number("qw")?);
            return Ok(
                State::at(DVec3::new(number("x")?, number("y")?, number("z")?))
                    .with_orientation(turn),
            );
        }
    }
    Err("the table lacks trial 1 at its end".into())
}
