//! Do the spheres hold what is below them?

use super::against_scene::object;
use super::places::{Place, PlacedTree};
use super::report::ValidationReport;
use crate::scene::Mesh;
use glam::{DAffine3, DVec3, Vec3};
use rayon::prelude::*;
use std::collections::HashMap;

/// A vertex may stick out by this share of the sphere's radius and of its distance from the origin: spheres are
/// stored in single precision, and clients place vertices in single precision too.
const TOLERANCE: f64 = 1e-5;

/// Reports the spheres that do not hold all triangles of the objects below them. What nested trees hold is not
/// looked into.
pub(super) fn check(
    tree: &PlacedTree,
    place: &Place,
    nested: &HashMap<u32, usize>,
    report: &mut ValidationReport,
) {
    let nodes = tree.tree.nodes();
    // How far vertices stick out, in units of tree space; 0 if within the tolerance.
    let excess = |node: &svs_runtime::Node| -> f64 {
        excess(tree, place, nested, node.center, node.radius, node.objects())
    };
    let excesses: Vec<f64> = nodes.par_iter().map(excess).collect();
    let outside = excesses.iter().filter(|&&excess| excess > 0.0).count();
    let worst = excesses.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
    if let Some((node, excess)) = worst.filter(|_| outside > 0) {
        let message = format!(
            "{outside} of {} spheres do not hold all vertices below them; the worst is that of node {node} with radius \
             {}, by {excess:.3e}.",
            nodes.len(),
            nodes[node].radius
        );
        report.warning("SPHERE_TOO_SMALL", format!("{}/tables/NODE_SPHERE", tree.at), message);
    }
}

/// Distance from a sphere's centre that vertices may have.
pub(super) fn allowed(center: Vec3, radius: f32) -> f64 {
    let radius = f64::from(radius);
    radius + TOLERANCE * (radius + center.as_dvec3().abs().max_element())
}

/// How far objects, given by place in the tree's order, stick out of a sphere; 0 if within the tolerance.
pub(super) fn excess(
    tree: &PlacedTree,
    place: &Place,
    nested: &HashMap<u32, usize>,
    center: Vec3,
    radius: f32,
    objects: impl Iterator<Item = u32>,
) -> f64 {
    let (allowed, center, radius) = (allowed(center, radius), center.as_dvec3(), f64::from(radius));
    let farthest = objects
        .filter(|k| !nested.contains_key(k))
        .map(|k| {
            let object = object(tree, place, k).1;
            let mesh = &place.scene.meshes[object.mesh as usize];
            farthest(mesh, &(place.to_tree * object.to_world), center, allowed)
        })
        .fold(0.0, f64::max);
    if farthest > allowed { farthest - radius } else { 0.0 }
}

/// Largest distance of the mesh's triangles from `center`, or 0 if the mesh's box shows that it is at most `allowed`.
fn farthest(mesh: &Mesh, to_tree: &DAffine3, center: DVec3, allowed: f64) -> f64 {
    let corner = |i: u32| {
        let pick = |bit: u32, low: f64, high: f64| if i & bit == 0 { low } else { high };
        let (low, high) = (mesh.min, mesh.max);
        DVec3::new(pick(1, low.x, high.x), pick(2, low.y, high.y), pick(4, low.z, high.z))
    };
    let distance = |position: DVec3| to_tree.transform_point3(position).distance(center);
    if (0..8).all(|i| distance(corner(i)) <= allowed) {
        return 0.0;
    }
    let vertex = |&vertex: &u32| distance(mesh.origin + mesh.positions[vertex as usize].as_dvec3());
    mesh.triangles.iter().flatten().map(vertex).fold(0.0, f64::max)
}
