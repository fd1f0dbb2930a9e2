//! Mesh levels as `MSFT_lod`, for loaders that know that extension and not ours.
//!
//! The extension leaves open what coverage is measured of; here it is what Babylon.js compares with: the area of the
//! disc that the bounding sphere of the mesh fills, over that of the screen. Loaders that take heights for areas stay with
//! finer versions for longer.

use super::ProxyBake;
use super::options::SCREEN_LINES;
use crate::gltf::Document;
use crate::gltf::json;
use crate::gltf::payload::lod::{COVERAGE, MSFT_LOD};
use crate::gltf::payload::{Additions, NodeLevels};
use crate::scene::{Object, Role, Scene};
use serde::Serialize;
use serde_json::{Map, Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::FRAC_PI_4;

/// Error that a version may have where it is drawn, pixels.
const PIXELS: f64 = 1.0;

/// Width of the screen by its height.
const ASPECT: f64 = 16.0 / 9.0;

/// What became of `MSFT_lod`, in figures.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct LodReport {
    /// Nodes that name simplified versions of what they show.
    pub nodes: usize,
    /// Nodes that show those, in no scene.
    pub appended: usize,
    /// Bytes of JSON for both; they do not count towards [`super::ProxyOptions::share`].
    pub bytes: u64,
    /// Nodes whose mesh has simplified versions and that stay as they are: what they carry beside the mesh would get lost.
    pub left: usize,
    /// The first of those.
    pub first_left: Option<usize>,
}

/// Adds `MSFT_lod` to the nodes whose mesh has levels.
pub(super) fn add(document: &Document, scene: &Scene, bake: &mut ProxyBake) -> LodReport {
    let mut report = LodReport::default();
    let levels: BTreeMap<usize, &[Value]> = bake
        .mesh_levels
        .iter()
        .filter_map(|entry| Some((json::index(entry.get("mesh")?)?, json::array(entry, "levels"))))
        .collect();
    let all = json::array(&document.json, "nodes");
    let mut done = BTreeSet::new();
    let mut nodes: Vec<Value> = Vec::new();
    let mut carriers: Vec<NodeLevels> = Vec::new();
    for object in &scene.objects {
        let Some(node) = all.get(object.node).and_then(Value::as_object) else { continue };
        let Some(levels) = node.get("mesh").and_then(json::index).and_then(|mesh| levels.get(&mesh)) else {
            continue;
        };
        // A node of many instances is many objects.
        if !done.insert(object.node) {
            continue;
        }
        if !shows_a_mesh_alone(node) || moves(scene, object) {
            report.left += 1;
            report.first_left.get_or_insert(object.node);
            continue;
        }
        let mesh = &scene.meshes[object.mesh as usize];
        let radius = (mesh.max - mesh.min).length() / 2.0;
        let first = Additions::first_node(document) + nodes.len();
        let errors = levels.iter().map(|level| level["error"].as_f64().unwrap_or(f64::INFINITY));
        let coverage = errors.map(|error| coverage(radius, error)).chain([0.0]).collect();
        nodes.extend(levels.iter().map(|level| version(node, &level["mesh"])));
        let ids = (first..first + levels.len()).collect();
        carriers.push(NodeLevels { node: object.node, ids, coverage });
    }
    report.nodes = carriers.len();
    report.appended = nodes.len();
    report.bytes = bytes(&nodes, &carriers);
    if !carriers.is_empty() {
        bake.additions.extensions.push((MSFT_LOD, false));
    }
    bake.additions.nodes = nodes;
    bake.additions.levels = carriers;
    report
}

/// Nothing of the node is lost if another one with its transform and another mesh takes its place.
fn shows_a_mesh_alone(node: &Map<String, Value>) -> bool {
    let others = ["extensions", "children", "skin", "weights", "camera"];
    let extras = node.get("extras");
    !others.iter().any(|key| node.contains_key(*key))
        && extras.is_none_or(|extras| extras.as_object().is_some_and(|extras| !extras.contains_key(COVERAGE)))
}

/// The object deforms, or an animation moves its very node: another one would stand still.
fn moves(scene: &Scene, object: &Object) -> bool {
    object.role != Role::Static || scene.nodes[object.scene_node as usize].moving
}

/// A node at the same place that shows another mesh.
fn version(node: &Map<String, Value>, mesh: &Value) -> Value {
    let mut version = Map::from_iter([("mesh".to_owned(), mesh.clone())]);
    for key in ["matrix", "translation", "rotation", "scale"] {
        if let Some(value) = node.get(key) {
            version.insert(key.to_owned(), value.clone());
        }
    }
    version.into()
}

/// The coverage below which an error is less than [`PIXELS`] on a screen of [`SCREEN_LINES`]; `radius` of the mesh's sphere
/// and `error` in the same unit.
fn coverage(radius: f64, error: f64) -> f64 {
    // Pixels across of the sphere where the error is as large as it may be.
    let across = PIXELS * 2.0 * radius / error;
    let coverage = FRAC_PI_4 * across * across / (SCREEN_LINES * SCREEN_LINES * ASPECT);
    if coverage >= 1.0 {
        1.0
    } else if coverage > 0.0 {
        rounded_down(coverage)
    } else {
        // Also what is not a number.
        0.0
    }
}

/// To four digits: a number in a file of many.
fn rounded_down(value: f64) -> f64 {
    let scale = 10_f64.powi(3 - value.log10().floor() as i32);
    let rounded = (value * scale).floor() / scale;
    if rounded.is_finite() { rounded } else { 0.0 }
}

/// Bytes of JSON that the nodes and what names them take.
fn bytes(nodes: &[Value], carriers: &[NodeLevels]) -> u64 {
    let appended = nodes.iter().map(|node| node.to_string().len() + 1);
    let named = carriers.iter().map(|carrier| {
        let lod =
            json!({"extensions": {MSFT_LOD: {"ids": carrier.ids}}, "extras": {COVERAGE: carrier.coverage}});
        lod.to_string().len() - 1
    });
    appended.chain(named).sum::<usize>() as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_is_a_pixel_at_the_threshold() {
        // A sphere 540 pixels across, half of the screen's height; a 540th of that is a pixel.
        let half = coverage(1.0, 2.0 / 540.0);
        assert!((half - FRAC_PI_4 * 540.0 * 540.0 / (1920.0 * 1080.0)).abs() < 1e-3 * half, "{half}");
        assert!(coverage(1.0, 0.01) < half);
        assert_eq!(coverage(3.0, 6.0 / 540.0), half, "the unit does not matter");
        assert_eq!(half.to_string(), "0.1104");
    }

    #[test]
    fn coverages_are_shares_whatever_the_error() {
        assert_eq!([coverage(1.0, 0.0), coverage(1.0, 1e-9)], [1.0; 2]);
        for [radius, error] in [
            [0.0, 0.0],
            [0.0, 1.0],
            [1.0, f64::INFINITY],
            [f64::NAN, 1.0],
            [f64::NEG_INFINITY, f64::INFINITY],
        ] {
            assert_eq!(coverage(radius, error), 0.0, "{radius} {error}");
        }
        assert!((0.0..1e-300).contains(&coverage(1e-160, 1.0)));
    }

    #[test]
    fn nodes_with_more_than_a_mesh_stay() {
        for (node, alone) in [
            (json!({"mesh": 0, "translation": [1, 0, 0], "extras": {"a": 1}, "name": "n"}), true),
            (json!({"mesh": 0, "extras": {}}), true),
            (json!({"mesh": 0, "extras": "text"}), false),
            (json!({"mesh": 0, "extras": {"MSFT_screencoverage": [1]}}), false),
            (json!({"mesh": 0, "extensions": {"MSFT_lod": {"ids": [1]}}}), false),
            (json!({"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {}}}), false),
            (json!({"mesh": 0, "skin": 0}), false),
            (json!({"mesh": 0, "children": [1]}), false),
        ] {
            assert_eq!(shows_a_mesh_alone(node.as_object().unwrap()), alone, "{node}");
        }
    }

    #[test]
    fn versions_are_where_the_node_is() {
        let node =
            json!({"name": "n", "mesh": 0, "scale": [1, 2, 3], "rotation": [0, 0, 0, 1], "extras": {}});
        let version = version(node.as_object().unwrap(), &json!(7));
        assert_eq!(version, json!({"mesh": 7, "scale": [1, 2, 3], "rotation": [0, 0, 0, 1]}));
    }
}
