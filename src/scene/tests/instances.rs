//! `EXT_mesh_gpu_instancing`.

use super::builder::{Builder, noted};
use crate::scene::{Role, SceneError};
use glam::DVec3;
use serde_json::{Value, json};

fn instanced(b: &mut Builder, attributes: Value) {
    let mesh = b.triangle();
    let extension = json!({"EXT_mesh_gpu_instancing": {"attributes": attributes}});
    b.node(json!({"mesh": mesh, "translation": [100, 0, 0], "extensions": extension}));
    b.scene(&[0]);
}

#[test]
fn each_instance_is_an_object() {
    let mut b = Builder::new();
    let translation = b.floats(&[[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [f32::NAN, 0.0, 0.0]]);
    let scale = b.floats(&[[1.0, 1.0, 1.0], [2.0, 2.0, 2.0], [1.0, 1.0, 1.0]]);
    // 90 degrees about z as normalized bytes, within their precision.
    let rotation = b.accessor(&[0, 0, 0, 127, 0, 0, 90, 90, 0, 0, 0, 127], 5120, "VEC4", 3);
    b.json["accessors"][rotation]["normalized"] = json!(true);
    instanced(&mut b, json!({"TRANSLATION": translation, "ROTATION": rotation, "SCALE": scale}));
    let scene = b.read().unwrap();
    let instances: Vec<_> = scene.objects.iter().map(|o| (o.node, o.instance, o.mesh, o.role)).collect();
    let (kept, out) = (Role::Static, Role::Excluded);
    assert_eq!(instances, [(0, Some(0), 0, kept), (0, Some(1), 0, kept), (0, Some(2), 0, out)]);
    let x = |i: usize| scene.objects[i].to_world.transform_point3(DVec3::X);
    assert_eq!(x(0), DVec3::new(102.0, 0.0, 0.0));
    assert!(x(1).distance(DVec3::new(102.0, 2.0, 0.0)) < 0.02, "{}", x(1));
    assert_eq!(scene.nodes[0].objects, 0..3);
    assert_eq!(noted(&scene, "TRANSFORM_NOT_FINITE"), 1);
}

#[test]
fn custom_attributes_alone_tell_the_count() {
    let mut b = Builder::new();
    let id = b.accessor(&[1, 2], 5121, "SCALAR", 2);
    instanced(&mut b, json!({"_ID": id}));
    let scene = b.read().unwrap();
    assert_eq!(scene.objects.len(), 2);
    assert_eq!(scene.objects[1].to_world.translation.x, 100.0);

    let mut b = Builder::new();
    instanced(&mut b, json!({}));
    assert_eq!(b.read().unwrap().objects.len(), 0);
}

#[test]
fn unequal_counts_and_broken_attributes_are_errors() {
    let mut b = Builder::new();
    let two = b.floats(&[[0.0; 3]; 2]);
    let three = b.floats(&[[1.0; 3]; 3]);
    instanced(&mut b, json!({"TRANSLATION": two, "SCALE": three}));
    assert!(matches!(b.read(), Err(SceneError::CountMismatch { count: 3, expected: 2, .. })));
    let path = "/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes";
    for (attributes, expected) in [
        (json!([]), "expected an object of accessors"),
        (json!({"TRANSLATION": 99}), "/TRANSLATION: index 99 is out of range"),
        (json!({"ROTATION": two}), "/ROTATION: "),
    ] {
        *b.json.pointer_mut(path).unwrap() = attributes;
        let error = b.error();
        assert!(error.starts_with(path) && error.contains(expected), "{error}");
    }
}

#[test]
fn a_small_file_cannot_ask_for_endless_objects() {
    let mut b = Builder::new();
    let translation = b.floats(&[[0.0; 3]; 20_000]);
    instanced(&mut b, json!({"TRANSLATION": translation}));
    let node = b.json["nodes"][0].clone();
    b.json["nodes"] = Value::Array(vec![node; 100]);
    b.json["scenes"] = json!([{"nodes": (0..100).collect::<Vec<_>>()}]);
    assert!(matches!(b.read(), Err(SceneError::TooLarge { what: "objects", .. })));
}
