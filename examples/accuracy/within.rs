//! The cheapest settings for an error, beside a plain Rk4.

// Steps in a second are few.
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
use super::table;
use super::truth::{DURATION, distance, trial};

/// Steps in a second: every number to 100, and then 1 to 2 % more from one to the next, so that a step which hits the truth by chance has neighbours that do not.
fn steps() -> Vec<f64> {
    core::iter::successors(Some(60_u32), |count| Some(count + count / 50))
        .take_while(|&count| count <= 4000)
        .map(|count| DURATION / f64::from(count))
        .collect()
}

/// m
const TOLERANCES: [f64; 12] = [
    3e-3, 2e-3, 1e-3, 5e-4, 3e-4, 2e-4, 1e-4, 5e-5, 3e-5, 2e-5, 1e-5, 5e-6,
];
/// The price is the least of so many runs.
const RUNS: usize = 200;
/// Steps of the report's loop in one of them.
const REPORT_STEPS: u32 = 100;

/// What can be run with a step (s) or a tolerance (m): the end of the trial, and the time that it took, s.
type Run = Box<dyn Fn(f64) -> Result<(State, f64), Box<dyn Error>>>;

/// Its name, the knobs to try, how they are written, and a run.
type Method<'a> = (&'a str, &'a [f64], fn(f64) -> String, Run);

/// Prints a row a method: its longest step or largest tolerance that is within `error` (m), *and every shorter or smaller one that is tried with it*, so that no chance hit counts.
pub(crate) fn table(error: f64, truth: &State) -> Result<(), Box<dyn Error>> {
    let within = format!("within {error:e} m");
    let head = [
        &within,
        "setting",
        "error",
        "price of 1 s",
        "of the plain Rk4's",
        "in steps of the report's loop",
    ];
    let mut rows = vec![table::cells(head)];
    let steps = steps();
    let yardstick = report_step()?;
    let methods: [Method; 7] = [
        (
            "an Rk4 as anyone would write it",
            &steps,
            milliseconds,
            Box::new(plain),
        ),
        (
            "`Rk4`",
            &steps,
            milliseconds,
            run(|time_step| Rk4 { time_step }),
        ),
        (
            "`StrangSplitting`",
            &steps,
            milliseconds,
            run(|time_step| StrangSplitting { time_step }),
        ),
        (
            "`EnergyMomentum`",
            &steps,
            milliseconds,
            run(|time_step| EnergyMomentum { time_step }),
        ),
        (
            "`BogackiShampine32`",
            &TOLERANCES,
            metres,
            run(BogackiShampine32::new),
        ),
        (
            "`DormandPrince54`",
            &TOLERANCES,
            metres,
            run(DormandPrince54::new),
        ),
        (
            "`Nystrom`",
            &steps,
            milliseconds,
            run(|time_step| Nystrom { time_step }),
        ),
    ];
    let mut plain_price = None;
    for (name, knobs, show, run) in methods {
        let mut longest = None;
        for &knob in knobs.iter().rev() {
            if distance(&run(knob)?.0, truth) > error {
                break;
            }
            longest = Some(knob);
        }
        let Some(knob) = longest else {
            rows.push(table::cells([name, "none that is tried", "", "", "", ""]));
            continue;
        };
        let (end, mut price) = run(knob)?;
        for _ in 0..RUNS {
            price = price.min(run(knob)?.1);
        }
        let whole = *plain_price.get_or_insert(price);
        rows.push(table::cells([
            name.to_owned(),
            show(knob),
            format!("{:.1e} m", distance(&end, truth)),
            format!("{:.0} µs", price * 1e6),
            format!("{:.2}", price / whole),
            format!("{:.0}", price / yardstick),
        ]));
    }
    table::print(&rows);
    Ok(())
}

/// Price of a step of the report's loop at the start of the trial, s: with it, prices on two machines can be compared.
fn report_step() -> Result<f64, &'static str> {
    let start = ReportLoop::new(ReportTrial::numbered(1).ok_or("the report has a trial 1")?);
    let once = || {
        let (mut report, clock) = (start.clone(), Instant::now());
        for _ in 0..REPORT_STEPS {
            report.step();
        }
        black_box(report);
        clock.elapsed().as_secs_f64() / f64::from(REPORT_STEPS)
    };
    Ok((0..RUNS).map(|_| once()).fold(f64::MAX, f64::min))
}

/// A tenth of a millisecond tells any two of the steps apart.
fn milliseconds(time_step: f64) -> String {
    format!("{} ms", (time_step * 1e4).round() / 10.0)
}

fn metres(tolerance: f64) -> String {
    format!("{tolerance:e} m")
}

fn run<I: Integrator + 'static>(with: impl Fn(f64) -> I + 'static) -> Run {
    Box::new(move |knob| {
        let trial = trial()?;
        let stepper = trial.stepper(with(knob))?;
        let (mut state, clock) = (trial.state(), Instant::now());
        stepper.advance(&mut state, DURATION)?;
        Ok((state, clock.elapsed().as_secs_f64()))
    })
}

fn plain(time_step: f64) -> Result<(State, f64), Box<dyn Error>> {
    let trial = trial()?;
    let law = Law {
        mass: 1.0,
        inertia: DVec3::new(0.25, 0.125, 0.125),
        contacts: trial.coin().contacts().to_vec(),
        stiffness: 1000.0,
        damping: trial.damping,
        coefficient: trial.coefficient,
        slip_speed: trial.slip_speed,
        gravity: 9.8,
    };
    let (mut state, clock) = (trial.state(), Instant::now());
    for _ in 0..(DURATION / time_step).round() as u32 {
        state = plain_rk4::step(&law, &state, time_step);
    }
    Ok((state, clock.elapsed().as_secs_f64()))
}
