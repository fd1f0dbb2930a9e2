//! Proxies and mesh levels against the document: are their meshes there and drawn by no node, do levels get simpler, do
//! spheres hold what they stand for?

use super::ROOT;
use super::places::{Place, PlacedTree};
use super::report::ValidationReport;
use super::spheres::{allowed, excess};
use crate::gltf::{Document, json};
use glam::DVec3;
use rayon::prelude::*;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use svs_runtime::{Deviation, Proxies};

/// Vertices of proxies compared with spheres at most: many proxies may name one large mesh. Boxes come first, so that a
/// clean file needs hardly any.
const MOST_COMPARISONS: usize = 1 << 27;

/// Meshes that nodes of scenes use, each with the first of them. Nodes in no scene do not count: `MSFT_lod` names such.
pub(super) fn used_meshes(doc: &Document) -> BTreeMap<u64, usize> {
    let nodes = doc.json.get("nodes").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let mut used = BTreeMap::new();
    let reached = reached_nodes(doc, nodes);
    for (index, node) in nodes.iter().enumerate().filter(|(index, _)| reached[*index]) {
        if let Some(mesh) = node.get("mesh").and_then(Value::as_u64) {
            used.entry(mesh).or_insert(index);
        }
    }
    used
}

/// By node: a scene reaches it.
fn reached_nodes(doc: &Document, nodes: &[Value]) -> Vec<bool> {
    let mut reached = vec![false; nodes.len()];
    let named = |object: &Value, list: &str| -> Vec<usize> {
        json::array(object, list).iter().filter_map(json::index).collect()
    };
    let scenes = json::array(&doc.json, "scenes");
    let mut open: Vec<usize> = scenes.iter().flat_map(|scene| named(scene, "nodes")).collect();
    while let Some(node) = open.pop() {
        // Each node once, so that a broken graph ends too.
        if reached.get(node) == Some(&false) {
            reached[node] = true;
            open.extend(named(&nodes[node], "children"));
        }
    }
    reached
}

/// Checks `meshLevels`.
pub(super) fn check_mesh_levels(
    doc: &Document,
    extension: &Value,
    used: &BTreeMap<u64, usize>,
    report: &mut ValidationReport,
) {
    let entries = extension["meshLevels"].as_array().map_or(&[][..], Vec::as_slice);
    let originals: BTreeSet<u64> = entries.iter().filter_map(|entry| entry["mesh"].as_u64()).collect();
    let mut seen = BTreeSet::new();
    for (number, entry) in entries.iter().enumerate() {
        let at = format!("{ROOT}/meshLevels/{number}");
        let Some(mesh) = entry["mesh"].as_u64() else { continue };
        let mut before = triangles(doc, mesh);
        if before.is_none() {
            unresolved(mesh, format!("{at}/mesh"), report);
        }
        if !seen.insert(mesh) {
            let message = format!("Mesh {mesh} has another entry.");
            report.error("MESH_LEVELS_INVALID", format!("{at}/mesh"), message);
        }
        let mut error = 0.0;
        let levels = entry["levels"].as_array().map_or(&[][..], Vec::as_slice);
        for (index, level) in levels.iter().enumerate() {
            let at = format!("{at}/levels/{index}");
            if let Some(next) = level["error"].as_f64() {
                if next < error || !(next as f32).is_finite() {
                    let message =
                        format!("Error {next} is not finite or less than that of the level before.");
                    report.error("MESH_LEVELS_INVALID", format!("{at}/error"), message);
                }
                error = next;
            }
            if let Some(numbers) = level["deviation"].as_array()
                && !deviation(numbers).is_valid(error as f32)
            {
                let message = "It must be in order: 0 <= mean <= rms <= error, and the share 0 to 1.";
                report.error("MESH_LEVELS_INVALID", format!("{at}/deviation"), message.to_owned());
            }
            let Some(mesh) = level["mesh"].as_u64() else { continue };
            if originals.contains(&mesh) {
                let message = format!("Mesh {mesh} has levels itself.");
                report.error("MESH_LEVELS_INVALID", format!("{at}/mesh"), message);
            }
            let Some(count) = triangles(doc, mesh) else {
                unresolved(mesh, format!("{at}/mesh"), report);
                continue;
            };
            if let Some(before) = before.filter(|&before| count >= before) {
                let message = format!("Mesh {mesh} has {count} triangles, the finer one {before}.");
                report.error("MESH_LEVEL_NOT_SIMPLER", format!("{at}/mesh"), message);
            }
            before = Some(count);
            if let Some(node) = used.get(&mesh) {
                let message = format!("Node {node} draws mesh {mesh}, which stands for another one.");
                report.error("MESH_LEVEL_USED", format!("{at}/mesh"), message);
            }
        }
    }
}

/// Of a level; what is no number is NaN.
fn deviation(numbers: &[Value]) -> Deviation {
    let number = |index: usize| numbers.get(index).and_then(Value::as_f64).map_or(f32::NAN, |x| x as f32);
    Deviation { mean: number(0), rms: number(1), wrong: number(2) }
}

/// Checks what the proxies of a tree name.
pub(super) fn check_meshes(
    doc: &Document,
    tree: &PlacedTree,
    used: &BTreeMap<u64, usize>,
    report: &mut ValidationReport,
) {
    let Some(proxies) = tree.tree.proxies() else { return };
    let at = || format!("{}/proxies/tables/PROXY_MESH", tree.at);
    let meshes: BTreeSet<u64> = proxies.nodes().iter().map(|node| node.mesh.into()).collect();
    if let Some(&mesh) = meshes.iter().find(|&&mesh| triangles(doc, mesh).is_none()) {
        unresolved(mesh, at(), report);
    }
    if let Some((mesh, node)) = meshes.iter().find_map(|mesh| Some((mesh, used.get(mesh)?))) {
        let message = format!("Node {node} draws mesh {mesh}, which is a proxy.");
        report.error("PROXY_MESH_USED", at(), message);
    }
}

/// Checks that the spheres hold the objects, the proxies' own vertices and the spheres below them.
pub(super) fn check_spheres(
    doc: &Document,
    tree: &PlacedTree,
    place: &Place,
    nested: &HashMap<u32, usize>,
    report: &mut ValidationReport,
) {
    let Some(proxies) = tree.tree.proxies() else { return };
    let nodes = proxies.nodes();
    let at = || format!("{}/proxies/tables/PROXY_SPHERE", tree.at);
    let objects = |node: usize| -> f64 {
        let places = nodes[node].objects().map(|position| proxies.object(position));
        excess(tree, place, nested, nodes[node].center, nodes[node].radius, places)
    };
    let of_objects: Vec<f64> = (0..nodes.len()).into_par_iter().map(objects).collect();
    let vertices = vertices_outside(doc, proxies);
    let children = spheres_outside(proxies);
    for (what, excesses) in
        [("objects", of_objects), ("vertices of the proxies", vertices), ("spheres below them", children)]
    {
        let outside = excesses.iter().filter(|&&excess| excess > 0.0).count();
        let worst = excesses.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
        if let Some((node, excess)) = worst.filter(|_| outside > 0) {
            let (all, radius) = (nodes.len(), nodes[node].radius);
            let message = format!(
                "{outside} of {all} spheres of proxies do not hold all {what}; the worst is that of proxy {node} with \
                 radius {radius}, by {excess:.3e}."
            );
            report.warning("PROXY_SPHERE_TOO_SMALL", at(), message);
        }
    }
}

/// How far the mesh of each proxy sticks out of its sphere, 0 if within the tolerance. Meshes that cannot be read count
/// nothing: whoever reads the document's meshes says so.
fn vertices_outside(doc: &Document, proxies: &Proxies) -> Vec<f64> {
    let nodes = proxies.nodes();
    let mut by_mesh: Vec<usize> = (0..nodes.len()).collect();
    by_mesh.sort_by_key(|&node| nodes[node].mesh);
    let mut outside = vec![0.0; nodes.len()];
    let mut left = MOST_COMPARISONS;
    for same_mesh in by_mesh.chunk_by(|&a, &b| nodes[a].mesh == nodes[b].mesh) {
        let points = vertices(doc, nodes[same_mesh[0]].mesh, &mut left);
        let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let (min, max) = points.iter().fold(empty, |(min, max), &p| (min.min(p), max.max(p)));
        for &index in same_mesh {
            let node = &nodes[index];
            let center = node.center.as_dvec3() - node.origin.as_dvec3();
            let allowed = allowed(node.center, node.radius);
            let farthest_corner = (center - min).abs().max((max - center).abs()).length();
            if points.is_empty() || farthest_corner <= allowed || points.len() > left {
                continue;
            }
            left -= points.len();
            let farthest = points.iter().map(|point| point.distance(center)).fold(0.0, f64::max);
            if farthest > allowed {
                outside[index] = farthest - f64::from(node.radius);
            }
        }
    }
    outside
}

/// How far the spheres of the children of each proxy stick out of its own, 0 if within the tolerance.
fn spheres_outside(proxies: &Proxies) -> Vec<f64> {
    let nodes = proxies.nodes();
    let mut outside = vec![0.0; nodes.len()];
    let mut open: Vec<usize> = Vec::new();
    for (index, node) in nodes.iter().enumerate() {
        open.truncate(node.depth as usize);
        if let Some(&parent) = open.last() {
            let above = &nodes[parent];
            let reach = node.center.as_dvec3().distance(above.center.as_dvec3()) + f64::from(node.radius);
            if reach > allowed(above.center, above.radius) {
                outside[parent] = f64::max(outside[parent], reach - f64::from(above.radius));
            }
        }
        open.push(index);
    }
    outside
}

/// Positions of a mesh; none if they are more than are left to look at, which become fewer.
fn vertices(doc: &Document, mesh: u32, left: &mut usize) -> Vec<DVec3> {
    let primitives = doc.json.pointer(&format!("/meshes/{mesh}/primitives")).and_then(Value::as_array);
    let accessors: BTreeSet<u64> = primitives
        .into_iter()
        .flatten()
        .filter_map(|primitive| primitive["attributes"]["POSITION"].as_u64())
        .collect();
    let mut points = Vec::new();
    for accessor in accessors {
        let Some(accessor) = usize::try_from(accessor).ok().and_then(|index| doc.accessor(index).ok()) else {
            continue;
        };
        let Some(rest) = left.checked_sub(accessor.count) else { continue };
        *left = rest;
        points.extend(accessor.read_vec3_f64().into_iter().flatten().filter(|point| point.is_finite()));
    }
    points
}

/// Triangles of a mesh as the specification counts them; `None` if there is no such mesh.
fn triangles(doc: &Document, mesh: u64) -> Option<u64> {
    let mesh = doc.json.get("meshes")?.get(usize::try_from(mesh).ok()?)?;
    let count = |accessor: &Value| {
        let index = usize::try_from(accessor.as_u64()?).ok()?;
        doc.json.get("accessors")?.get(index)?.get("count")?.as_u64()
    };
    let of_primitive = |primitive: &Value| {
        let corners = match primitive.get("indices") {
            Some(indices) => count(indices),
            None => count(&primitive["attributes"]["POSITION"]),
        };
        let corners = corners.unwrap_or(0);
        match primitive.get("mode").map_or(Some(4), Value::as_u64) {
            Some(4) => corners / 3,
            Some(5 | 6) => corners.saturating_sub(2),
            _ => 0,
        }
    };
    let primitives = mesh.get("primitives").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    Some(primitives.iter().map(of_primitive).fold(0, u64::saturating_add))
}

fn unresolved(mesh: u64, pointer: String, report: &mut ValidationReport) {
    report.error("UNRESOLVED_REFERENCE", pointer, format!("Unresolved reference: mesh {mesh}."));
}
