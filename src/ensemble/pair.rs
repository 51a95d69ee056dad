//! Two outcomes of the same toss, to estimate how many labels are wrong.

use super::interval::wilson;
use super::tally::Tally;
use crate::error::SceneError;
use crate::outcome::Outcome;

/// Outcomes of one toss by two methods, counted by [`Ensemble::compare`](super::Ensemble::compare).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Pair<L> {
    /// Outcome by the method that is judged.
    pub coarse: Outcome<L>,
    /// Outcome by the more accurate method.
    pub fine: Outcome<L>,
}

impl<L: PartialEq> Tally<Pair<L>> {
    /// Returns the number of tosses with an outcome by both methods.
    #[must_use]
    pub fn compared(&self) -> u64 {
        self.decided().iter().map(|(_, count)| count.count()).sum()
    }

    /// Returns the number of tosses whose outcomes differ.
    #[must_use]
    pub fn changed(&self) -> u64 {
        let changed = (self.decided().iter()).filter(|(pair, _)| pair.coarse != pair.fine);
        changed.map(|(_, count)| count.count()).sum()
    }

    /// Returns Wilson's interval for the fraction of tosses whose outcome changes. See [`wilson`].
    ///
    /// It estimates the label error of the coarse method, if the fine one is much more accurate.
    /// Tosses that failed are left out.
    ///
    /// # Errors
    /// Returns [`SceneError`] if the confidence is not between 0 and 1.
    pub fn label_error(&self, confidence: f64) -> Result<[f64; 2], SceneError> {
        wilson(self.changed(), self.compared(), confidence)
    }
}
