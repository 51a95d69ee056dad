//! A single toss: its number and its stream of random numbers.

use alloc::vec::Vec;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

use super::Ensemble;
use super::error::TossError;
use super::uniform::Uniform;

/// A toss of an ensemble, with its number and its own stream of random numbers.
///
/// Toss i takes its numbers from stream i of the generator ChaCha8 with the ensemble's seed. The
/// start of a toss therefore does not depend on who plays it, on which machine, and in which order.
#[derive(Debug)]
pub struct Toss<'a> {
    ensemble: &'a Ensemble,
    number: u64,
    stream: ChaCha8Rng,
    pub(crate) records: Vec<(usize, f64)>,
}

impl<'a> Toss<'a> {
    pub(crate) fn new(ensemble: &'a Ensemble, number: u64) -> Self {
        let mut stream = ChaCha8Rng::seed_from_u64(ensemble.seed());
        stream.set_stream(number);
        Self {
            ensemble,
            number,
            stream,
            records: Vec::new(),
        }
    }

    /// Returns the number of the toss.
    #[must_use]
    pub fn number(&self) -> u64 {
        self.number
    }

    /// Returns the next 64 random bits of the stream. Use them as the seed of a generator of your
    /// own if you need other distributions.
    pub fn bits(&mut self) -> u64 {
        self.stream.next_u64()
    }

    /// Returns a uniform number, at least 0 and below 1: a multiple of 2⁻⁵³.
    pub fn fraction(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Returns a uniform number between two numbers, or the number of a [`Uniform`] that is fixed.
    pub fn uniform(&mut self, between: impl Into<Uniform>) -> f64 {
        let fraction = self.fraction();
        between.into().at(fraction)
    }

    /// Returns a stratified uniform number, at least 0 and below 1.
    ///
    /// Toss i is uniform in stratum `i mod strata` of as many equal strata. The tosses of a group,
    /// `k strata` to `(k + 1) strata - 1`, have one number in each stratum, so that their mean
    /// varies less than that of independent numbers. With 0 or 1 strata it is
    /// [`fraction`](Self::fraction).
    pub fn stratified(&mut self, strata: u32) -> f64 {
        let strata = strata.max(1);
        let stratum = self.number % u64::from(strata);
        within(stratum as f64, self.fraction(), strata)
    }

    /// Returns a number of a Latin hypercube, at least 0 and below 1, for one coordinate.
    ///
    /// `coordinate` numbers the random quantities of a toss. A [`RandomStart`](super::RandomStart)
    /// uses 0 to 7. The tosses `k strata` to `(k + 1) strata - 1` form a group. Each group has one
    /// number in each stratum, in an order that is random and independent for each group and
    /// coordinate (McKay, Beckman & Conover, Technometrics 21, 1979). With 0 or 1 strata it is
    /// [`fraction`](Self::fraction). The cost is proportional to `strata`.
    pub fn latin(&mut self, strata: u32, coordinate: u32) -> f64 {
        let strata = strata.max(1);
        let stratum = self.latin_stratum(strata, coordinate);
        within(stratum as f64, self.fraction(), strata)
    }

    /// Stratum of this toss in the random order of its group.
    fn latin_stratum(&self, strata: u32, coordinate: u32) -> u64 {
        let (group, place) = (
            self.number / u64::from(strata),
            self.number % u64::from(strata),
        );
        // The orders have a key of their own, so that they share no number with the tosses.
        let mut key = [0; 32];
        key[..8].copy_from_slice(&self.ensemble.seed().to_le_bytes());
        key[8..14].copy_from_slice(b"strata");
        key[16..20].copy_from_slice(&coordinate.to_le_bytes());
        let mut stream = ChaCha8Rng::from_seed(key);
        stream.set_stream(group);
        // Position of one element in the shuffle of Fisher and Yates, which swaps the positions `last`
        // and `chosen`. The position `last` is final afterwards.
        let mut position = place;
        for last in (1..u64::from(strata)).rev() {
            // Uniform from 0 to `last`, with a bias below 2⁻³².
            let product = u128::from(stream.next_u64()) * u128::from(last + 1);
            let chosen = u64::try_from(product >> 64).unwrap_or(0);
            if position == last {
                position = chosen;
            } else if position == chosen {
                return last;
            }
        }
        position
    }

    /// Records a value of an observable, for the [histogram](Ensemble::with_histogram) of this
    /// name.
    ///
    /// Values of a toss that ends with an error or a panic are not counted.
    ///
    /// # Errors
    /// Returns [`TossError`] if the ensemble has no histogram of this name.
    pub fn record(&mut self, name: &str, value: f64) -> Result<(), TossError> {
        let histograms = self.ensemble.histograms();
        let Some(at) = histograms.iter().position(|(own, _)| own == name) else {
            let message =
                alloc::format!("a recorded observable must have a histogram, got {name:?}");
            return Err(TossError::new("unknown observable", message));
        };
        self.records.push((at, value));
        Ok(())
    }
}

/// Number within a stratum of the unit interval. Rounding of the last stratum could give 1.
fn within(stratum: f64, fraction: f64, strata: u32) -> f64 {
    ((stratum + fraction) / f64::from(strata)).min(1.0 - f64::EPSILON / 2.0)
}

#[cfg(test)]
mod tests {
    use super::within;

    #[test]
    fn no_stratum_ends_with_1() {
        let last = 1.0 - f64::EPSILON / 2.0;
        assert!((1.0 + last) / 2.0 >= 1.0);
        for strata in [1, 2, 3, 1000, u32::MAX] {
            assert!(within(f64::from(strata - 1), last, strata) < 1.0);
        }
        assert!((within(1.0, 0.5, 4) - 0.375).abs() < 1e-15);
    }
}
