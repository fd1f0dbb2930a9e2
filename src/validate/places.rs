//! Where the trees of a document are: the scenes they belong to and what is below their anchors.

use super::report::ValidationReport;
use crate::gltf::Document;
use crate::scene::{MaskMode, ReadOptions, Scene, read_scene};
use glam::DAffine3;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;
use svs_runtime::{Placement, Tree};

/// One occurrence of a tree: its scene, or one of its anchors.
#[derive(Clone, Debug)]
pub(super) struct Place {
    /// JSON pointer of the `scene` property or of the anchor.
    pub(super) pointer: String,
    /// Index of the scene, to tell objects of different scenes apart.
    pub(super) scene_index: usize,
    /// The scene.
    pub(super) scene: Arc<Scene>,
    /// Index of the anchor in [`Scene::nodes`].
    pub(super) anchor: Option<u32>,
    /// The objects below, in [`Scene::objects`].
    pub(super) objects: Range<u32>,
    /// World space to tree space.
    pub(super) to_tree: DAffine3,
}

/// A tree without errors of its own.
pub(super) struct PlacedTree {
    /// JSON pointer of the tree.
    pub(super) at: String,
    /// The tree, without its nested trees.
    pub(super) tree: Arc<Tree>,
    /// Its scene, or its anchors in order; `None` for those that cannot be found.
    pub(super) places: Vec<Option<Place>>,
}

/// Reads scenes when they are first asked for.
pub(super) struct Scenes<'a> {
    doc: &'a Document,
    known: BTreeMap<usize, Option<Arc<Scene>>>,
}

impl<'a> Scenes<'a> {
    pub(super) fn new(doc: &'a Document) -> Self {
        Self { doc, known: BTreeMap::new() }
    }

    /// Number of scenes; a document without any has one, made of the nodes that are nobody's child.
    fn count(&self) -> usize {
        self.listed().max(1)
    }

    fn listed(&self) -> usize {
        self.doc.json.get("scenes").and_then(|scenes| scenes.as_array()).map_or(0, Vec::len)
    }

    fn get(&mut self, index: usize, report: &mut ValidationReport) -> Option<Arc<Scene>> {
        if let Some(known) = self.known.get(&index) {
            return known.clone();
        }
        // Textures do not matter here.
        let scene = (self.listed() > 0).then_some(index);
        let scene = match read_scene(
            self.doc,
            &ReadOptions { scene, mask: MaskMode::Transparent, ..ReadOptions::default() },
        ) {
            Ok(scene) => Some(Arc::new(scene)),
            Err(error) => {
                let message =
                    format!("The scene cannot be read, so trees are not checked against it: {error}.");
                report.warning("SCENE_UNREADABLE", format!("/scenes/{index}"), message);
                None
            }
        };
        self.known.insert(index, scene.clone());
        scene
    }

    /// The places of a tree, in the order of its anchors; `None` for those that cannot be found, which is
    /// reported. `at` points to the tree.
    pub(super) fn places(
        &mut self,
        placement: &Placement,
        at: &str,
        report: &mut ValidationReport,
    ) -> Vec<Option<Place>> {
        match placement {
            Placement::Scene(index) => vec![self.scene_place(*index as usize, format!("{at}/scene"), report)],
            Placement::Anchors(anchors) => {
                let place = |(i, &node): (usize, &u32)| {
                    self.anchor_place(node as usize, format!("{at}/anchors/{i}"), report)
                };
                let places: Vec<Option<Place>> = anchors.iter().enumerate().map(place).collect();
                check_apart(&places, report);
                places
            }
        }
    }

    fn scene_place(&mut self, index: usize, pointer: String, report: &mut ValidationReport) -> Option<Place> {
        if index >= self.count() {
            report.error("UNRESOLVED_REFERENCE", pointer, format!("Unresolved reference: scene {index}."));
            return None;
        }
        let scene = self.get(index, report)?;
        let objects = 0..scene.objects.len() as u32;
        Some(Place { pointer, scene_index: index, scene, anchor: None, objects, to_tree: DAffine3::IDENTITY })
    }

    fn anchor_place(&mut self, node: usize, pointer: String, report: &mut ValidationReport) -> Option<Place> {
        let nodes = self.doc.json.get("nodes").and_then(|nodes| nodes.as_array()).map_or(0, Vec::len);
        if node >= nodes {
            report.error("UNRESOLVED_REFERENCE", pointer, format!("Unresolved reference: node {node}."));
            return None;
        }
        let default = self.doc.json.get("scene").and_then(|scene| scene.as_u64()).unwrap_or(0) as usize;
        let mut unreadable = false;
        for index in std::iter::once(default).chain((0..self.count()).filter(|&i| i != default)) {
            let Some(scene) = self.get(index, report) else {
                unreadable = true;
                continue;
            };
            let Some(anchor) = scene.nodes.iter().position(|n| n.node == node) else { continue };
            let to_tree = scene.nodes[anchor].to_world.inverse();
            if !to_tree.is_finite() {
                let message = format!(
                    "The global transform of node {node} cannot be inverted: no tree can hang there."
                );
                report.warning("ANCHOR_NOT_INVERTIBLE", pointer, message);
                return None;
            }
            let objects = scene.nodes[anchor].objects.clone();
            return Some(Place {
                pointer,
                scene_index: index,
                scene,
                anchor: Some(anchor as u32),
                objects,
                to_tree,
            });
        }
        if !unreadable {
            report.information("ANCHOR_UNREACHABLE", pointer, format!("No scene shows node {node}."));
        }
        None
    }
}

/// No anchor may be below another one.
fn check_apart(places: &[Option<Place>], report: &mut ValidationReport) {
    let mut ranges: Vec<(usize, u32, u32, &Place)> = places
        .iter()
        .flatten()
        .filter_map(|place| {
            let anchor = place.anchor?;
            Some((place.scene_index, anchor, place.scene.nodes[anchor as usize].subtree_end, place))
        })
        .collect();
    ranges.sort_by_key(|&(scene, start, ..)| (scene, start));
    // Subtrees nest or are apart, so the next one by start is the first that could be inside.
    if let Some([outer, inner]) = ranges.array_windows::<2>().find(|[a, b]| a.0 == b.0 && b.1 < a.2) {
        let message = format!("This anchor is below the anchor at {}.", outer.3.pointer);
        report.error("ANCHOR_BELOW_ANCHOR", inner.3.pointer.clone(), message);
    }
}
