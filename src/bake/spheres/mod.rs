//! Bounding spheres of a hierarchy's nodes.
//!
//! Every sphere holds all vertices (of triangles) of the members below its node, and its centre and radius are
//! numbers that `f32` holds exactly, so that what is baked and what is stored are the same sphere.

mod epos98;
mod exact_ball;
mod points;
mod simple;
#[cfg(test)]
mod tests;
mod tight;

use crate::bake::hierarchy::is_usable;
use crate::bake::tree::{Hierarchy, Member, Part, Sphere};
use crate::scene::Mesh;
use glam::DVec3;
use points::{MeshPoints, PlacedPart};
use rayon::prelude::*;

/// How spheres are computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, clap::ValueEnum)]
pub enum SphereKind {
    /// Union of the children's spheres, or the sphere about the node's box if that is smaller. Radii sum up to
    /// 7-18 % more than tight ones (Eikel, Spherical Visibility Sampling, 2013, section 5.5).
    Simple,
    /// Smallest ball of the extreme points along 49 directions (Larsson 2008), then of all vertices.
    #[default]
    Tight,
}

/// One sphere per node of `hierarchy`, in its order, in tree space (metres).
///
/// Members without a usable box, parts that are transformed beyond 1e37 m and vertices that no triangle uses have no
/// influence. A node without any vertex gets radius 0 about the centre of its members' boxes (about the origin if
/// they are empty). The result does not depend on the number of threads.
pub fn spheres(
    kind: SphereKind,
    hierarchy: &Hierarchy,
    members: &[Member],
    parts: &[Part],
    meshes: &[Mesh],
) -> Vec<Sphere> {
    let mut is_used = vec![false; meshes.len()];
    for part in parts {
        if let Some(is_used) = is_used.get_mut(part.mesh as usize) {
            *is_used = true;
        }
    }
    let points: Vec<MeshPoints> = meshes
        .par_iter()
        .zip(is_used)
        .map(|(mesh, is_used)| if is_used { MeshPoints::new(mesh) } else { MeshPoints::default() })
        .collect();
    let geometry = Geometry { hierarchy, members, parts, points: &points };
    match kind {
        SphereKind::Simple => simple::spheres(&geometry),
        SphereKind::Tight => tight::spheres(&geometry),
    }
}

/// What the spheres are put around.
struct Geometry<'a> {
    hierarchy: &'a Hierarchy,
    members: &'a [Member],
    parts: &'a [Part],
    points: &'a [MeshPoints],
}

impl<'a> Geometry<'a> {
    /// The parts with vertices of the member at a place of the hierarchy's order.
    fn parts_at(&self, place: u32) -> impl Iterator<Item = PlacedPart<'a>> {
        let member = &self.members[self.hierarchy.order[place as usize] as usize];
        let range = if is_usable(&member.bounds) { member.parts.clone() } else { 0..0 };
        let (parts, points) = (self.parts, self.points);
        range.filter_map(move |part| {
            let part = parts.get(part as usize)?;
            PlacedPart::new(points.get(part.mesh as usize)?, part.to_tree)
        })
    }

    /// The places that hang on a node itself.
    fn direct_places(&self, node: usize) -> std::ops::Range<u32> {
        let own = &self.hierarchy.nodes[node];
        let end =
            if own.subtree > 1 { self.hierarchy.nodes[node + 1].members.start } else { own.members.end };
        own.members.start..end
    }

    /// Sphere of a node without vertices.
    fn point_sphere(&self, node: usize) -> Sphere {
        let bounds = self.hierarchy.nodes[node]
            .members
            .clone()
            .map(|place| self.members[self.hierarchy.order[place as usize] as usize].bounds)
            .filter(is_usable)
            .reduce(|all, bounds| all.union(&bounds));
        Sphere { center: round(bounds.map_or(DVec3::ZERO, |bounds| bounds.center())), radius: 0.0 }
    }
}

/// The nearest point that `f32` holds.
fn round(point: DVec3) -> DVec3 {
    point.as_vec3().as_dvec3()
}

/// The sphere about a centre that `f32` holds, its radius rounded up to an `f32` that leaves room for the rounding
/// errors of the vertices' own transforms.
fn storable(center: DVec3, radius: f64) -> Sphere {
    let slack = 8.0 * f64::EPSILON * (center.abs().max_element() + radius);
    let wanted = radius + slack;
    let mut radius = wanted as f32;
    if f64::from(radius) < wanted {
        radius = radius.next_up();
    }
    Sphere { center, radius: f64::from(radius) }
}
