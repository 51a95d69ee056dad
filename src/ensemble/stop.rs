//! Progress of an ensemble, and rules that end it early.

use core::time::Duration;

use super::interval::wilson;
use super::tally::Tally;
use crate::error::{self, SceneError};

/// Progress of a run over a range of tosses, passed to the caller after each block.
#[derive(Clone, Copy, Debug)]
pub struct Progress<'a, L> {
    /// Counts so far.
    pub tally: &'a Tally<L>,
    /// Number of tosses so far.
    pub done: u64,
    /// Number of tosses of the range.
    pub total: u64,
    /// Time since the start of the run.
    pub elapsed: Duration,
}

impl<L> Progress<'_, L> {
    /// Returns the number of tosses per second so far, or 0 before any time has passed.
    #[must_use]
    pub fn rate(&self) -> f64 {
        let seconds = self.elapsed.as_secs_f64();
        if seconds > 0.0 {
            self.done as f64 / seconds
        } else {
            0.0
        }
    }

    /// Returns the time left at the rate so far. Returns `None` if there is no rate yet, or if the
    /// time is longer than a [`Duration`].
    #[must_use]
    pub fn remaining(&self) -> Option<Duration> {
        let seconds = (self.total - self.done) as f64 / self.rate();
        Duration::try_from_secs_f64(seconds).ok()
    }
}

/// Rules that end a run before the end of its range, at the end of a [block](super::Ensemble).
///
/// | rule | result |
/// |---|---|
/// | number of tosses | the range of the run itself |
/// | [`at_width`](Self::at_width) | the same on any machine with any number of threads |
/// | [`after`](Self::after) | depends on the speed of the machine; its range says how far it came |
///
/// In each case the result is that of the tosses in its ranges, and it can be continued and merged.
#[derive(Clone, Debug, PartialEq)]
pub struct Stop<L> {
    width: Option<(L, f64, f64)>,
    time: Option<Duration>,
}

impl<L> Default for Stop<L> {
    fn default() -> Self {
        Self::at_end()
    }
}

impl<L> Stop<L> {
    /// Creates a rule that never ends a run early.
    #[must_use]
    pub fn at_end() -> Self {
        Self {
            width: None,
            time: None,
        }
    }

    /// Returns the rules with a limit on the width: the run ends if Wilson's interval for `label`
    /// is at most as wide as `width` (a fraction, 0 to 1).
    ///
    /// A second call replaces the label, the confidence and the width of the first. With a limit on
    /// the [time](Self::after) too, the run ends at whichever is reached first.
    ///
    /// *Limit:* the interval is evaluated after each block, and the run ends at a moment that
    /// depends on it. Its coverage is then a little below the confidence. For an exact statement,
    /// fix the number of tosses beforehand.
    ///
    /// # Errors
    /// Returns [`SceneError`] if the confidence is not between 0 and 1, or if the width is not
    /// above 0.
    pub fn at_width(self, label: L, confidence: f64, width: f64) -> Result<Self, SceneError> {
        wilson(0, 0, confidence)?;
        error::above_zero("width of the interval", width, "")?;
        Ok(Self {
            width: Some((label, confidence, width)),
            ..self
        })
    }

    /// Returns the rules with a limit on the time: the run ends after the first block that ends at
    /// `time` or later, counted from the start of the run. A second call replaces the time.
    #[must_use]
    pub fn after(self, time: Duration) -> Self {
        Self {
            time: Some(time),
            ..self
        }
    }
}

impl<L: Ord> Stop<L> {
    pub(crate) fn is_reached(&self, progress: &Progress<'_, L>) -> bool {
        let is_late = self.time.is_some_and(|time| progress.elapsed >= time);
        let is_narrow = self
            .width
            .as_ref()
            .is_some_and(|(label, confidence, width)| {
                let interval = progress.tally.interval(label, *confidence);
                interval.is_ok_and(|[low, high]| high - low <= *width)
            });
        is_late || is_narrow
    }
}
