//! Directions with components of -0.0 are those with +0.0.
//!
//! `obvhs` 0.4.0's `CwBvh` misses everything then: its slab test takes the order of the planes from the sign bit of
//! 1 / direction and the far plane from its value, and -infinity makes the interval empty. So nothing here uses it.
//! `Bvh2`, which is used, picks an infinity by the sign as well; adding +0.0 to the direction makes both the same.

use crate::baking::Unpruned;
use crate::document::{Builder, cuboid};
use glam::{DVec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::ray::Ray;
use std::time::Duration;
use svs::bake::hierarchy::HierarchyKind;
use svs::bake::rays::LineHit;

/// All ways to put signs on the zeros of a direction.
fn signs(direction: DVec3) -> impl Iterator<Item = DVec3> {
    (0..8).map(move |bits| {
        let mut signed = direction;
        for axis in 0..3 {
            if signed[axis] == 0.0 && bits >> axis & 1 == 1 {
                signed[axis] = -0.0;
            }
        }
        signed
    })
}

fn directions() -> Vec<DVec3> {
    let mut directions: Vec<DVec3> = DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]).collect();
    directions.extend([DVec3::new(0.6, 0.8, 0.0), DVec3::new(0.0, -0.6, 0.8), DVec3::new(-0.8, 0.0, -0.6)]);
    directions
}

#[test]
fn lines_hit_the_same() {
    for shared in [false, true] {
        let mut builder = Builder::new();
        let mut mesh = builder.mesh(&cuboid([0.5; 3]), None);
        for k in 0..27 {
            // One mesh for all boxes or one each: instances and merged triangles take different paths.
            if !shared {
                mesh = builder.mesh(&cuboid([0.5; 3]), None);
            }
            let place = DVec3::new(f64::from(k % 3), f64::from(k / 3 % 3), f64::from(k / 9));
            builder.object(None, mesh, place * 2.0);
        }
        let scene = Unpruned::new(&builder.finish(), HierarchyKind::Octree);
        let rays = scene.rays();
        for direction in directions() {
            let trace = |direction: DVec3, point: DVec3| {
                let mut hits = Vec::new();
                rays.line(point, direction, &mut hits);
                hits.sort_by(|a: &LineHit, b| a.t.total_cmp(&b.t).then(a.member.cmp(&b.member)));
                hits
            };
            let mut hits = 0;
            for k in 0..100 {
                let share = |step: i32| f64::from(k * step % 101) / 101.0 - 0.5;
                let point = DVec3::new(share(37), share(59), share(83));
                // In the plane across the direction.
                let point = point - direction * point.dot(direction);
                let expected = trace(direction, point);
                hits += expected.len();
                for signed in signs(direction) {
                    assert_eq!(trace(signed, point), expected, "{signed:?} {point}");
                }
            }
            assert!(hits > 100, "{direction}: {hits}");
        }
    }
}

#[test]
fn levels_are_the_same() {
    let mut builder = Builder::new();
    let mesh = builder.mesh(&cuboid([0.5; 3]), None);
    for k in 0..4 {
        builder.object(None, mesh, DVec3::X * 2.0 * f64::from(k));
    }
    let scene = Unpruned::new(&builder.finish(), HierarchyKind::Octree);
    for direction in directions() {
        let expected = scene.levels_from(direction, 1_000);
        assert!(expected.iter().any(|&level| level > 0));
        assert!(signs(direction).all(|signed| scene.levels_from(signed, 1_000) == expected));
    }
}

#[test]
fn bvh2_visits_the_same_leaves() {
    let boxes: Vec<Aabb> = (0..64)
        .map(|k| {
            let place = Vec3A::new((k % 4) as f32, (k / 4 % 4) as f32, (k / 16) as f32) - 1.5;
            Aabb::new(place - 0.25, place + 0.25)
        })
        .collect();
    let bvh = build_bvh2(&boxes, BvhBuildParams::medium_build(), &mut Duration::default());
    for direction in directions() {
        // Through the middle of a box: between the boxes are gaps.
        let start = direction.as_vec3a() * -10.0 + 0.5;
        let visited = |direction: Vec3A| {
            let mut visited = Vec::new();
            bvh.ray_traverse_anyhit(Ray::new(start, direction, 0.0, f32::INFINITY), |_, i| visited.push(i));
            visited.sort_unstable();
            visited
        };
        let expected = visited(direction.as_vec3a() + Vec3A::ZERO);
        assert!(!expected.is_empty(), "{direction}");
        for signed in signs(direction) {
            // As the ray scene does it.
            assert_eq!(visited(signed.as_vec3a() + Vec3A::ZERO), expected, "{signed:?}");
        }
    }
}
