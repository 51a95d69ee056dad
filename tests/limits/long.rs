//! Runs that are as long as is asked, and their record.
//!
//! `.ci/long.sh` runs the sweep of the extremes with many seeds, and the eight trials of the coin
//! report for one simulated hour. `TUMBLE_SWEEP_RECORD` names the file to which each of these
//! runs appends a line. `TUMBLE_TRIAL_SECONDS` is the simulated time of a trial; a plain
//! `cargo test` takes two seconds.

// Helpers of these tests fail by panicking, like the tests.
#![allow(clippy::unwrap_used)]

use core::fmt::Display;
use std::env;
use std::fs::OpenOptions;
use std::io::Write;
use tumble::real::Quaternion;
use tumble::{Energy, EnergyMomentum, Real, State, Trial};

/// Counts of a run in the order of the columns of the record: scenes, steps, scenes that ended with
/// a refusal that the documentation allows, steps that were not taken whole, steps that the energy
/// limiter held, iterations, most evaluations of a step, and steps by role.
pub(super) type Counts = [u64; 12];

/// Appends a line to the record, if one is asked for.
///
/// `failure` is the first promise that was broken. The run ends there.
pub(super) fn record(name: &str, counts: Counts, failure: Option<&dyn Display>) {
    let Some(path) = env::var_os("TUMBLE_SWEEP_RECORD") else {
        return;
    };
    let seed = env::var("PROPTEST_RNG_SEED").unwrap_or_default();
    let counts = counts.map(|count| count.to_string()).join(",");
    let failure = failure.map_or(String::new(), |failure| {
        let text = failure.to_string().replace(['"', '\n'], " ");
        format!("\"{text}\"")
    });
    let mut file = OpenOptions::new().create(true).append(true).open(path);
    let line = format!("{seed},\"{name}\",{counts},{failure}\n");
    file.as_mut().unwrap().write_all(line.as_bytes()).unwrap();
}

/// Simulated time of a trial, s.
fn trial_seconds() -> f64 {
    let asked = env::var("TUMBLE_TRIAL_SECONDS").ok();
    asked.map_or(2.0, |seconds| seconds.parse().unwrap())
}

/// Runs a trial at 1 ms and checks each step: the energy never increases, the state is finite, and
/// the orientation is a unit quaternion. Returns the first violation.
fn follow<R: Real>(number: usize, counts: &mut Counts) -> Result<(), String> {
    let trial = Trial::<R>::report(number).unwrap();
    let time_step = R::from_f64(1e-3);
    let stepper = trial.stepper(EnergyMomentum { time_step }).unwrap();
    let mut session = stepper.session(trial.state());
    let mut before = session.energy();
    counts[0] += 1;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // A count.
    for index in 0..(trial_seconds() * 1e3) as u64 {
        let step = session.step();
        let step = step.map_err(|error| format!("trial {number}, step {index}: {error}"))?;
        let after = session.energy();
        if let Some(violation) = violation(session.state(), &before, &after) {
            return Err(format!("trial {number}, step {index}: {violation}"));
        }
        counts[1] += 1;
        counts[3] += u64::from(step.fallback);
        counts[4] += u64::from(step.energy_removed > R::ZERO);
        counts[5] += u64::from(step.iterations);
        counts[6] = counts[6].max(u64::from(step.evaluations));
        before = after;
    }
    Ok(())
}

/// Returns the promise that a state breaks.
fn violation<R: Real>(
    state: &State<R>,
    before: &Energy<R>,
    after: &Energy<R>,
) -> Option<&'static str> {
    let [x, y, z, w] = state.orientation.xyzw();
    let excess = (w - R::ONE) * (w + R::ONE) + x * x + (y * y + z * z);
    if state.not_finite().is_some() {
        Some("the state is not finite")
    } else if after.total() > before.total() {
        Some("the energy increases")
    } else if excess.abs() > R::EPSILON * R::from_f64(4.0) {
        Some("the orientation is no unit quaternion")
    } else {
        None
    }
}

fn all_trials<R: Real>(name: &str) {
    for number in 1..=8 {
        let mut counts = [0; 12];
        let result = follow::<R>(number, &mut counts);
        let failure = result.as_ref().err().map(|text| text as &dyn Display);
        record(&format!("trial {number}, {name}"), counts, failure);
        assert_eq!(result, Ok(()));
    }
}

#[test]
fn the_eight_trials_keep_their_promises_for_as_long_as_is_asked() {
    all_trials::<f64>("f64");
    all_trials::<f32>("f32");
}
