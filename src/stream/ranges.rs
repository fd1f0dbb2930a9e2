//! Sets of bytes.

use std::collections::BTreeMap;
use std::ops::Range;

/// Disjoint ranges, none empty, none touching another.
#[derive(Clone, Debug, Default)]
pub(super) struct Ranges(BTreeMap<u64, u64>);

impl Ranges {
    /// Adds a range.
    pub(super) fn insert(&mut self, range: Range<u64>) {
        if range.is_empty() {
            return;
        }
        let (mut start, mut end) = (range.start, range.end);
        // The last range that begins before the end, again and again, as long as it reaches the new one.
        while let Some((&s, &e)) = self.0.range(..=end).next_back().filter(|&(_, &e)| e >= start) {
            self.0.remove(&s);
            (start, end) = (start.min(s), end.max(e));
        }
        self.0.insert(start, end);
    }

    /// Whether all of a range is in the set.
    pub(super) fn contains(&self, range: &Range<u64>) -> bool {
        let before = self.0.range(..=range.start).next_back();
        range.is_empty() || before.is_some_and(|(_, &end)| end >= range.end)
    }

    /// The parts of a range that are not in the set.
    pub(super) fn missing(&self, range: Range<u64>) -> Vec<Range<u64>> {
        let mut missing = Vec::new();
        let mut at = range.start;
        if let Some((_, &end)) = self.0.range(..=at).next_back() {
            at = at.max(end);
        }
        for (&start, &end) in self.0.range(range.start..range.end) {
            if start > at {
                missing.push(at..start);
            }
            at = at.max(end);
        }
        if at < range.end {
            missing.push(at..range.end);
        }
        missing
    }

    /// Bytes in the set.
    #[cfg(test)]
    pub(super) fn total(&self) -> u64 {
        self.0.iter().map(|(start, end)| end - start).sum()
    }
}

/// Ranges with gaps of at most `gap` closed: a request costs more than the bytes of a small gap.
pub(super) fn coalesce(mut ranges: Vec<Range<u64>>, gap: u64) -> Vec<Range<u64>> {
    ranges.sort_unstable_by_key(|range| range.start);
    let mut joined: Vec<Range<u64>> = Vec::with_capacity(ranges.len());
    for range in ranges {
        match joined.last_mut() {
            Some(last) if range.start <= last.end.saturating_add(gap) => last.end = last.end.max(range.end),
            _ => joined.push(range),
        }
    }
    joined
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn agree_with_a_list_of_flags(list in prop::collection::vec((0..60_u64, 0..12_u64), 0..20), ask in (0..60_u64, 0..20_u64)) {
            let mut ranges = Ranges::default();
            let mut flags = [false; 100];
            for (start, length) in list {
                ranges.insert(start..start + length);
                flags[start as usize..(start + length) as usize].fill(true);
            }
            let asked = ask.0..ask.0 + ask.1;
            let inside = &flags[asked.start as usize..asked.end as usize];
            prop_assert_eq!(ranges.contains(&asked), inside.iter().all(|&flag| flag));
            let missing = ranges.missing(asked.clone());
            let mut found = [false; 100];
            for range in &missing {
                prop_assert!(!range.is_empty());
                found[range.start as usize..range.end as usize].fill(true);
            }
            for at in asked {
                prop_assert_eq!(found[at as usize], !flags[at as usize]);
            }
            prop_assert_eq!(ranges.total(), flags.iter().filter(|&&flag| flag).count() as u64);
        }
    }

    #[test]
    fn small_gaps_are_closed() {
        assert_eq!(coalesce(vec![30..40, 0..10, 12..20], 2), [0..20, 30..40]);
        assert_eq!(coalesce(vec![0..10, 5..7], 0), vec![0..10; 1]);
    }
}
