//! Runs a setup, by an integrator of the library or by the loop of the coin report.

use std::error::Error;
use std::io::{self, Write};
use std::time::Instant;

use indicatif::ProgressBar;
use tumble::{
    Coin, ContactPoint, Coulomb, EnergyMomentum, FlatGround, ForwardEuler, Integrator, Nystrom,
    Observer, Rk4, Sample, State, Stepper, StrangSplitting, SymplecticEuler, UniformGravity,
};

use crate::options::UsageError;
use crate::recorder::{Recorder, RingCoin};
use crate::recording::Recording;
use crate::report;
use crate::setup::{MASS, Method, RADIUS, Setup};
use crate::tally::Tallied;

/// Stepper of the coin on its floor.
pub(crate) type CoinStepper<I> = Stepper<RingCoin, FlatGround, Coulomb, UniformGravity, I>;

/// Runs from the start of the trial to the end of its duration.
///
/// # Errors
///
/// Returns an error if the setup is invalid, or if a step fails.
pub(crate) fn run(setup: Setup, bar: &ProgressBar) -> Result<Recording, Box<dyn Error>> {
    let time_step = setup.time_step;
    match setup.method {
        Method::EnergyMomentum => record(setup, bar, EnergyMomentum { time_step }, by_library),
        Method::Report => record(setup, bar, StrangSplitting { time_step }, report::run),
        Method::ForwardEuler => record(setup, bar, ForwardEuler { time_step }, by_library),
        Method::SymplecticEuler => record(setup, bar, SymplecticEuler { time_step }, by_library),
        Method::Strang => record(setup, bar, StrangSplitting { time_step }, by_library),
        Method::Rk4 => record(setup, bar, Rk4 { time_step }, by_library),
        Method::Nystrom => record(setup, bar, Nystrom { time_step }, by_library),
    }
}

/// Composes the scene, runs it by `drive` and returns the recording.
fn record<I: Integrator<f64>>(
    setup: Setup,
    bar: &ProgressBar,
    integrator: I,
    drive: impl FnOnce(
        &Setup,
        &CoinStepper<Tallied<I>>,
        &mut Recorder<'_>,
    ) -> Result<(), Box<dyn Error>>,
) -> Result<Recording, Box<dyn Error>> {
    let stepper = compose(&setup, Tallied::new(integrator)).map_err(UsageError::new)?;
    let mut recorder = Recorder::new(&setup, stepper.body(), bar);
    let begin = Instant::now();
    drive(&setup, &stepper, &mut recorder)?;
    let wall_time = begin.elapsed().as_secs_f64();
    let (moments, audit) = recorder.finish();
    Ok(Recording {
        setup,
        moments,
        audit,
        tally: stepper.integrator().tally(),
        wall_time,
    })
}

fn compose<I: Integrator<f64>>(
    setup: &Setup,
    integrator: I,
) -> Result<CoinStepper<I>, tumble::SceneError> {
    let points = vec![ContactPoint::default(); setup.points];
    Stepper::builder(Coin::ring_with_storage(points, MASS, RADIUS))
        .ground(FlatGround::level(setup.stiffness, setup.trial.damping))
        .friction(setup.trial.friction())
        .gravity(setup.trial.gravity())
        .integrator(integrator)
        .build()
}

fn by_library<I: Integrator<f64>>(
    setup: &Setup,
    stepper: &CoinStepper<I>,
    recorder: &mut Recorder<'_>,
) -> Result<(), Box<dyn Error>> {
    let mut state: State = setup.trial.state();
    let mut limit = StepLimit::default();
    let result = stepper.run(&mut state, setup.duration, &mut |sample: &Sample<'_>| {
        limit.sample(stepper, sample);
        recorder.observe(sample)
    });
    limit.warn(setup.time_step);
    result.map_err(|error| format!("after {:.2} s: {error}", recorder.time()))?;
    Ok(())
}

/// First state of a run, sampled every 10 ms, at which the step size is unstable.
#[derive(Default)]
struct StepLimit {
    /// Time of the next sample, s.
    next: f64,
    /// Least stability limit so far and its time, s.
    least: Option<(f64, f64)>,
}

impl StepLimit {
    fn sample<I: Integrator<f64>>(&mut self, stepper: &CoinStepper<I>, sample: &Sample<'_>) {
        if sample.time < self.next {
            return;
        }
        self.next = sample.time + 0.01;
        if let Some(limit) = stepper.largest_stable_step(sample.state)
            && self.least.is_none_or(|(least, _)| limit < least)
        {
            self.least = Some((limit, sample.time));
        }
    }

    /// Prints a warning if the step size was unstable for the stiffness of a contact, or for
    /// friction in stick.
    fn warn(&self, time_step: f64) {
        if let Some((least, time)) = self.least.filter(|(least, _)| *least < time_step) {
            // The run goes on if nobody can read the warning.
            let _ = writeln!(
                io::stderr(),
                "warning: the step of {time_step:e} s is longer than {least:.1e} s, the largest \
                 stable one at {time:.2} s"
            );
        }
    }
}
