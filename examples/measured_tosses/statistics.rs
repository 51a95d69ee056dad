//! Bootstrap over whole motions: the tosses of one motion, and the samples of one toss, are not
//! independent.

use common::Random;

/// Number of drawings of a bootstrap. The ends of a 95 % interval then have a standard error of
/// about a twentieth of its width.
const DRAWINGS: usize = 2000;

/// A mean with the interval that contains 95 % of the means of a bootstrap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Interval {
    pub(crate) mean: f64,
    pub(crate) low: f64,
    pub(crate) high: f64,
}

impl Interval {
    /// Mean over all tosses, from their values by motion.
    pub(crate) fn of(motions: &[Vec<f64>], seed: u64) -> Self {
        let mean_of = |drawing: &[usize]| {
            let values = || drawing.iter().flat_map(|&motion| &motions[motion]);
            values().sum::<f64>() / values().count() as f64
        };
        let mut means: Vec<f64> = drawings(motions.len(), seed)
            .map(|drawing| mean_of(&drawing))
            .collect();
        means.sort_by(f64::total_cmp);
        let all: Vec<usize> = (0..motions.len()).collect();
        Self {
            mean: mean_of(&all),
            low: means[DRAWINGS / 40],
            high: means[DRAWINGS - 1 - DRAWINGS / 40],
        }
    }

    /// Formats the interval for a table, with `places` places.
    pub(crate) fn shown(&self, places: usize) -> String {
        let [mean, low, high] = [self.mean, self.low, self.high].map(|number| {
            let text = format!("{number:.places$}");
            // Avoids "-0.0".
            let is_zero = !text.contains(|digit: char| matches!(digit, '1'..='9'));
            if is_zero { text.replace('-', "") } else { text }
        });
        format!("{mean} ({low} to {high})")
    }
}

/// Drawings of a bootstrap. Each has `count` of the numbers below `count`, with repetition.
pub(crate) fn drawings(count: usize, seed: u64) -> impl Iterator<Item = Vec<usize>> {
    let mut random = Random(seed);
    (0..DRAWINGS).map(move |_| (0..count).map(|_| below(&mut random, count)).collect())
}

/// One of the first `count` numbers.
// Between 0 and count, which is a few hundred.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
pub(crate) fn below(random: &mut Random, count: usize) -> usize {
    (random.between(0.0, count as f64) as usize).min(count - 1)
}

/// Standard deviation.
pub(crate) fn deviation(values: impl Iterator<Item = f64>) -> f64 {
    let values: Vec<f64> = values.collect();
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares = values.iter().map(|value| (value - mean) * (value - mean));
    (squares.sum::<f64>() / (count - 1.0)).sqrt()
}

/// Median.
pub(crate) fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}
