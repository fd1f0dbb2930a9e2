//! The all-levels walk: one line gives the visibility of its objects from every node of the hierarchy at once.
//!
//! An object seen from outside an ancestor is also seen, from the same direction, from every node between that
//! ancestor and itself: whatever hides it in the smaller group hides it in the larger one. So it is enough to go
//! along the line, and from each object up its ancestors until one is reached that something nearer has already
//! closed; the number of open ancestors is the object's visible level on this line.

use crate::bake::rays::LineHit;
use crate::bake::tree::Hierarchy;

const NONE: u32 = u32::MAX;

/// Parents of members (in document order) and of nodes, for walking up.
#[derive(Clone, Debug)]
pub struct Ancestry {
    parent_of_member: Vec<u32>,
    parent_of_node: Vec<u32>,
    depth_of_member: Vec<u8>,
}

/// Deepest hierarchy that levels (bytes) can describe.
pub const MAX_DEPTH: u32 = 250;

impl Ancestry {
    /// Reads the parents off a hierarchy that is at most [`MAX_DEPTH`] deep.
    pub fn new(hierarchy: &Hierarchy) -> Self {
        let parents = hierarchy.parents_of_members();
        let depths = hierarchy.depths_of_members();
        let mut parent_of_member = vec![NONE; parents.len()];
        let mut depth_of_member = vec![0; parents.len()];
        for (place, &member) in hierarchy.order.iter().enumerate() {
            parent_of_member[member as usize] = parents[place].unwrap_or(NONE);
            depth_of_member[member as usize] = depths[place].min(MAX_DEPTH) as u8;
        }
        Self {
            parent_of_member,
            parent_of_node: hierarchy.nodes.iter().map(|n| n.parent.unwrap_or(NONE)).collect(),
            depth_of_member,
        }
    }

    /// Number of members.
    pub fn members(&self) -> usize {
        self.parent_of_member.len()
    }

    /// How many nodes are above a member (document order).
    pub fn depth(&self, member: u32) -> u8 {
        self.depth_of_member[member as usize]
    }

    /// The nodes above a member, from its parent to the root.
    pub fn ancestors(&self, member: u32) -> impl Iterator<Item = u32> + '_ {
        let mut node = self.parent_of_member[member as usize];
        std::iter::from_fn(move || {
            let current = (node != NONE).then_some(node)?;
            node = self.parent_of_node[current as usize];
            Some(current)
        })
    }
}

/// Which end of the line the viewer is at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    Start,
    Finish,
}

/// Working memory of one thread.
#[derive(Debug)]
pub(crate) struct Walker {
    closed: Vec<u32>,
    seen: Vec<u32>,
    stamp: u32,
}

impl Walker {
    pub(crate) fn new(ancestry: &Ancestry) -> Self {
        Self {
            closed: vec![0; ancestry.parent_of_node.len()],
            seen: vec![0; ancestry.parent_of_member.len()],
            stamp: 0,
        }
    }

    /// Calls `visible(member, level)` once for every member that a viewer at `end` sees from at least one of its
    /// ancestors (or that has none). `hits` are ordered away from that end.
    ///
    /// Surfaces at exactly the same place are all seen: which of them a renderer shows is not ours to decide.
    pub(crate) fn walk(
        &mut self,
        ancestry: &Ancestry,
        hits: &[LineHit],
        end: End,
        mut visible: impl FnMut(u32, u8),
    ) {
        if self.stamp == u32::MAX {
            self.closed.fill(0);
            self.seen.fill(0);
            self.stamp = 0;
        }
        self.stamp += 1;
        let faces = |hit: &LineHit| match end {
            End::Start => hit.seen_from_start,
            End::Finish => hit.seen_from_end,
        };
        for group in hits.chunk_by(|a, b| a.t == b.t) {
            for hit in group.iter().filter(|h| faces(h)) {
                self.report(ancestry, hit.member, &mut visible);
            }
            for hit in group.iter().filter(|h| h.opaque && faces(h)) {
                self.close(ancestry, hit.member);
            }
        }
    }

    #[inline(always)]
    fn report(&mut self, ancestry: &Ancestry, member: u32, visible: &mut impl FnMut(u32, u8)) {
        if self.seen[member as usize] == self.stamp {
            return;
        }
        let mut node = ancestry.parent_of_member[member as usize];
        let mut level = 0;
        while node != NONE && self.closed[node as usize] != self.stamp {
            level += 1;
            node = ancestry.parent_of_node[node as usize];
        }
        if level > 0 || ancestry.depth(member) == 0 {
            self.seen[member as usize] = self.stamp;
            visible(member, level);
        }
    }

    #[inline(always)]
    fn close(&mut self, ancestry: &Ancestry, member: u32) {
        let mut node = ancestry.parent_of_member[member as usize];
        while node != NONE && self.closed[node as usize] != self.stamp {
            self.closed[node as usize] = self.stamp;
            node = ancestry.parent_of_node[node as usize];
        }
    }
}
