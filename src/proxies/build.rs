//! Proxies of all nodes, from the leaves up: those of inner nodes are made of their children's.

use super::Setting;
use super::geometry::{NodeOptions, Part, ProxyGeometry, simplify_node};
use super::hierarchy::ProxyHierarchy;
use super::options::ProxyMode;
use crate::bake::Progress;
use crate::bake::subject::Subject;
use crate::bake::tree::{HierarchyNode, Sphere};
use glam::{DAffine3, DVec3};
use rayon::prelude::*;
use std::ops::Range;

/// A leaf's proxy has at most this part of the originals' triangles, else it saves nothing.
const LEAF_PART: u64 = 4;

/// From one level of a node to the next coarser.
const LEVEL_PART: usize = 6;

/// Levels have at least this many triangles.
const LEAST_TRIANGLES: usize = 48;

/// Simplified meshes take the place of originals in a proxy if their error is at most this part of the node's radius, or half
/// of what the finest proxies may have: far less than the proxy's own.
const UNSEEN: f64 = 0.002;

/// The coarsest proxies of a tree together have at most this share of its triangles, if they can.
const ROOT_SHARE: f64 = 0.003;

/// The proxies of a hierarchy.
#[derive(Debug, Default)]
pub(super) struct Built {
    /// For each node its levels, the finest first; empty for copies and for nodes that show nothing.
    pub(super) levels: Vec<Vec<ProxyGeometry>>,
    /// For each node: the proxy of an ancestor is as good, and small enough.
    pub(super) redundant: Vec<bool>,
    /// For each node where the positions of its proxy are relative to, tree space.
    pub(super) origins: Vec<DVec3>,
    /// Triangles of the originals below each node.
    pub(super) below: Vec<u64>,
}

/// Makes the proxies.
pub(super) fn build(
    setting: &Setting<'_>,
    subject: &Subject,
    tree: &ProxyHierarchy,
    spheres: &[Sphere],
    progress: &dyn Progress,
) -> Built {
    let nodes = &tree.hierarchy.nodes;
    let below = below(subject, tree);
    let radius = spheres.first().map_or(0.0, |sphere| sphere.radius);
    let maker = Maker {
        setting,
        subject,
        spheres,
        tree,
        origins: origins(subject, tree, spheres),
        below: &below,
        finest: setting.options.finest_error(radius),
        all: below.first().copied().unwrap_or(0),
    };
    let mut levels: Vec<Vec<ProxyGeometry>> = vec![Vec::new(); nodes.len()];
    for batch in batches(tree) {
        let made: Vec<(u32, Vec<ProxyGeometry>)> = batch
            .into_par_iter()
            .map(|node| {
                let made = maker.node(node as usize, &levels);
                progress.advance(1);
                (node, made)
            })
            .collect();
        for (node, made) in made {
            levels[node as usize] = made;
        }
    }
    let redundant = maker.redundant(&levels);
    let origins = maker.origins;
    Built { levels, redundant, origins, below }
}

/// Originals of the same height, leaves first.
fn batches(tree: &ProxyHierarchy) -> Vec<Vec<u32>> {
    let nodes = &tree.hierarchy.nodes;
    let mut heights = vec![0usize; nodes.len()];
    for (index, node) in nodes.iter().enumerate().rev() {
        if let Some(parent) = node.parent {
            heights[parent as usize] = heights[parent as usize].max(heights[index] + 1);
        }
    }
    let mut batches = vec![Vec::new(); heights.iter().max().map_or(0, |highest| highest + 1)];
    for (index, &height) in heights.iter().enumerate() {
        if tree.original[index] as usize == index {
            batches[height].push(index as u32);
        }
    }
    batches
}

fn below(subject: &Subject, tree: &ProxyHierarchy) -> Vec<u64> {
    let triangles = |node: &HierarchyNode| {
        let places = node.members.clone();
        places
            .map(|place| u64::from(subject.members[tree.hierarchy.order[place as usize] as usize].triangles))
            .sum()
    };
    tree.hierarchy.nodes.par_iter().map(triangles).collect()
}

/// The centres of the spheres; a copy's is its original's, moved.
fn origins(subject: &Subject, tree: &ProxyHierarchy, spheres: &[Sphere]) -> Vec<DVec3> {
    let first = |node: usize| {
        let place = tree.hierarchy.nodes[node].members.start as usize;
        subject.parts[tree.hierarchy.order[place] as usize].to_tree.translation
    };
    (0..tree.hierarchy.nodes.len())
        .map(|node| match tree.original[node] as usize {
            original if original == node => spheres[node].center,
            original => spheres[original].center + (first(node) - first(original)),
        })
        .collect()
}

/// What all nodes are made with.
struct Maker<'a> {
    setting: &'a Setting<'a>,
    subject: &'a Subject,
    spheres: &'a [Sphere],
    tree: &'a ProxyHierarchy,
    origins: Vec<DVec3>,
    below: &'a [u64],
    /// Error that needs no improvement, metres.
    finest: f64,
    /// Triangles of all originals.
    all: u64,
}

impl Maker<'_> {
    /// All levels of one node.
    fn node(&self, node: usize, made: &[Vec<ProxyGeometry>]) -> Vec<ProxyGeometry> {
        let children = self.children(node);
        let objects = self.direct(node, &children).filter_map(|place| self.object(node, place));
        let (objects, errors): (Vec<Part<'_>>, Vec<f64>) = objects.unzip();
        // Of simplified meshes among the objects.
        let own = errors.into_iter().fold(0.0, f64::max);
        let parts: Vec<Part<'_>> = objects
            .into_iter()
            .chain(children.iter().filter_map(|&child| {
                let geometry = made[self.tree.original[child as usize] as usize].first()?;
                Some(Part::Proxy { geometry, origin: self.origins[child as usize] - self.origins[node] })
            }))
            .collect();
        if parts.is_empty() {
            return Vec::new();
        }
        let mut target = u64::from(self.setting.options.triangles / 2).max(LEAST_TRIANGLES as u64);
        if children.is_empty() {
            target = target.min(self.below[node] / LEAF_PART);
        }
        let inherited = parts.iter().fold(own, |largest: f64, part| match part {
            Part::Proxy { geometry, .. } => largest.max(geometry.error),
            Part::Mesh { .. } => largest,
        });
        let mut finest = simplify_node(
            &parts,
            self.setting.palette,
            &NodeOptions {
                target_triangles: target as usize,
                tolerance: (self.finest - inherited).max(0.0),
                visible_only: self.setting.options.mode != ProxyMode::All,
                ..NodeOptions::default()
            },
        );
        // What the proxies among the parts differ by is in there already.
        finest.error += own;
        let mut levels = vec![finest];
        while let Some(coarser) = self.coarser(node, &levels) {
            levels.push(coarser);
        }
        levels
    }

    /// The next coarser level, if it is wanted and there is one.
    fn coarser(&self, node: usize, levels: &[ProxyGeometry]) -> Option<ProxyGeometry> {
        let last = levels.last()?;
        let is_root = self.tree.hierarchy.nodes[node].parent.is_none();
        let floor = if is_root { (ROOT_SHARE * self.all as f64) as usize } else { LEAST_TRIANGLES };
        let target = last.triangles / LEVEL_PART;
        // The root goes on until its coarsest level is a small share of the scene, other nodes have one level more.
        let is_enough = if is_root { last.triangles <= floor } else { levels.len() > 1 || target < floor };
        let target = target.max(floor);
        if is_enough || target == 0 {
            return None;
        }
        let options = NodeOptions { target_triangles: target, visible_only: false, ..NodeOptions::default() };
        let coarser = simplify_node(
            &[Part::Proxy { geometry: last, origin: DVec3::ZERO }],
            self.setting.palette,
            &options,
        );
        (coarser.triangles > 0 && coarser.triangles * 3 <= last.triangles * 2).then_some(coarser)
    }

    fn children(&self, node: usize) -> Vec<u32> {
        children(&self.tree.hierarchy.nodes, node)
    }

    fn direct(&self, node: usize, children: &[u32]) -> Range<u32> {
        let nodes = &self.tree.hierarchy.nodes;
        let members = nodes[node].members.clone();
        members.start..children.first().map_or(members.end, |&child| nodes[child as usize].members.start)
    }

    /// An object as a part of a node, and its error in metres: a simplified version of its mesh where nobody will tell.
    fn object(&self, node: usize, place: u32) -> Option<(Part<'_>, f64)> {
        let part = &self.subject.parts[self.tree.hierarchy.order[place as usize] as usize];
        let to_node = DAffine3::from_translation(-self.origins[node]) * part.to_tree;
        // Not smaller than the largest singular value.
        let scale = part.to_tree.matrix3.to_cols_array().iter().map(|c| c * c).sum::<f64>().sqrt();
        let allowed = (self.spheres[node].radius * UNSEEN).max(self.finest * 0.5);
        let levels =
            self.setting.simplified.get(part.mesh as usize).copied().flatten().map(|mesh| &mesh.levels);
        let level = levels.into_iter().flatten().rfind(|level| level.error * scale <= allowed);
        let (mesh, error) = match level {
            Some(level) => (&level.mesh, level.error * scale),
            None => (self.setting.meshes.get(part.mesh as usize)?, 0.0),
        };
        Some((Part::Mesh { mesh, to_node }, error))
    }

    /// Nodes below one that is as good as they need to be, and no larger than a proxy may be.
    fn redundant(&self, levels: &[Vec<ProxyGeometry>]) -> Vec<bool> {
        let nodes = &self.tree.hierarchy.nodes;
        let mut redundant = vec![false; nodes.len()];
        let target = self.setting.options.triangles as usize / 2;
        for node in 0..nodes.len() {
            let finest = levels[self.tree.original[node] as usize].first();
            let is_enough = finest.is_some_and(|g| g.error <= self.finest && g.triangles <= target);
            if redundant[node] || is_enough {
                for child in self.children(node) {
                    redundant[child as usize] = true;
                }
            }
        }
        redundant
    }
}

/// Children of a node in depth-first order.
pub(super) fn children(nodes: &[HierarchyNode], node: usize) -> Vec<u32> {
    let end = node as u32 + nodes[node].subtree;
    let mut children = Vec::new();
    let mut next = node as u32 + 1;
    while next < end {
        children.push(next);
        next += nodes[next as usize].subtree;
    }
    children
}
