//! Error against cost: each integrator on trial 1 of the coin report, compared with the exact
//! solution of its equations.
//!
//! Prints a table of error and cost, and the cheapest settings for an error of 1e-4 m, compared
//! with a Rk4 as a user would write it.
//!
//! Run `cargo run --release --example accuracy` on a machine that does nothing else. With
//! `-- --f32` it prints the tables of single precision in `src/guide/accuracy.md`. These contain
//! errors only, which do not depend on other work of the machine.

mod conservative;
mod page;
#[path = "../common/plain_rk4.rs"]
mod plain_rk4;
#[path = "../../tests/common/report_loop.rs"]
mod report_loop;
mod single;
mod truth;
mod within;

use core::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use common::{program, say, table};
use lexopt::prelude::*;
use truth::{DURATION, distance, trial, truth};
use tumble::{
    EnergyMomentum, ForwardEuler, Integrator, Nystrom, Rk4, State, StrangSplitting, SymplecticEuler,
};

/// Number of runs, of which the cost is the least. Other work of the machine only increases the
/// cost.
const RUNS: usize = 20;

/// What the command line requests.
enum Task {
    Costs,
    Single { is_written: bool },
    Motion { is_written: bool },
    Page(PathBuf),
}

fn main() -> ExitCode {
    program(parse(), HELP, |task| match task {
        Task::Costs => costs().map(|()| true),
        Task::Single { is_written } => single::tables(*is_written).map(|()| true),
        Task::Motion { is_written } => conservative::tables(*is_written).map(|()| true),
        Task::Page(folder) => page::write(folder),
    })
}

/// Returns `None` if the help text is requested.
fn parse() -> Result<Option<Task>, lexopt::Error> {
    let mut parser = lexopt::Parser::from_env();
    let mut task = Task::Costs;
    while let Some(argument) = parser.next()? {
        match (argument, &mut task) {
            (Short('h') | Long("help"), _) => return Ok(None),
            (Long("f32"), Task::Costs) => task = Task::Single { is_written: false },
            (Long("f32-motion"), Task::Costs) => task = Task::Motion { is_written: false },
            (Long("page"), Task::Costs) => task = Task::Page("out".into()),
            (Long("write"), Task::Single { is_written } | Task::Motion { is_written }) => {
                *is_written = true;
            }
            (Short('o') | Long("out"), Task::Page(folder)) => *folder = parser.value()?.into(),
            (other, _) => return Err(other.unexpected()),
        }
    }
    Ok(Some(task))
}

const HELP: &str = "\
Runs trial 1 for a second with each integrator, with steps of at most 1 ms. Prints the error,
relative to an exact solution of 13 digits, and the cost.

Usage: cargo run --release --example accuracy -- [OPTIONS]

      --page [--out <FOLDER>]
               instead, a page with the error over the step size, in out/accuracy
      --f32 [--write]
               instead, error and energy in single and double precision, for each integrator and
               step size; with --write into src/guide/accuracy.md
      --f32-motion [--write]
               instead, free flight, elastic bounces and falls in single precision by EnergyMomentum
               (half a minute); with --write into src/guide/accuracy.md
  -h, --help   this text
";

/// Prints the table of error and cost.
fn costs() -> Result<(), Box<dyn Error>> {
    let truth = truth()?;
    // The method of the coin report is stable below damping/stiffness = 0.5 ms.
    let mut rows = vec![
        table::cells(["integrator", "order", "time step", "error", "cost of 1 s"]),
        row(
            "`ForwardEuler`, the report's",
            ForwardEuler { time_step: 1e-4 },
            &truth,
        )?,
    ];
    for time_step in [1e-3, 1e-4] {
        rows.extend([
            row(
                "`EnergyMomentum`, the default",
                EnergyMomentum { time_step },
                &truth,
            )?,
            row("`SymplecticEuler`", SymplecticEuler { time_step }, &truth)?,
            row("`StrangSplitting`", StrangSplitting { time_step }, &truth)?,
            row("`Rk4`", Rk4 { time_step }, &truth)?,
            row("`Nystrom`", Nystrom { time_step }, &truth)?,
        ]);
    }
    table::print(&rows);
    say("\n");
    within::table(1e-4, &truth)
}

/// Row of one integrator.
fn row<I: Integrator>(
    name: &str,
    integrator: I,
    truth: &State,
) -> Result<Vec<String>, Box<dyn Error>> {
    let trial = trial()?;
    let order = integrator.order();
    let time_step = integrator
        .fixed_step()
        .ok_or("the method chooses its steps")?;
    let stepper = trial.stepper(integrator)?;
    let (mut end, mut cost) = (trial.state(), f64::INFINITY);
    for _ in 0..RUNS {
        end = trial.state();
        let start = Instant::now();
        stepper.advance(&mut end, DURATION)?;
        cost = cost.min(start.elapsed().as_secs_f64());
    }
    let error = distance(&end, truth);
    Ok(table::cells([
        name.to_owned(),
        order.to_string(),
        format!("{} ms", time_step * 1e3),
        format!("{error:.1e} m"),
        format!("{:.0} µs", cost * 1e6),
    ]))
}
