//! Where the trees are in the scene: their anchors, their objects, the objects' boxes.

use crate::SceneError;
use crate::describe::{Description, Graph, mesh_box};
use glam::{DAffine3, DVec3, Vec3};
use std::ops::Range;
use svs_runtime::{Bounds, Draw, Placement, SceneCuller, Tree, Visibility};

/// One place of a tree.
#[derive(Clone, Debug)]
pub(crate) struct Anchor {
    /// Place of the node, or `None` for the scene itself.
    pub(crate) node: Option<u32>,
    /// Objects below it; empty and not shown if the scene does not reach it.
    pub(crate) objects: Range<u32>,
    pub(crate) shown: bool,
}

/// All trees of a file in one of its scenes.
#[derive(Debug)]
pub(crate) struct Places {
    pub(crate) visibility: Visibility,
    /// Per tree.
    pub(crate) anchors: Vec<Vec<Anchor>>,
}

/// Coordinates beyond this do not fit the culler's boxes with room for arithmetic.
const MAX_COORDINATE: f64 = 1e18;

const NOWHERE: Bounds = Bounds { min: Vec3::ZERO, max: Vec3::ZERO };

impl Places {
    pub(crate) fn new(
        visibility: Visibility,
        description: &Description,
        graph: &Graph,
    ) -> Result<Self, SceneError> {
        // glTF index above place.
        let places = graph.nodes.iter().enumerate();
        let mut places: Vec<u64> =
            places.map(|(place, node)| u64::from(node.gltf) << 32 | place as u64).collect();
        places.sort_unstable();
        let at_node = |&gltf: &u32| {
            let found = places.get(places.partition_point(|key| key >> 32 < u64::from(gltf)));
            let node = found.filter(|&key| key >> 32 == u64::from(gltf)).map(|&key| key as u32);
            let objects = node.map(|node| &graph.nodes[node as usize]).map(|n| n.first_object..n.end_object);
            Anchor { node, shown: objects.is_some(), objects: objects.unwrap_or(0..0) }
        };
        let anchors = visibility.trees().iter().map(|tree| match tree.placement() {
            Placement::Scene(scene) => {
                let shown = *scene == description.scene;
                let objects = if shown { 0..graph.objects.len() as u32 } else { 0..0 };
                vec![Anchor { node: None, objects, shown }]
            }
            Placement::Anchors(nodes) => nodes.iter().map(at_node).collect(),
        });
        let anchors = anchors.collect();
        let places = Self { visibility, anchors };
        places.check(description, graph)?;
        Ok(places)
    }

    /// Every object exists and has the triangles it was baked with.
    fn check(&self, description: &Description, graph: &Graph) -> Result<(), SceneError> {
        for (index, tree) in self.visibility.trees().iter().enumerate() {
            for anchor in self.anchors[index].iter().filter(|anchor| anchor.shown) {
                let triangles: Option<Vec<u32>> = (0..tree.object_count())
                    .map(|place| Some(triangles(description, graph, object(tree, anchor, place)?)))
                    .collect();
                // An object that stands for a tree has no triangles of its own to compare.
                let is_stale =
                    triangles.is_none_or(|counts| tree.nested().is_empty() && tree.is_stale(&counts));
                if is_stale {
                    return Err(SceneError::Stale { tree: index });
                }
            }
        }
        Ok(())
    }

    /// The object of the scene that the culler says to draw; `None` if the scene does not show it.
    pub(crate) fn object_of(&self, draw: Draw) -> Option<u32> {
        let tree = self.visibility.trees().get(draw.tree as usize)?;
        let anchor = self.anchors[draw.tree as usize].get(draw.anchor as usize)?;
        object(tree, anchor, draw.object as usize)
    }

    /// From tree space to the scene's.
    pub(crate) fn to_world(&self, graph: &Graph, anchor: &Anchor) -> DAffine3 {
        anchor.node.map_or(DAffine3::IDENTITY, |node| graph.nodes[node as usize].world)
    }

    /// Everything that the trees decide about, tree by tree: what the culler says to draw, and its object of the scene.
    pub(crate) fn draws(&self) -> Vec<(Draw, u32)> {
        let mut draws = Vec::new();
        for (index, (tree, anchors)) in self.visibility.trees().iter().zip(&self.anchors).enumerate() {
            let is_nested = is_nested(tree);
            for (anchor, at) in anchors.iter().enumerate().filter(|(_, at)| at.shown) {
                for place in (0..tree.object_count()).filter(|&place| !is_nested[place]) {
                    let draw = Draw { tree: index as u32, anchor: anchor as u32, object: place as u32 };
                    draws.extend(object(tree, at, place).map(|object| (draw, object)));
                }
            }
        }
        draws
    }

    /// The runtime's culler over all trees.
    pub(crate) fn culler(&self, description: &Description, graph: &Graph) -> Result<SceneCuller, SceneError> {
        let trees = self.visibility.trees();
        let bounds: Vec<Vec<Bounds>> =
            (0..trees.len()).map(|tree| self.boxes(description, graph, tree)).collect();
        let mut culler = SceneCuller::new(&self.visibility, &bounds)?;
        for (index, (tree, anchors)) in trees.iter().zip(&self.anchors).enumerate() {
            let is_nested = is_nested(tree);
            if let Some(anchor) = anchors.iter().find(|anchor| anchor.shown) {
                let count = |place: usize| {
                    let object = object(tree, anchor, place).filter(|_| !is_nested[place]);
                    object.map_or(0, |object| triangles(description, graph, object))
                };
                let counts: Vec<u32> = (0..tree.object_count()).map(count).collect();
                culler.set_triangles(index as u32, &counts)?;
            }
            for (place, anchor) in anchors.iter().enumerate() {
                culler.set_anchor(index as u32, place as u32, self.to_world(graph, anchor));
                culler.set_shown(index as u32, place as u32, anchor.shown);
            }
        }
        Ok(culler)
    }

    /// Boxes of a tree's objects in its space, as a loader has them, below the first anchor that is shown.
    fn boxes(&self, description: &Description, graph: &Graph, tree: usize) -> Vec<Bounds> {
        let data = &self.visibility.trees()[tree];
        let mut boxes = vec![NOWHERE; data.object_count()];
        let shown = self.anchors[tree].iter().enumerate().find(|(_, anchor)| anchor.shown);
        let Some((index, anchor)) = shown else { return boxes };
        let from_world = self.to_world(graph, anchor).inverse();
        let mut guests: Vec<Option<Range<u32>>> = vec![None; data.object_count()];
        for nested in data.nested() {
            let guest = self.anchors[nested.tree as usize].get(data.nested_anchor(nested, index));
            guests[nested.object as usize] = Some(guest.map_or(0..0, |guest| guest.objects.clone()));
        }
        for (place, bounds) in boxes.iter_mut().enumerate() {
            let own = || object(data, anchor, place).map_or(0..0, |object| object..object + 1);
            let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
            for object in guests[place].clone().unwrap_or_else(own) {
                let object = &graph.objects[object as usize];
                let Some(corners) = mesh_box(description, object.mesh) else { continue };
                let to_tree = from_world * graph.object_world(object);
                for corner in 0..8_u32 {
                    let pick = |bit: u32, low: f64, high: f64| if corner & bit == 0 { low } else { high };
                    let corner = to_tree.transform_point3(DVec3::new(
                        pick(1, corners.0.x, corners.1.x),
                        pick(2, corners.0.y, corners.1.y),
                        pick(4, corners.0.z, corners.1.z),
                    ));
                    (min, max) = (min.min(corner), max.max(corner));
                }
            }
            if min.cmple(max).all() && min.abs().max(max.abs()).max_element() <= MAX_COORDINATE {
                *bounds = outward(min, max);
            }
        }
        boxes
    }
}

/// The smallest box in single precision around one.
fn outward(min: DVec3, max: DVec3) -> Bounds {
    let down = |value: f64| {
        let rounded = value as f32;
        if f64::from(rounded) > value { rounded.next_down() } else { rounded }
    };
    let each = |v: DVec3, round: &dyn Fn(f64) -> f32| Vec3::new(round(v.x), round(v.y), round(v.z));
    Bounds { min: each(min, &down), max: each(max, &|value| -down(-value)) }
}

fn object(tree: &Tree, anchor: &Anchor, place: usize) -> Option<u32> {
    if place >= tree.object_count() {
        return None;
    }
    let object = anchor.objects.start.checked_add(tree.document_index(place))?;
    anchor.objects.contains(&object).then_some(object)
}

pub(crate) fn triangles(description: &Description, graph: &Graph, object: u32) -> u32 {
    let mesh = graph.objects[object as usize].mesh;
    description.mesh_triangles.get(mesh as usize).copied().unwrap_or(0)
}

pub(crate) fn is_nested(tree: &Tree) -> Vec<bool> {
    let mut is_nested = vec![false; tree.object_count()];
    tree.nested().iter().for_each(|nested| is_nested[nested.object as usize] = true);
    is_nested
}
