//! Requirement of `largest_stable_step`: damped oscillators do not grow in shorter steps.

use super::plan::Draw;
use super::roles::oscillator;
use super::{Input, Requirement, Violation, cannot_be, demand_at_most};
use crate::error;
use crate::integrator::Integrator;
use crate::real::{Real, Vector};
use crate::state::State;

/// Steps of each run.
const STEPS: u32 = 100;

/// Largest amplitude in the first half of a run, relative to that at the start.
///
/// A stable run may grow before it decays, where both amplification factors of a step are nearly
/// equal.
const TRANSIENT: f64 = 1e6;

/// Oscillator `y'' + damping y' + stiffness y = 0`.
#[derive(Clone, Copy)]
struct Oscillator<R> {
    /// 1/s².
    stiffness: R,
    /// 1/s.
    damping: R,
}

impl<R: Real> Oscillator<R> {
    /// Creates an oscillator with a frequency (rad/s) and a damping ratio.
    fn new(frequency: R, ratio: R) -> Self {
        Self {
            stiffness: frequency * frequency,
            damping: frequency * ratio * R::TWO,
        }
    }
}

/// Checks that oscillators do not grow in steps of 0.9 of the limit that a method states for them,
/// and in shorter ones.
///
/// They are too stiff for the method's own step size, so that the limit sets the steps. The damping
/// ratios are 0 to 30, and there is one damper without a spring. As many random oscillators as
/// `cases` follow. Nothing is checked if the method states no limit.
pub(super) fn check_stable_step<R: Real, I: Integrator<R>>(
    integrator: &I,
    time_step: R,
    cases: u32,
    draw: &mut Draw,
) -> Result<(), Violation> {
    let frequency = R::from_f64(8.0) / time_step;
    let [long, middle, short] = [0.9, 0.5, 0.2].map(R::from_f64);
    for (ratio, shorter) in [
        (0.0, middle),
        (0.1, short),
        (0.3, middle),
        (1.0, short),
        (3.0, middle),
        (30.0, short),
    ] {
        let oscillator = Oscillator::new(frequency, R::from_f64(ratio));
        is_stable(integrator, oscillator, long, time_step)?;
        is_stable(integrator, oscillator, shorter, time_step)?;
    }
    let damper = Oscillator {
        stiffness: R::ZERO,
        damping: frequency,
    };
    is_stable(integrator, damper, long, time_step)?;
    for _ in 0..cases {
        let stiffer = frequency / draw.scale::<R>(8);
        let ratio = R::from_f64(30.0) * draw.scale::<R>(12);
        let share = long * draw.share::<R>();
        is_stable(
            integrator,
            Oscillator::new(stiffer, ratio),
            share,
            time_step,
        )?;
    }
    Ok(())
}

/// Checks that an oscillator does not grow in steps of a fraction `share` of its limit.
fn is_stable<R: Real, I: Integrator<R>>(
    integrator: &I,
    Oscillator { stiffness, damping }: Oscillator<R>,
    share: R,
    time_step: R,
) -> Result<(), Violation> {
    let Some(limit) = integrator.largest_stable_step(stiffness, damping) else {
        return Ok(());
    };
    // An infinite limit is none. A limit that is not a number stays and is an error.
    let limit = R::MAX.at_most(limit);
    error::at_least_zero("largest stable step", limit, " s").map_err(cannot_be)?;
    let step = time_step.at_most(limit * share);
    if step <= R::ZERO {
        // No step is stable.
        return Ok(());
    }
    let input = || Input::Oscillator {
        stiffness: stiffness.to_f64(),
        damping: damping.to_f64(),
        step: step.to_f64(),
    };
    let time = R::ONE / (stiffness.sqrt() + damping);
    let setup = oscillator(stiffness, damping, time).map_err(cannot_be)?;
    let amplitude =
        |state: &State<R>| state.position.length() + state.linear_velocity.length() * time;
    let (mut state, mut workspace) = (setup.start, I::Workspace::default());
    let mut largest = amplitude(&state);
    let mut bound = largest * R::from_f64(TRANSIENT);
    for number in 0..STEPS {
        if number == STEPS / 2 {
            // An oscillation that neither grows nor decays varies with its phase.
            bound = largest * R::TWO;
        }
        let outcome = integrator.step(&setup.scene, &mut state, step, &mut workspace);
        outcome.map_err(|error| Violation {
            requirement: Requirement::Steps(error),
            input: input(),
            value: 0.0,
            bound: 0.0,
        })?;
        let size = amplitude(&state);
        demand_at_most(size, bound, Requirement::StableStep, input)?;
        largest = largest.at_least(size);
    }
    Ok(())
}

#[cfg(test)]
mod tests;
