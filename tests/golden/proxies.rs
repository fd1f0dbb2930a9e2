//! Proxies of scenes that are known exactly, and what must hold of the proxies of any scene.

use crate::baking::{bake, document, options};
use crate::document::{Builder, Shape, cuboid};
use glam::{DMat4, DVec3};
use serde_json::{Value, json};
use std::sync::Arc;
use svs::bake::BakeOptions;
use svs::generate::{GridOptions, SampleKind, SampleOptions, generate, grid};
use svs::gltf::{Document, payload};
use svs::proxies::{ProxyMode, ProxyOptions};
use svs::scene::{ReadOptions, read_scene};
use svs_runtime::{ProxyNode, Tree};

/// Proxies without a limit on their bytes.
fn with_proxies(mode: ProxyMode, triangles: u32) -> BakeOptions {
    let proxies = ProxyOptions { mode, triangles, share: 100.0, ..ProxyOptions::default() };
    BakeOptions { proxies, ..options(1 << 16) }
}

/// Vertices of a glTF mesh.
fn vertices(doc: &Document, mesh: u32) -> Vec<DVec3> {
    let primitives = doc.json["meshes"][mesh as usize]["primitives"].as_array().expect("primitives");
    let positions = primitives.iter().map(|p| p["attributes"]["POSITION"].as_u64().expect("positions"));
    positions
        .flat_map(|accessor| {
            doc.accessor(accessor as usize).expect("there").read_vec3_f64().expect("positions")
        })
        .collect()
}

fn triangles(doc: &Document, mesh: u32) -> usize {
    let primitives = doc.json["meshes"][mesh as usize]["primitives"].as_array().expect("primitives");
    primitives
        .iter()
        .map(|p| doc.accessor(p["indices"].as_u64().expect("indices") as usize).expect("there").count / 3)
        .sum()
}

/// Vertices of a proxy in tree space.
fn placed(doc: &Document, node: &ProxyNode) -> Vec<DVec3> {
    vertices(doc, node.mesh).into_iter().map(|v| v + node.origin.as_dvec3()).collect()
}

/// What must hold of the proxies of every scene that stands still; `slack` is what places may be off, metres.
fn check(doc: &Document, tree: &Tree, slack: f64) {
    let proxies = tree.proxies().expect("proxies");
    let scene = read_scene(doc, &ReadOptions::default()).expect("a scene");
    let inside = |node: &ProxyNode, point: DVec3, radius: f64, what: &str| {
        let distance = node.center.as_dvec3().distance(point) + radius;
        assert!(
            distance <= f64::from(node.radius) * (1.0 + 1e-5) + slack,
            "{what}: {distance} of {}",
            node.radius
        );
    };
    let mut parents: Vec<usize> = Vec::new();
    for (index, node) in proxies.nodes().iter().enumerate() {
        parents.truncate(node.depth as usize);
        if let Some(&parent) = parents.last() {
            let parent = &proxies.nodes()[parent];
            inside(parent, node.center.as_dvec3(), f64::from(node.radius), "a child");
            assert!(node.error <= parent.error);
        }
        parents.push(index);
        let mut originals = 0;
        for position in node.objects() {
            let object = &scene.objects[tree.document_index(proxies.object(position) as usize) as usize];
            assert!(!object.hidden, "hidden objects have no part in proxies");
            let mesh = &scene.meshes[object.mesh as usize];
            originals += mesh.drawn_triangles as usize;
            for vertex in &mesh.positions {
                inside(
                    node,
                    object.to_world.transform_point3(vertex.as_dvec3() + mesh.origin),
                    0.0,
                    "an original",
                );
            }
        }
        assert!(triangles(doc, node.mesh) < originals, "{} of {originals}", triangles(doc, node.mesh));
        for vertex in placed(doc, node) {
            inside(node, vertex, 0.0, "a vertex");
        }
    }
    for node in doc.json["nodes"].as_array().expect("nodes") {
        let mesh = node.get("mesh").and_then(Value::as_u64);
        assert!(mesh.is_none_or(|mesh| proxies.nodes().iter().all(|p| u64::from(p.mesh) != mesh)));
    }
}

/// Bakes, checks, and strips again: the document is what it was.
fn round_trip(doc: &mut Document, options: &BakeOptions, slack: f64) -> (Arc<Tree>, Document) {
    let before = (doc.json.to_string(), doc.buffers.clone());
    let (trees, report) = bake(doc, options);
    assert!(report.proxies.expect("a report").nodes > 0);
    check(doc, &trees[0], slack);
    let baked = doc.clone();
    assert!(payload::strip(doc));
    assert!(before == (doc.json.to_string(), doc.buffers.clone()), "JSON or buffers differ");
    (trees[0].clone(), baked)
}

/// A large box with eight small ones inside.
fn nested() -> Document {
    let mut builder = Builder::new();
    let (outer, inner) = (builder.mesh(&cuboid([10.0; 3]), None), builder.mesh(&cuboid([2.0; 3]), None));
    builder.object(None, outer, DVec3::ZERO);
    for corner in 0..8 {
        let at = [0, 1, 2].map(|axis| if corner >> axis & 1 == 0 { -5.0 } else { 5.0 });
        builder.object(None, inner, at.into());
    }
    builder.finish()
}

#[test]
fn what_is_inside_a_closed_box_is_in_no_proxy() {
    let innermost = |mode| {
        let mut doc = nested();
        let (tree, baked) = round_trip(&mut doc, &with_proxies(mode, 16), 0.0);
        let proxies = tree.proxies().expect("proxies");
        assert_eq!(proxies.visible_only(), mode == ProxyMode::Auto);
        assert_eq!(proxies.nodes()[0].object_count, 9);
        let root = placed(&baked, &proxies.nodes()[0]);
        root.into_iter().map(|v| v.abs().max_element()).fold(f64::INFINITY, f64::min)
    };
    assert!(innermost(ProxyMode::Auto) > 9.9);
    assert!(innermost(ProxyMode::All) < 8.0);
}

#[test]
fn proxies_of_generated_scenes() {
    for kind in [SampleKind::Plant, SampleKind::City, SampleKind::Cubes] {
        let mut doc = document(generate(&SampleOptions { scale: 0.2, ..SampleOptions::new(kind) }));
        round_trip(&mut doc, &with_proxies(ProxyMode::Auto, 256), 0.0);
        round_trip(&mut doc, &with_proxies(ProxyMode::All, 256), 0.0);
    }
}

#[test]
fn mirrored_far_away_and_tiny() {
    for (placement, slack) in [
        (json!({ "scale": [-1, 1, 1] }), 0.0),
        (json!({ "translation": [1e7, -1e7, 1e7] }), 2.0),
        (json!({ "scale": [1e-6, 1e-6, 1e-6] }), 0.0),
    ] {
        let mut sample = generate(&SampleOptions { scale: 0.1, ..SampleOptions::new(SampleKind::Plant) });
        let roots = sample.json["scenes"][0]["nodes"].take();
        let nodes = sample.json["nodes"].as_array_mut().expect("nodes");
        let mut node = placement;
        node["children"] = roots;
        nodes.push(node);
        sample.json["scenes"][0]["nodes"] = json!([nodes.len() - 1]);
        round_trip(&mut document(sample), &with_proxies(ProxyMode::Auto, 256), slack);
    }
}

#[test]
fn copies_share_their_proxies() {
    let mut doc = document(generate(&SampleOptions { scale: 0.1, ..SampleOptions::new(SampleKind::Plant) }));
    grid(&mut doc, &GridOptions { copies: 16, spacing: 1.1 }).expect("a grid");
    let (tree, _) = round_trip(&mut doc, &with_proxies(ProxyMode::Auto, 256), 1e-3);
    let nodes = tree.proxies().expect("proxies").nodes();
    let meshes: std::collections::BTreeSet<u32> = nodes.iter().map(|node| node.mesh).collect();
    assert!(meshes.len() * 6 < nodes.len(), "{} meshes for {} proxies", meshes.len(), nodes.len());
}

#[test]
fn instances_are_objects_too() {
    let mut builder = Builder::new();
    let mesh = builder.mesh(&cuboid([0.5; 3]), None);
    let places: Vec<f32> = (0..64).flat_map(|i| [i % 4, i / 4 % 4, i / 16].map(|c| c as f32 * 2.0)).collect();
    let bytes: Vec<u8> = places.iter().flat_map(|c| c.to_le_bytes()).collect();
    let view = builder.view(&bytes);
    let accessor = builder
        .push("accessors", json!({ "bufferView": view, "componentType": 5126, "count": 64, "type": "VEC3" }));
    let attributes = json!({ "attributes": { "TRANSLATION": accessor } });
    builder.node(None, json!({ "mesh": mesh, "extensions": { "EXT_mesh_gpu_instancing": attributes } }));
    builder.json["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
    let (tree, _) = round_trip(&mut builder.finish(), &with_proxies(ProxyMode::Auto, 64), 0.0);
    assert_eq!(tree.proxies().expect("proxies").nodes()[0].object_count, 64);
}

#[test]
fn hidden_and_unusable_objects_stay_outside() {
    let mut builder = Builder::new();
    let (mesh, point) = (builder.mesh(&cuboid([0.5; 3]), None), {
        let shape = Shape { positions: vec![[1.0; 3]; 3], uvs: Vec::new(), indices: vec![0, 1, 2] };
        builder.mesh(&shape, None)
    });
    let sheet = builder.mesh(&Shape { indices: vec![0, 1, 2, 2, 1, 0], ..cuboid([0.5, 0.0, 0.5]) }, None);
    for i in 0..20 {
        let at = DVec3::new(f64::from(i) * 1.5, 0.0, 0.0);
        builder.object(None, if i % 5 == 1 { sheet } else { mesh }, at);
    }
    builder.object(None, point, DVec3::ZERO);
    builder.node(
        None,
        json!({ "mesh": mesh, "translation": [0, 5, 0], "extensions": { "KHR_node_visibility": { "visible": false } } }),
    );
    let huge = DMat4::from_scale(DVec3::splat(1e30)).to_cols_array();
    builder.node(None, json!({ "mesh": mesh, "matrix": huge }));
    builder.json["extensionsUsed"] = json!(["KHR_node_visibility"]);
    let mut doc = builder.finish();
    let (trees, _) = bake(&mut doc, &with_proxies(ProxyMode::Auto, 64));
    for tree in trees.iter().filter(|tree| tree.proxies().is_some()) {
        for node in tree.proxies().expect("proxies").nodes() {
            assert!(node.center.is_finite() && node.radius.is_finite() && node.error.is_finite());
            assert!(placed(&doc, node).iter().all(|v| v.is_finite()));
        }
    }
    assert!(payload::strip(&mut doc));
}

#[test]
fn small_scenes_get_none_and_the_report_says_so() {
    let mut doc = nested();
    let before = doc.json.to_string();
    let (trees, report) = bake(&mut doc, &with_proxies(ProxyMode::Auto, 2000));
    assert!(trees[0].proxies().is_none());
    assert_eq!(report.proxies.expect("a report").without.len(), 1);
    assert!(payload::strip(&mut doc));
    assert_eq!(doc.json.to_string(), before);
}
