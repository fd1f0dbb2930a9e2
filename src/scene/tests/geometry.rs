//! Primitives to triangles.

use super::builder::{Builder, noted, points};
use crate::scene::{Role, SceneError};
use glam::DVec3;
use serde_json::json;

const QUAD: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [2.0, 2.0, 0.0]];

/// Twice the signed area along z.
fn area_z([a, b, c]: [[f64; 3]; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[test]
fn strips_and_fans_become_triangles_that_face_the_same_way() {
    for (mode, order) in [(5, [0, 1, 2, 3]), (6, [0, 1, 3, 2])] {
        let mut b = Builder::new();
        let position = b.positions(&QUAD);
        let indices = b.indices(&order);
        let b = b.with_primitives(
            json!([{"attributes": {"POSITION": position}, "indices": indices, "mode": mode}]),
        );
        let scene = b.read().unwrap();
        let mesh = &scene.meshes[0];
        assert_eq!((mesh.triangles.len(), mesh.drawn_triangles, mesh.positions.len()), (2, 2, 4));
        assert!(points(&scene, 0).into_iter().all(|triangle| area_z(triangle) == 4.0), "mode {mode}");
        assert_eq!((mesh.min, mesh.max), (DVec3::ZERO, DVec3::new(2.0, 2.0, 0.0)));
        assert_eq!(mesh.origin, DVec3::new(1.0, 1.0, 0.0));
        assert_eq!(mesh.bytes, 4 * 12 + 4 * 2);
        assert_eq!(scene.objects[0].role, Role::Static);
    }
}

#[test]
fn broken_and_flat_triangles_are_counted_but_not_kept() {
    let mut b = Builder::new();
    let mut quad = QUAD.to_vec();
    quad.extend([[f32::NAN, 0.0, 0.0], [0.0, f32::INFINITY, 0.0], [4.0, 0.0, 0.0]]);
    let position = b.positions(&quad);
    let indices = b.indices(&[
        0, 1, 2, /**/ 0, 1, 4, /**/ 0, 5, 1, /**/ 1, 1, 2, /**/ 0, 1, 6, /**/ 3,
    ]);
    let b = b.with_primitives(json!([{"attributes": {"POSITION": position}, "indices": indices}]));
    let scene = b.read().unwrap();
    let mesh = &scene.meshes[0];
    assert_eq!((mesh.triangles.len(), mesh.drawn_triangles), (1, 5));
    assert_eq!(mesh.positions.len(), 3, "only vertices in use");
    assert!(mesh.positions.iter().all(|p| p.is_finite()));
    assert_eq!((noted(&scene, "VERTEX_NOT_FINITE"), noted(&scene, "DEGENERATE_TRIANGLE")), (2, 2));
    // serde_json writes the infinite maximum as null: the box is that of the finite positions.
    assert_eq!((mesh.min, mesh.max), (DVec3::ZERO, DVec3::new(4.0, 2.0, 0.0)));
    assert_eq!(noted(&scene, "BOUNDS_WRONG"), 1);
}

#[test]
fn stated_bounds_are_taken_if_they_hold_the_data() {
    let bounds = |min: f64, max: f64| {
        let mut b = Builder::new();
        let position = b.positions(&QUAD);
        b.json["accessors"][position]["min"] = json!([min, min, min]);
        b.json["accessors"][position]["max"] = json!([max, max, max]);
        let b = b.with_primitives(json!([{"attributes": {"POSITION": position}}]));
        let scene = b.read().unwrap();
        (scene.meshes[0].min.x, scene.meshes[0].max.x, noted(&scene, "BOUNDS_WRONG"))
    };
    assert_eq!(bounds(-5.0, 5.0), (-5.0, 5.0, 0));
    assert_eq!(bounds(-5.0, 1.0), (0.0, 2.0, 1));
    assert_eq!(bounds(5.0, -5.0), (0.0, 2.0, 1));
}

#[test]
fn far_meshes_keep_their_precision() {
    let mut b = Builder::new();
    let far = 8_388_608.0; // 2^23: one f32 step is a metre.
    let position = b.positions(&[[far, 0.0, 0.0], [far + 1.0, 0.0, 0.0], [far, 1.0, 0.0]]);
    let b = b.with_primitives(json!([{"attributes": {"POSITION": position}}]));
    let scene = b.read().unwrap();
    assert_eq!(scene.meshes[0].origin, DVec3::new(f64::from(far) + 0.5, 0.5, 0.0));
    assert_eq!(points(&scene, 0)[0][1], [f64::from(far) + 1.0, 0.0, 0.0]);
}

#[test]
fn lines_points_and_meshes_without_positions_draw_nothing() {
    let mut b = Builder::new();
    let position = b.positions(&QUAD);
    for mode in 0..4 {
        let mesh = b.mesh(json!([{"attributes": {"POSITION": position}, "mode": mode}]));
        b.node(json!({"mesh": mesh}));
    }
    let none = b.mesh(json!([{"attributes": {"NORMAL": position}}, {}]));
    b.node(json!({"mesh": none}));
    let empty = b.mesh(json!([]));
    b.node(json!({"mesh": empty}));
    b.push("meshes", json!({}));
    b.node(json!({"mesh": 6}));
    b.scene(&[0, 1, 2, 3, 4, 5, 6]);
    let scene = b.read().unwrap();
    assert_eq!(scene.objects.len(), 7);
    assert!(scene.objects.iter().all(|o| o.role == Role::Excluded));
    assert!(scene.meshes.iter().all(|m| m.is_empty() && m.drawn_triangles == 0 && m.min.x > m.max.x));
    let count = |code| noted(&scene, code);
    assert_eq!((count("LINES_OR_POINTS"), count("NO_POSITION"), count("NO_TRIANGLES")), (4, 2, 7));
}

#[test]
fn a_vertex_index_out_of_range_is_an_error() {
    let mut b = Builder::new();
    let position = b.positions(&QUAD);
    let indices = b.indices(&[0, 1, 4]);
    let b = b.with_primitives(json!([{"attributes": {"POSITION": position}, "indices": indices}]));
    match b.read().unwrap_err() {
        SceneError::VertexIndexOutOfRange { pointer, index: 4, vertices: 4 } => {
            assert_eq!(pointer, "/meshes/0/primitives/0/indices");
        }
        other => panic!("{other}"),
    }
}

#[test]
fn normalized_and_plain_integers_are_positions() {
    let shorts: Vec<u8> = [[0_i16, 0, 0], [32767, 0, 0], [0, -32768, 0]]
        .iter()
        .flatten()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    for (normalized, unit, low) in [(true, 1.0, -1.0), (false, 32767.0, -32768.0)] {
        let mut b = Builder::new();
        let position = b.accessor(&shorts, 5122, "VEC3", 3);
        b.json["accessors"][position]["normalized"] = json!(normalized);
        // Stored values, whether normalized or not.
        b.json["accessors"][position]["min"] = json!([0, -32768, 0]);
        b.json["accessors"][position]["max"] = json!([32767, 0, 0]);
        let b = b.with_primitives(json!([{"attributes": {"POSITION": position}}]));
        let scene = b.read().unwrap();
        let mesh = &scene.meshes[0];
        assert_eq!((mesh.min, mesh.max), (DVec3::new(0.0, low, 0.0), DVec3::new(unit, 0.0, 0.0)));
        assert_eq!(points(&scene, 0), [[[0.0; 3], [unit, 0.0, 0.0], [0.0, low, 0.0]]]);
        assert!(scene.notes.is_empty(), "{:?}", scene.notes);
    }
}

#[test]
fn sparse_positions_are_substituted() {
    let mut b = Builder::new();
    let position = b.positions(&[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]]);
    let indices = b.view(&[2]);
    let values: Vec<u8> = [0.0_f32, 3.0, 0.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    let values = b.view(&values);
    b.json["accessors"][position]["max"] = json!([1, 3, 0]);
    b.json["accessors"][position]["sparse"] = json!({
        "count": 1,
        "indices": {"bufferView": indices, "componentType": 5121},
        "values": {"bufferView": values}
    });
    let b = b.with_primitives(json!([{"attributes": {"POSITION": position}}]));
    let scene = b.read().unwrap();
    assert_eq!(points(&scene, 0)[0][2], [0.0, 3.0, 0.0]);
}

#[test]
fn primitives_and_meshes_may_share_one_accessor() {
    let mut b = Builder::new();
    let position = b.positions(&QUAD);
    let (low, high) = (b.indices(&[0, 1, 2]), b.indices(&[1, 3, 2]));
    let primitive = |indices: usize| json!({"attributes": {"POSITION": position}, "indices": indices});
    let both = b.mesh(json!([primitive(low), primitive(high)]));
    let one = b.mesh(json!([primitive(high)]));
    b.node(json!({"mesh": both}));
    b.node(json!({"mesh": one}));
    b.scene(&[0, 1]);
    let scene = b.read().unwrap();
    let sizes: Vec<_> =
        scene.meshes.iter().map(|m| (m.positions.len(), m.triangles.len(), m.bytes)).collect();
    assert_eq!(sizes, [(4, 2, 48 + 12), (3, 1, 48 + 6)]);
    assert_eq!(points(&scene, 0)[1], points(&scene, 1)[0]);
}

#[test]
fn compressed_geometry_names_the_way_out() {
    let mut b = Builder::new();
    let position = b.push("accessors", json!({"componentType": 5126, "type": "VEC3", "count": 3}));
    let draco = json!({"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}});
    let b = b.with_primitives(json!([{"attributes": {"POSITION": position}, "extensions": draco}]));
    let error = b.error();
    assert!(error.contains("KHR_draco_mesh_compression") && error.contains("gltf-transform copy"), "{error}");

    for name in ["EXT_meshopt_compression", "KHR_meshopt_compression"] {
        let json = json!({
            "asset": {"version": "2.0"},
            "buffers": [{"byteLength": 4}, {"byteLength": 36, "extensions": {name: {"fallback": true}}}],
            "bufferViews": [{"buffer": 1, "byteLength": 36, "extensions": {name: {"buffer": 0}}}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "nodes": [{"mesh": 0}],
            "scenes": [{"nodes": [0]}]
        });
        let doc = crate::gltf::Document::from_parts(json, Some(vec![0; 4])).unwrap();
        // There is a decoder; what it gets here is nothing.
        let error = crate::scene::read_scene(&doc, &Default::default()).unwrap_err();
        assert!(matches!(&error, SceneError::Accessor { .. }), "{error}");
        assert!(error.to_string().contains(&format!("/bufferViews/0/extensions/{name}/count")), "{error}");
    }
}

#[test]
fn data_behind_a_compression_fallback_is_read() {
    let mut b = Builder::new();
    let position = b.positions(&QUAD);
    b.json["bufferViews"][0]["extensions"] = json!({"EXT_meshopt_compression": {"buffer": 1}});
    let draco = json!({"KHR_draco_mesh_compression": {"bufferView": 9, "attributes": {}}});
    let b = b.with_primitives(json!([{"attributes": {"POSITION": position}, "extensions": draco}]));
    assert_eq!(b.read().unwrap().meshes[0].triangles.len(), 1);
}

#[test]
fn a_small_file_cannot_ask_for_endless_triangles() {
    let mut b = Builder::new();
    let points: Vec<[f32; 3]> = (0..3000).map(|i| [i as f32, (i % 7) as f32, 0.0]).collect();
    let position = b.positions(&points);
    let primitives: Vec<_> = (0..8000).map(|_| json!({"attributes": {"POSITION": position}})).collect();
    let b = b.with_primitives(json!(primitives));
    assert!(matches!(b.read(), Err(SceneError::TooLarge { .. })));
}

#[test]
fn meshes_pick_their_vertices_from_one_big_accessor() {
    let mut b = Builder::new();
    let all: Vec<[f32; 3]> = (0..9000_u16).map(|i| [f32::from(i), f32::from((i % 3).pow(2)), 0.0]).collect();
    let position = b.positions(&all);
    for first in [0, 6000] {
        let indices = b.indices(&[first, first + 1, first + 2, first + 1, first + 3, first + 2]);
        let mesh = b.mesh(json!([{"attributes": {"POSITION": position}, "indices": indices}]));
        b.node(json!({"mesh": mesh}));
    }
    b.scene(&[0, 1]);
    let scene = b.read().unwrap();
    for (mesh, first) in [(0, 0.0), (1, 6000.0)] {
        assert_eq!(scene.meshes[mesh].positions.len(), 4);
        assert_eq!(
            points(&scene, mesh)[1],
            [[first + 1.0, 1.0, 0.0], [first + 3.0, 0.0, 0.0], [first + 2.0, 4.0, 0.0]]
        );
        assert_eq!(scene.meshes[mesh].max.x, 8999.0, "the box a loader sees");
    }
}
