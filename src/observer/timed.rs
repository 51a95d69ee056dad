//! Observation at given times.

use core::ops::ControlFlow;

use super::{Observer, Sample};
use crate::error::{self, SceneError};
use crate::real::Real;

/// Passes the states at the start and at multiples of an interval to another observer, instead of
/// those after each step.
///
/// A state between two steps is that at the end of a shorter step from the first of them. This step
/// is computed separately and does not affect the run. With a fixed step size the state has the
/// bits of an [`advance`](crate::Stepper::advance) to that time. With [`Flight`](crate::Flight) it
/// agrees to rounding, because that `advance` divides a flight otherwise. An adaptive method keeps
/// its tolerance. A sample costs one step.
///
/// ```
/// use core::ops::ControlFlow;
/// use tumble::{DormandPrince54, Sample, Timed, Trial};
///
/// let trial = Trial::report(1).ok_or("no such trial")?;
/// let stepper = trial.stepper(DormandPrince54::new(1e-5))?;
/// let mut heights = Vec::new();
/// let mut film = Timed::every(1.0 / 60.0, |sample: &Sample<'_>| {
///     heights.push(sample.state.position.z);
///     ControlFlow::Continue(())
/// })?;
/// stepper.run(&mut trial.state(), 1.0, &mut film)?;
/// assert_eq!(heights.len(), 61);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timed<O, R = f64> {
    interval: R,
    looks: u32,
    observer: O,
}

impl<O, R: Real> Timed<O, R> {
    /// Creates an observer with samples at 0, `seconds`, twice that, and so on.
    ///
    /// # Errors
    /// Returns [`SceneError`] if `seconds` is not above 0 or not finite. The error names the
    /// quantity, the rule and the value. [`run`](crate::Stepper::run) rejects an interval that is
    /// too short for it.
    pub fn every(seconds: R, observer: O) -> Result<Self, SceneError> {
        error::above_zero("interval of the samples", seconds, " s")?;
        Ok(Self {
            interval: seconds,
            looks: 0,
            observer,
        })
    }

    /// Returns the inner observer.
    #[must_use]
    pub fn into_inner(self) -> O {
        self.observer
    }

    fn look(&mut self, sample: &Sample<'_, R>) -> ControlFlow<()>
    where
        O: Observer<R>,
    {
        self.looks = self.looks.saturating_add(1);
        self.observer.observe(sample)
    }
}

impl<R: Real, O: Observer<R>> Observer<R> for Timed<O, R> {
    fn observe(&mut self, sample: &Sample<'_, R>) -> ControlFlow<()> {
        // Start of a run.
        if sample.step == 0 {
            self.looks = 0;
            self.look(sample)
        } else {
            ControlFlow::Continue(())
        }
    }

    fn requested_time(&self) -> Option<R> {
        let next = self.interval * R::from_usize(self.looks as usize);
        next.is_finite().then_some(next)
    }

    fn interval(&self) -> Option<R> {
        Some(self.interval)
    }

    fn observe_requested(&mut self, sample: &Sample<'_, R>) -> ControlFlow<()> {
        self.look(sample)
    }
}
