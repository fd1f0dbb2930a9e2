//! Simple spheres: union of the children's, or the box's where that is smaller (Eikel, Spherical Visibility Sampling,
//! 2013, section 3.3).

use super::{Geometry, round, storable, tight};
use crate::bake::tree::{Aabb, Sphere};
use glam::DVec3;
use rayon::prelude::*;

/// One sphere per node.
pub(super) fn spheres(geometry: &Geometry<'_>) -> Vec<Sphere> {
    let nodes = &geometry.hierarchy.nodes;
    let members: Vec<Option<(Sphere, Aabb)>> = (0..geometry.hierarchy.order.len() as u32)
        .into_par_iter()
        .map(|place| {
            let extremes = tight::of_member(geometry, place);
            let sphere = tight::ball(extremes.points(), || geometry.parts_at(place))?;
            Some((sphere, extremes.bounds()))
        })
        .collect();
    let mut gathered: Vec<Option<(Sphere, Aabb)>> = vec![None; nodes.len()];
    let mut spheres = Vec::with_capacity(nodes.len());
    for node in (0..nodes.len()).rev() {
        let mut own = gathered[node];
        for member in geometry.direct_places(node).filter_map(|place| members[place as usize]) {
            own = Some(join(own, member));
        }
        let Some((union, bounds)) = own else {
            spheres.push(geometry.point_sphere(node));
            continue;
        };
        let around_box = Sphere { center: bounds.center(), radius: (bounds.max - bounds.min).length() * 0.5 };
        let sphere = if around_box.radius < union.radius { around_box } else { union };
        let center = round(sphere.center);
        spheres.push(storable(center, sphere.radius + center.distance(sphere.center)));
        if let Some(parent) = nodes[node].parent {
            let above = &mut gathered[parent as usize];
            *above = Some(join(*above, (sphere, bounds)));
        }
    }
    spheres.reverse();
    spheres
}

fn join(all: Option<(Sphere, Aabb)>, (sphere, bounds): (Sphere, Aabb)) -> (Sphere, Aabb) {
    match all {
        Some((union, all)) => (union_of_two(&union, &sphere), all.union(&bounds)),
        None => (sphere, bounds),
    }
}

/// Smallest sphere that holds two.
pub(super) fn union_of_two(a: &Sphere, b: &Sphere) -> Sphere {
    let between: DVec3 = b.center - a.center;
    let distance = between.length();
    if distance + b.radius <= a.radius {
        return *a;
    }
    if distance + a.radius <= b.radius {
        return *b;
    }
    // From the far side of the one to the far side of the other. The distance is not 0 here.
    let radius = (distance + a.radius + b.radius) * 0.5;
    Sphere { center: a.center + between * ((radius - a.radius) / distance), radius }
}
