//! The baked file as a user of the runtime has it: decoded trees, placed in the scene, and their culler.

use super::VerifyError;
use super::methods::Slider;
use super::target::Target;
use super::view::View;
use crate::bake::subject::box_in_tree;
use crate::bake::tree::Aabb;
use crate::gltf::{Document, DocumentTables};
use crate::scene::{ReadOptions, Role, Scene, read_scene};
use glam::{DAffine3, DMat3, DMat4, Vec3};
use serde::Deserialize;
use std::collections::HashMap;
use std::ops::Range;
use svs_runtime::format::{EXTENSION_NAME, Extension};
use svs_runtime::{Bounds, Camera, Placement, SceneCuller, Settings, Tree, Visibility};

/// Trees of a file and where they are in its scene.
pub(super) struct Baked {
    pub scene: Scene,
    visibility: Visibility,
    /// For each tree its anchors.
    anchors: Vec<Vec<Anchor>>,
}

/// One place of a tree.
struct Anchor {
    to_world: DAffine3,
    /// Objects of the scene below it; `None` if the scene does not show it.
    objects: Option<Range<u32>>,
}

impl Baked {
    /// Decodes the extension of `doc` and reads the scene that its first tree with a scene names, else the default
    /// one.
    pub(super) fn read(doc: &Document) -> Result<Self, VerifyError> {
        let json = doc.json.get("extensions").and_then(|all| all.get(EXTENSION_NAME));
        let json = json.ok_or(VerifyError::NotBaked)?;
        let extension = Extension::deserialize(json).map_err(svs_runtime::DecodeError::from)?;
        let visibility = Visibility::decode(json, &DocumentTables::of_extension(doc, &extension))?;
        let index = extension.trees.iter().find_map(|tree| tree.scene);
        let index = index.map(|index| index as usize);
        let scene = read_scene(doc, &ReadOptions { scene: index, ..ReadOptions::default() })?;
        let node_of: HashMap<usize, usize> =
            scene.nodes.iter().enumerate().map(|(place, node)| (node.node, place)).collect();
        let place = |placement: &Placement| match placement {
            Placement::Scene(at) => {
                let objects = (scene.index == Some(*at as usize)).then_some(0..scene.objects.len() as u32);
                vec![Anchor { to_world: DAffine3::IDENTITY, objects }]
            }
            Placement::Anchors(nodes) => nodes
                .iter()
                .map(|&node| match node_of.get(&(node as usize)) {
                    Some(&at) => Anchor {
                        to_world: scene.nodes[at].to_world,
                        objects: Some(scene.nodes[at].objects.clone()),
                    },
                    None => Anchor { to_world: DAffine3::IDENTITY, objects: None },
                })
                .collect(),
        };
        let anchors = visibility.trees().iter().map(|tree| place(tree.placement())).collect();
        let baked = Self { scene, visibility, anchors };
        baked.check()?;
        Ok(baked)
    }

    /// Every object exists and has the triangles it was baked with.
    fn check(&self) -> Result<(), VerifyError> {
        for (index, tree) in self.visibility.trees().iter().enumerate() {
            for range in self.anchors[index].iter().filter_map(|a| a.objects.as_ref()) {
                let triangles: Option<Vec<u32>> = (0..tree.object_count())
                    .map(|place| {
                        let object = self.object(tree, range, place)?;
                        let mesh = self.scene.objects[object as usize].mesh;
                        Some(self.scene.meshes[mesh as usize].drawn_triangles)
                    })
                    .collect();
                // An object that stands for a tree has no triangles of its own to compare.
                let is_stale =
                    triangles.is_none_or(|counts| tree.nested().is_empty() && tree.is_stale(&counts));
                if is_stale {
                    return Err(VerifyError::Stale { tree: index });
                }
            }
        }
        Ok(())
    }

    /// Index in the scene's objects; `None` if the scene has fewer below the anchor.
    fn object(&self, tree: &Tree, below: &Range<u32>, place: usize) -> Option<u32> {
        let object = below.start.checked_add(tree.document_index(place))?;
        below.contains(&object).then_some(object)
    }

    /// For each object of the scene: a tree decides whether it is drawn.
    pub(super) fn covered(&self) -> Vec<bool> {
        let mut covered = vec![false; self.scene.objects.len()];
        for (tree, anchors) in self.visibility.trees().iter().zip(&self.anchors) {
            let mut is_nested = vec![false; tree.object_count()];
            for nested in tree.nested() {
                is_nested[nested.object as usize] = true;
            }
            for range in anchors.iter().filter_map(|a| a.objects.as_ref()) {
                for place in (0..tree.object_count()).filter(|&place| !is_nested[place]) {
                    if let Some(object) = self.object(tree, range, place) {
                        covered[object as usize] = true;
                    }
                }
            }
        }
        covered
    }

    /// Quality that the file recommends: the highest of its trees', since all share one slider.
    pub(super) fn recommended(&self) -> Option<f32> {
        let qualities = self.visibility.trees().iter().filter_map(|tree| tree.recommended_quality());
        qualities.reduce(f32::max)
    }

    /// The runtime's culler over all trees, for the objects of `target`.
    pub(super) fn slider<'a>(&'a self, target: &'a Target) -> Result<RuntimeSlider<'a>, VerifyError> {
        let trees = self.visibility.trees();
        let bounds: Vec<Vec<Bounds>> = (0..trees.len()).map(|tree| self.boxes(tree)).collect();
        let mut culler = SceneCuller::new(&self.visibility, &bounds)?;
        for (tree, anchors) in self.anchors.iter().enumerate() {
            for (anchor, place) in anchors.iter().enumerate() {
                culler.set_anchor(tree as u32, anchor as u32, place.to_world);
                culler.set_shown(tree as u32, anchor as u32, place.objects.is_some());
            }
        }
        Ok(RuntimeSlider { baked: self, target, culler })
    }

    /// Boxes of a tree's objects in its space, as a loader has them, below the first anchor that is shown.
    fn boxes(&self, tree: usize) -> Vec<Bounds> {
        const NOWHERE: Bounds = Bounds { min: Vec3::ZERO, max: Vec3::ZERO };
        let data = &self.visibility.trees()[tree];
        let mut boxes = vec![NOWHERE; data.object_count()];
        let Some((anchor, place)) =
            self.anchors[tree].iter().enumerate().find(|(_, place)| place.objects.is_some())
        else {
            return boxes;
        };
        let from_world = place.to_world.inverse();
        let Some(range) = &place.objects else { return boxes };
        let mut guests = vec![None; data.object_count()];
        for nested in data.nested() {
            let guest = data.nested_anchor(nested, anchor);
            guests[nested.object as usize] = self.anchors[nested.tree as usize].get(guest);
        }
        for (at, bounds) in boxes.iter_mut().enumerate() {
            let objects = match guests[at] {
                Some(guest) => guest.objects.clone().unwrap_or(0..0),
                None => self.object(data, range, at).map_or(0..0, |object| object..object + 1),
            };
            let around = objects
                .map(|object| &self.scene.objects[object as usize])
                .filter(|object| object.role == Role::Static)
                .map(|object| {
                    box_in_tree(&self.scene.meshes[object.mesh as usize], &(from_world * object.to_world))
                })
                .filter(|b| !b.is_empty())
                .fold(Aabb::EMPTY, |all, b| all.union(&b));
            *bounds = outward(&around).unwrap_or(NOWHERE);
        }
        boxes
    }
}

/// The smallest `f32` box around a box; `None` for an empty one.
fn outward(bounds: &Aabb) -> Option<Bounds> {
    if bounds.is_empty() {
        return None;
    }
    let down = |v: f64| {
        let rounded = v.clamp(f64::from(f32::MIN), f64::from(f32::MAX)) as f32;
        if f64::from(rounded) > v { rounded.next_down() } else { rounded }
    };
    let pick = |v: glam::DVec3, round: &dyn Fn(f64) -> f32| Vec3::new(round(v.x), round(v.y), round(v.z));
    Some(Bounds { min: pick(bounds.min, &down), max: pick(bounds.max, &|v| -down(-v)) })
}

/// The runtime, asked for cameras of the item buffer.
pub(super) struct RuntimeSlider<'a> {
    baked: &'a Baked,
    target: &'a Target,
    culler: SceneCuller,
}

impl Slider for RuntimeSlider<'_> {
    fn draw(&mut self, view: &View, settings: &Settings, drawn: &mut Vec<u32>) {
        let baked = self.baked;
        drawn.clear();
        for draw in self.culler.cull(&runtime_camera(view), settings) {
            let tree = &baked.visibility.trees()[draw.tree as usize];
            let range = baked.anchors[draw.tree as usize][draw.anchor as usize].objects.as_ref();
            let object = range.and_then(|range| baked.object(tree, range, draw.object as usize));
            drawn.extend(object.and_then(|object| self.target.member_of_object[object as usize]));
        }
    }
}

/// The same camera for the runtime; nothing is too near.
fn runtime_camera(view: &View) -> Camera {
    let to_eye = DMat3::from_cols(view.right, view.up, -view.forward).transpose();
    let matrix = DMat4::from_mat3(to_eye) * DMat4::from_translation(-view.eye);
    let vertical = 2.0 * view.half_height.atan();
    Camera::perspective(matrix, vertical, f64::from(view.width), f64::from(view.height), 0.0)
}
