//! Histogram of an observable, with whole numbers.

use alloc::vec::Vec;

use crate::error::{self, Rule, SceneError};

/// Number of values in each of some equal bins.
///
/// Bin k of n contains `low + k w <= x < low + (k + 1) w` with `w = (high - low)/n`. A value within
/// rounding of an edge may count in the neighbouring bin, but in the same bin on every machine.
/// Values outside are counted too. Counts are whole numbers, so they do not depend on the order.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "saved::Saved")
)]
pub struct Histogram {
    low: f64,
    high: f64,
    bins: Vec<u64>,
    below: u64,
    above: u64,
    nan: u64,
}

/// Largest number of bins, 8 MB.
const MOST_BINS: usize = 1 << 20;
/// Largest number of values of a loaded or merged histogram. Further values that are counted one by
/// one then never reach the 2⁶⁴ at which a counter overflows.
const MOST_VALUES: u64 = 1 << 63;

impl Histogram {
    /// Creates an empty histogram of `bins` equal bins from `low` to `high`.
    ///
    /// # Errors
    /// Returns [`SceneError`] if an end or the width is not finite, if `high` is not above `low`,
    /// or if there are no bins or more than 2²⁰. The error names the quantity, the rule and the
    /// value.
    pub fn new(low: f64, high: f64, bins: usize) -> Result<Self, SceneError> {
        error::finite("low end of a histogram", low, "")?;
        error::finite("high end of a histogram", high, "")?;
        error::above_zero("width of a histogram", high - low, "")?;
        let count = |rule| SceneError::new("number of bins", rule, bins as f64, "");
        if bins == 0 {
            return Err(count(Rule::AtLeast(1)));
        }
        if bins > MOST_BINS {
            return Err(count(Rule::AtMost(MOST_BINS)));
        }
        Ok(Self {
            low,
            high,
            bins: alloc::vec![0; bins],
            below: 0,
            above: 0,
            nan: 0,
        })
    }

    /// Counts a value.
    pub fn add(&mut self, value: f64) {
        let counter = if value.is_nan() {
            &mut self.nan
        } else if value < self.low {
            &mut self.below
        } else if value >= self.high {
            &mut self.above
        } else {
            let last = self.bins.len() - 1;
            let fraction = (value - self.low) / (self.high - self.low);
            // At least 0 and at most 2²⁰.
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            let bin = (fraction * self.bins.len() as f64) as usize;
            &mut self.bins[bin.min(last)]
        };
        *counter += 1;
    }

    /// Returns the number of values in each bin.
    #[must_use]
    pub fn bins(&self) -> &[u64] {
        &self.bins
    }

    /// Returns the number of values below the first bin.
    #[must_use]
    pub fn below(&self) -> u64 {
        self.below
    }

    /// Returns the number of values at or above the high end.
    #[must_use]
    pub fn above(&self) -> u64 {
        self.above
    }

    /// Returns the number of values that were NaN.
    #[must_use]
    pub fn nan(&self) -> u64 {
        self.nan
    }

    /// Returns the number of values, without NaN.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.below + self.bins.iter().sum::<u64>() + self.above
    }

    /// Returns both edges of a bin, numbered from 0. The last bin ends at the high end of the
    /// histogram, and the edges of a larger number are those of a grid that continues beyond it.
    #[must_use]
    pub fn edges(&self, bin: usize) -> [f64; 2] {
        let edge = |at: usize| {
            let fraction = at as f64 / self.bins.len() as f64;
            if at == self.bins.len() {
                self.high
            } else {
                self.low + (self.high - self.low) * fraction
            }
        };
        [edge(bin), edge(bin.saturating_add(1))]
    }

    /// Returns an interval that contains the quantile of a fraction, such as 0.5 for the median:
    /// the edges of its bin. An end is infinite if the quantile is outside of the bins.
    ///
    /// The quantile is the least value with at least `fraction` of all values at or below it.
    /// Returns `None` if there is no value, or if the fraction is not above 0 and at most 1.
    #[must_use]
    pub fn quantile(&self, fraction: f64) -> Option<[f64; 2]> {
        let is_valid = fraction > 0.0 && fraction <= 1.0 && self.count() > 0;
        let all = is_valid.then(|| self.count() as f64)?;
        // Rounds as the caller's own 7.0 / 100.0 does, which a product would not.
        let is_reached = |until: u64| until as f64 / all >= fraction;
        let mut until = self.below;
        if is_reached(until) {
            return Some([f64::NEG_INFINITY, self.low]);
        }
        for (bin, count) in self.bins.iter().enumerate() {
            until += count;
            if is_reached(until) {
                return Some(self.edges(bin));
            }
        }
        Some([self.high, f64::INFINITY])
    }

    /// Returns the histogram with the same bins and counts of 0.
    pub(crate) fn emptied(mut self) -> Self {
        self.bins.fill(0);
        Self {
            below: 0,
            above: 0,
            nan: 0,
            ..self
        }
    }

    /// Returns true if both histograms have the same bins.
    pub(crate) fn has_bins_of(&self, other: &Self) -> bool {
        let ends = |h: &Self| (h.low.to_bits(), h.high.to_bits(), h.bins.len());
        ends(self) == ends(other)
    }

    /// Number of all values, or `None` if it exceeds 64 bits, as in a file it may.
    fn total(&self) -> Option<u64> {
        let outside = [self.below, self.above, self.nan];
        let mut counts = self.bins.iter().chain(&outside);
        counts.try_fold(0_u64, |sum, count| sum.checked_add(*count))
    }

    /// Returns true if the sum of both histograms has at most 2⁶³ values.
    pub(crate) fn can_join(&self, other: &Self) -> bool {
        let totals = self.total().zip(other.total());
        let sum = totals.and_then(|(ours, theirs)| ours.checked_add(theirs));
        sum.is_some_and(|sum| sum <= MOST_VALUES)
    }

    /// Adds the counts of a histogram with the same bins.
    pub(crate) fn join(&mut self, other: &Self) {
        for (ours, theirs) in self.bins.iter_mut().zip(&other.bins) {
            *ours += theirs;
        }
        self.below += other.below;
        self.above += other.above;
        self.nan += other.nan;
    }
}

#[cfg(feature = "serde")]
mod saved {
    //! A histogram as it is loaded, before it is checked.

    use super::{Histogram, MOST_VALUES, Vec};
    use crate::ensemble::error::{EnsembleError, require};

    #[derive(serde::Deserialize)]
    pub(super) struct Saved {
        low: f64,
        high: f64,
        bins: Vec<u64>,
        below: u64,
        above: u64,
        nan: u64,
    }

    impl TryFrom<Saved> for Histogram {
        type Error = EnsembleError;

        fn try_from(saved: Saved) -> Result<Self, EnsembleError> {
            let histogram = Self {
                low: saved.low,
                high: saved.high,
                bins: saved.bins,
                below: saved.below,
                above: saved.above,
                nan: saved.nan,
            };
            let empty = Self::new(histogram.low, histogram.high, histogram.bins.len());
            require(empty.is_ok(), "histograms have bins of a finite width")?;
            let fits = histogram.total().is_some_and(|total| total <= MOST_VALUES);
            require(fits, "a histogram has at most 2⁶³ values")?;
            Ok(histogram)
        }
    }
}

#[cfg(test)]
mod tests {
    use alloc::string::ToString;

    use super::*;

    /// Of n values, one in each bin, the fraction k/n is reached in bin k - 1.
    #[test]
    fn quantiles_are_in_their_bins_for_every_fraction_as_it_is_written() {
        for bins in [10_u32, 64, 100, 720] {
            let width = f64::from(bins);
            let mut histogram = Histogram::new(0.0, width, bins as usize).unwrap();
            (0..bins).for_each(|value| histogram.add(f64::from(value) + 0.5));
            for rank in 1..=bins {
                let fraction = f64::from(rank) / width;
                let expected = [f64::from(rank - 1), f64::from(rank)];
                let found = histogram.quantile(fraction).unwrap();
                let off = (found[0] - expected[0])
                    .abs()
                    .max((found[1] - expected[1]).abs());
                assert!(off < 1e-9, "{fraction}: {found:?}");
            }
        }
    }

    /// `low + (high - low)` is another number than `high` in each of these histograms.
    #[test]
    fn the_last_bin_ends_at_the_high_end() {
        for [low, high] in [
            [-0.1, 0.2],
            [0.3, 0.9],
            [-1.0, 0.1],
            [6.7, 15.4],
            [-1.0, 1e-17],
        ] {
            for bins in [1, 7, 64] {
                let mut histogram = Histogram::new(low, high, bins).unwrap();
                assert_eq!(histogram.edges(bins - 1)[1].to_bits(), high.to_bits());
                let largest = f64::from_bits(high.to_bits() - 1);
                histogram.add(largest);
                let [from, to] = histogram.quantile(1.0).unwrap();
                assert!(from <= largest && largest <= to, "{from} {largest} {to}");
            }
        }
    }

    #[test]
    fn each_value_is_counted_once() {
        let mut histogram = Histogram::new(-1.0, 1.0, 4).unwrap();
        let values = [
            -2.0,
            -1.0,
            -0.6,
            0.0,
            0.9,
            1.0_f64.next_down(),
            1.0,
            f64::NAN,
        ];
        values.into_iter().for_each(|value| histogram.add(value));
        assert_eq!(histogram.bins(), [2, 0, 1, 2]);
        assert_eq!(
            [histogram.below(), histogram.above(), histogram.nan()],
            [1; 3]
        );
        assert_eq!(histogram.count(), 7);
        assert_eq!(
            histogram.edges(3).map(f64::to_bits),
            [0.5, 1.0].map(f64::to_bits)
        );
    }

    #[test]
    fn a_quantile_is_within_its_edges() {
        let mut histogram = Histogram::new(0.0, 10.0, 10).unwrap();
        for value in 0..100 {
            histogram.add(f64::from(value) * 0.1 + 0.05);
        }
        assert_eq!(histogram.quantile(0.5), Some([4.0, 5.0]));
        assert_eq!(histogram.quantile(0.51), Some([5.0, 6.0]));
        assert_eq!(histogram.quantile(0.0), None);
        histogram.add(11.0);
        assert_eq!(histogram.quantile(1.0), Some([10.0, f64::INFINITY]));
    }

    #[test]
    fn invalid_bins_are_refused() {
        let error = Histogram::new(1.0, 1.0, 4).unwrap_err();
        assert_eq!(
            error.to_string(),
            "width of a histogram must be above 0, got 0"
        );
        assert!(Histogram::new(0.0, f64::INFINITY, 4).is_err());
        assert!(Histogram::new(-f64::MAX, f64::MAX, 4).is_err());
        assert!(Histogram::new(0.0, 1.0, 0).is_err());
        assert!(Histogram::new(0.0, 1.0, usize::MAX).is_err());
    }
    /// Two values or more of each kind, so that no sum is a product.
    #[test]
    fn joined_histograms_have_the_counts_of_all_values() {
        let values = [-3.0, -2.0, -1.5, 0.1, 0.2, 0.7, 5.0, 6.0, f64::NAN];
        let empty = Histogram::new(0.0, 1.0, 2).unwrap();
        let count = |values: &[f64]| {
            let mut histogram = empty.clone();
            values.iter().for_each(|value| histogram.add(*value));
            histogram
        };
        for split in 0..=values.len() {
            let (first, second) = values.split_at(split);
            let mut joined = count(first);
            let second = count(second);
            assert!(joined.can_join(&second));
            joined.join(&second);
            joined.join(&count(&values));
            assert_eq!(joined.bins(), [4, 2]);
            let outside = [joined.below(), joined.above(), joined.nan()];
            assert_eq!(outside, [6, 4, 2], "{split}");
        }
    }

    #[test]
    fn a_sum_of_too_many_values_is_refused() {
        let mut many = Histogram::new(0.0, 1.0, 1).unwrap();
        many.bins[0] = MOST_VALUES - 1;
        let mut one = Histogram::new(0.0, 1.0, 1).unwrap();
        one.add(2.0);
        assert!(many.can_join(&one));
        one.add(f64::NAN);
        assert!(!many.can_join(&one));
        many.bins[0] = u64::MAX;
        assert!(!many.can_join(&one));
    }

    #[test]
    fn an_empty_histogram_has_no_quantile() {
        let mut histogram = Histogram::new(0.0, 1.0, 1).unwrap();
        assert_eq!(histogram.quantile(0.5), None);
        histogram.add(f64::NAN);
        assert_eq!(histogram.quantile(0.5), None);
    }
}
