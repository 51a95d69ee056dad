//! Error against price: each integrator on trial 1 of the report, against the truth of its equations. Prints the README's table, and the cheapest settings for an error of 1e-4 m,
//! beside an Rk4 as anyone would write it.
//!
//! `cargo run --release --example accuracy`, on a machine with nothing else to do. With `-- --f32` it prints the tables of single precision in
//! `src/guide/accuracy.md`: errors of the numbers alone, which no other work on the machine changes.

#[path = "../common/plain_rk4.rs"]
mod plain_rk4;
mod single;
mod truth;
mod within;

use core::error::Error;
use std::time::Instant;

use lexopt::prelude::*;
use truth::{DURATION, distance, trial, truth};
use tumble::{
    EnergyMomentum, ForwardEuler, Integrator, Nystrom, Rk4, State, StrangSplitting, SymplecticEuler,
};

/// The price is the least of so many runs: whatever else the machine does only adds to it.
const RUNS: usize = 20;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = lexopt::Parser::from_env();
    match arguments.next()? {
        None => prices(),
        Some(Long("f32")) => single::tables(),
        Some(Long("help")) => {
            print!("{HELP}");
            Ok(())
        }
        Some(other) => Err(other.unexpected().into()),
    }
}

const HELP: &str = "\
Runs trial 1 for a second by each integrator, in steps of 1 ms and less, and prints its error against
13 digits of the truth beside its price: the README's table.

Usage: cargo run --release --example accuracy -- [OPTIONS]

      --f32    instead, error and energy in single against double precision, for each integrator and step
      --help   this text
";

/// The README's table.
fn prices() -> Result<(), Box<dyn Error>> {
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
        row(
            "`Nystrom`",
            time_step,
            |time_step| Nystrom { time_step },
            &truth,
        )?;
    }
    println!();
    within::table(1e-4, &truth)
}

/// Prints the row of one integrator with one step (s).
fn row<I: Integrator>(
    name: &str,
    time_step: f64,
    with: impl Fn(f64) -> I,
    truth: &State,
) -> Result<(), Box<dyn Error>> {
    let trial = trial()?;
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
