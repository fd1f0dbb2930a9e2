//! Data passed between the stages of a bake of one tree.

pub use crate::volume::{Aabb, Sphere};
use glam::DAffine3;
use std::ops::Range;

/// Geometry that belongs to a member: one mesh, placed.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    /// Index into [`crate::scene::Scene::meshes`].
    pub mesh: u32,
    /// Index of the member it belongs to.
    pub member: u32,
    /// Mesh space to tree space.
    pub to_tree: DAffine3,
}

/// What a tree's leaves are: objects in document order, before the tree gives them its own order.
#[derive(Clone, Debug)]
pub struct Member {
    /// Box in tree space as a loader computes it: union of the boxes of the eight transformed corners of
    /// [`crate::scene::Mesh::min`]/`max`.
    pub bounds: Aabb,
    /// Triangles drawn for it.
    pub triangles: u32,
    /// Range of the tree's parts.
    pub parts: Range<u32>,
}

/// A group of the scene's own node tree, for `--hierarchy scene`: depth-first, parents first.
#[derive(Clone, Debug)]
pub struct Group {
    /// Index of the parent group, `None` for the first.
    pub parent: Option<u32>,
    /// Members below this group, contiguous in document order.
    pub members: Range<u32>,
}

/// Inner nodes over members: the tree before and after pruning.
///
/// Nodes are in depth-first order. The members below a node are contiguous in `order`; those that hang on the
/// node itself come before those of its children.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hierarchy {
    /// The inner nodes.
    pub nodes: Vec<HierarchyNode>,
    /// `order[k]` is the member (document order) at place `k` of the tree's order; a permutation.
    pub order: Vec<u32>,
}

/// One inner node.
#[derive(Clone, Debug, PartialEq)]
pub struct HierarchyNode {
    /// Parent node, `None` for a root.
    pub parent: Option<u32>,
    /// Nodes in this subtree, itself included.
    pub subtree: u32,
    /// Places in [`Hierarchy::order`] below this node.
    pub members: Range<u32>,
}

impl Hierarchy {
    /// For every place in the order: the innermost node above it, `None` if it hangs on no node.
    pub fn parents_of_members(&self) -> Vec<Option<u32>> {
        let mut parents = vec![None; self.order.len()];
        // Depth-first order: an inner node overwrites what its ancestors wrote.
        for (index, node) in self.nodes.iter().enumerate() {
            for place in node.members.clone() {
                parents[place as usize] = Some(index as u32);
            }
        }
        parents
    }

    /// For every place in the order: how many nodes are above it.
    pub fn depths_of_members(&self) -> Vec<u32> {
        let mut depths = vec![0; self.order.len()];
        for node in &self.nodes {
            for place in node.members.clone() {
                depths[place as usize] += 1;
            }
        }
        depths
    }
}
