//! The programs that are compared.

pub(crate) mod ode;
pub(crate) mod ours;
pub(crate) mod plain;
pub(crate) mod rapier;
pub(crate) mod stiff;

use tumble::State;

use crate::law::Law;

/// Sees the states of a run, the first and that after each step.
pub(crate) type Watch<'a> = &'a mut dyn FnMut(&State);

/// One program with its settings, ready to run one scene from its start to its end.
pub(crate) trait Program {
    /// Who it is.
    fn name(&self) -> String;
    /// Its settings.
    fn settings(&self) -> String;
    /// A whole run.
    ///
    /// # Errors
    /// Says why the program could not go on.
    fn run(&self, watch: Option<Watch<'_>>) -> Result<End, String>;
    /// Whether its contacts are rigid, so that the rigid answer is its own.
    fn is_rigid(&self) -> bool {
        false
    }
    /// Whether its state is read 240 times a second, and not at the end alone.
    fn is_sampled(&self) -> bool {
        false
    }
    /// Whether it is this library.
    fn is_ours(&self) -> bool {
        false
    }
}

/// Where a run ended.
#[derive(Clone, Copy, Debug)]
pub(crate) struct End {
    pub(crate) state: State,
    pub(crate) steps: u64,
    /// CPU seconds before the first step, where that is worth mentioning: no part of the price.
    pub(crate) preparation: f64,
}

/// `1e-2 s`, `1.25e-2 s`: with as many digits as it takes.
fn name_of_step(time_step: f64) -> String {
    let short = format!("{time_step:.0e}");
    let is_exact = short
        .parse()
        .is_ok_and(|short: f64| (short / time_step - 1.0).abs() < 1e-3);
    if is_exact {
        format!("{short} s")
    } else {
        format!("{time_step:.2e} s")
    }
}

/// `tol 1e-6`, with the samples where there are any.
fn name_of_tolerance(tolerance: f64, is_sampled: bool) -> String {
    let samples = if is_sampled { ", 240 Hz" } else { "" };
    format!("tol {tolerance:.0e}{samples}")
}

/// Most steps of an adaptive method in a run. What takes more is no choice for the scene.
fn most_steps(law: &Law) -> u32 {
    if law.contacts.is_empty() {
        500_000
    } else {
        100_000
    }
}

/// Samples a second of a program that is sampled: four for each picture of a film.
const SAMPLES_A_SECOND: f64 = 240.0;

/// Time between two samples of a run, s: a whole number of them fills it.
fn sample_interval(seconds: f64) -> f64 {
    seconds / (seconds * SAMPLES_A_SECOND).round().max(1.0)
}
