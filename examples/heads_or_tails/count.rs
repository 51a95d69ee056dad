//! Counts of outcomes, with their intervals.

/// Quantile of the normal distribution that is exceeded in absolute value with 1e-3.
pub(crate) const QUANTILE: f64 = 3.290_526_731_491_9;

/// Outcomes of some tosses. Sums of integers do not depend on their order, nor on the threads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Count {
    pub(crate) heads: u64,
    pub(crate) tails: u64,
    /// Neither, within the time of a toss.
    pub(crate) undecided: u64,
    /// Heads and tails that never passed upright.
    pub(crate) straight: u64,
}

impl Count {
    pub(crate) fn plus(self, other: Self) -> Self {
        Self {
            heads: self.heads + other.heads,
            tails: self.tails + other.tails,
            undecided: self.undecided + other.undecided,
            straight: self.straight + other.straight,
        }
    }

    pub(crate) fn decided(&self) -> u64 {
        self.heads + self.tails
    }

    /// Fraction of heads among the decided tosses.
    pub(crate) fn fraction(&self) -> f64 {
        self.heads as f64 / self.decided().max(1) as f64
    }

    /// Interval of Wilson (J. Am. Stat. Assoc. 22, 1927) at 99.9 %.
    pub(crate) fn interval(&self) -> [f64; 2] {
        let (count, fraction) = (self.decided().max(1) as f64, self.fraction());
        let square = QUANTILE * QUANTILE / count;
        let middle = (fraction + 0.5 * square) / (1.0 + square);
        let variance = fraction * (1.0 - fraction) / count + 0.25 * square / count;
        let half = QUANTILE * variance.sqrt() / (1.0 + square);
        [middle - half, middle + half]
    }

    /// Probability that a fair coin is at least so far from one half, by the normal distribution.
    pub(crate) fn p_value(&self) -> f64 {
        let distance = (self.fraction() - 0.5).abs() * 2.0 * (self.decided() as f64).sqrt();
        libm::erfc(distance / core::f64::consts::SQRT_2)
    }
}
