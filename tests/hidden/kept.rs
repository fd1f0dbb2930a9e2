//! What stays although nobody sees it, and what hides nothing.

use crate::builder::{Builder, shell};
use crate::left;
use serde_json::{Value, json};

/// Room for no camera inside the boxes of these tests.
const TIGHT: Option<f64> = Some(0.55);

/// A closed box with `more` in its node, and a box in it.
fn boxed(material: usize, more: Value) -> (Builder, usize, usize) {
    let mut builder = Builder::new();
    let mesh = builder.mesh(&shell([1.0; 3], 1, &[]), material);
    let outer = builder.node("outer", mesh, more);
    let inner = builder.cube("inner", 0.5, [0.0; 3], 1);
    (builder, outer, inner)
}

#[test]
fn blended_and_alpha_tested_shells_hide_nothing() {
    assert_eq!(left(&boxed(2, json!({})).0, TIGHT).0, ["outer", "inner"], "BLEND");
    // Whatever the texture holds: its alpha may pass anywhere.
    let (mut builder, _, _) = boxed(3, json!({}));
    let points =
        builder.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"].as_u64().expect("an index");
    let count = builder.json["accessors"][points as usize]["count"].as_u64().expect("a count");
    let texels = vec![0u8; 8 * count as usize];
    let texels = builder.accessor(&texels, json!({"componentType": 5126, "count": count, "type": "VEC2"}));
    builder.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = texels.into();
    builder.json["materials"][3]["pbrMetallicRoughness"] = json!({"baseColorTexture": {"index": 0}});
    builder.json["textures"] = json!([{"source": 0}]);
    builder.json["images"] = json!([{"uri": "data:image/png;base64,AAAA"}]);
    assert_eq!(left(&builder, TIGHT).0, ["outer", "inner"], "MASK");
    // Without a texture alpha is 1 everywhere, and the surface as good as an opaque one.
    assert_eq!(left(&boxed(3, json!({})).0, TIGHT).0, ["outer"], "MASK that always passes");
}

#[test]
fn alpha_tested_objects_stay_and_blended_ones_are_judged() {
    let mut builder = boxed(1, json!({})).0;
    builder.cube("mask", 0.2, [0.0; 3], 3);
    builder.cube("blend", 0.2, [0.0; 3], 2);
    let (names, report, _) = left(&builder, TIGHT);
    assert_eq!(names, ["outer", "mask"]);
    assert_eq!((report.not_judged, report.objects_removed), (1, 2));
}

#[test]
fn what_moves_stays_and_hides_nothing() {
    let (mut builder, outer, _) = boxed(1, json!({}));
    builder.animate(outer);
    assert_eq!(left(&builder, TIGHT).0, ["outer", "inner"], "a moving shell");

    let (mut builder, _, inner) = boxed(1, json!({}));
    builder.animate(inner);
    assert_eq!(left(&builder, TIGHT).0, ["outer", "inner"], "moving content");

    // A door is the sixth face of a box.
    let mut builder = Builder::new();
    let mesh = builder.mesh(&shell([1.0; 3], 1, &[5]), 1);
    builder.node("box", mesh, json!({}));
    let door = builder.mesh(&shell([1.0; 3], 1, &[0, 1, 2, 3, 4]), 1);
    let door = builder.node("door", door, json!({}));
    builder.cube("inner", 0.5, [0.0; 3], 1);
    assert_eq!(left(&builder, TIGHT).0, ["box", "door"], "a fixed door");
    builder.animate(door);
    assert_eq!(left(&builder, TIGHT).0, ["box", "door", "inner"], "a moving door");
}

#[test]
fn what_a_run_time_may_switch_stays_and_hides_nothing() {
    for visible in [true, false] {
        let switch = json!({"extensions": {"KHR_node_visibility": {"visible": visible}}});
        let (mut builder, _, _) = boxed(1, switch.clone());
        builder.uses("KHR_node_visibility");
        assert_eq!(left(&builder, TIGHT).0, ["outer", "inner"], "shell, visible: {visible}");
        let (mut builder, _, inner) = boxed(1, json!({}));
        builder.uses("KHR_node_visibility");
        builder.json["nodes"][inner]["extensions"] = switch["extensions"].clone();
        assert_eq!(left(&builder, TIGHT).0, ["outer", "inner"], "content, visible: {visible}");
    }
}

#[test]
fn skinned_and_morphed_objects_stay() {
    let (mut builder, _, inner) = boxed(1, json!({}));
    builder.json["nodes"][inner]["skin"] = 0.into();
    builder.json["skins"] = json!([{"joints": [0]}]);
    assert_eq!(left(&builder, TIGHT).0, ["outer", "inner"]);
    let (mut builder, _, _) = boxed(1, json!({}));
    let position = builder.json["meshes"][1]["primitives"][0]["attributes"]["POSITION"].clone();
    builder.json["meshes"][1]["primitives"][0]["targets"] = json!([{"POSITION": position}]);
    assert_eq!(left(&builder, TIGHT).0, ["outer", "inner"]);
}

#[test]
fn what_another_scene_shows_stays() {
    let (mut builder, _, inner) = boxed(1, json!({}));
    builder.json["scenes"].as_array_mut().expect("scenes").push(json!({"nodes": [inner]}));
    assert_eq!(left(&builder, TIGHT).0, ["outer", "inner"]);
}

#[test]
fn lines_and_specks_stay() {
    let (mut builder, _, _) = boxed(1, json!({}));
    let mesh = builder.mesh(&shell([0.2; 3], 1, &[]), 1);
    let mut line = builder.json["meshes"][mesh]["primitives"][0].clone();
    line["mode"] = 1.into();
    builder.json["meshes"][mesh]["primitives"].as_array_mut().expect("primitives").push(line);
    builder.node("wire", mesh, json!({}));
    builder.cube("speck", 2e-5, [0.0; 3], 1);
    let (names, report, _) = left(&builder, TIGHT);
    assert_eq!(names, ["outer", "wire", "speck"]);
    assert_eq!((report.not_judged, report.tiny), (1, 1));
}

#[test]
fn a_node_keeps_all_of_its_instances_or_none() {
    for (far, expected) in [(0.0f32, &["outer"][..]), (3.0, &["outer", "instances"][..])] {
        let mut builder = Builder::new();
        let mesh = builder.mesh(&shell([1.0; 3], 1, &[]), 1);
        builder.node("outer", mesh, json!({}));
        let places = builder.positions(&[[0.2, 0.0, 0.0], [far, 0.1, 0.0]]);
        let instances = json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": places}}});
        let content = builder.mesh(&shell([0.3; 3], 1, &[]), 1);
        builder.node("instances", content, json!({"extensions": instances}));
        builder.uses("EXT_mesh_gpu_instancing");
        let (names, report, document) = left(&builder, TIGHT);
        assert_eq!(names, expected);
        assert_eq!(report.objects, 3);
        assert!(document.accessor(places).expect("placed").read_vec3_f64().is_ok());
    }
}

#[test]
fn a_node_that_goes_keeps_everything_but_its_mesh() {
    let (mut builder, _, inner) = boxed(1, json!({}));
    builder.json["nodes"][inner]["extras"] = json!({"id": 1.50});
    let child = builder.cube("child", 0.2, [5.0, 0.0, 0.0], 1);
    let roots = builder.json["scenes"][0]["nodes"].as_array_mut().expect("roots");
    roots.retain(|root| root != child);
    builder.json["nodes"][inner]["children"] = json!([child]);
    let mut expected = builder.json["nodes"].clone();
    expected[inner].as_object_mut().expect("a node").shift_remove("mesh");
    let (_, report, document) = left(&builder, TIGHT);
    assert_eq!(report.objects_removed, 1);
    assert_eq!(document.json["nodes"].to_string(), expected.to_string());
    let count = |json: &Value, key: &str| json[key].as_array().expect("an array").len();
    for key in ["nodes", "meshes", "materials", "accessors", "bufferViews"] {
        assert_eq!(count(&document.json, key), count(&builder.json, key), "{key}");
    }
}
