//! The levels by brute force, for tests: every node on its own, every triangle of it, in f64, no hierarchy of
//! boxes and no walk.

use super::lines::Batch;
use crate::bake::tree::{Hierarchy, Part};
use crate::scene::{Mesh, Opacity};
use glam::DVec3;
use svs_runtime::directions::DirectionSet;

struct Crossing {
    t: f64,
    member: u32,
    opaque: bool,
    sides: [bool; 2],
}

/// Levels by member and direction after the lines of a batch; also checks that visibility is monotone.
pub(crate) fn levels(
    meshes: &[Mesh],
    parts: &[Part],
    hierarchy: &Hierarchy,
    directions: &DirectionSet,
    batch: &Batch,
    to_tree_space: impl Fn(DVec3) -> DVec3,
) -> Vec<Vec<u8>> {
    let mut levels = vec![vec![0u8; directions.len()]; hierarchy.order.len()];
    for grid in &batch.grids {
        for point in grid.points() {
            let crossings = crossings(meshes, parts, to_tree_space(point), grid.direction);
            for (side, bin) in [
                (0, directions.nearest((-grid.direction).as_vec3())),
                (1, directions.nearest(grid.direction.as_vec3())),
            ] {
                let mut seen_by = vec![Vec::new(); hierarchy.order.len()];
                for (index, node) in hierarchy.nodes.iter().enumerate() {
                    let members: Vec<u32> =
                        hierarchy.order[node.members.start as usize..node.members.end as usize].to_vec();
                    for member in visible(&crossings, &members, side) {
                        seen_by[member as usize].push(index as u32);
                    }
                }
                for (member, nodes) in seen_by.iter().enumerate() {
                    assert_is_bottom_part_of_ancestors(hierarchy, member as u32, nodes);
                    let level = &mut levels[member][bin];
                    *level = (*level).max(nodes.len() as u8);
                }
            }
        }
    }
    levels
}

fn visible(crossings: &[Crossing], members: &[u32], side: usize) -> Vec<u32> {
    let distance = |c: &Crossing| if side == 0 { c.t } else { -c.t };
    let within: Vec<&Crossing> =
        crossings.iter().filter(|c| c.sides[side] && members.contains(&c.member)).collect();
    let nearest =
        within.iter().filter(|c| c.opaque).map(|c| distance(c)).fold(f64::INFINITY, f64::min);
    let mut seen: Vec<u32> = within
        .iter()
        .filter(|c| distance(c) <= nearest + if nearest.is_finite() { 1e-9 } else { 0.0 })
        .map(|c| c.member)
        .collect();
    seen.sort_unstable();
    seen.dedup();
    seen
}

fn assert_is_bottom_part_of_ancestors(hierarchy: &Hierarchy, member: u32, nodes: &[u32]) {
    let place = hierarchy.order.iter().position(|&m| m == member).expect("a permutation");
    let mut node = hierarchy.parents_of_members()[place];
    let mut ancestors = Vec::new();
    while let Some(index) = node {
        ancestors.push(index);
        node = hierarchy.nodes[index as usize].parent;
    }
    let mut lowest = ancestors[..nodes.len()].to_vec();
    lowest.sort_unstable();
    assert_eq!(lowest, nodes, "visibility must be monotone up the hierarchy");
}

/// Möller, Trumbore: Fast, Minimum Storage Ray-Triangle Intersection, 1997, over all triangles.
fn crossings(meshes: &[Mesh], parts: &[Part], point: DVec3, direction: DVec3) -> Vec<Crossing> {
    let mut result = Vec::new();
    for part in parts {
        let mesh = &meshes[part.mesh as usize];
        let corner =
            |v: u32| part.to_tree.transform_point3(mesh.origin + mesh.positions[v as usize].as_dvec3());
        for surface in &mesh.surfaces {
            for triangle in &mesh.triangles[surface.triangles.start as usize..surface.triangles.end as usize] {
                let [a, b, c] = triangle.map(corner);
                let (edge1, edge2) = (b - a, c - a);
                let p = direction.cross(edge2);
                let determinant = edge1.dot(p);
                if determinant == 0.0 {
                    continue;
                }
                let from = point - a;
                let u = from.dot(p) / determinant;
                let q = from.cross(edge1);
                let v = direction.dot(q) / determinant;
                if u < 0.0 || v < 0.0 || u + v > 1.0 {
                    continue;
                }
                // A mirrored placement turns the winding round; glTF says the front is then the other side.
                let mirrored = part.to_tree.matrix3.determinant() < 0.0;
                let front = (edge1.cross(edge2).dot(direction) < 0.0) != mirrored;
                result.push(Crossing {
                    t: edge2.dot(q) / determinant,
                    member: part.member,
                    opaque: matches!(surface.opacity, Opacity::Opaque),
                    sides: [surface.double_sided || front, surface.double_sided || !front],
                });
            }
        }
    }
    result
}
