//! The node graph: roots, transforms, cycles, what is left out.

use super::builder::{Builder, noted};
use crate::scene::{ReadOptions, Role, SceneError, read_scene};
use glam::DVec3;
use serde_json::{Value, json};

#[test]
fn objects_come_in_depth_first_order_with_their_subtrees() {
    let mut b = Builder::new();
    let (m0, m1) = (b.triangle(), b.triangle());
    // 0 ── 1 (mesh) ── 2 (mesh)
    //  └── 3 (mesh, the same as 2)     4 (mesh)
    b.node(json!({"children": [1, 3], "translation": [10, 0, 0]}));
    b.node(json!({"children": [2], "mesh": m1, "translation": [1, 0, 0]}));
    b.node(json!({"mesh": m0, "scale": [-1, 1, 1]}));
    b.node(json!({"mesh": m0}));
    b.node(json!({"mesh": m0}));
    b.scene(&[4, 0]);
    let scene = b.read().unwrap();
    let objects: Vec<_> = scene.objects.iter().map(|o| (o.node, o.mesh, o.scene_node)).collect();
    assert_eq!(objects, [(4, 0, 0), (1, 1, 2), (2, 0, 3), (3, 0, 4)]);
    assert!(scene.objects.iter().all(|o| o.role == Role::Static), "a mirror is no reason to leave out");
    assert_eq!(scene.meshes.len(), 2);
    let nodes: Vec<_> =
        scene.nodes.iter().map(|n| (n.node, n.parent, n.subtree_end, n.objects.clone())).collect();
    assert_eq!(
        nodes,
        [
            (4, None, 1, 0..1),
            (0, None, 5, 1..4),
            (1, Some(1), 4, 1..3),
            (2, Some(2), 4, 2..3),
            (3, Some(1), 5, 3..4)
        ]
    );
    assert_eq!(scene.objects[2].to_world.transform_point3(DVec3::X), DVec3::new(10.0, 0.0, 0.0));
    assert!(scene.notes.is_empty(), "{:?}", scene.notes);
}

#[test]
fn a_cycle_and_a_second_parent_are_errors() {
    let mut b = Builder::new();
    b.node(json!({"children": [1]}));
    b.node(json!({"children": [2]}));
    b.node(json!({"children": [1]}));
    b.scene(&[0]);
    assert!(
        matches!(b.read(), Err(SceneError::Cycle { node: 1, pointer }) if pointer == "/nodes/2/children/0")
    );

    let mut b = Builder::new();
    b.node(json!({"children": [0]}));
    b.scene(&[0]);
    assert!(matches!(b.read(), Err(SceneError::Cycle { node: 0, .. })));

    let mut b = Builder::new();
    b.node(json!({"children": [2]}));
    b.node(json!({"children": [2]}));
    b.node(json!({}));
    b.scene(&[0, 1]);
    let error = b.read().unwrap_err();
    assert!(
        matches!(&error, SceneError::TwoParents { node: 2, pointer } if pointer == "/nodes/1/children/0")
    );

    // A root that is also a child.
    b.json["scenes"] = json!([{"nodes": [0, 2]}]);
    assert!(
        matches!(b.read(), Err(SceneError::TwoParents { node: 2, pointer }) if pointer == "/scenes/0/nodes/1")
    );
}

#[test]
fn a_chain_of_ten_thousand_nodes_is_read() {
    const DEPTH: usize = 10_000;
    let mut b = Builder::new();
    let mesh = b.triangle();
    let chain = (0..DEPTH - 1).map(|n| json!({"children": [n + 1], "translation": [1, 0, 0]}));
    b.json["nodes"] = Value::Array(chain.chain([json!({"mesh": mesh})]).collect());
    b.scene(&[0]);
    let scene = b.read().unwrap();
    assert_eq!((scene.nodes.len(), scene.objects.len()), (DEPTH, 1));
    assert_eq!(scene.objects[0].to_world.translation.x, (DEPTH - 1) as f64);
    assert!(scene.nodes.iter().all(|node| node.subtree_end as usize == DEPTH && node.objects == (0..1)));
}

#[test]
fn broken_references_are_errors_with_their_place() {
    let mut b = Builder::new();
    b.triangle();
    b.node(json!({"mesh": 0, "children": [1]}));
    b.node(json!({}));
    b.scene(&[0]);
    assert!(b.read().is_ok());
    for (path, value, expected) in [
        ("/nodes/0", json!({"mesh": 1}), "/nodes/0/mesh: index 1 is out of range"),
        ("/nodes/0", json!({"children": [7]}), "/nodes/0/children/0: index 7 is out of range"),
        ("/nodes/0", json!({"children": {}}), "/nodes/0/children: expected an array"),
        ("/nodes/0", json!({"children": ["1"]}), "/nodes/0/children/0: expected"),
        ("/nodes/0", json!({"mesh": -1}), "/nodes/0/mesh: expected"),
        ("/nodes/0", json!({"matrix": [1]}), "/nodes/0/matrix: expected 16 numbers"),
        ("/nodes/1", json!(5), "/nodes/1: expected an object"),
        ("/scenes/0/nodes", json!([9]), "/scenes/0/nodes/0: index 9 is out of range"),
        (
            "/meshes/0/primitives/0",
            json!({"attributes": {"POSITION": 4}}),
            "/meshes/0/primitives/0/attributes/POSITION",
        ),
        (
            "/meshes/0/primitives/0",
            json!({"attributes": {"POSITION": 0}, "indices": 4}),
            "/meshes/0/primitives/0/indices",
        ),
        (
            "/meshes/0/primitives/0",
            json!({"attributes": {"POSITION": 0}, "material": 0}),
            "/meshes/0/primitives/0/material",
        ),
        (
            "/meshes/0/primitives/0",
            json!({"attributes": {"POSITION": 0}, "mode": 7}),
            "/meshes/0/primitives/0/mode",
        ),
        ("/accessors/0/count", json!(4), "/meshes/0/primitives/0/attributes/POSITION: "),
    ] {
        let mut broken = Builder::new();
        broken.triangle();
        let mut json = b.json.clone();
        *json.pointer_mut(path).unwrap() = value;
        broken.json = json;
        let error = broken.error();
        assert!(error.starts_with(expected), "{error}");
    }
    b.json["scene"] = json!(3);
    assert!(b.error().starts_with("/scene: index 3 is out of range"), "{}", b.error());
}

#[test]
fn scenes_are_chosen_as_asked() {
    let mut b = Builder::new();
    let mesh = b.triangle();
    b.node(json!({"mesh": mesh}));
    b.node(json!({}));
    b.scene(&[1]);
    b.scene(&[0, 1]);
    let count = |b: &Builder, scene| {
        read_scene(&b.document(), &ReadOptions { scene, ..ReadOptions::default() }).map(|s| s.objects.len())
    };
    assert_eq!(count(&b, None).unwrap(), 0);
    assert_eq!(count(&b, Some(1)).unwrap(), 1);
    assert!(matches!(count(&b, Some(2)), Err(SceneError::NoSuchScene { index: 2, count: 2 })));
    b.json["scene"] = json!(1);
    assert_eq!(count(&b, None).unwrap(), 1);
}

#[test]
fn without_scenes_the_parentless_nodes_are_the_roots() {
    let mut b = Builder::new();
    let mesh = b.triangle();
    b.node(json!({"mesh": mesh}));
    b.node(json!({"children": [0], "translation": [5, 0, 0]}));
    let scene = b.read().unwrap();
    assert_eq!((scene.nodes.len(), scene.objects.len()), (2, 1));
    assert_eq!(scene.objects[0].to_world.translation.x, 5.0);
    assert_eq!(noted(&scene, "NO_SCENE"), 1);
    b.json["nodes"][0]["children"] = json!([1]);
    assert!(matches!(b.read(), Err(SceneError::Cycle { .. })));
}

#[test]
fn empty_documents_are_empty_scenes() {
    for (key, value) in [("meshes", json!([])), ("nodes", json!([])), ("scenes", json!([{}]))] {
        let mut b = Builder::new();
        b.json[key] = value;
        let scene = b.read().unwrap();
        assert_eq!((scene.objects.len(), scene.nodes.len(), scene.meshes.len()), (0, 0, 0));
    }
}

#[test]
fn unusable_transforms_leave_objects_out() {
    let mut b = Builder::new();
    let mesh = b.triangle();
    let far = "{\"mesh\": 0, \"matrix\": [1,0,0,0, 0,1,0,0, 0,0,1,0, 1e999,0,0,1]}";
    b.node(serde_json::from_str(far).unwrap());
    b.node(json!({"mesh": mesh, "scale": [1, 0, 1]}));
    b.node(json!({"mesh": mesh, "scale": [1e200, 1e200, 1e200], "children": [3]}));
    b.node(json!({"mesh": mesh, "scale": [1e200, 1e200, 1e200]}));
    b.node(json!({"mesh": mesh, "scale": [1, -2, 1]}));
    b.scene(&[0, 1, 2, 4]);
    let scene = b.read().unwrap();
    let roles: Vec<_> = scene.objects.iter().map(|o| o.role).collect();
    let (out, kept) = (Role::Excluded, Role::Static);
    assert_eq!(roles, [out, out, out, out, kept]);
    assert!(scene.objects.iter().all(|o| o.to_world.is_finite()));
    assert!(scene.nodes.iter().all(|n| n.to_world.is_finite()));
    assert_eq!(noted(&scene, "TRANSFORM_NOT_FINITE"), 2);
    assert_eq!(noted(&scene, "TRANSFORM_DEGENERATE"), 1);
    assert_eq!(noted(&scene, "OUT_OF_RANGE"), 1);
}

#[test]
fn hidden_skinned_and_morphed_objects_are_left_out() {
    let mut b = Builder::new();
    let mesh = b.triangle();
    let hidden = json!({"KHR_node_visibility": {"visible": false}});
    b.node(json!({"children": [1], "extensions": hidden}));
    b.node(json!({"mesh": mesh, "extensions": {"KHR_node_visibility": {"visible": true}}}));
    b.node(json!({"mesh": mesh, "skin": 0}));
    let morphed = b.mesh(json!([{"attributes": {"POSITION": 0}, "targets": [{"POSITION": 0}]}]));
    b.node(json!({"mesh": morphed}));
    b.scene(&[0, 2, 3]);
    let scene = b.read().unwrap();
    assert_eq!(scene.objects.len(), 3);
    assert!(scene.objects.iter().all(|o| o.role == Role::Excluded));
    let codes: Vec<_> = scene.notes.iter().map(|n| (n.code, n.count, n.pointer.as_str())).collect();
    assert_eq!(
        codes,
        [("NODE_HIDDEN", 1, "/nodes/1"), ("SKINNED", 1, "/nodes/2"), ("MORPHED", 1, "/nodes/3")]
    );
}

#[test]
fn animated_nodes_move() {
    let mut b = Builder::new();
    let mesh = b.triangle();
    b.node(json!({"children": [1]}));
    b.node(json!({"mesh": mesh}));
    b.scene(&[0]);
    b.push(
        "animations",
        json!({"channels": [{"sampler": 0, "target": {"node": 1, "path": "rotation"}}], "samplers": []}),
    );
    let scene = b.read().unwrap();
    let moving: Vec<_> = scene.nodes.iter().map(|node| node.moving).collect();
    assert_eq!(moving, [false, true]);
    assert_eq!(scene.objects[0].role, Role::Static, "still relative to its anchor");
}

#[test]
fn unknown_required_extensions_are_noted() {
    let mut b = Builder::new();
    b.json["extensionsRequired"] = json!(["KHR_mesh_quantization", "XY_folded_space"]);
    let scene = b.read().unwrap();
    assert_eq!(noted(&scene, "REQUIRED_EXTENSION_UNKNOWN"), 1);
}
