//! A screw of a micrometre in a scene of a thousand kilometres.

use crate::baking::{bake, options};
use crate::document::{Builder, cuboid};
use glam::DVec3;
use serde_json::json;
use svs::bake::HierarchyChoice;
use svs::bake::hierarchy::HierarchyKind;

#[test]
fn what_no_ray_meets_is_not_taken_for_hidden() {
    for kind in [HierarchyKind::Scene, HierarchyKind::Octree, HierarchyKind::Bvh] {
        let mut builder = Builder::new();
        let mesh = builder.mesh(&cuboid([0.5; 3]), None);
        for k in 0..8 {
            let at = DVec3::new(f64::from(k % 2), f64::from(k / 2 % 2), f64::from(k / 4)) * 1e6;
            builder
                .node(None, json!({ "mesh": mesh, "translation": at.to_array(), "scale": [2e5, 2e5, 2e5] }));
        }
        let screw =
            builder.node(None, json!({ "translation": [5e5, 5e5, 5e5], "scale": [1e-6, 1e-6, 1e-6] }));
        for k in 0..12 {
            builder.object(Some(screw), mesh, DVec3::X * 2.0 * f64::from(k));
        }
        let mut doc = builder.finish();
        let mut options = options(1 << 20);
        options.hierarchy = HierarchyChoice::Kind(kind);
        let (trees, report) = bake(&mut doc, &options);
        println!("{}: {} spheres kept", kind.name(), report.trees[0].nodes_kept);
        // Every part of the screw is seen from near the screw, from the sides at least: there must be no sphere
        // around the screw alone that says otherwise.
        for tree in &trees {
            for place in 0..tree.object_count() {
                if tree.document_index(place) < 8 {
                    continue;
                }
                let node = tree.nodes().iter().filter(|n| n.objects().contains(&(place as u32))).last();
                if let Some(node) = node.filter(|n| n.radius < 1.0) {
                    let side = tree.direction_set().nearest_f64(DVec3::Y);
                    assert!(tree.level(place, side) > 0, "{}: {place} in {node:?}", kind.name());
                }
            }
        }
    }
}
