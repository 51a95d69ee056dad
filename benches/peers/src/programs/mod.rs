//! The compared programs.

pub(crate) mod ode;
pub(crate) mod ours;
pub(crate) mod plain;
pub(crate) mod rapier;
pub(crate) mod stiff;

use tumble::State;

use crate::law::Law;

/// Receives the states of a run, at the start and after each step.
pub(crate) type Watch<'a> = &'a mut dyn FnMut(&State);

/// A program with its settings, which runs one scene from its start to its end.
pub(crate) trait Program {
    /// Name of the program.
    fn name(&self) -> String;
    /// Settings of the program.
    fn settings(&self) -> String;
    /// Runs the scene.
    ///
    /// # Errors
    ///
    /// Returns the reason if the program fails.
    fn run(&self, watch: Option<Watch<'_>>) -> Result<End, String>;
    /// Returns true if its contacts are rigid, so that its result is the rigid one.
    fn is_rigid(&self) -> bool {
        false
    }
    /// Returns true if its state is sampled 240 times a second, and not only at the end.
    fn is_sampled(&self) -> bool {
        false
    }
    /// Returns true if it is this library.
    fn is_ours(&self) -> bool {
        false
    }
}

/// End of a run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct End {
    pub(crate) state: State,
    pub(crate) steps: u64,
    /// CPU seconds before the first step, if worth mentioning. They are not part of the cost.
    pub(crate) preparation: f64,
}

/// Returns a step size as text, `1e-2 s` or `1.25e-2 s`, with as many digits as needed.
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

/// Returns a tolerance as text, `tol 1e-6`, followed by the sampling rate if there is one.
fn name_of_tolerance(tolerance: f64, is_sampled: bool) -> String {
    let samples = if is_sampled { ", 240 Hz" } else { "" };
    let short = format!("{tolerance:.0e}");
    let is_exact = (short.parse()).is_ok_and(|short: f64| (short / tolerance - 1.0).abs() < 1e-3);
    if is_exact {
        format!("tol {short}{samples}")
    } else {
        format!("tol {tolerance:.1e}{samples}")
    }
}

/// Largest number of steps of an adaptive method in a run. A setting that takes more is not
/// suitable.
fn most_steps(law: &Law) -> u32 {
    if law.contacts.is_empty() {
        500_000
    } else {
        100_000
    }
}

/// Samples a second of a sampled program: four for each frame of a film.
const SAMPLES_A_SECOND: f64 = 240.0;

/// Interval between two samples of a run, s. A whole number of intervals fills the run.
fn sample_interval(seconds: f64) -> f64 {
    seconds / (seconds * SAMPLES_A_SECOND).round().max(1.0)
}
