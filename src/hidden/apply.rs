//! The smallest change that drops what is hidden.
//!
//! A node that goes loses its `mesh` and nothing else: name, children, extras and index stay, so animations, skins and
//! other tools find it. A primitive that loses triangles gets new `indices`, in an accessor appended to the file, in
//! the order of the old ones, unless they are so few that the file would grow. Meshes and accessors that nobody uses afterwards keep their entries; their bytes go
//! ([`crate::gltf::release`]).

use super::decide::{Hidden, Key, key};
use super::subject::{index, items};
use crate::gltf::{ComponentType, Document, Released, append_indices, release};
use crate::scene::triangulate::Topology;
use crate::scene::{Mesh, Scene};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet, HashSet};

/// What was changed.
#[derive(Debug, Default)]
pub(super) struct Outcome {
    /// Triangles that left the primitives, by mesh of the scene.
    pub(super) triangles: Vec<u64>,
    /// What became of the bytes.
    pub(super) released: Released,
}

/// Bytes of indices that a primitive must lose to get an accessor of its own: what is written about that in JSON.
const WORTH_AN_ACCESSOR: usize = 128;

/// A primitive with triangles left.
struct Rest {
    mesh: usize,
    primitive: usize,
    old: Option<usize>,
    indices: Vec<u32>,
}

pub(super) fn apply(doc: &mut Document, scene: &Scene, hidden: &Hidden) -> Outcome {
    let gone: BTreeSet<usize> =
        scene.objects.iter().zip(&hidden.objects).filter(|(_, gone)| **gone).map(|(o, _)| o.node).collect();
    let mut lost = BTreeSet::new();
    for &node in &gone {
        if let Some(Value::Object(node)) = doc.json["nodes"].get_mut(node) {
            lost.extend(node.shift_remove("mesh").and_then(|mesh| mesh.as_f64()).map(|mesh| mesh as usize));
        }
    }
    for node in items(&doc.json, "nodes") {
        if let Some(mesh) = index(node, "mesh") {
            lost.remove(&mesh);
        }
    }

    let mut outcome = Outcome { triangles: vec![0; scene.meshes.len()], ..Outcome::default() };
    let mut rests = Vec::new();
    for (place, triangles) in hidden.triangles.iter().enumerate() {
        let mesh = hidden.mesh_indices[place];
        if !triangles.is_empty() && !lost.contains(&mesh) {
            let (found, removed) = rest(doc, mesh, &scene.meshes[place], triangles);
            rests.extend(found);
            outcome.triangles[place] = removed;
        }
    }
    let replaced = replace(doc, &rests);
    if !lost.is_empty() || !replaced.is_empty() {
        outcome.released = release(doc, &lost, &replaced);
    }
    outcome
}

/// The primitives of a mesh that lose triangles, and how many those are.
fn rest(doc: &Document, mesh: usize, geometry: &Mesh, hidden: &HashSet<Key>) -> (Vec<Rest>, u64) {
    let mut rests = Vec::new();
    let mut removed = 0;
    let json = &items(&doc.json, "meshes")[mesh];
    for (primitive, json) in items(json, "primitives").iter().enumerate() {
        let mode = index(json, "mode").unwrap_or(4);
        let Some(Some(topology)) = Topology::from_mode(mode) else { continue };
        let Some(position) = json.get("attributes").and_then(|all| index(all, "POSITION")) else { continue };
        // Both were read before; a file that cannot be read is not here.
        let Some(points) = doc.accessor(position).ok().and_then(|a| a.read_vec3_f64().ok()) else { continue };
        let old = index(json, "indices");
        let list = match old {
            Some(old) => match doc.accessor(old).ok().and_then(|a| a.read_indices_u32().ok()) {
                Some(list) => list,
                None => continue,
            },
            None => (0..points.len() as u32).collect(),
        };
        let count = topology.triangle_count(list.len());
        let corners = |t: usize| topology.corners(t).map(|place| list[place]);
        let stays = |t: &usize| {
            let points = corners(*t).map(|v| points.get(v as usize).copied().unwrap_or(glam::DVec3::NAN));
            !hidden.contains(&key(geometry, points))
        };
        let mut left: Vec<usize> = (0..count).filter(stays).collect();
        if left.is_empty() && count > 0 {
            // glTF has no empty accessors, and a primitive less would renumber the others.
            left.push(0);
        }
        let size = match old.and_then(|old| doc.accessor(old).ok()).map(|old| old.component_type) {
            Some(ComponentType::U8) => 1,
            Some(ComponentType::U32) => 4,
            _ => 2,
        };
        if (count - left.len()) * 3 * size >= WORTH_AN_ACCESSOR {
            removed += (count - left.len()) as u64;
            let indices = left.into_iter().flat_map(corners).collect();
            rests.push(Rest { mesh, primitive, old, indices });
        }
    }
    (rests, removed)
}

/// Gives primitives their new indices; returns the accessors they had.
fn replace(doc: &mut Document, rests: &[Rest]) -> BTreeSet<usize> {
    // Equal lists are stored once: meshes often share their geometry and differ in material.
    let mut places: BTreeMap<(usize, &[u32]), usize> = BTreeMap::new();
    let mut lists = Vec::new();
    for rest in rests {
        let component = component_type(doc, rest);
        places.entry((component, &rest.indices)).or_insert_with(|| {
            lists.push((component, rest.indices.as_slice()));
            lists.len() - 1
        });
    }
    let Some(first) = append_indices(doc, &lists) else { return BTreeSet::new() };
    let mut old = BTreeSet::new();
    for rest in rests {
        let component = component_type(doc, rest);
        let pointer = format!("/meshes/{}/primitives/{}", rest.mesh, rest.primitive);
        if let Some(Value::Object(primitive)) = doc.json.pointer_mut(&pointer)
            && let Some(place) = places.get(&(component, rest.indices.as_slice()))
        {
            primitive.insert("indices".into(), (first + place).into());
            if primitive.get("mode").is_some_and(|mode| mode.as_f64() != Some(4.0)) {
                primitive.insert("mode".into(), 4.into());
            }
            old.extend(rest.old);
        }
    }
    old
}

/// As the old indices have it; of a primitive without any, the smallest that holds them.
fn component_type(doc: &Document, rest: &Rest) -> usize {
    let old = rest.old.and_then(|old| index(items(&doc.json, "accessors").get(old)?, "componentType"));
    // The largest number of a type is not an index: it restarts strips.
    let largest = rest.indices.iter().max().copied().unwrap_or(0);
    old.unwrap_or(if largest < 65_535 { 5123 } else { 5125 })
}
