//! Watching now and then.

use core::ops::ControlFlow;

use super::{Observer, Sample};
use crate::real::Real;

/// Shows another observer only each `steps`-th sample, from the first one on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Every<O> {
    steps: u64,
    observer: O,
}

impl<O> Every<O> {
    /// Each `steps`-th sample; 0 counts as 1.
    #[must_use]
    pub fn steps(steps: u64, observer: O) -> Self {
        Self {
            steps: steps.max(1),
            observer,
        }
    }

    /// The observer again.
    #[must_use]
    pub fn into_inner(self) -> O {
        self.observer
    }
}

impl<R: Real, O: Observer<R>> Observer<R> for Every<O> {
    fn observe(&mut self, sample: &Sample<'_, R>) -> ControlFlow<()> {
        if sample.step % self.steps == 0 {
            self.observer.observe(sample)
        } else {
            ControlFlow::Continue(())
        }
    }
}
