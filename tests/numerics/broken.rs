//! Broken and empty input: a result that is valid, or an error that says what is wrong.

use crate::baking::{bake, options};
use crate::document::{Builder, Shape, cuboid};
use glam::DVec3;
use serde_json::{Value, json};
use svs::bake::{self, BakeError, BakeReport, Silent};
use svs::gltf::Document;
use svs::scene::SceneError;

const RAYS: u64 = 1 << 16;

/// Bakes; the result is valid, and so is a bake of the result.
#[track_caller]
fn baked(mut doc: Document) -> BakeReport {
    let (_, report) = bake(&mut doc, &options(RAYS));
    let json = doc.json.to_string();
    let (_, again) = bake(&mut doc, &options(RAYS));
    assert_eq!(doc.json.to_string(), json, "a second build changes the result");
    assert_eq!(again.baked_objects, report.baked_objects);
    report
}

#[track_caller]
fn refused(mut doc: Document) -> SceneError {
    let before = doc.json.to_string();
    let error = bake::build(&mut doc, &options(RAYS), &Silent).expect_err("an error");
    assert_eq!(doc.json.to_string(), before, "a failed build changes nothing");
    assert!(!error.to_string().is_empty());
    match error {
        BakeError::Scene(error) => error,
        error => panic!("{error}"),
    }
}

/// Three boxes in a row beside what is tested.
fn boxes(builder: &mut Builder) -> usize {
    let mesh = builder.mesh(&cuboid([0.5; 3]), None);
    for k in 0..3 {
        builder.object(None, mesh, DVec3::X * 2.0 * f64::from(k));
    }
    mesh
}

fn with_mesh(shape: &Shape) -> Document {
    let mut builder = Builder::new();
    boxes(&mut builder);
    let mesh = builder.mesh(shape, None);
    // Bounds of broken positions are not JSON numbers; readers must not need them.
    for accessor in builder.json["accessors"].as_array_mut().expect("accessors") {
        if accessor["min"].as_array().is_some_and(|min| min.iter().any(Value::is_null)) {
            accessor["min"] = json!([-1, -1, -1]);
            accessor["max"] = json!([1, 1, 1]);
        }
    }
    builder.object(None, mesh, DVec3::Y * 2.0);
    builder.finish()
}

#[test]
fn vertices_that_are_no_numbers_lose_their_triangles_only() {
    for broken in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let mut shape = cuboid([0.5; 3]);
        shape.positions[3][1] = broken;
        assert_eq!(baked(with_mesh(&shape)).baked_objects, 4);
        for position in &mut shape.positions {
            *position = [broken; 3];
        }
        assert_eq!(baked(with_mesh(&shape)).baked_objects, 3);
    }
}

#[test]
fn huge_and_tiny_vertices_bake() {
    for size in [f32::MAX, 1e30, 1e-30, f32::MIN_POSITIVE, f32::from_bits(1)] {
        let report = baked(with_mesh(&cuboid([size; 3])));
        println!("{size}: {} objects, notes {:?}", report.baked_objects, report.notes);
        assert!(report.baked_objects >= 3, "{size}");
    }
}

#[test]
fn triangles_without_area_are_left_out() {
    let flat = Shape { positions: vec![[1.0, 2.0, 3.0]; 3], uvs: Vec::new(), indices: vec![0, 1, 2] };
    assert_eq!(baked(with_mesh(&flat)).baked_objects, 3);
    let line =
        Shape { positions: vec![[0.0; 3], [1.0; 3], [2.0; 3]], uvs: Vec::new(), indices: vec![0, 1, 2] };
    baked(with_mesh(&line));
    let mut some = cuboid([0.5; 3]);
    some.indices.extend([0, 0, 1, 5, 5, 5]);
    assert_eq!(baked(with_mesh(&some)).baked_objects, 4);
}

#[test]
fn scales_of_any_sign_and_size_bake() {
    for (scale, counted) in [
        ([0.0, 0.0, 0.0], false),
        ([1.0, 0.0, 1.0], false),
        ([-1.0, 1.0, 1.0], true),
        ([-2.0, -2.0, -2.0], true),
        ([1e-20, 1.0, 1.0], true),
        ([1e20, 1.0, 1.0], true),
        ([1e-300, 1e-300, 1e-300], false),
        ([1e300, 1e300, 1e300], false),
    ] {
        let mut builder = Builder::new();
        let mesh = boxes(&mut builder);
        builder.node(None, json!({ "mesh": mesh, "scale": scale, "translation": [0, 2, 0] }));
        let report = baked(builder.finish());
        println!("{scale:?}: {} objects, notes {:?}", report.baked_objects, report.notes);
        assert!((3..=4).contains(&report.baked_objects));
        if scale.iter().all(|s: &f64| (0.1..10.0).contains(&s.abs())) {
            assert_eq!(report.baked_objects == 4, counted, "{scale:?}");
        }
    }
}

#[test]
fn few_and_no_objects_give_no_extension() {
    let mut empty_mesh = Builder::new();
    let mesh = empty_mesh.push("meshes", json!({ "primitives": [{ "attributes": {} }] }));
    empty_mesh.object(None, mesh, DVec3::ZERO);
    let mut one = Builder::new();
    let mesh = one.mesh(&cuboid([0.5; 3]), None);
    one.object(None, mesh, DVec3::ZERO);
    let mut unused = Builder::new();
    unused.mesh(&cuboid([0.5; 3]), None);
    let bare = Document::from_parts(json!({ "asset": { "version": "2.0" } }), None).expect("a document");
    for doc in [Builder::new().finish(), empty_mesh.finish(), one.finish(), unused.finish(), bare] {
        let report = baked(doc);
        assert_eq!((report.trees.len(), report.baked_objects), (0, 0));
    }
}

#[test]
fn files_without_scenes_bake() {
    let mut builder = Builder::new();
    boxes(&mut builder);
    let json = builder.json.as_object_mut().expect("an object");
    json.remove("scene");
    let mut with_default = builder.finish();
    baked(
        Document::from_parts(with_default.json.clone(), Some(with_default.buffers[0].clone()))
            .expect("a document"),
    );
    with_default.json.as_object_mut().expect("an object").remove("scenes");
    let report = baked(with_default);
    assert_eq!((report.objects, report.trees.len()), (3, 0), "a tree would have nothing to hang on");
}

#[test]
fn chains_of_ten_thousand_nodes_bake() {
    const LENGTH: usize = 10_000;
    for meshes_all_along in [false, true] {
        let mut builder = Builder::new();
        let mesh = builder.mesh(&cuboid([0.5; 3]), None);
        let mut nodes: Vec<Value> = (0..LENGTH)
            .map(|k| json!({ "children": [k + 1], "translation": [0.01, 0, 0] }))
            .chain([json!({ "mesh": mesh })])
            .collect();
        nodes[0]["mesh"] = mesh.into();
        if meshes_all_along {
            for node in &mut nodes {
                node["mesh"] = mesh.into();
            }
        }
        builder.json["nodes"] = nodes.into();
        builder.json["scenes"][0]["nodes"] = json!([0]);
        let report = baked(builder.finish());
        assert_eq!(report.baked_objects, if meshes_all_along { LENGTH + 1 } else { 2 });
    }
}

#[test]
fn graphs_that_are_no_trees_are_refused() {
    let with_children = |children: &[(usize, Value)]| {
        let mut builder = Builder::new();
        boxes(&mut builder);
        for (node, children) in children {
            builder.json["nodes"][*node]["children"] = children.clone();
        }
        builder.finish()
    };
    for children in [
        vec![(0, json!([0]))],
        vec![(0, json!([1])), (1, json!([0]))],
        vec![(0, json!([1])), (1, json!([2])), (2, json!([0]))],
    ] {
        let error = refused(with_children(&children));
        assert!(matches!(error, SceneError::Cycle { .. } | SceneError::TwoParents { .. }), "{error}");
    }
    let mut builder = Builder::new();
    let mesh = boxes(&mut builder);
    let shared = builder.push("nodes", json!({ "mesh": mesh }));
    builder.json["nodes"][0]["children"] = json!([shared]);
    builder.json["nodes"][1]["children"] = json!([shared]);
    let error = refused(builder.finish());
    assert!(matches!(error, SceneError::TwoParents { .. }), "{error}");
    let error = refused(with_children(&[(0, json!([77]))]));
    assert!(matches!(error, SceneError::IndexOutOfRange { .. }), "{error}");
}

#[test]
fn transforms_that_are_no_numbers_are_left_out() {
    let mut builder = Builder::new();
    let mesh = boxes(&mut builder);
    // 1e999 is a JSON number, but no f64.
    let huge: Value = serde_json::from_str("[1e999, 0, 0]").expect("JSON");
    builder.node(None, json!({ "mesh": mesh, "translation": huge }));
    builder.node(None, json!({ "mesh": mesh, "rotation": [0, 0, 0, 0] }));
    let mut doc = builder.finish();
    match bake::build(&mut doc, &options(RAYS), &Silent) {
        Ok(report) => assert!((3..=4).contains(&report.baked_objects), "{}", report.baked_objects),
        Err(error) => assert!(matches!(error, BakeError::Scene(_)), "{error}"),
    }
}
