//! Counts of the outcomes of an ensemble.

use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;
use core::ops::Range;

use super::error::{EnsembleError, require};
use super::histogram::Histogram;
use super::interval::wilson;
use super::ranges::Ranges;
use super::scene_hash::SceneHash;
use crate::error::SceneError;
use crate::outcome::Outcome;

/// Number of tosses with one outcome, and the lowest of their numbers, for a replay.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Count {
    count: u64,
    first: Vec<u64>,
}

impl Count {
    /// Largest number of toss numbers that are kept. The lowest ones are kept, so that they do not
    /// depend on the order.
    pub const KEPT: usize = 16;

    /// Returns the number of tosses.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Returns the lowest toss numbers, at most [`KEPT`](Self::KEPT), in increasing order.
    #[must_use]
    pub fn first(&self) -> &[u64] {
        &self.first
    }

    fn add(&mut self, toss: u64) {
        self.count += 1;
        self.keep(&[toss]);
    }

    fn join(&mut self, other: &Self) {
        self.count += other.count;
        self.keep(&other.first);
    }

    fn keep(&mut self, tosses: &[u64]) {
        let is_full = self.first.len() == Self::KEPT;
        if is_full && self.first.last() < tosses.first() {
            return;
        }
        self.first.extend_from_slice(tosses);
        self.first.sort_unstable();
        self.first.truncate(Self::KEPT);
    }

    #[cfg(feature = "serde")]
    fn is_valid(&self, ranges: &Ranges) -> bool {
        let kept = usize::try_from(self.count).map_or(Self::KEPT, |count| count.min(Self::KEPT));
        let is_sorted = self.first.windows(2).all(|pair| pair[0] < pair[1]);
        let is_inside = self.first.iter().all(|&toss| ranges.contains(toss));
        self.first.len() == kept && is_sorted && is_inside
    }
}

/// How a toss ended.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Ending<L> {
    Outcome(Outcome<L>),
    Error(&'static str),
    Panic,
}

/// A toss that was played.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Played<L> {
    pub(crate) ending: Ending<L>,
    /// Values of observables, each with the number of its histogram.
    pub(crate) records: Vec<(usize, f64)>,
}

/// Counts of the outcomes of some tosses of an ensemble, with the label type `L`.
///
/// All counts are whole numbers, and depend on the tosses only. They do not depend on their order,
/// on the threads, and on the parts that were [merged](Self::merge). The size depends on the number
/// of different labels and kinds of errors, not on the number of tosses.
///
/// `Display` writes a table with Wilson's intervals of 95 %.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(bound(
        serialize = "L: serde::Serialize",
        deserialize = "L: serde::Deserialize<'de> + Ord"
    )),
    serde(try_from = "saved::Saved<L>")
)]
pub struct Tally<L> {
    seed: u64,
    scene: SceneHash,
    ranges: Ranges,
    /// In increasing order of the labels.
    decided: Vec<(L, Count)>,
    undecided: Count,
    /// In increasing order of the kinds.
    errors: Vec<(String, Count)>,
    panics: Count,
    histograms: Vec<(String, Histogram)>,
}

impl<L: Ord> Tally<L> {
    pub(crate) fn new(seed: u64, scene: SceneHash, histograms: &[(String, Histogram)]) -> Self {
        Self {
            seed,
            scene,
            ranges: Ranges::default(),
            decided: Vec::new(),
            undecided: Count::default(),
            errors: Vec::new(),
            panics: Count::default(),
            histograms: histograms.to_vec(),
        }
    }

    /// Counts the tosses of a range.
    pub(crate) fn add(&mut self, range: Range<u64>, played: Vec<Played<L>>) {
        for (toss, played) in range.clone().zip(played) {
            match played.ending {
                Ending::Outcome(Outcome::Decided(label)) => {
                    entry(&mut self.decided, label).add(toss);
                }
                Ending::Outcome(Outcome::Undecided) => self.undecided.add(toss),
                Ending::Error(kind) => entry(&mut self.errors, String::from(kind)).add(toss),
                Ending::Panic => self.panics.add(toss),
            }
            for (at, value) in played.records {
                if let Some((_, histogram)) = self.histograms.get_mut(at) {
                    histogram.add(value);
                }
            }
        }
        self.ranges.join(&range.into());
    }

    /// Adds the counts of other tosses of the same ensemble.
    ///
    /// # Errors
    /// Returns [`EnsembleError`] if a toss is in both results, if seed, scene hash or histograms
    /// differ, or if a histogram has more than 2⁶³ values. The result is then unchanged.
    pub fn merge(&mut self, other: &Self) -> Result<(), EnsembleError>
    where
        L: Clone,
    {
        self.check_same(other)?;
        self.ranges.check_disjoint(&other.ranges)?;
        self.ranges.join(&other.ranges);
        for (label, count) in &other.decided {
            entry(&mut self.decided, label.clone()).join(count);
        }
        self.undecided.join(&other.undecided);
        for (kind, count) in &other.errors {
            entry(&mut self.errors, kind.clone()).join(count);
        }
        self.panics.join(&other.panics);
        for ((_, ours), (_, theirs)) in self.histograms.iter_mut().zip(&other.histograms) {
            ours.join(theirs);
        }
        Ok(())
    }

    fn check_same(&self, other: &Self) -> Result<(), EnsembleError> {
        if self.seed != other.seed {
            let (ours, theirs) = (self.seed, other.seed);
            return Err(EnsembleError::OtherSeed { ours, theirs });
        }
        if self.scene != other.scene {
            let (ours, theirs) = (self.scene, other.scene);
            return Err(EnsembleError::OtherScene { ours, theirs });
        }
        let mut pairs = self.histograms.iter().zip(&other.histograms);
        let is_same = pairs.all(|(a, b)| a.0 == b.0 && a.1.has_bins_of(&b.1));
        if !is_same || self.histograms.len() != other.histograms.len() {
            return Err(EnsembleError::OtherHistograms);
        }
        let mut pairs = self.histograms.iter().zip(&other.histograms);
        let fits = pairs.all(|(a, b)| a.1.can_join(&b.1));
        require(fits, "a histogram has at most 2⁶³ values")
    }

    /// Returns the number of tosses that were decided with this label.
    #[must_use]
    pub fn count(&self, label: &L) -> u64 {
        let found = self.decided.binary_search_by(|(own, _)| own.cmp(label));
        found.map_or(0, |at| self.decided[at].1.count)
    }

    /// Returns Wilson's interval for the probability that a toss is decided with this label. See
    /// [`wilson`].
    ///
    /// The trials are all tosses, also those that are undecided or that failed.
    ///
    /// # Errors
    /// Returns [`SceneError`] if the confidence is not between 0 and 1.
    pub fn interval(&self, label: &L, confidence: f64) -> Result<[f64; 2], SceneError> {
        wilson(self.count(label), self.tosses(), confidence)
    }

    /// Returns an interval like [`interval`](Self::interval) that holds whatever the tosses without
    /// a face would have shown.
    ///
    /// At the low end none of the tosses that are undecided or that failed has this label, and at
    /// the high end all of them have it.
    ///
    /// # Errors
    /// Returns [`SceneError`] if the confidence is not between 0 and 1.
    pub fn bounds(&self, label: &L, confidence: f64) -> Result<[f64; 2], SceneError> {
        let (count, tosses) = (self.count(label), self.tosses());
        let decided: u64 = self.decided.iter().map(|(_, count)| count.count).sum();
        let [low, _] = wilson(count, tosses, confidence)?;
        let [_, high] = wilson(count + (tosses - decided), tosses, confidence)?;
        Ok([low, high])
    }
}

impl<L> Tally<L> {
    /// Returns the seed of the ensemble.
    #[must_use]
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Returns the scene hash of the ensemble.
    #[must_use]
    pub fn scene(&self) -> SceneHash {
        self.scene
    }

    /// Returns the number of all tosses that are counted.
    #[must_use]
    pub fn tosses(&self) -> u64 {
        self.ranges.total()
    }

    /// Returns the toss numbers that are counted, as ranges in increasing order with gaps between
    /// them.
    #[must_use]
    pub fn ranges(&self) -> &[Range<u64>] {
        self.ranges.as_slice()
    }

    /// Returns the toss numbers of a range that are not counted, as ranges in increasing order.
    #[must_use]
    pub fn gaps(&self, within: Range<u64>) -> Vec<Range<u64>> {
        self.ranges.gaps(within)
    }

    /// Returns the decided tosses by label, in increasing order of the labels that occur.
    #[must_use]
    pub fn decided(&self) -> &[(L, Count)] {
        &self.decided
    }

    /// Returns the undecided tosses.
    #[must_use]
    pub fn undecided(&self) -> &Count {
        &self.undecided
    }

    /// Returns the tosses that ended with an error, by the kind of the error.
    #[must_use]
    pub fn errors(&self) -> &[(String, Count)] {
        &self.errors
    }

    /// Returns the tosses that ended with a panic.
    #[must_use]
    pub fn panics(&self) -> &Count {
        &self.panics
    }

    /// Returns the histogram of an observable by its name.
    #[must_use]
    pub fn histogram(&self, name: &str) -> Option<&Histogram> {
        let mut named = self.histograms.iter().filter(|(own, _)| own == name);
        named.next().map(|(_, histogram)| histogram)
    }
}

/// The counter of a key in a sorted list, which is inserted where there is none.
fn entry<K: Ord>(counts: &mut Vec<(K, Count)>, key: K) -> &mut Count {
    let at = match counts.binary_search_by(|(own, _)| own.cmp(&key)) {
        Ok(at) => at,
        Err(at) => {
            counts.insert(at, (key, Count::default()));
            at
        }
    };
    &mut counts[at].1
}

impl<L: fmt::Debug> fmt::Display for Tally<L> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (tosses, seed, scene) = (self.tosses(), self.seed, self.scene);
        write!(f, "{tosses} tosses, seed {seed}, scene {scene}")?;
        let mut line = |name: &str, count: &Count| {
            let [low, high] = wilson(count.count, tosses, 0.95).map_err(|_| fmt::Error)?;
            let fraction = count.count as f64 / tosses.max(1) as f64;
            let count = count.count;
            write!(
                f,
                "\n{name:<16} {count:>12}  {fraction:.4} [{low:.4}, {high:.4}]"
            )
        };
        for (label, count) in &self.decided {
            line(&alloc::format!("{label:?}"), count)?;
        }
        line("undecided", &self.undecided)?;
        for (kind, count) in &self.errors {
            line(kind, count)?;
        }
        if self.panics.count > 0 {
            line("panic", &self.panics)?;
        }
        Ok(())
    }
}

#[cfg(feature = "serde")]
mod saved {
    //! A tally as it is loaded, before it is checked.

    use super::{Count, EnsembleError, Histogram, Ranges, SceneHash, String, Tally, Vec, require};

    #[derive(serde::Deserialize)]
    pub(super) struct Saved<L> {
        seed: u64,
        scene: SceneHash,
        ranges: Ranges,
        decided: Vec<(L, Count)>,
        undecided: Count,
        errors: Vec<(String, Count)>,
        panics: Count,
        histograms: Vec<(String, Histogram)>,
    }

    impl<L: Ord> TryFrom<Saved<L>> for Tally<L> {
        type Error = EnsembleError;

        fn try_from(saved: Saved<L>) -> Result<Self, EnsembleError> {
            let tally = Self {
                seed: saved.seed,
                scene: saved.scene,
                ranges: saved.ranges,
                decided: saved.decided,
                undecided: saved.undecided,
                errors: saved.errors,
                panics: saved.panics,
                histograms: saved.histograms,
            };
            tally.check()?;
            Ok(tally)
        }
    }

    impl<L: Ord> Tally<L> {
        fn check(&self) -> Result<(), EnsembleError> {
            require(self.ranges.is_valid(), "ranges are sorted and disjoint")?;
            let labels = self.decided.windows(2).all(|pair| pair[0].0 < pair[1].0);
            let kinds = self.errors.windows(2).all(|pair| pair[0].0 < pair[1].0);
            require(labels && kinds, "labels and kinds are sorted")?;
            let counts = || {
                let decided = self.decided.iter().map(|(_, count)| count);
                let errors = self.errors.iter().map(|(_, count)| count);
                decided.chain(errors).chain([&self.undecided, &self.panics])
            };
            let total = counts().try_fold(0_u64, |sum, count| sum.checked_add(count.count));
            let adds_up = total == Some(self.tosses());
            require(adds_up, "the counts add up to the number of tosses")?;
            let has_first = counts().all(|count| count.is_valid(&self.ranges));
            require(
                has_first,
                "the lowest toss numbers are listed, in the ranges",
            )?;
            let mut first: Vec<u64> = counts().flat_map(|count| &count.first).copied().collect();
            first.sort_unstable();
            let is_once = first.windows(2).all(|pair| pair[0] < pair[1]);
            require(is_once, "a toss is counted once")?;
            let mut names: Vec<&str> = self.histograms.iter().map(|(name, _)| &**name).collect();
            names.sort_unstable();
            let differ = names.windows(2).all(|pair| pair[0] != pair[1]);
            require(differ, "histograms have different names")
        }
    }
}

#[cfg(test)]
mod tests {
    use alloc::string::ToString;

    use super::*;

    fn tally(endings: &[Ending<u8>]) -> Tally<u8> {
        let mut tally = Tally::new(7, SceneHash::of_bytes(b""), &[]);
        let played = endings.iter().map(|ending| Played {
            ending: ending.clone(),
            records: Vec::new(),
        });
        tally.add(0..endings.len() as u64, played.collect());
        tally
    }

    fn decided(label: u8) -> Ending<u8> {
        Ending::Outcome(Outcome::Decided(label))
    }

    #[test]
    fn the_table_has_a_line_for_each_ending_and_one_for_panics_if_there_are_any() {
        let undecided = Ending::Outcome(Outcome::Undecided);
        let mut endings = alloc::vec![decided(3), decided(3), decided(4), undecided];
        let table = tally(&endings).to_string();
        assert!(table.starts_with("4 tosses, seed 7, scene "), "{table}");
        let line = |table: &str, name: &str| {
            let words = |line: &str| -> Vec<String> { line.split(' ').map(String::from).collect() };
            let lines = table.lines().map(words);
            let mut found = lines.filter(|words| words[0] == name);
            found.next().map(|words| words.join(" "))
        };
        assert!(line(&table, "3").unwrap().contains(" 2  0.5000 ["));
        assert!(line(&table, "undecided").unwrap().contains(" 1  0.2500 ["));
        assert_eq!(line(&table, "panic"), None);
        endings.push(Ending::Panic);
        let table = tally(&endings).to_string();
        assert!(line(&table, "panic").unwrap().contains(" 1  0.2000 ["));
        assert_eq!(tally(&endings).seed(), 7);
    }

    #[test]
    #[cfg(feature = "serde")]
    fn a_label_a_kind_or_a_toss_that_stands_twice_is_refused() {
        let loads = |tally: &Tally<u8>| {
            let text = serde_json::to_string(tally).unwrap();
            serde_json::from_str::<Tally<u8>>(&text).is_ok()
        };
        let sound = tally(&[
            decided(1),
            decided(2),
            Ending::Error("a"),
            Ending::Error("b"),
        ]);
        assert!(loads(&sound));
        let mut twice = sound.clone();
        twice.decided[1].0 = 1;
        assert!(!loads(&twice));
        let mut twice = sound.clone();
        twice.errors[1].0 = String::from("a");
        assert!(!loads(&twice));
        let mut unsorted = sound.clone();
        unsorted.errors.swap(0, 1);
        assert!(!loads(&unsorted));
        let mut twice = tally(&[decided(1), decided(1)]);
        twice.decided[0].1.first[1] = 0;
        assert!(!loads(&twice));
    }

    #[test]
    #[cfg(feature = "serde")]
    fn a_toss_with_two_endings_is_refused() {
        let mut both = tally(&[decided(1), Ending::Outcome(Outcome::Undecided)]);
        both.undecided.first[0] = 0;
        let text = serde_json::to_string(&both).unwrap();
        let error = serde_json::from_str::<Tally<u8>>(&text).unwrap_err();
        assert!(
            error.to_string().contains("a toss is counted once"),
            "{error}"
        );
    }

    #[test]
    fn parts_that_share_tosses_are_refused_with_the_range_that_they_share() {
        let part = |range: Range<u64>| {
            let mut part = tally(&[]);
            let played = range.clone().map(|_| Played {
                ending: decided(1),
                records: Vec::new(),
            });
            part.add(range.clone(), played.collect());
            part
        };
        let whole = part(10..20);
        for (other, shared) in [(19..25, 19..20), (12..13, 12..13), (0..30, 10..20)] {
            let error = whole.clone().merge(&part(other)).unwrap_err();
            let Range { start, end } = shared;
            assert_eq!(error, EnsembleError::Overlap { start, end });
        }
        assert!(whole.clone().merge(&part(20..21)).is_ok());
    }
}
