//! A screw of a micrometre in a scene of a thousand kilometres.

use crate::baking::{bake, options};
use crate::document::{Builder, cuboid};
use glam::DVec3;
use serde_json::json;
use svs::bake::HierarchyChoice;
use svs::bake::hierarchy::HierarchyKind;
use svs::gltf::Document;

const KINDS: [HierarchyKind; 3] = [HierarchyKind::Scene, HierarchyKind::Octree, HierarchyKind::Bvh];

/// Objects that are not the screw's.
const LARGE: usize = 8;

/// Boxes 200 km wide at the corners of a cube, and in the middle a screw of so many parts.
fn scene(parts: usize) -> Document {
    let mut builder = Builder::new();
    let mesh = builder.mesh(&cuboid([0.5; 3]), None);
    for k in 0..LARGE {
        let at = [k % 2, k / 2 % 2, k / 4].map(|corner| corner as f64 * 1e6);
        builder.node(None, json!({ "mesh": mesh, "translation": at, "scale": [2e5, 2e5, 2e5] }));
    }
    if parts > 0 {
        let screw =
            builder.node(None, json!({ "translation": [5e5, 5e5, 5e5], "scale": [1e-6, 1e-6, 1e-6] }));
        for k in 0..parts {
            builder.object(Some(screw), mesh, DVec3::X * 2.0 * k as f64);
        }
    }
    builder.finish()
}

#[test]
fn the_screw_changes_nothing_of_the_rest() {
    for kind in KINDS {
        let drawn = |parts: usize| -> Vec<bool> {
            let options =
                svs::bake::BakeOptions { hierarchy: HierarchyChoice::Kind(kind), ..options(1 << 20) };
            let (trees, report) = bake(&mut scene(parts), &options);
            assert_eq!(report.baked_objects, LARGE + parts);
            let tree = &trees[0];
            let mut drawn = Vec::new();
            for document_index in 0..LARGE as u32 {
                let place = (0..tree.object_count()).find(|&p| tree.document_index(p) == document_index);
                let place = place.expect("every object has a place");
                drawn.extend(
                    (0..tree.direction_set().len())
                        .map(|direction| u32::from(tree.level(place, direction)) >= tree.depth(place)),
                );
            }
            drawn
        };
        assert_eq!(drawn(12), drawn(0), "{}", kind.name());
    }
}

#[test]
fn what_no_ray_meets_is_not_taken_for_hidden() {
    for kind in KINDS {
        let options = svs::bake::BakeOptions { hierarchy: HierarchyChoice::Kind(kind), ..options(1 << 20) };
        let (trees, report) = bake(&mut scene(12), &options);
        println!("{}: {} spheres kept", kind.name(), report.trees[0].nodes_kept);
        // From its side every part of the screw is seen: a sphere around the screw alone must not say otherwise.
        for tree in &trees {
            for place in (0..tree.object_count()).filter(|&p| tree.document_index(p) >= LARGE as u32) {
                let innermost = tree.nodes().iter().rfind(|n| n.objects().contains(&(place as u32)));
                if let Some(node) = innermost.filter(|n| n.radius < 1.0) {
                    let side = tree.direction_set().nearest_f64(DVec3::Y);
                    assert!(tree.level(place, side) > 0, "{}: {place} in {node:?}", kind.name());
                }
            }
        }
    }
}
