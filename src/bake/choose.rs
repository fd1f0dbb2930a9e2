//! Which hierarchy is best for a scene, by measured cost.

use super::tree::{Hierarchy, Member, Sphere};
use glam::DVec3;

/// Viewpoints inside the scene that the cost is averaged over, at most.
const VIEWPOINTS: usize = 512;

/// Expected triangles per frame without frustum culling: the geometric mean of a viewer outside everything and
/// of viewers standing at the objects themselves. `visible` are the triangles that each node shows from outside.
///
/// Geometric, because a hierarchy that halves either view is as good as one that halves the other.
pub(super) fn cost(hierarchy: &Hierarchy, spheres: &[Sphere], members: &[Member], visible: &[f64]) -> f64 {
    let outside = drawn_from(hierarchy, spheres, members, visible, None);
    let step = (members.len() / VIEWPOINTS).max(1);
    let viewpoints: Vec<DVec3> = members
        .iter()
        .step_by(step)
        .filter(|m| !m.bounds.is_empty())
        // Beside the object, not in its middle: a corner of its box.
        .map(|m| m.bounds.max)
        .collect();
    let inside: f64 =
        viewpoints.iter().map(|&v| drawn_from(hierarchy, spheres, members, visible, Some(v))).sum();
    let inside = inside / viewpoints.len().max(1) as f64;
    (outside.max(1.0) * inside.max(1.0)).sqrt()
}

/// Triangles drawn from a viewpoint; `None` is outside every sphere.
fn drawn_from(
    hierarchy: &Hierarchy,
    spheres: &[Sphere],
    members: &[Member],
    visible: &[f64],
    viewpoint: Option<DVec3>,
) -> f64 {
    let mut drawn = 0.0;
    let mut place = 0u32;
    let mut node = 0usize;
    let triangles = |range: std::ops::Range<u32>| -> f64 {
        range.map(|p| f64::from(members[hierarchy.order[p as usize] as usize].triangles)).sum()
    };
    while node < hierarchy.nodes.len() {
        let current = &hierarchy.nodes[node];
        // Members before this node hang on nodes that were entered, or on none.
        drawn += triangles(place..current.members.start);
        place = current.members.start;
        let inside = viewpoint.is_some_and(|v| v.distance(spheres[node].center) <= spheres[node].radius);
        if inside {
            node += 1;
        } else {
            drawn += visible[node];
            place = current.members.end;
            node += current.subtree as usize;
        }
    }
    drawn + triangles(place..hierarchy.order.len() as u32)
}
