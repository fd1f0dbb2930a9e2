//! Groups of the scene that are copies of one another up to translation: what is built for one serves all.

use crate::bake::hierarchy::is_usable;
use crate::bake::subject::Subject;
use glam::DVec3;
use std::collections::HashMap;
use std::ops::Range;

/// Transforms that differ by less than this part of the group's size are the same.
const TOLERANCE: f64 = 1e-6;

/// Different groups of the same meshes that are told apart; more count as unique.
const KINDS: usize = 64;

/// Ranges of members (document order) that are copies of one another.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Repeats {
    /// Per copy its members and its kind; disjoint, ascending.
    pub(super) copies: Vec<(Range<u32>, u32)>,
}

/// First groups of the same meshes, with their kinds.
type Known = Vec<(Range<u32>, u32)>;

/// The outermost repeated groups inside `within` with at least `triangles` each, unless they are only a small part of it.
pub(super) fn find(subject: &Subject, drawn: &[bool], within: Range<u32>, triangles: u64) -> Repeats {
    let sums = prefix_sums(subject);
    let all = sums[within.end as usize] - sums[within.start as usize];
    let ranges: Vec<Range<u32>> = subject
        .groups
        .iter()
        .map(|group| group.members.clone())
        .filter(|range| within.start <= range.start && range.end <= within.end && *range != within)
        .filter(|range| sums[range.end as usize] - sums[range.start as usize] >= triangles)
        .filter(|range| {
            let usable = |m: u32| drawn[m as usize] && is_usable(&subject.members[m as usize].bounds);
            range.clone().all(usable)
        })
        .collect();
    let hashes = Hashes::new(subject);
    let mut kinds: HashMap<(u32, u64), Known> = HashMap::new();
    let mut kind_of: Vec<Option<u32>> = Vec::with_capacity(ranges.len());
    let mut counts: Vec<u32> = Vec::new();
    for range in &ranges {
        let known = kinds.entry((range.end - range.start, hashes.of(range))).or_default();
        let mut kind = known.iter().find(|(first, _)| is_copy(subject, first, range)).map(|(_, kind)| *kind);
        if kind.is_none() && known.len() < KINDS {
            let next = counts.len() as u32;
            known.push((range.clone(), next));
            counts.push(0);
            kind = Some(next);
        }
        if let Some(kind) = kind {
            counts[kind as usize] += 1;
        }
        kind_of.push(kind);
    }
    // Groups come parents first, so the first that is repeated is the outermost.
    let mut copies: Vec<(Range<u32>, u32)> = Vec::new();
    let mut end = within.start;
    let mut covered = 0;
    for (range, kind) in ranges.iter().zip(kind_of) {
        let Some(kind) = kind.filter(|&kind| counts[kind as usize] > 1 && range.start >= end) else {
            continue;
        };
        end = range.end;
        covered += sums[range.end as usize] - sums[range.start as usize];
        copies.push((range.clone(), kind));
    }
    // Few copies are no reason to group by them instead of by place.
    if covered * 2 < all { Repeats::default() } else { Repeats { copies } }
}

/// Triangles of all members before each.
fn prefix_sums(subject: &Subject) -> Vec<u64> {
    let mut sums = vec![0];
    let mut sum = 0;
    for member in &subject.members {
        sum += u64::from(member.triangles);
        sums.push(sum);
    }
    sums
}

/// Hashes of ranges of meshes, in constant time each.
struct Hashes {
    prefix: Vec<u64>,
    powers: Vec<u64>,
}

impl Hashes {
    const BASE: u64 = 0x9E37_79B9_7F4A_7C15;

    fn new(subject: &Subject) -> Self {
        let (mut prefix, mut powers) = (vec![0u64], vec![1u64]);
        for part in &subject.parts {
            let last = prefix[prefix.len() - 1];
            prefix.push(last.wrapping_mul(Self::BASE).wrapping_add(u64::from(part.mesh) + 1));
            powers.push(powers[powers.len() - 1].wrapping_mul(Self::BASE));
        }
        Self { prefix, powers }
    }

    /// A member has one part.
    fn of(&self, range: &Range<u32>) -> u64 {
        let (start, end) = (range.start as usize, range.end as usize);
        self.prefix[end].wrapping_sub(self.prefix[start].wrapping_mul(self.powers[end - start]))
    }
}

/// The second range is the first one, moved.
fn is_copy(subject: &Subject, first: &Range<u32>, second: &Range<u32>) -> bool {
    let part = |member: u32| &subject.parts[member as usize];
    let bounds = first
        .clone()
        .map(|member| subject.members[member as usize].bounds)
        .reduce(|all, bounds| all.union(&bounds));
    let Some(bounds) = bounds else { return false };
    let tolerance = TOLERANCE * (bounds.max - bounds.min).length();
    let shift = shift(subject, first, second);
    first.clone().zip(second.clone()).all(|(a, b)| {
        let (a, b) = (part(a), part(b));
        let moved = a.to_tree.translation + shift - b.to_tree.translation;
        let linear = (0..3).all(|axis| {
            let (a, b) = (a.to_tree.matrix3.col(axis), b.to_tree.matrix3.col(axis));
            (a - b).length() <= TOLERANCE * a.length()
        });
        a.mesh == b.mesh && linear && moved.length() <= tolerance
    })
}

/// From the first copy to the second, metres.
pub(super) fn shift(subject: &Subject, first: &Range<u32>, second: &Range<u32>) -> DVec3 {
    let place = |member: u32| subject.parts[member as usize].to_tree.translation;
    place(second.start) - place(first.start)
}
