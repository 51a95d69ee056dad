//! A number that is uniform in an interval.

use core::ops::RangeInclusive;

use crate::error::{self, SceneError};

/// A parameter that is uniform in an interval, or fixed. Created from a number, or from an interval
/// such as `0.1..=0.3`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Uniform {
    /// Low end.
    pub low: f64,
    /// High end, at least `low`.
    pub high: f64,
}

impl Uniform {
    /// Number at a fraction of the interval.
    pub(crate) fn at(self, fraction: f64) -> f64 {
        self.low + (self.high - self.low) * fraction
    }

    pub(super) fn check(
        self,
        [low, width]: [&'static str; 2],
        unit: &'static str,
    ) -> Result<(), SceneError> {
        error::finite(low, self.low, unit)?;
        error::at_least_zero(width, self.high - self.low, unit)
    }
}

impl From<f64> for Uniform {
    fn from(fixed: f64) -> Self {
        Self {
            low: fixed,
            high: fixed,
        }
    }
}

impl From<RangeInclusive<f64>> for Uniform {
    fn from(interval: RangeInclusive<f64>) -> Self {
        Self {
            low: *interval.start(),
            high: *interval.end(),
        }
    }
}
