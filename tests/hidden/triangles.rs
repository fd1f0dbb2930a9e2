//! Triangles of objects that stay.

use crate::builder::{Builder, Shape, shell};
use crate::options;
use serde_json::json;
use svs::bake::Silent;
use svs::gltf::Document;
use svs::hidden::{HiddenReport, RemoveMode, remove};
use svs::scene::{ReadOptions, read_scene};

fn without_hidden(builder: &Builder, clearance: f64) -> (Document, HiddenReport) {
    let mut document = builder.document();
    let report =
        remove(&mut document, &options(RemoveMode::Triangles, Some(clearance)), &Silent).expect("a scene");
    (document, report)
}

/// A strip of `cells` squares of 0.1 m along x, two-sided, from -1 m on.
fn ribbon(cells: u32) -> Shape {
    let points =
        (0..=cells).flat_map(|i| [[i as f32 * 0.1 - 1.0, 0.0, -0.05], [i as f32 * 0.1 - 1.0, 0.0, 0.05]]);
    let indices = (0..cells).flat_map(|i| [0, 1, 3, 0, 3, 2].map(|corner| 2 * i + corner));
    Shape { points: points.collect(), indices: indices.collect() }
}

/// A box with a ribbon that reaches into it from outside: 40 squares, half of them in the box.
fn pierced() -> Builder {
    let mut builder = Builder::new();
    let mesh = builder.mesh(&shell([1.0; 3], 1, &[]), 1);
    builder.node("box", mesh, json!({}));
    let mesh = builder.mesh(&ribbon(40), 1);
    builder.node("ribbon", mesh, json!({"translation": [0.05, 0.0, 0.0]}));
    builder
}

#[test]
fn hidden_triangles_go_and_neighbours_of_visible_ones_stay() {
    let (document, report) = without_hidden(&pierced(), 1.1);
    // 19.5 squares are inside; the one in the wall is seen, and its neighbours (in front of it) stay.
    assert_eq!(report.objects_removed, 0);
    let removed = report.triangles_removed_of_kept;
    assert!((35..=37).contains(&removed), "{report:?}");
    assert_eq!(report.triangles_removed, removed);
    let scene = read_scene(&document, &ReadOptions::default()).expect("a scene");
    assert_eq!(u64::from(scene.meshes[1].drawn_triangles), 80 - removed);
    assert_eq!(scene.meshes[0].drawn_triangles, 12, "the box has lost none");
    // What is left is in the old order.
    let old = read_scene(&pierced().document(), &ReadOptions::default()).expect("a scene");
    let corners = |scene: &svs::scene::Scene| -> Vec<[[f64; 3]; 3]> {
        let mesh = &scene.meshes[1];
        let place = |v: u32| (mesh.positions[v as usize].as_dvec3() + mesh.origin).to_array();
        mesh.triangles.iter().map(|triangle| triangle.map(place)).collect()
    };
    let round = |all: Vec<[[f64; 3]; 3]>| -> Vec<[[i64; 3]; 3]> {
        all.into_iter().map(|t| t.map(|p| p.map(|x| (x * 1e4).round() as i64))).collect()
    };
    let (old, new) = (round(corners(&old)), round(corners(&scene)));
    let mut rest = old.iter();
    assert!(new.iter().all(|triangle| rest.any(|other| other == triangle)), "order changed");
}

#[test]
fn a_triangle_stays_if_one_instance_shows_it() {
    let mut builder = pierced();
    // The same ribbon once more where nothing hides it.
    builder.node("free", 1, json!({"translation": [0.0, 3.0, 0.0]}));
    let (_, report) = without_hidden(&builder, 1.1);
    assert_eq!(report.triangles_removed, 0, "{report:?}");
    // And once more where all of it is hidden: that object goes, the triangles stay.
    let mut builder = pierced();
    builder.node("free", 1, json!({"translation": [0.0, 3.0, 0.0]}));
    builder.node("hidden", 1, json!({"scale": [0.2, 0.2, 0.2]}));
    let (_, report) = without_hidden(&builder, 1.1);
    assert_eq!((report.objects_removed, report.triangles_removed), (1, 80), "{report:?}");
    assert_eq!((report.triangles_removed_of_kept, report.bytes_released), (0, 0));
}

#[test]
fn triangles_of_a_mesh_with_an_unjudged_user_stay() {
    let mut builder = pierced();
    let moving = builder.node("moving", 1, json!({}));
    builder.animate(moving);
    assert_eq!(without_hidden(&builder, 1.1).1.triangles_removed, 0);
    // A node that no scene reaches.
    let mut builder = pierced();
    builder.node("spare", 1, json!({}));
    builder.json["scenes"][0]["nodes"].as_array_mut().expect("roots").pop();
    assert_eq!(without_hidden(&builder, 1.1).1.triangles_removed, 0);
}

#[test]
fn strips_and_primitives_without_indices_become_lists() {
    let list = without_hidden(&pierced(), 1.1).1.triangles_removed;
    // The ribbon's points are in the order of a strip.
    let mut builder = pierced();
    let primitive = &mut builder.json["meshes"][1]["primitives"][0];
    primitive["mode"] = 5.into();
    primitive.as_object_mut().expect("a primitive").shift_remove("indices");
    let (document, report) = without_hidden(&builder, 1.1);
    assert!(report.triangles_removed.abs_diff(list) <= 2, "{report:?}");
    let primitive = &document.json["meshes"][1]["primitives"][0];
    assert_eq!(primitive["mode"], 4);
    let indices = primitive["indices"].as_u64().expect("indices") as usize;
    let count = document.accessor(indices).expect("indices").count as u64;
    assert_eq!(count, 3 * (80 - report.triangles_removed));
}

#[test]
fn a_primitive_that_nobody_sees_keeps_one_triangle() {
    let mut builder = pierced();
    let hidden = builder.mesh(&shell([0.1; 3], 2, &[]), 1);
    let primitive = builder.json["meshes"][hidden]["primitives"][0].clone();
    builder.json["meshes"][1]["primitives"].as_array_mut().expect("primitives").push(primitive);
    let (document, report) = without_hidden(&builder, 1.1);
    assert_eq!(report.objects_removed, 0);
    let scene = read_scene(&document, &ReadOptions::default()).expect("a scene");
    assert_eq!(u64::from(scene.meshes[1].drawn_triangles), 128 - report.triangles_removed);
    let indices = document.json["meshes"][1]["primitives"][1]["indices"].as_u64().expect("indices");
    assert_eq!(document.accessor(indices as usize).expect("indices").count, 3);
}
