//! Invariants of every scene that is read, on random trees and on randomly damaged documents.

use super::builder::Builder;
use crate::gltf::Document;
use crate::scene::{Opacity, ReadOptions, Role, Scene, read_scene};
use glam::DAffine3;
use proptest::prelude::*;
use serde_json::{Value, json};

/// Panics unless the scene keeps what its types promise.
pub(super) fn check(scene: &Scene) {
    for mesh in &scene.meshes {
        assert!(mesh.origin.is_finite() && mesh.positions.iter().all(|p| p.is_finite()));
        assert!(mesh.triangles.iter().flatten().all(|&v| (v as usize) < mesh.positions.len()));
        assert!(mesh.triangles.iter().all(|[a, b, c]| a != b && b != c && c != a));
        assert!(mesh.triangles.len() as u64 <= u64::from(mesh.drawn_triangles));
        let masked = mesh.surfaces.iter().any(|s| matches!(s.opacity, Opacity::Mask(_)));
        assert_eq!(mesh.uvs.len(), if masked { mesh.positions.len() } else { 0 });
        assert!(mesh.uvs.iter().all(|uv| uv.is_finite()));
        let mut end = 0;
        for surface in &mesh.surfaces {
            assert!(surface.triangles.start == end && surface.triangles.end > end);
            end = surface.triangles.end;
        }
        assert_eq!(end as usize, mesh.triangles.len());
        if !mesh.is_empty() {
            let slack = (mesh.max - mesh.min).length() * 1e-4 + 1e-30;
            for p in &mesh.positions {
                let p = p.as_dvec3() + mesh.origin;
                assert!(p.cmpge(mesh.min - slack).all() && p.cmple(mesh.max + slack).all());
            }
        }
    }
    for (i, node) in scene.nodes.iter().enumerate() {
        assert!(node.to_world.is_finite());
        assert!(node.subtree_end as usize > i && node.subtree_end as usize <= scene.nodes.len());
        if let Some(parent) = node.parent {
            let parent = &scene.nodes[parent as usize];
            assert!((node.parent.unwrap() as usize) < i && node.subtree_end <= parent.subtree_end);
            assert!(parent.objects.start <= node.objects.start && node.objects.end <= parent.objects.end);
        }
    }
    for (i, object) in scene.objects.iter().enumerate() {
        let node = &scene.nodes[object.scene_node as usize];
        assert_eq!(node.node, object.node);
        assert!(node.objects.contains(&(i as u32)));
        assert!(object.to_world.is_finite());
        let mesh = &scene.meshes[object.mesh as usize];
        if object.role == Role::Static {
            assert!(!mesh.is_empty() && object.to_world.inverse().is_finite());
        }
    }
}

/// A document with something of everything.
fn rich() -> Builder {
    let mut b = Builder::new();
    let png = image::RgbaImage::from_fn(2, 2, |x, _| image::Rgba([0, 0, 0, 255 * x as u8]));
    let mut bytes = std::io::Cursor::new(Vec::new());
    png.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    let view = b.view(&bytes.into_inner());
    b.push("images", json!({"bufferView": view}));
    b.push("samplers", json!({"wrapS": 33071, "wrapT": 33648}));
    b.push("textures", json!({"source": 0, "sampler": 0}));
    let transform = json!({"KHR_texture_transform": {"scale": [2, 2], "rotation": 1, "texCoord": 0}});
    b.push(
        "materials",
        json!({"alphaMode": "MASK", "alphaCutoff": 0.5, "doubleSided": true, "pbrMetallicRoughness":
            {"baseColorFactor": [1, 1, 1, 1], "baseColorTexture": {"index": 0, "extensions": transform}}}),
    );
    b.push("materials", json!({"alphaMode": "BLEND"}));
    let position = b.positions(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 1.0]]);
    let uv = b.floats(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]);
    let indices = b.indices(&[0, 1, 2, 1, 3, 2]);
    let mesh = b.mesh(json!([
        {"attributes": {"POSITION": position, "TEXCOORD_0": uv}, "indices": indices, "material": 0},
        {"attributes": {"POSITION": position}, "mode": 5, "material": 1},
    ]));
    let plain = b.mesh(json!([{"attributes": {"POSITION": position}, "indices": indices}]));
    let translation = b.floats(&[[1.0; 3], [2.0; 3]]);
    let instancing = json!({"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": translation}}});
    b.node(json!({"children": [1, 2], "translation": [1, 2, 3]}));
    b.node(json!({"mesh": mesh, "rotation": [0, 0, 0, 1], "extensions": instancing}));
    b.node(json!({"mesh": plain, "scale": [1, 2, -1], "children": [3]}));
    b.node(json!({"mesh": mesh, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}));
    b.scene(&[0]);
    b.json["scene"] = json!(0);
    b.push("animations", json!({"channels": [{"target": {"node": 3, "path": "scale"}}]}));
    b
}

/// All values of a document that a reader may look at, by pointer.
fn pointers(value: &Value, prefix: &str, out: &mut Vec<String>) {
    let children: Vec<(String, &Value)> = match value {
        Value::Array(items) => items.iter().enumerate().map(|(i, v)| (i.to_string(), v)).collect(),
        Value::Object(map) => map.iter().map(|(k, v)| (k.clone(), v)).collect(),
        _ => return,
    };
    for (key, child) in children {
        let pointer = format!("{prefix}/{key}");
        pointers(child, &pointer, out);
        out.push(pointer);
    }
}

fn junk() -> impl Strategy<Value = Value> {
    prop_oneof![
        Just(Value::Null),
        (-3_i64..12).prop_map(|i| json!(i)),
        any::<f64>().prop_map(|f| json!(f)),
        Just(serde_json::from_str("1e999").unwrap()),
        Just(json!(u64::MAX)),
        Just(json!(u32::MAX)),
        Just(json!([])),
        Just(json!([0, 0, 0])),
        Just(json!([1, 2, 3, 0])),
        Just(json!({})),
        Just(json!(true)),
        Just(json!("MASK")),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, ..ProptestConfig::default() })]

    #[test]
    fn damaged_documents_are_errors_or_sound_scenes(
        damages in prop::collection::vec((any::<prop::sample::Index>(), junk()), 1..4),
        bytes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..4),
    ) {
        let sound = rich().document();
        let mut json = sound.json.clone();
        for (place, value) in damages {
            let mut all = Vec::new();
            pointers(&json, "", &mut all);
            all.retain(|pointer| !pointer.starts_with("/asset"));
            if let Some(target) = json.pointer_mut(place.get(all.as_slice()).as_str()) {
                *target = value;
            }
        }
        let mut bin = sound.buffers[0].clone();
        for (place, byte) in bytes {
            let place = place.index(bin.len());
            bin[place] = byte;
        }
        // Damage that the container refuses is not this reader's concern.
        if let Ok(doc) = Document::from_parts(json, Some(bin)) {
            match read_scene(&doc, &ReadOptions::default()) {
                Ok(scene) => check(&scene),
                Err(error) => prop_assert!(error.to_string().starts_with('/'), "{}", error),
            }
        }
    }

    #[test]
    fn random_trees_match_a_recursive_walk(
        parents in prop::collection::vec(any::<prop::sample::Index>(), 1..40),
        with_mesh in prop::collection::vec(any::<bool>(), 40),
    ) {
        let mut b = Builder::new();
        b.triangle();
        let mut children = vec![Vec::new(); parents.len()];
        let mut roots = Vec::new();
        for (n, parent) in parents.iter().enumerate() {
            // Node n hangs below an earlier node or is a root.
            match parent.index(n + 1) {
                p if p == n => roots.push(n),
                p => children[p].push(n),
            }
        }
        for (n, children) in children.iter().enumerate() {
            let mut node = json!({"translation": [n, 1, 0], "children": children});
            if with_mesh[n] {
                node["mesh"] = json!(0);
            }
            b.node(node);
        }
        b.scene(&roots);
        let scene = b.read().unwrap();
        check(&scene);

        fn walk(n: usize, world: DAffine3, children: &[Vec<usize>], mesh: &[bool], out: &mut Vec<(usize, DAffine3)>) {
            let world = world * DAffine3::from_translation(glam::DVec3::new(n as f64, 1.0, 0.0));
            if mesh[n] {
                out.push((n, world));
            }
            for &child in &children[n] {
                walk(child, world, children, mesh, out);
            }
        }
        let mut expected = Vec::new();
        for &root in &roots {
            walk(root, DAffine3::IDENTITY, &children, &with_mesh, &mut expected);
        }
        let found: Vec<_> = scene.objects.iter().map(|o| (o.node, o.to_world)).collect();
        prop_assert_eq!(found, expected);
        prop_assert_eq!(scene.nodes.len(), parents.len());
    }
}

#[test]
fn the_document_that_is_damaged_is_sound() {
    let scene = rich().read().unwrap();
    check(&scene);
    assert_eq!((scene.objects.len(), scene.meshes.len()), (4, 2));
    assert!(scene.notes.is_empty(), "{:?}", scene.notes);
}

#[test]
fn results_do_not_depend_on_the_thread_count() {
    let mut b = rich();
    b.json["meshes"][1]["primitives"].as_array_mut().unwrap().push(json!({"mode": 0}));
    let doc = b.document();
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        format!("{:?}", pool.install(|| read_scene(&doc, &ReadOptions::default())).unwrap())
    };
    assert_eq!(with(1), with(4));
}
