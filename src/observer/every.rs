//! Observation of every n-th sample.

use core::ops::ControlFlow;

use super::{Observer, Sample};
use crate::error::{Rule, SceneError};
use crate::real::Real;

/// Passes only every `steps`-th sample to another observer, starting with the first of each run.
///
/// The count starts again in each run, so short runs pass at least one sample each.
///
/// It passes on the samples after steps only. A time that the other observer requests, as
/// [`Timed`](super::Timed) does, is not requested of the run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Every<O> {
    steps: u64,
    /// Samples since the last one that was passed on.
    count: u64,
    observer: O,
}

impl<O> Every<O> {
    /// Creates an observer of every `steps`-th sample. `steps` is at least 1.
    ///
    /// # Errors
    /// Returns [`SceneError`] if `steps` is 0. The error names the quantity, the rule and the
    /// value.
    pub fn steps(steps: u64, observer: O) -> Result<Self, SceneError> {
        if steps == 0 {
            let quantity = "number of steps between samples";
            return Err(SceneError::new(quantity, Rule::AtLeast(1), 0.0, ""));
        }
        Ok(Self {
            steps,
            count: 0,
            observer,
        })
    }

    /// Returns the inner observer.
    #[must_use]
    pub fn into_inner(self) -> O {
        self.observer
    }
}

impl<R: Real, O: Observer<R>> Observer<R> for Every<O> {
    fn observe(&mut self, sample: &Sample<'_, R>) -> ControlFlow<()> {
        let is_due = sample.step == 0 || self.count == 0 || self.count >= self.steps;
        self.count = if is_due { 1 } else { self.count + 1 };
        if is_due {
            self.observer.observe(sample)
        } else {
            ControlFlow::Continue(())
        }
    }
}
