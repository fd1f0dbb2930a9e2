//! The scene's own groups as a hierarchy.

use super::draft::{Child, Draft};
use super::octree;
use crate::bake::tree::{Aabb, Group, Member};

/// Groups with more children than this say nothing about where things are, and are subdivided.
const FLAT_GROUP: usize = 64;

/// Makes a draft node per group that holds something, below one root; returns the root. `usable` are the members
/// to place, in ascending order.
pub(super) fn build(draft: &mut Draft, members: &[Member], usable: &[u32], groups: &[Group]) -> u32 {
    // The last place is the root's: it takes what is in no group.
    let root = groups.len();
    let owners = innermost_groups(usable, groups);
    let mut children = vec![Vec::new(); groups.len() + 1];
    let mut bounds = vec![Aabb::EMPTY; groups.len() + 1];
    for (&member, owner) in usable.iter().zip(owners) {
        let owner = owner.map_or(root, |group| group as usize);
        children[owner].push((members[member as usize].bounds, Child::Member(member)));
        bounds[owner] = bounds[owner].union(&members[member as usize].bounds);
    }
    // Parents come before their children, so backwards every group is complete when it is its turn.
    for index in (0..groups.len()).rev() {
        let mut own = std::mem::take(&mut children[index]);
        if own.is_empty() {
            continue;
        }
        let child = match own.as_slice() {
            [(_, only)] => *only,
            _ => {
                sort(&mut own);
                Child::Node(node(draft, own))
            }
        };
        let parent = match groups[index].parent {
            Some(parent) if (parent as usize) < index => parent as usize,
            _ => root,
        };
        children[parent].push((bounds[index], child));
        bounds[parent] = bounds[parent].union(&bounds[index]);
    }
    let mut own = std::mem::take(&mut children[root]);
    sort(&mut own);
    node(draft, own)
}

/// Members first, then groups in document order (they were added backwards, so later nodes come first).
fn sort(children: &mut [(Aabb, Child)]) {
    children.sort_by_key(|(_, child)| match *child {
        Child::Member(member) => (0, member),
        Child::Node(node) => (1, u32::MAX - node),
    });
}

fn node(draft: &mut Draft, children: Vec<(Aabb, Child)>) -> u32 {
    let children = if children.len() > FLAT_GROUP {
        octree::subdivide(draft, &children)
    } else {
        children.into_iter().map(|(_, child)| child).collect()
    };
    draft.add(children)
}

/// For each usable member the innermost group that holds it.
fn innermost_groups(usable: &[u32], groups: &[Group]) -> Vec<Option<u32>> {
    let mut owners = vec![None; usable.len()];
    // Inner groups come last, so backwards the first group to claim a member is the innermost. `next[i]` leads from
    // `i` to a member that is not claimed yet (with path halving), so deep nesting costs no more than flat groups.
    let mut next: Vec<usize> = (0..=usable.len()).collect();
    let mut find = |mut i: usize, claimed: bool| {
        if claimed {
            next[i] = i + 1;
        }
        while next[i] != i {
            next[i] = next[next[i]];
            i = next[i];
        }
        i
    };
    for (index, group) in groups.iter().enumerate().rev() {
        let end = usable.partition_point(|&member| member < group.members.end);
        let mut i = find(usable.partition_point(|&member| member < group.members.start), false);
        while i < end {
            owners[i] = Some(index as u32);
            i = find(i, true);
        }
    }
    owners
}
