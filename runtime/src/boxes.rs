//! Boxes of everything in a tree.

use crate::bounds::Bounds;
use crate::detail::mu::{Shape, shapes};
use crate::nesting;
use crate::tree::Tree;

/// Boxes of a tree's objects and nodes.
#[derive(Debug)]
pub(crate) struct Boxes {
    pub(crate) objects: Vec<Bounds>,
    /// Union of the objects' boxes: always right, and mostly tighter than the sphere.
    pub(crate) nodes: Vec<Bounds>,
    /// Unions of [`CHUNK`] objects each in tree order, for where there are no nodes.
    pub(crate) chunks: Vec<Bounds>,
    /// What each proxy could show.
    pub(crate) proxies: Vec<Shape>,
}

/// Objects with a common box where there are no nodes.
pub(crate) const CHUNK: u32 = 16;

impl Boxes {
    /// One valid box per object; boxes of the nodes are made from them, linear in nodes plus objects.
    pub(crate) fn new(tree: &Tree, objects: &[Bounds]) -> Self {
        let mut nodes = vec![Bounds::EMPTY; tree.nodes().len()];
        let parents = parents(tree);
        // Each object goes to its innermost node; then children, which come later, are added to their parents.
        for (place, node) in innermost(tree).into_iter().enumerate() {
            if let Some(node) = node {
                nodes[node as usize].extend(&objects[place]);
            }
        }
        for node in (0..nodes.len()).rev() {
            if let Some(parent) = parents[node] {
                let child = nodes[node];
                nodes[parent as usize].extend(&child);
            }
        }
        let union = |boxes: &[Bounds]| {
            boxes.iter().fold(Bounds::EMPTY, |mut union, bounds| {
                union.extend(bounds);
                union
            })
        };
        let chunks = objects.chunks(CHUNK as usize).map(union).collect();
        let proxies = tree.proxies().map_or(Vec::new(), |proxies| shapes(tree, proxies, objects));
        Self { objects: objects.to_vec(), nodes, chunks, proxies }
    }
}

/// Parent of each node.
pub(crate) fn parents(tree: &Tree) -> Vec<Option<u32>> {
    nesting::parents(tree.nodes().iter().map(|node| node.depth))
}

/// Innermost node above each object; empty without nodes.
pub(crate) fn innermost(tree: &Tree) -> Vec<Option<u32>> {
    let nodes = tree.nodes();
    let mut result = vec![None; tree.objects.len()];
    for (index, node) in nodes.iter().enumerate() {
        // A node's own objects come first: they end where its first child's begin.
        let first_child = nodes.get(index + 1).filter(|_| node.subtree > 1);
        let end = first_child.map_or(node.objects().end, |child| child.first_object);
        for place in node.first_object..end {
            result[place as usize] = Some(index as u32);
        }
    }
    result
}
