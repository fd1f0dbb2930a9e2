//! What leaves the file, and what must not.

use crate::builder::{Builder, shell};
use crate::{left, options};
use proptest::prelude::*;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use svs::bake::Silent;
use svs::gltf::{Document, release};
use svs::hidden::{HiddenError, HiddenOptions, RemoveMode, remove};

/// A closed box with ten different boxes in it.
fn full_box() -> Builder {
    let mut builder = Builder::new();
    let mesh = builder.mesh(&shell([1.0; 3], 4, &[]), 1);
    builder.node("outer", mesh, json!({}));
    for number in 0..10 {
        builder.cube(&format!("inner {number}"), 0.3 + 0.01 * number as f32, [0.0; 3], 1);
    }
    builder
}

const TIGHT: Option<f64> = Some(0.55);

#[test]
fn bytes_of_removed_objects_leave_the_buffer() {
    let builder = full_box();
    let (_, report, document) = left(&builder, TIGHT);
    assert_eq!(report.objects_removed, 10);
    // Each has 24 points of 12 bytes and 36 indices of 2.
    assert!((3_540..=3_600).contains(&report.bytes_released), "{report:?}");
    assert_eq!(document.buffers[0].len() as u64, builder.bin.len() as u64 - report.bytes_released);
    assert_eq!(report.bytes_after, document.bytes());
    // What stays reads as before, also from a written file.
    let again = Document::from_glb(&document.to_glb().expect("written")).expect("read");
    let before = builder.document();
    for accessor in 0..2 {
        let (old, new) = (before.accessor(accessor).expect("old"), again.accessor(accessor).expect("new"));
        assert_eq!(old.count, new.count);
    }
    let points = |document: &Document| document.accessor(0).expect("points").read_vec3_f64().expect("points");
    assert_eq!(points(&before), points(&again));
}

#[test]
fn a_second_run_and_any_number_of_threads_give_the_same_bytes() {
    for mode in [RemoveMode::Objects, RemoveMode::Triangles] {
        let run = |document: &mut Document| {
            remove(document, &options(mode, TIGHT), &Silent).expect("a scene");
            document.to_glb().expect("written")
        };
        let first = run(&mut full_box().document());
        let single = rayon_pool(1, || run(&mut full_box().document()));
        assert!(first == single, "threads matter");
        let mut again = Document::from_glb(&first).expect("read");
        assert!(run(&mut again) == first, "a second run changes the file");
    }
}

fn rayon_pool<R: Send>(threads: usize, work: impl FnOnce() -> R + Send) -> R {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads").install(work)
}

#[test]
fn nothing_hidden_changes_nothing() {
    let mut builder = Builder::new();
    builder.cube("alone", 1.0, [0.0; 3], 1);
    let (_, report, document) = left(&builder, None);
    assert_eq!(
        (report.bytes_before, report.bytes_after, report.estimated_missing_ppm),
        (report.bytes_after, report.bytes_before, 0.0)
    );
    assert_eq!(document.json.to_string(), builder.document().json.to_string());
    assert_eq!(document.buffers, builder.document().buffers);
}

#[test]
fn files_that_may_refer_to_data_in_other_ways_keep_it() {
    for place in ["declared", "present"] {
        let mut builder = full_box();
        match place {
            "declared" => builder.uses("EXT_structural_metadata"),
            _ => builder.json["materials"][0]["extensions"] = json!({"VENDOR_thing": {"table": 0}}),
        }
        let (names, report, document) = left(&builder, TIGHT);
        assert_eq!(names, ["outer"], "{place}");
        assert_eq!(report.bytes_released, 0);
        let reason = report.bytes_kept_because.expect("a reason");
        assert!(reason.contains("EXT_structural_metadata") || reason.contains("VENDOR_thing"), "{reason}");
        assert_eq!(document.buffers[0], builder.bin);
    }
}

#[test]
fn data_that_others_use_stays() {
    let mut builder = full_box();
    // Inner box 3 is drawn with another material outside, inner box 5 shares its points only.
    let mut primitive = builder.json["meshes"][4]["primitives"][0].clone();
    primitive["material"] = 0.into();
    let meshes = builder.json["meshes"].as_array_mut().expect("meshes");
    meshes.push(json!({"primitives": [primitive]}));
    let mesh = meshes.len() - 1;
    builder.node("outside", mesh, json!({"translation": [5, 0, 0]}));
    let before = builder.document();
    let (names, report, document) = left(&builder, TIGHT);
    assert_eq!((names.as_slice(), report.objects_removed), (&["outer".into(), "outside".into()][..], 10));
    let pointer = |key: &str| format!("/meshes/{mesh}/primitives/0/{key}");
    let accessor = |key: &str| before.json.pointer(&pointer(key)).and_then(Value::as_u64).expect("an index");
    let (points, indices) = (accessor("attributes/POSITION") as usize, accessor("indices") as usize);
    let read = |document: &Document| {
        let points = document.accessor(points).expect("points").read_vec3_f64().expect("points");
        (points, document.accessor(indices).expect("indices").read_indices_u32().expect("indices"))
    };
    assert_eq!(read(&before), read(&document));
    assert!((3_100..3_250).contains(&report.bytes_released), "{report:?}");
}

#[test]
fn a_gltf_with_external_buffers_gets_a_file_of_its_own() {
    let folder = tempfile::tempdir().expect("a folder");
    let builder = full_box();
    let mut json = builder.json.clone();
    json["buffers"] = json!([{"uri": "data.bin", "byteLength": builder.bin.len()}]);
    let path = folder.path().join("scene.gltf");
    std::fs::write(folder.path().join("data.bin"), &builder.bin).expect("written");
    std::fs::write(&path, serde_json::to_string_pretty(&json).expect("text")).expect("written");
    let mut document = Document::read(&path).expect("read");
    let report = remove(&mut document, &options(RemoveMode::Triangles, TIGHT), &Silent).expect("a scene");
    assert!(report.bytes_released > 3_500);
    let output = folder.path().join("out.gltf");
    document.write(&output).expect("written");
    assert_eq!(std::fs::read(folder.path().join("data.bin")).expect("still there"), builder.bin);
    let smaller = std::fs::metadata(folder.path().join("out.visible.bin")).expect("a new file").len();
    assert_eq!(smaller, builder.bin.len() as u64 - report.bytes_released);
    let again = Document::read(&output).expect("read");
    svs::scene::read_scene(&again, &svs::scene::ReadOptions::default()).expect("a scene");
}

#[test]
fn broken_files_and_options_are_errors() {
    let good = full_box();
    let run = |json: &Value| {
        let mut json = json.clone();
        json["buffers"] = json!([{"byteLength": good.bin.len()}]);
        let mut document = Document::from_parts(json, Some(good.bin.clone())).expect("a document");
        remove(&mut document, &options(RemoveMode::Triangles, TIGHT), &Silent)
    };
    let mut cases = Vec::new();
    for (pointer, value) in [
        ("/nodes/0/mesh", json!(99)),
        ("/nodes/0/children", json!([0])),
        ("/meshes/0/primitives/0/indices", json!(0)),
        ("/meshes/0/primitives/0/mode", json!(7)),
        ("/accessors/0/count", json!(4_000_000_000u32)),
        ("/bufferViews/0/byteLength", json!(1e15)),
        ("/scene", json!(5)),
    ] {
        let mut json = good.json.clone();
        let (parent, key) = pointer.rsplit_once('/').expect("a pointer");
        json.pointer_mut(parent).expect("a parent")[key] = value;
        cases.push((pointer, json));
    }
    for (pointer, json) in cases {
        assert!(matches!(run(&json), Err(HiddenError::Scene(_))), "{pointer}");
    }
    // Transforms beyond all bounds leave objects out, not more.
    let mut json = good.json.clone();
    json["nodes"][1]["scale"] = json!([1e300, 1e300, 1e300]);
    json["nodes"][2]["scale"] = json!([0, 0, 0]);
    let report = run(&json).expect("a scene");
    assert_eq!((report.not_judged, report.objects_removed), (2, 8));
    // Nothing at all.
    let mut empty = Document::from_parts(json!({"asset": {"version": "2.0"}}), None).expect("a document");
    let report = remove(&mut empty, &HiddenOptions::default(), &Silent).expect("an empty scene");
    assert_eq!((report.objects, report.rays), (0, 0));
    for clearance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let result = remove(&mut good.document(), &options(RemoveMode::Objects, Some(clearance)), &Silent);
        assert!(matches!(result, Err(HiddenError::Clearance { .. })), "{clearance}");
    }
}

/// An accessor in a shared buffer: which view, where, how many elements, how large, and which mesh has it.
type Piece = (usize, usize, usize, usize, usize);

proptest! {
    /// Accessors anywhere in overlapping views of two buffers, meshes that share them: whatever dies, the others read
    /// the same bytes.
    #[test]
    fn live_accessors_read_the_same_after_a_release(
        views in proptest::collection::vec((0usize..2, 0usize..40, 1usize..60, 0usize..3), 1..6),
        pieces in proptest::collection::vec((0usize..6, 0usize..40, 1usize..12, 0usize..4, 0usize..5), 1..16),
        dead in proptest::collection::btree_set(0usize..5, 0..5),
    ) {
        let (document, used) = scattered(&views, &pieces);
        let mut after = document.clone();
        let dead: BTreeSet<usize> = dead;
        let released = release(&mut after, &dead, &BTreeSet::new());
        prop_assert!(released.kept_because.is_none(), "{released:?}");
        let length = |document: &Document| document.buffers.iter().map(Vec::len).sum::<usize>() as u64;
        prop_assert_eq!(length(&document) - released.bytes, length(&after));
        for (accessor, mesh) in used {
            let new = after.accessor(accessor);
            prop_assert!(new.is_ok(), "{new:?}");
            if !dead.contains(&mesh) {
                let old = document.accessor(accessor).expect("made so").read_vec3_f64().expect("points");
                prop_assert_eq!(old, new.expect("checked").read_vec3_f64().expect("points"));
            }
            let json = &after.json["accessors"][accessor];
            if let Some(view) = json.get("bufferView").and_then(Value::as_u64) {
                let at = |value: &Value| value.get("byteOffset").and_then(Value::as_u64).unwrap_or(0);
                prop_assert_eq!((at(json) + at(&after.json["bufferViews"][view as usize])) % 4, 0);
                prop_assert_eq!(at(json) % 4, 0);
            }
        }
        prop_assert!(Document::from_glb(&after.to_glb().expect("consistent")).is_ok());
    }
}

/// A document of five meshes with these accessors as positions; the accessors that fit, each with its mesh.
fn scattered(views: &[(usize, usize, usize, usize)], pieces: &[Piece]) -> (Document, Vec<(usize, usize)>) {
    let bytes =
        |seed: u32| -> Vec<u8> { (0..600u32).flat_map(|i| ((i * 7 + seed) as f32).to_le_bytes()).collect() };
    let views_json: Vec<Value> = views
        .iter()
        .map(|&(buffer, start, length, stride)| {
            let mut view =
                json!({"buffer": buffer, "byteOffset": start * 12, "byteLength": length * 12 + 24});
            if stride > 0 {
                view["byteStride"] = (12 * stride).into();
            }
            view
        })
        .collect();
    let mut accessors = Vec::new();
    let mut meshes: Vec<Vec<Value>> = vec![Vec::new(); 5];
    let mut used = Vec::new();
    for &(view, start, count, _, mesh) in pieces {
        let view = view % views.len();
        let stride = views[view].3.max(1) * 12;
        if start * 12 + (count - 1) * stride + 12 > views[view].2 * 12 + 24 {
            continue;
        }
        accessors.push(json!({"bufferView": view, "byteOffset": start * 12, "componentType": 5126, "count": count, "type": "VEC3"}));
        meshes[mesh].push(json!({"attributes": {"POSITION": accessors.len() - 1}}));
        used.push((accessors.len() - 1, mesh));
    }
    let meshes: Vec<Value> = meshes.into_iter().map(|primitives| json!({"primitives": primitives})).collect();
    let uri = {
        use base64::Engine as _;
        format!(
            "data:application/octet-stream;base64,{}",
            base64::engine::general_purpose::STANDARD.encode(bytes(1))
        )
    };
    let json = json!({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 2400}, {"byteLength": 2400, "uri": uri}],
        "bufferViews": views_json, "accessors": accessors, "meshes": meshes});
    (Document::from_parts(json, Some(bytes(0))).expect("a document"), used)
}
