//! Errors of an ensemble, and of a single toss.

use alloc::string::{String, ToString};

use super::scene_hash::SceneHash;
use crate::error::{SceneError, StepError};

/// Error of an ensemble: an invalid parameter, or results that do not belong together.
///
/// The error of a single toss is a [`TossError`], which is counted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EnsembleError {
    /// A range of tosses ends before its start.
    #[error("the end of a range of tosses must be at least its start {start}, got {end}")]
    BadRange {
        /// First toss of the range.
        start: u64,
        /// End of the range, exclusive.
        end: u64,
    },
    /// Two results contain the same tosses.
    #[error("a toss must be counted once, got the tosses {start}..{end} in both results")]
    Overlap {
        /// First toss that is in both results.
        start: u64,
        /// End of the first range of tosses that are in both results, exclusive.
        end: u64,
    },
    /// Two results have different seeds.
    #[error("the seed of a merged result must be {ours}, got {theirs}")]
    OtherSeed {
        /// Seed of the result that was merged into.
        ours: u64,
        /// Seed of the other result.
        theirs: u64,
    },
    /// Two results have different scenes, or starts, or versions of the crate.
    #[error("the scene hash of a merged result must be {ours}, got {theirs}")]
    OtherScene {
        /// Scene hash of the result that was merged into.
        ours: SceneHash,
        /// Scene hash of the other result.
        theirs: SceneHash,
    },
    /// Two results have histograms of different names or bins.
    #[error("the histograms of merged results must have equal names and bins")]
    OtherHistograms,
    /// Two histograms of an ensemble have one name.
    #[error("the name of a histogram must be unique, got {name:?} twice")]
    RepeatedName {
        /// Name of both histograms.
        name: String,
    },
    /// The scene has no energy barriers, so that no outcome is decided. [`Barriers::of`] lists the
    /// causes.
    ///
    /// [`Barriers::of`]: crate::Barriers::of
    #[error(
        "the scene has no energy barriers: the ground must be a single level plane that is at rest \
         and stiff enough to support the body, gravity plus any constant force must point along \
         -z, and any other force must be passive (`Force::is_passive`)"
    )]
    NoBarriers,
    /// A result contradicts itself: a loaded one breaks a rule, or the histograms of two merged
    /// results would have more than 2⁶³ values.
    #[error("a result must be consistent: {rule}")]
    Inconsistent {
        /// Rule that the result breaks.
        rule: &'static str,
    },
    /// A parameter is invalid.
    #[error(transparent)]
    Scene(#[from] SceneError),
}

/// Error that ended a single toss. An ensemble counts it by its kind.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct TossError {
    kind: &'static str,
    message: String,
}

impl TossError {
    /// Creates an error of your own. `kind` is the name under which it is counted.
    #[must_use]
    pub fn new(kind: &'static str, message: impl Into<String>) -> Self {
        Self {
            kind,
            message: message.into(),
        }
    }

    /// Returns the name under which the error is counted.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        self.kind
    }
}

impl From<SceneError> for TossError {
    fn from(error: SceneError) -> Self {
        Self::new("invalid scene", error.to_string())
    }
}

impl From<StepError> for TossError {
    fn from(error: StepError) -> Self {
        let kind = match error {
            StepError::BadState { .. } => "invalid state",
            StepError::Diverged(_) => "diverged",
            StepError::BrokenLaw { .. } => "broken law",
            StepError::StepTooShort { .. } => "step too short",
            StepError::BudgetSpent { .. } => "budget spent",
            StepError::BadEnergy { .. } => "invalid energy",
            StepError::StepTooLong { .. } => "step too long",
            StepError::ForceTooSteep { .. } => "force too steep",
            StepError::Stalled => "stalled",
            StepError::BadDuration { .. } => "invalid duration",
            StepError::BadLimit { .. } => "invalid limit",
            StepError::BadImpulse { .. } => "invalid impulse",
            StepError::TooManySteps { .. } => "too many steps",
            StepError::TooManySamples { .. } => "too many samples",
            StepError::BadTime { .. } => "time outside of a step",
            StepError::BadEvent { .. } => "event without a value",
        };
        Self::new(kind, error.to_string())
    }
}

/// Returns [`EnsembleError::Inconsistent`] if a rule does not hold.
pub(super) fn require(holds: bool, rule: &'static str) -> Result<(), EnsembleError> {
    if holds {
        Ok(())
    } else {
        Err(EnsembleError::Inconsistent { rule })
    }
}
