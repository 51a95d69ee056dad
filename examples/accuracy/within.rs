//! The cheapest settings for an error, compared with a plain Rk4.

// The number of steps in a second is small.
#![allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]

use core::error::Error;
use core::hint::black_box;
use std::time::Instant;

use tumble::glam::DVec3;
use tumble::{
    BogackiShampine32, DormandPrince54, EnergyMomentum, Integrator, Nystrom, RigidPointBody, Rk4,
    State, StrangSplitting,
};

use super::plain_rk4::{self, Law};
use super::report_loop::{ReportLoop, ReportTrial};
use super::truth::{DURATION, distance, trial};
use common::table;

/// Numbers of steps in a second.
///
/// Every number up to 100 is used, and then numbers that increase by 1 to 2 %. A setting that
/// agrees with the exact solution by chance then has neighbours that do not.
fn steps() -> Vec<f64> {
    core::iter::successors(Some(60_u32), |count| Some(count + count / 50))
        .take_while(|&count| count <= 4000)
        .map(|count| DURATION / f64::from(count))
        .collect()
}

/// Tolerances, m.
const TOLERANCES: [f64; 12] = [
    3e-3, 2e-3, 1e-3, 5e-4, 3e-4, 2e-4, 1e-4, 5e-5, 3e-5, 2e-5, 1e-5, 5e-6,
];
/// Number of repetitions, of which the cost is the least. Other work of the machine only increases
/// the cost, and the clock frequency is the same for all programs.
const TURNS: usize = 200;
const IN_A_ROW: usize = 20;
/// Number of steps in a run of the report's loop.
const REPORT_STEPS: u32 = 60;

/// Runs the trial again. Returns its end, and the time that it took, s.
type Program = Box<dyn Fn() -> Result<(State, f64), Box<dyn Error>>>;

/// A program for a step size (s) or a tolerance (m).
type With = Box<dyn Fn(f64) -> Result<Program, Box<dyn Error>>>;

/// Name of a method, the parameters to try, their format, and the program.
type Method<'a> = (&'a str, &'a [f64], fn(f64) -> String, With);

/// Prints a row for each method: the longest step or largest tolerance that is within `error` (m),
/// *together with every shorter or smaller one that was tried*, so that no chance result counts.
pub(crate) fn table(error: f64, truth: &State) -> Result<(), Box<dyn Error>> {
    let within = format!("within {error:e} m");
    let head = [
        &within,
        "setting",
        "error",
        "cost of 1 s",
        "of the plain Rk4's",
        "in steps of the report's loop",
    ];
    let (mut rows, mut programs) = (vec![table::cells(head)], Vec::new());
    for (name, parameters, show, with) in methods(&steps()) {
        let Some(parameter) = largest_within(error, truth, parameters, &with)? else {
            rows.push(table::cells([name, "none that is tried", "", "", "", ""]));
            continue;
        };
        let program = with(parameter)?;
        let error = distance(&program()?.0, truth);
        rows.push(table::cells([
            name.to_owned(),
            show(parameter),
            format!("{error:.1e} m"),
        ]));
        programs.push((rows.len() - 1, program));
    }
    let (costs, yardstick) = costs(programs.iter().map(|(_, program)| program))?;
    for (&(row, _), cost) in programs.iter().zip(&costs) {
        rows[row].extend([
            format!("{:.0} µs", cost * 1e6),
            format!("{:.2}", cost / costs[0]),
            format!("{:.0}", cost / yardstick),
        ]);
    }
    table::print(&rows);
    Ok(())
}

/// Returns the methods. The first is the plain Rk4, with which the others are compared.
fn methods(steps: &[f64]) -> [Method<'_>; 7] {
    [
        (
            "an Rk4 as anyone would write it",
            steps,
            milliseconds,
            Box::new(plain),
        ),
        (
            "`Rk4`",
            steps,
            milliseconds,
            with(|time_step| Rk4 { time_step }),
        ),
        (
            "`StrangSplitting`",
            steps,
            milliseconds,
            with(|time_step| StrangSplitting { time_step }),
        ),
        (
            "`EnergyMomentum`",
            steps,
            milliseconds,
            with(|time_step| EnergyMomentum { time_step }),
        ),
        (
            "`BogackiShampine32`",
            &TOLERANCES,
            metres,
            with(BogackiShampine32::new),
        ),
        (
            "`DormandPrince54`",
            &TOLERANCES,
            metres,
            with(DormandPrince54::new),
        ),
        (
            "`Nystrom`",
            steps,
            milliseconds,
            with(|time_step| Nystrom { time_step }),
        ),
    ]
}

fn largest_within(
    error: f64,
    truth: &State,
    parameters: &[f64],
    with: &With,
) -> Result<Option<f64>, Box<dyn Error>> {
    let mut largest = None;
    for &parameter in parameters.iter().rev() {
        let (end, _) = with(parameter)?()?;
        if distance(&end, truth) > error {
            break;
        }
        largest = Some(parameter);
    }
    Ok(largest)
}

/// Costs of the programs and of a step of the report's loop, s. With the latter, costs on two
/// machines can be compared.
fn costs<'a>(
    programs: impl Iterator<Item = &'a Program> + Clone,
) -> Result<(Vec<f64>, f64), Box<dyn Error>> {
    let start = ReportLoop::new(ReportTrial::numbered(1).ok_or("the report has a trial 1")?);
    let mut costs = vec![f64::INFINITY; programs.clone().count()];
    let mut yardstick = f64::INFINITY;
    for _ in 0..TURNS {
        for (cost, program) in costs.iter_mut().zip(programs.clone()) {
            for _ in 0..IN_A_ROW {
                *cost = cost.min(program()?.1);
            }
        }
        for _ in 0..IN_A_ROW {
            yardstick = yardstick.min(report_step(&start));
        }
    }
    Ok((costs, yardstick))
}

/// Cost of a step of the report's loop at the start of the trial, s.
fn report_step(start: &ReportLoop) -> f64 {
    let (mut report, clock) = (start.clone(), Instant::now());
    for _ in 0..REPORT_STEPS {
        report.step();
    }
    black_box(report);
    clock.elapsed().as_secs_f64() / f64::from(REPORT_STEPS)
}

/// Formats a step size in ms with one decimal place, which distinguishes all of the steps.
fn milliseconds(time_step: f64) -> String {
    format!("{} ms", (time_step * 1e4).round() / 10.0)
}

fn metres(tolerance: f64) -> String {
    format!("{tolerance:e} m")
}

fn with<I: Integrator + 'static>(integrator: impl Fn(f64) -> I + 'static) -> With {
    Box::new(move |parameter| {
        let trial = trial()?;
        let stepper = trial.stepper(integrator(parameter))?;
        Ok(Box::new(move || {
            let (mut state, clock) = (trial.state(), Instant::now());
            stepper.advance(&mut state, DURATION)?;
            Ok((state, clock.elapsed().as_secs_f64()))
        }))
    })
}

fn plain(time_step: f64) -> Result<Program, Box<dyn Error>> {
    let trial = trial()?;
    let law = Law {
        mass: 1.0,
        inertia: DVec3::new(0.25, 0.125, 0.125),
        contacts: trial.coin().contacts().to_vec(),
        rim: 0.0,
        stiffness: 1000.0,
        damping: trial.damping,
        coefficient: trial.coefficient,
        slip_speed: trial.slip_speed,
        gravity: 9.8,
    };
    Ok(Box::new(move || {
        let (mut state, clock) = (trial.state(), Instant::now());
        for _ in 0..(DURATION / time_step).round() as u32 {
            state = plain_rk4::step(&law, &state, time_step);
        }
        Ok((state, clock.elapsed().as_secs_f64()))
    }))
}
