//! `MSFT_lod` on nodes: simplified versions for loaders that know that extension only.
//!
//! The versions are nodes at the end of `nodes`, in no scene and below no node. The extension's `extras.before` records
//! - `nodes`: how many nodes there were,
//! - `extras`: nodes whose `extras` were there and empty.

use crate::gltf::json;
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;
use std::ops::Range;

/// Name of the extension.
pub(crate) const MSFT_LOD: &str = "MSFT_lod";

/// Where `MSFT_lod` has its thresholds, in a node's `extras`.
pub(crate) const COVERAGE: &str = "MSFT_screencoverage";

/// Simplified versions of what a node shows.
#[derive(Clone, Debug, PartialEq)]
pub struct NodeLevels {
    /// Index of a node that has no `extensions`, and no `extras` or an object without thresholds.
    pub node: usize,
    /// Nodes that show the simplified versions, coarser and coarser.
    pub ids: Vec<usize>,
    /// Smallest coverage (share of the screen's area, 0 to 1) that each version is for, the node itself first.
    pub coverage: Vec<f64>,
}

/// Appends nodes and names them. What does not fit [`NodeLevels::node`] stays as it is.
pub(super) fn add(
    root: &mut Value,
    nodes: Vec<Value>,
    levels: Vec<NodeLevels>,
    before: &mut Map<String, Value>,
) {
    let Some(Value::Array(all)) = root.get_mut("nodes") else { return };
    if nodes.is_empty() {
        return;
    }
    before.insert("nodes".into(), all.len().into());
    let mut empty = Vec::new();
    for NodeLevels { node: index, ids, coverage } in levels {
        let Some(Value::Object(node)) = all.get_mut(index) else { continue };
        let extras = node.get("extras");
        if node.contains_key("extensions") || extras.is_some_and(|extras| !extras.is_object()) {
            continue;
        }
        if extras.and_then(Value::as_object).is_some_and(Map::is_empty) {
            empty.push(Value::from(index));
        }
        node.insert("extensions".into(), json!({ MSFT_LOD: {"ids": ids} }));
        node.entry("extras").or_insert_with(|| json!({}))[COVERAGE] = coverage.into();
    }
    all.extend(nodes);
    if !empty.is_empty() {
        before.insert("extras".into(), empty.into());
    }
}

/// What [`add`] has added.
#[derive(Debug, PartialEq)]
pub(super) struct OwnNodes {
    /// The first appended node; all after it are appended too.
    pub(super) first: usize,
    /// Nodes that name them.
    carriers: Vec<usize>,
}

impl OwnNodes {
    /// `None` if what was added is not as it was: not last, used by others, or with something below it. `meshes` are the
    /// simplified ones.
    pub(super) fn find(root: &Value, before: &Map<String, Value>, meshes: Range<usize>) -> Option<Self> {
        let all = json::array(root, "nodes");
        let Some(first) = before.get("nodes") else {
            return Some(Self { first: all.len(), carriers: Vec::new() });
        };
        let first = json::index(first).filter(|&first| first <= all.len())?;
        let shows_own = |node: &Value| {
            let mesh = node.get("mesh").and_then(json::index);
            mesh.is_some_and(|mesh| meshes.contains(&mesh)) && node.get("children").is_none()
        };
        let is_own = |value: &Value| json::index(value).is_some_and(|node| node >= first);
        if !all[first..].iter().all(shows_own) || is_named(root, is_own) {
            return None;
        }
        let mut carriers = Vec::new();
        let mut named = BTreeSet::new();
        for (index, node) in all.iter().enumerate() {
            let Some(lod) = node.get("extensions").and_then(|all| all.get(MSFT_LOD)) else { continue };
            let ids = json::array(lod, "ids");
            if ids.iter().any(is_own) {
                if index >= first || !ids.iter().all(is_own) {
                    return None;
                }
                carriers.push(index);
                named.extend(ids.iter().filter_map(json::index));
            }
        }
        // A node that nothing names was not added here.
        (named.into_iter().eq(first..all.len())).then_some(Self { first, carriers })
    }

    /// Takes it out again.
    pub(super) fn remove(&self, root: &mut Value, before: &Map<String, Value>) {
        let Some(Value::Array(all)) = root.get_mut("nodes") else { return };
        all.truncate(self.first);
        let was_empty: BTreeSet<usize> = before
            .get("extras")
            .and_then(Value::as_array)
            .into_iter()
            .flatten()
            .filter_map(json::index)
            .collect();
        for &index in &self.carriers {
            let Some(Value::Object(node)) = all.get_mut(index) else { continue };
            take(node, "extensions", MSFT_LOD, false);
            take(node, "extras", COVERAGE, was_empty.contains(&index));
        }
    }
}

/// Removes a member of a property, and the property if nothing is left of it, unless it `stays`.
fn take(node: &mut Map<String, Value>, property: &str, name: &str, stays: bool) {
    let Some(Value::Object(object)) = node.get_mut(property) else { return };
    if object.shift_remove(name).is_some() && object.is_empty() && !stays {
        node.shift_remove(property);
    }
}

/// Whether a scene, a node, a skin or an animation uses one of these nodes.
fn is_named(root: &Value, hit: impl Fn(&Value) -> bool + Copy) -> bool {
    let lists = |key: &str, list: &str| {
        json::array(root, key).iter().any(|object| json::array(object, list).iter().any(hit))
    };
    lists("scenes", "nodes")
        || lists("nodes", "children")
        || lists("skins", "joints")
        || json::array(root, "skins").iter().any(|skin| skin.get("skeleton").is_some_and(hit))
        || json::array(root, "animations").iter().any(|animation| {
            let channels = json::array(animation, "channels").iter();
            channels.filter_map(|channel| channel.pointer("/target/node")).any(hit)
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain() -> Value {
        json!({
            "scenes": [{"nodes": [0, 1, 2, 3]}],
            "nodes": [
                {"mesh": 0, "name": "none"},
                {"mesh": 0, "extras": {"a": 1}},
                {"mesh": 0, "extras": {}},
                {"mesh": 0, "extensions": {"MSFT_lod": {"ids": [4]}}, "extras": {"MSFT_screencoverage": [0.5, 0]}},
                {"mesh": 1},
            ],
        })
    }

    fn added() -> (Value, Map<String, Value>) {
        let (mut root, mut before) = (plain(), Map::new());
        let level =
            |node: usize| NodeLevels { node, ids: vec![node + 5, node + 8], coverage: vec![0.5, 0.1, 0.0] };
        add(&mut root, vec![json!({"mesh": 2}); 6], (0..3).map(level).collect(), &mut before);
        (root, before)
    }

    #[test]
    fn what_was_added_is_removed_exactly() {
        let (mut root, before) = added();
        assert_eq!(root["nodes"][1]["extensions"], json!({"MSFT_lod": {"ids": [6, 9]}}));
        assert_eq!(root["nodes"][1]["extras"], json!({"a": 1, "MSFT_screencoverage": [0.5, 0.1, 0.0]}));
        assert_eq!(root["nodes"].as_array().unwrap().len(), 11);
        let own = OwnNodes::find(&root, &before, 2..3).unwrap();
        assert_eq!(own, OwnNodes { first: 5, carriers: vec![0, 1, 2] });
        own.remove(&mut root, &before);
        assert_eq!(root.to_string(), plain().to_string(), "the order of properties counts too");
    }

    #[test]
    fn what_others_have_changed_stays() {
        for (pointer, value) in [
            ("/scenes/0/nodes/0", json!(5)),
            ("/nodes/0/children", json!([5])),
            ("/nodes/5/children", json!([0])),
            ("/nodes/5/mesh", json!(0)),
            ("/nodes/0/extensions/MSFT_lod/ids", json!([4, 5])),
            ("/nodes/0/extensions/MSFT_lod/ids", json!([5])),
            ("/nodes/5/extensions", json!({"MSFT_lod": {"ids": [6]}})),
            ("/skins", json!([{"joints": [5]}])),
            ("/animations", json!([{"channels": [{"target": {"node": 5}}]}])),
        ] {
            let (mut root, before) = added();
            let (parent, key) = pointer.rsplit_once('/').unwrap();
            match root.pointer_mut(parent).unwrap() {
                Value::Array(items) => items[key.parse::<usize>().unwrap()] = value,
                object => object[key] = value,
            }
            assert_eq!(OwnNodes::find(&root, &before, 2..3), None, "{pointer}");
        }
        let (mut root, before) = added();
        root["nodes"].as_array_mut().unwrap().push(json!({}));
        assert_eq!(OwnNodes::find(&root, &before, 2..3), None);
    }

    #[test]
    fn a_wrong_record_removes_nothing() {
        let (root, _) = added();
        for count in [json!(0), json!(4), json!(12), json!(-1), json!("5")] {
            let before = Map::from_iter([("nodes".to_owned(), count.clone())]);
            assert_eq!(OwnNodes::find(&root, &before, 2..3), None, "{count}");
        }
    }

    #[test]
    fn nodes_that_cannot_carry_it_stay() {
        let mut root = json!({"nodes": [{"extensions": {}}, {"extras": 1}]});
        let levels = (0..3).map(|node| NodeLevels { node, ids: vec![2], coverage: vec![1.0, 0.0] });
        add(&mut root, vec![json!({"mesh": 0})], levels.collect(), &mut Map::new());
        assert_eq!(root, json!({"nodes": [{"extensions": {}}, {"extras": 1}, {"mesh": 0}]}));
    }
}
