//! Sets of toss numbers, as ranges.

use alloc::vec::Vec;
use core::ops::Range;

use super::error::EnsembleError;

/// Toss numbers as ranges in increasing order, of which no two overlap, touch or are empty.
///
/// Its size depends on the number of gaps, not on the number of tosses.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Ranges(Vec<Range<u64>>);

impl Ranges {
    pub(crate) fn as_slice(&self) -> &[Range<u64>] {
        &self.0
    }

    /// Number of tosses.
    pub(crate) fn total(&self) -> u64 {
        self.0.iter().map(|range| range.end - range.start).sum()
    }

    #[cfg(any(test, feature = "serde"))]
    pub(crate) fn contains(&self, toss: u64) -> bool {
        let after = self.0.partition_point(|range| range.end <= toss);
        self.0.get(after).is_some_and(|range| range.start <= toss)
    }

    /// Returns [`EnsembleError::Overlap`] with the first tosses that both sets contain.
    pub(crate) fn check_disjoint(&self, other: &Self) -> Result<(), EnsembleError> {
        let (mut ours, mut theirs) = (self.0.iter().peekable(), other.0.iter().peekable());
        while let (Some(a), Some(b)) = (ours.peek(), theirs.peek()) {
            let (start, end) = (a.start.max(b.start), a.end.min(b.end));
            if start < end {
                return Err(EnsembleError::Overlap { start, end });
            }
            if a.end <= b.end {
                ours.next();
            } else {
                theirs.next();
            }
        }
        Ok(())
    }

    /// Adds a disjoint set.
    pub(crate) fn join(&mut self, other: &Self) {
        self.0.extend_from_slice(&other.0);
        self.0.sort_unstable_by_key(|range| range.start);
        let mut joined: Vec<Range<u64>> = Vec::with_capacity(self.0.len());
        for range in self.0.drain(..) {
            match joined.last_mut() {
                Some(last) if last.end == range.start => last.end = range.end,
                _ => joined.push(range),
            }
        }
        self.0 = joined;
    }

    /// Ranges of `within` that the set does not contain.
    pub(crate) fn gaps(&self, within: Range<u64>) -> Vec<Range<u64>> {
        let mut gaps = Vec::new();
        let mut start = within.start;
        for range in &self.0 {
            let end = range.start.min(within.end);
            if start < end {
                gaps.push(start..end);
            }
            start = start.max(range.end);
        }
        if start < within.end {
            gaps.push(start..within.end);
        }
        gaps
    }

    /// Returns true if the ranges are as the type promises.
    #[cfg(any(test, feature = "serde"))]
    pub(crate) fn is_valid(&self) -> bool {
        let has_tosses = self.0.iter().all(|range| range.start < range.end);
        has_tosses && self.0.windows(2).all(|pair| pair[0].end < pair[1].start)
    }
}

impl From<Range<u64>> for Ranges {
    fn from(range: Range<u64>) -> Self {
        Self(if range.is_empty() {
            Vec::new()
        } else {
            alloc::vec![range]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(ranges: &[Range<u64>]) -> Ranges {
        let mut all = Ranges::default();
        for range in ranges {
            let one = Ranges::from(range.clone());
            all.check_disjoint(&one).unwrap();
            all.join(&one);
        }
        all
    }

    #[test]
    fn the_order_of_the_parts_does_not_matter() {
        let sorted = set(&[0..3, 3..5, 8..9]);
        assert_eq!(sorted.as_slice(), [0..5, 8..9]);
        assert_eq!(set(&[8..9, 3..5, 0..3]), sorted);
        assert!(sorted.is_valid() && sorted.total() == 6);
        assert!(sorted.contains(4) && !sorted.contains(5) && sorted.contains(8));
    }

    #[test]
    fn an_overlap_is_named() {
        let set = set(&[0..3, 5..8]);
        let error = set.check_disjoint(&Ranges::from(4..6)).unwrap_err();
        assert_eq!(error, EnsembleError::Overlap { start: 5, end: 6 });
        assert!(set.check_disjoint(&Ranges::from(3..5)).is_ok());
    }

    #[test]
    fn gaps_are_what_a_range_lacks() {
        let set = set(&[2..3, 5..8]);
        assert_eq!(set.gaps(0..10), [0..2, 3..5, 8..10]);
        assert_eq!(set.gaps(2..4).as_slice(), core::slice::from_ref(&(3..4)));
        assert!(set.gaps(5..8).is_empty() && set.gaps(6..6).is_empty());
        assert_eq!(set.gaps(9..u64::MAX).len(), 1);
    }
    #[test]
    fn empty_and_touching_ranges_are_invalid() {
        let valid = |ranges: &[Range<u64>]| Ranges(ranges.to_vec()).is_valid();
        assert!(valid(&[0..1, 2..3]));
        assert!(!valid(&[0..1, 1..3]));
        assert!(!valid(&[2..3, 0..1]));
        assert!(!valid(core::slice::from_ref(&(2..2))));
    }
}
