//! Trees against the objects they were baked from: are they stale, may the objects be in a tree, do the spheres
//! hold them?

use super::nested::{entries, is_moving_below};
use super::places::{Place, PlacedTree};
use super::report::ValidationReport;
use super::{proxies, spheres};
use crate::gltf::Document;
use crate::scene::Object;
use serde_json::Value;
use std::collections::HashMap;
use svs_runtime::encode::{fingerprint, format_hash};

/// The tree each object was met in, over all trees: from `(scene, object)` to the pointer of the place.
type Owners = HashMap<(usize, u32), String>;

/// Checks every tree at each of its places.
pub(super) fn check(
    doc: &Document,
    extension: &Value,
    trees: &[Option<PlacedTree>],
    report: &mut ValidationReport,
) {
    let mut owners = Owners::new();
    let used = proxies::used_meshes(doc);
    proxies::check_mesh_levels(doc, extension, &used, report);
    for (index, tree) in trees.iter().enumerate() {
        let Some(tree) = tree else { continue };
        // Object to index of the tree it stands for.
        let nested: HashMap<u32, usize> =
            entries(extension, index).into_iter().map(|entry| (entry.object, entry.tree as usize)).collect();
        proxies::check_meshes(doc, tree, &used, report);
        let mut first = true;
        for place in tree.places.iter().flatten() {
            if !check_count(tree, place, report) {
                continue;
            }
            check_fingerprint(trees, tree, &nested, place, report);
            check_objects(doc, tree, &nested, place, &mut owners, report);
            // What hangs on the other anchors is the same, or their fingerprints differ.
            if std::mem::take(&mut first) {
                spheres::check(tree, place, &nested, report);
                proxies::check_spheres(doc, tree, place, &nested, report);
            }
        }
    }
}

/// Index in the scene, and the object at place `k` of the tree's order.
pub(super) fn object<'p>(tree: &PlacedTree, place: &'p Place, k: u32) -> (u32, &'p Object) {
    let index = place.objects.start + tree.tree.document_index(k as usize);
    (index, &place.scene.objects[index as usize])
}

/// Every document number is there. Must hold before anything is looked up.
fn check_count(tree: &PlacedTree, place: &Place, report: &mut ValidationReport) -> bool {
    let (count, there) = (tree.tree.object_count(), place.objects.len());
    // A tree without tables may claim any number of objects: no loop over them before this comparison.
    let largest =
        if count > there { None } else { (0..count).map(|k| tree.tree.document_index(k) as usize).max() };
    if count <= there && largest.is_none_or(|largest| largest < there) {
        return true;
    }
    let asked = largest.map_or(String::new(), |largest| format!(", up to number {largest}"));
    let message = format!(
        "The bake is stale: the tree has {count} objects{asked}; the document has {there} here. Bake again."
    );
    report.error("OBJECT_COUNT_MISMATCH", place.pointer.clone(), message);
    false
}

fn check_fingerprint(
    trees: &[Option<PlacedTree>],
    tree: &PlacedTree,
    nested: &HashMap<u32, usize>,
    place: &Place,
    report: &mut ValidationReport,
) {
    let Some(stored) = tree.tree.fingerprint() else { return };
    let count = |k: u32| match nested.get(&k) {
        None => Some(place.scene.meshes[object(tree, place, k).1.mesh as usize].drawn_triangles),
        // A nested tree counts with all it holds; whether that is still there is checked at its own places.
        Some(&inner) => {
            let triangles = trees.get(inner)?.as_ref()?.tree.fingerprint()?.triangles;
            Some(u32::try_from(triangles).unwrap_or(u32::MAX))
        }
    };
    let counts: Option<Vec<u32>> = (0..tree.tree.object_count() as u32).map(count).collect();
    let Some(counts) = counts else { return };
    if !tree.tree.is_stale(&counts) {
        return;
    }
    let total: u64 = counts.iter().map(|&count| u64::from(count)).sum();
    let mut objects: Vec<(u32, u32)> =
        counts.iter().enumerate().map(|(k, &count)| (tree.tree.document_index(k), count)).collect();
    objects.sort_unstable();
    let message = format!(
        "The bake is stale: made from {} triangles with hash {}, but at {} are {total} with hash {}. Bake again.",
        stored.triangles,
        format_hash(stored.hash),
        place.pointer,
        format_hash(fingerprint(objects))
    );
    report.error("FINGERPRINT_MISMATCH", format!("{}/fingerprint", tree.at), message);
}

fn check_objects(
    doc: &Document,
    tree: &PlacedTree,
    nested: &HashMap<u32, usize>,
    place: &Place,
    owners: &mut Owners,
    report: &mut ValidationReport,
) {
    let moving = is_moving_below(place);
    let (mut moved, mut deforming, mut taken) = (None, None, None);
    for k in (0..tree.tree.object_count() as u32).filter(|k| !nested.contains_key(k)) {
        let (index, object) = object(tree, place, k);
        if moving[(index - place.objects.start) as usize] {
            moved.get_or_insert((k, object.node));
        }
        if deforms(doc, object.node) {
            deforming.get_or_insert((k, object.node));
        }
        if let Some(other) = owners.insert((place.scene_index, index), place.pointer.clone()) {
            taken.get_or_insert((k, object.node, other));
        }
    }
    let at = |node: usize| format!("/nodes/{node}");
    if let Some((k, node)) = moved {
        report.error(
            "OBJECT_ANIMATED",
            at(node),
            format!("Object {k} of {} moves within the tree's space.", tree.at),
        );
    }
    if let Some((k, node)) = deforming {
        report.error(
            "OBJECT_DEFORMS",
            at(node),
            format!("Object {k} of {} has a skin or morph targets.", tree.at),
        );
    }
    if let Some((k, node, other)) = taken {
        let message = format!("Object {k} of {} is also in the tree at {other}.", tree.at);
        report.error("OBJECT_IN_TWO_TREES", at(node), message);
    }
}

fn deforms(doc: &Document, node: usize) -> bool {
    let Some(node) = doc.json.get("nodes").and_then(|nodes| nodes.get(node)) else { return false };
    let mesh = node.get("mesh").and_then(Value::as_u64);
    let mesh = mesh.and_then(|mesh| doc.json.get("meshes")?.get(mesh as usize));
    let primitives = mesh.and_then(|mesh| mesh.get("primitives")?.as_array());
    let morphs = |primitive: &Value| {
        primitive.get("targets").and_then(Value::as_array).is_some_and(|targets| !targets.is_empty())
    };
    node.get("skin").is_some() || primitives.is_some_and(|primitives| primitives.iter().any(morphs))
}
