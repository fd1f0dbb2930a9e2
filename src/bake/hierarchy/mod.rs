//! The node tree over the objects of one visibility tree.
//!
//! Three ways to build it; all give a [`Hierarchy`] with one root above every member, whose nodes have at least
//! two members (the root alone may have one), at least two children, and at most [`MAX_DEPTH`] nodes above any
//! member. Results depend on neither the number of threads nor, but for rounding, on the unit or the place of the
//! scene.

mod bvh;
mod draft;
mod groups;
mod octree;
#[cfg(test)]
mod tests;

use crate::bake::tree::{Aabb, Group, Hierarchy, Member};
use draft::{Child, Draft};

/// Most nodes above any member: visible levels are stored in at most eight bits. Deeper nodes are dissolved, their
/// members hang on the last node kept.
pub const MAX_DEPTH: u32 = 255;

/// Coordinates beyond this magnitude (metres) take no part: spheres are stored as `f32`, which ends at 3.4e38.
pub(crate) const COORDINATE_LIMIT: f64 = 1e37;

/// How the nodes above the members are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, clap::ValueEnum)]
pub enum HierarchyKind {
    /// The scene's own groups; groups with more than 64 children are subdivided by the octree rule.
    Scene,
    /// Loose octree with factor 2 (Ulrich, Loose Octrees, Game Programming Gems, 2000).
    Octree,
    /// Surface area heuristic over the members' boxes, up to eight children per node.
    Bvh,
}

impl HierarchyKind {
    /// The name on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scene => "scene",
            Self::Octree => "octree",
            Self::Bvh => "bvh",
        }
    }
}

/// Builds the nodes above `members`, which are in document order; `groups` are used by [`HierarchyKind::Scene`]
/// alone.
///
/// Members without a usable box ([`Aabb::is_empty`], not finite, or beyond 1e37 m) hang on the root itself.
/// Groups need not cover the members: what is in no group hangs on the root. No members give no nodes.
pub fn build(kind: HierarchyKind, members: &[Member], groups: &[Group]) -> Hierarchy {
    let (usable, outcasts): (Vec<u32>, Vec<u32>) =
        (0..members.len() as u32).partition(|&member| is_usable(&members[member as usize].bounds));
    let items = || -> Vec<(Aabb, Child)> {
        usable.iter().map(|&member| (members[member as usize].bounds, Child::Member(member))).collect()
    };
    let mut draft = Draft::default();
    let root = match kind {
        HierarchyKind::Scene => groups::build(&mut draft, members, &usable, groups),
        HierarchyKind::Octree => {
            let children = octree::subdivide(&mut draft, &items());
            draft.add(children)
        }
        HierarchyKind::Bvh => {
            let children = bvh::build(&mut draft, &items());
            draft.add(children)
        }
    };
    draft.finish(root, &outcasts, members.len())
}

/// The box can be used for arithmetic without overflow.
pub(crate) fn is_usable(bounds: &Aabb) -> bool {
    !bounds.is_empty() && bounds.min.abs().max(bounds.max.abs()).max_element() <= COORDINATE_LIMIT
}
