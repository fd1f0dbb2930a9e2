//! A grid of copies of a real scene: large test scenes made of real parts.
//!
//! Meshes, materials and buffers are shared, only nodes are repeated. The first copy is the scene's own nodes.

use crate::bake::subject::box_in_tree;
use crate::bake::tree::Aabb;
use crate::gltf::{Document, payload};
use crate::scene::{ReadOptions, Scene, SceneError, read_scene};
use glam::DVec3;
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;

/// How copies are laid out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridOptions {
    /// How many, the original counted: 1 to [`GridOptions::MAX_COPIES`].
    pub copies: usize,
    /// Distance from one to the next, in sizes of the scene along x and z: at 1 they touch. Above 0, at most 1000.
    pub spacing: f64,
}

/// What [`grid`] did.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct GridReport {
    /// Nodes of the result.
    pub nodes: usize,
    /// Objects of the result.
    pub objects: usize,
    /// For people: what of the file is not in the result.
    pub notes: Vec<String>,
}

/// Why a scene cannot be repeated.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GridError {
    /// Options out of range.
    #[error("{what} is out of range: use {range}")]
    Options {
        /// Which option, as on the command line.
        what: String,
        /// What is allowed.
        range: String,
    },
    /// What the copies would have to share or to have of their own is not known.
    #[error("the scene has {what}: only scenes without can be repeated")]
    Unsupported {
        /// What it has.
        what: &'static str,
    },
    /// Nothing is there to be repeated.
    #[error("the scene has nothing that is drawn")]
    Empty,
    /// The result would be too large.
    #[error("{copies} copies of {nodes} nodes are too many: more than {limit} nodes")]
    TooLarge {
        /// Copies asked for.
        copies: usize,
        /// Nodes of one.
        nodes: usize,
        /// Nodes allowed.
        limit: usize,
    },
    /// The scene cannot be read.
    #[error(transparent)]
    Scene(#[from] SceneError),
}

/// Nodes of the result: the JSON of more would not fit into memory or a GLB.
const MAX_NODES: usize = 8_000_000;

/// What a copy of a node has of the node: no extras, cameras or unknown properties.
const COPIED: [&str; 7] = ["name", "mesh", "matrix", "translation", "rotation", "scale", "weights"];

/// Extensions of nodes that do not refer to other nodes.
const COPIED_EXTENSIONS: [&str; 2] = ["EXT_mesh_gpu_instancing", "KHR_node_visibility"];

impl GridOptions {
    /// The most copies.
    pub const MAX_COPIES: usize = 1_000_000;

    /// Whether the options are in range.
    ///
    /// # Errors
    /// [`GridError::Options`].
    pub fn check(&self) -> Result<(), GridError> {
        let range = |what: String, range: String| Err(GridError::Options { what, range });
        if !(1..=Self::MAX_COPIES).contains(&self.copies) {
            return range(format!("--copies {}", self.copies), format!("1 to {}", Self::MAX_COPIES));
        }
        if !(self.spacing > 0.0 && self.spacing <= 1000.0) {
            return range(format!("--spacing {}", self.spacing), "a number above 0, at most 1000".to_owned());
        }
        Ok(())
    }
}

/// Repeats the default scene of `doc` in a square grid along x and z, under one root node for each copy. Baked visibility
/// is taken out; of several scenes the others are.
///
/// # Errors
/// [`GridError`]; the document is then unchanged but for its baked visibility.
pub fn grid(doc: &mut Document, options: &GridOptions) -> Result<GridReport, GridError> {
    options.check()?;
    let mut notes = Vec::new();
    if payload::strip(doc) {
        notes.push("the baked visibility is taken out: it was of one copy".to_owned());
    }
    let scene = read_scene(doc, &ReadOptions::default())?;
    for (key, what) in [("animations", "animations"), ("skins", "skins")] {
        if doc.json.get(key).and_then(Value::as_array).is_some_and(|items| !items.is_empty()) {
            return Err(GridError::Unsupported { what });
        }
    }
    let step = step(&scene).ok_or(GridError::Empty)? * options.spacing;
    let old = doc.json.get("nodes").and_then(Value::as_array).map_or(0, Vec::len);
    let nodes = scene.nodes.len().saturating_add(1).saturating_mul(options.copies).saturating_add(old);
    if nodes > MAX_NODES {
        return Err(GridError::TooLarge {
            copies: options.copies,
            nodes: scene.nodes.len(),
            limit: MAX_NODES,
        });
    }
    let template = Template::new(doc, &scene, &mut notes);
    let Some(Value::Array(list)) = doc.json.get_mut("nodes") else { return Err(GridError::Empty) };
    let columns = (options.copies as f64).sqrt().ceil() as usize;
    let mut roots = Vec::with_capacity(options.copies);
    for copy in 0..options.copies {
        let at = step * DVec3::new((copy % columns) as f64, 0.0, (copy / columns) as f64);
        let children: Vec<usize> = match copy {
            0 => template.roots().map(|place| template.original[place]).collect(),
            _ => template.copy_to(list),
        };
        roots.push(list.len());
        let mut root = json!({"name": format!("copy {copy}"), "children": children});
        if at != DVec3::ZERO {
            root["translation"] = json!(at.to_array());
        }
        list.push(root);
    }
    let count = list.len();
    let scenes = doc.json.get("scenes").and_then(Value::as_array).map_or(0, Vec::len);
    if scenes > 1 {
        notes.push(format!("{} other scenes are left out", scenes - 1));
    }
    let mut kept =
        doc.json.get("scenes").and_then(|scenes| scenes.get(scene.index?)).cloned().unwrap_or(json!({}));
    kept["nodes"] = json!(roots);
    doc.json["scenes"] = json!([kept]);
    doc.json["scene"] = json!(0);
    Ok(GridReport { nodes: count, objects: scene.objects.len() * options.copies, notes })
}

/// Size of what is drawn; flat scenes count as 1 m there.
fn step(scene: &Scene) -> Option<DVec3> {
    let boxes = scene.objects.iter().filter(|object| !object.hidden);
    let boxes = boxes.map(|object| box_in_tree(&scene.meshes[object.mesh as usize], &object.to_world));
    let all = boxes.filter(|b| !b.is_empty()).fold(Aabb::EMPTY, |all, b| all.union(&b));
    let size = all.max - all.min;
    (!all.is_empty() && size.is_finite()).then(|| DVec3::select(size.cmpgt(DVec3::ZERO), size, DVec3::ONE))
}

/// The nodes of the scene as they are copied, in depth-first order.
struct Template {
    /// Without children.
    nodes: Vec<Value>,
    /// Index in the file.
    original: Vec<usize>,
    parents: Vec<Option<u32>>,
}

impl Template {
    fn new(doc: &Document, scene: &Scene, notes: &mut Vec<String>) -> Self {
        let mut left_out = BTreeSet::new();
        let copy = |node: usize| {
            let original = doc.json.get("nodes").and_then(|nodes| nodes.get(node)?.as_object());
            let mut copy = Map::new();
            for (key, value) in original.into_iter().flatten() {
                if COPIED.contains(&key.as_str()) {
                    copy.insert(key.clone(), value.clone());
                }
            }
            let extensions = original.and_then(|node| node.get("extensions")?.as_object());
            for (name, value) in extensions.into_iter().flatten() {
                if COPIED_EXTENSIONS.contains(&name.as_str()) {
                    copy.entry("extensions").or_insert_with(|| json!({}))[name] = value.clone();
                } else {
                    left_out.insert(name.clone());
                }
            }
            Value::Object(copy)
        };
        let nodes = scene.nodes.iter().map(|node| node.node).map(copy).collect();
        notes.extend(left_out.iter().map(|name| format!("copies do not have the nodes' extension {name}")));
        Self {
            nodes,
            original: scene.nodes.iter().map(|node| node.node).collect(),
            parents: scene.nodes.iter().map(|node| node.parent).collect(),
        }
    }

    /// Places of the scene's roots.
    fn roots(&self) -> impl Iterator<Item = usize> {
        (0..self.nodes.len()).filter(|&place| self.parents[place].is_none())
    }

    /// Appends a copy of all nodes; returns its roots.
    fn copy_to(&self, list: &mut Vec<Value>) -> Vec<usize> {
        let first = list.len();
        let mut children: Vec<Vec<usize>> = vec![Vec::new(); self.nodes.len()];
        for (place, parent) in self.parents.iter().enumerate() {
            if let Some(parent) = parent {
                children[*parent as usize].push(first + place);
            }
        }
        list.extend(self.nodes.iter().zip(children).map(|(node, children)| {
            let mut node = node.clone();
            if !children.is_empty() {
                node["children"] = json!(children);
            }
            node
        }));
        self.roots().map(|place| first + place).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shells() -> Document {
        let sample = crate::generate::shells(&crate::generate::ShellOptions { depth: 3, hole: false });
        Document::from_parts(sample.json, Some(sample.bin)).expect("a document")
    }

    #[test]
    fn copies_are_the_scene_again_and_again() {
        let one = read_scene(&shells(), &ReadOptions::default()).expect("a scene");
        let mut doc = shells();
        doc.json["nodes"][0]["extras"] = json!({"long": "text"});
        let report = grid(&mut doc, &GridOptions { copies: 5, spacing: 1.5 }).expect("a grid");
        let five = read_scene(&doc, &ReadOptions::default()).expect("a scene");
        assert_eq!((five.objects.len(), report.objects), (one.objects.len() * 5, one.objects.len() * 5));
        assert_eq!(five.meshes.len(), one.meshes.len());
        assert_eq!(five.nodes.len(), one.nodes.len() * 5 + 5);
        // Three columns: the fifth copy is the second of the second row.
        let size = step(&one).expect("a size") * 1.5;
        for (place, object) in one.objects.iter().enumerate() {
            let copy = &five.objects[one.objects.len() * 4 + place];
            let moved = copy.to_world.translation - object.to_world.translation;
            assert!(moved.distance(DVec3::new(size.x, 0.0, size.z)) < 1e-9, "{moved}");
            assert_eq!(copy.mesh, object.mesh);
            assert_eq!(doc.json["nodes"][copy.node]["name"], doc.json["nodes"][object.node]["name"]);
        }
        let extras =
            doc.json["nodes"].as_array().expect("nodes").iter().filter(|n| n.get("extras").is_some());
        assert_eq!(extras.count(), 1);
    }

    #[test]
    fn what_cannot_be_repeated_is_refused() {
        let options = GridOptions { copies: 4, spacing: 1.1 };
        for key in ["animations", "skins"] {
            let mut doc = shells();
            doc.json[key] = json!([{}]);
            let error = grid(&mut doc, &options).expect_err(key).to_string();
            assert!(error.contains(key), "{error}");
        }
        let mut empty = Document::from_parts(json!({"asset": {"version": "2.0"}}), None).expect("a document");
        assert!(matches!(grid(&mut empty, &options), Err(GridError::Empty)));
        for wrong in [GridOptions { copies: 0, ..options }, GridOptions { spacing: f64::NAN, ..options }] {
            assert!(matches!(grid(&mut shells(), &wrong), Err(GridError::Options { .. })));
        }
        let many = GridOptions { copies: GridOptions::MAX_COPIES, ..options };
        assert!(matches!(grid(&mut shells(), &many), Err(GridError::TooLarge { .. })));
    }

    #[test]
    fn a_bake_and_other_scenes_are_left_out_aloud() {
        let mut doc = shells();
        let bake = crate::bake::BakeOptions { rays: Some(20_000), verify: false, ..Default::default() };
        crate::bake::build(&mut doc, &bake, &crate::bake::Silent).expect("a bake");
        doc.json["scenes"].as_array_mut().expect("scenes").push(json!({"nodes": []}));
        let report = grid(&mut doc, &GridOptions { copies: 2, spacing: 1.1 }).expect("a grid");
        assert_eq!(report.notes.len(), 2, "{:?}", report.notes);
        assert_eq!(doc.json["scenes"].as_array().map(Vec::len), Some(1));
        assert!(doc.json.get("extensions").is_none());
    }
}
