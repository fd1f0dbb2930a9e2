//! The sample asset of the specification: what a client must draw of it, and that a bake still gives its bytes.
//!
//! `cargo xtask samples` writes the files anew; after that, look at what changed in `shells.expected.json`.

use glam::{DMat4, DVec3, Vec3};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use svs::bake::subject::subjects;
use svs::bake::{BakeOptions, Quality, Silent, build};
use svs::generate::{ShellOptions, shells};
use svs::gltf::{Document, DocumentTables};
use svs::scene::{ReadOptions, read_scene};
use svs_runtime::format::Extension;
use svs_runtime::{Bounds, Camera, Culler, Query, Settings, Visibility};

/// Set by `cargo xtask samples`.
const WRITE: &str = "SVS_WRITE_SAMPLES";

fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("schema/EXT_spherical_visibility/samples/shells").join(name)
}

/// Three shells, one inside the other, with a small box beside each; the outermost has a hole on the +x side.
/// Nothing is pruned: in so small a scene no sphere is worth its bytes.
fn bake() -> Document {
    let sample = shells(&ShellOptions { depth: 3, hole: true });
    let mut doc = Document::from_parts(sample.json, Some(sample.bin)).expect("a readable sample");
    let options =
        BakeOptions { quality: Quality::Draft, prune: Some(0.0), verify: false, ..BakeOptions::default() };
    build(&mut doc, &options, &Silent).expect("a sample that can be baked");
    doc
}

/// For each direction of the set, names of the nodes that a client draws for an eye far away there. All ways to ask for
/// one bin must agree.
fn visible(doc: &Document) -> Vec<(Vec3, Vec<String>)> {
    let json = doc.json.pointer("/extensions/EXT_spherical_visibility").expect("a bake");
    let extension: Extension = serde_json::from_value(json.clone()).expect("the extension's form");
    let visibility =
        Visibility::decode(json, &DocumentTables::of_extension(doc, &extension)).expect("a valid bake");
    let [tree] = visibility.trees() else { panic!("one tree is expected") };
    let scene = read_scene(doc, &ReadOptions::default()).expect("a readable scene");
    let subject = &subjects(&scene)[0];
    let bounds: Vec<Bounds> = (0..tree.object_count())
        .map(|place| subject.members[tree.document_index(place) as usize].bounds)
        .map(|bounds| Bounds { min: bounds.min.as_vec3(), max: bounds.max.as_vec3() })
        .collect();
    let mut culler = Culler::new(tree, &bounds).expect("a box for each object");
    let set = tree.direction_set();
    let names = |culler: &mut Culler, settings: &Settings, direction: Vec3| {
        // So far away that the direction from every object is in the same bin.
        let eye = direction.as_dvec3() * 1e6;
        let camera = Camera::perspective(DMat4::from_translation(-eye), 1.0, 1.0, 1.0, 1.0);
        let drawn = culler.cull(&camera, &Settings { frustum: false, ..*settings });
        let mut objects: Vec<u32> = drawn.iter().map(|&place| tree.document_index(place as usize)).collect();
        objects.sort_unstable();
        let name = |object: u32| doc.json["nodes"][scene.objects[object as usize].node]["name"].as_str();
        objects.into_iter().map(|object| name(object).expect("a name").to_owned()).collect::<Vec<_>>()
    };
    (0..set.len())
        .map(|k| {
            let direction = set.direction(k);
            let drawn = names(&mut culler, &Settings::NEAREST_O, direction);
            let published = Settings { query: Query::SphereNearest, ..Settings::NEAREST_O };
            assert_eq!(names(&mut culler, &published, direction), drawn, "direction {k}");
            (direction, drawn)
        })
        .collect()
}

fn expected(visible: &[(Vec3, Vec<String>)]) -> Value {
    let entry = |(direction, nodes): &(Vec3, Vec<String>)| {
        // As JSON shows the 32-bit numbers: shortest text that gives them back.
        let direction =
            direction.to_array().map(|value| value.to_string().parse::<f64>().unwrap_or_default());
        json!({"direction": direction, "nodes": nodes})
    };
    json!({
        "asset": "shells.glb",
        "directions": "icosahedron-1",
        "visible": visible.iter().map(entry).collect::<Vec<_>>(),
    })
}

/// One line per direction.
fn text(expected: &Value) -> String {
    let lines: Vec<String> =
        expected["visible"].as_array().into_iter().flatten().map(|entry| format!("    {entry}")).collect();
    format!(
        "{{\n  \"asset\": {},\n  \"directions\": {},\n  \"visible\": [\n{}\n  ]\n}}\n",
        expected["asset"],
        expected["directions"],
        lines.join(",\n")
    )
}

#[test]
fn the_sample_asset_shows_what_is_expected() {
    let fresh = bake();
    let fresh_glb = fresh.to_glb().expect("a bake can be written");
    if std::env::var_os(WRITE).is_some() {
        std::fs::create_dir_all(path("")).expect("the folder");
        std::fs::write(path("shells.glb"), &fresh_glb).expect("the asset");
        std::fs::write(path("shells.expected.json"), text(&expected(&visible(&fresh))))
            .expect("the expectation");
    }
    let stored = Document::read(&path("shells.glb")).expect("the asset; `cargo xtask samples` writes it");
    let wanted: Value = std::fs::read(path("shells.expected.json"))
        .map(|bytes| serde_json::from_slice(&bytes).expect("JSON"))
        .expect("the expectation; `cargo xtask samples` writes it");
    // First what counts: the visible sets.
    let seen = visible(&stored);
    assert_eq!(text(&expected(&seen)), text(&wanted), "the asset shows something else than expected");
    assert_eq!(text(&expected(&visible(&fresh))), text(&wanted), "a fresh bake shows something else");
    assert!(
        fresh_glb == std::fs::read(path("shells.glb")).expect("the asset"),
        "a fresh bake has other bytes; if that is meant, run `cargo xtask samples`"
    );
    let report = svs::validate::validate(&stored);
    assert!(report.issues.is_empty(), "{report:#?}");
    check_by_geometry(&seen);
}

/// What the shape of the scene says, whatever the baker found.
fn check_by_geometry(seen: &[(Vec3, Vec<String>)]) {
    assert_eq!(seen.len(), 42);
    for (direction, nodes) in seen {
        let has = |name: &str| nodes.iter().any(|node| node == name);
        assert!(has("shell 0"), "{direction}: the outermost shell is seen from everywhere");
        for hidden in ["content 1", "shell 2", "content 2"] {
            assert!(!has(hidden), "{direction}: {hidden} is inside the closed shell 1");
        }
        // The next shell is seen within 44 degrees of the hole's axis; a bin reaches 22 degrees from its direction.
        let angle = direction.as_dvec3().angle_between(DVec3::X).to_degrees();
        if angle < 22.0 {
            assert!(has("shell 1"), "{direction}: {angle} degrees from the hole's axis");
        }
        if angle > 44.0 + 22.0 {
            assert!(!has("shell 1"), "{direction}: {angle} degrees from the hole's axis");
        }
        if angle > 112.0 {
            assert_eq!(nodes.len(), 1, "{direction}: the hole faces away");
        }
    }
}
