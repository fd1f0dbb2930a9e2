//! `svs build --remove-hidden` from end to end.

use crate::{build, folder, run, small_scene};
use std::fs;
use svs::gltf::Document;

/// Closed shells in one another: with a clearance that only the space around them has, all but one go.
#[test]
fn hidden_shells_are_removed_and_the_rest_is_baked() {
    let folder = folder();
    for name in ["scene.glb", "scene.gltf"] {
        let scene = small_scene(&folder, name);
        let output = folder.path().join(name.replace("scene", "out"));
        let plain = build(&scene, &output, &["--json"]).ok().json();
        assert!(plain.get("hidden").is_none(), "{plain}");
        let objects = plain["objects"].as_u64().expect("objects");

        let finished =
            build(&scene, &output, &["--json", "--remove-hidden", "--hidden-clearance", "1e6"]).ok();
        let json = finished.json();
        let hidden = &json["hidden"];
        assert_eq!(hidden["mode"], "objects");
        assert_eq!(hidden["objects"].as_u64(), Some(objects));
        assert_eq!(hidden["objects_removed"].as_u64(), Some(objects - 1), "{hidden}");
        assert_eq!(json["objects"].as_u64(), Some(1), "{json}");
        assert!(hidden["bytes_after"].as_u64() < hidden["bytes_before"].as_u64(), "{hidden}");
        assert!(hidden["largest"][0]["name"].is_string(), "{hidden}");
        run(&["validate".as_ref(), output.as_os_str()]).ok();
        let document = Document::read(&output).expect("readable");
        let nodes = document.json["nodes"].as_array().expect("nodes");
        assert_eq!(
            nodes.len(),
            Document::read(&scene).expect("readable").json["nodes"].as_array().expect("nodes").len()
        );
    }
}

#[test]
fn shells_with_room_for_a_camera_stay() {
    let folder = folder();
    let scene = small_scene(&folder, "scene.glb");
    let output = folder.path().join("out.glb");
    let json = build(&scene, &output, &["--json", "--remove-hidden"]).ok().json();
    assert_eq!(json["hidden"]["objects_removed"].as_u64(), Some(0), "{json}");
}

#[test]
fn triangles_too_and_the_same_bytes_again() {
    let folder = folder();
    let scene = small_scene(&folder, "scene.glb");
    let [first, second] = ["first.glb", "second.glb"].map(|name| folder.path().join(name));
    let more = ["--remove-hidden=triangles", "--hidden-clearance", "1e6"];
    let text = build(&scene, &first, &[&more[..], &["--threads", "1"]].concat()).ok().stdout;
    for words in ["hidden", "removed;", "largest removed objects", "shell"] {
        assert!(text.contains(words), "{words:?} is not in {text}");
    }
    build(&scene, &second, &[&more[..], &["--threads", "2"]].concat()).ok();
    assert!(fs::read(&first).expect("baked") == fs::read(&second).expect("baked"), "threads matter");
    // On its own output.
    build(&first, &second, &more).ok();
    assert!(fs::read(&first).expect("baked") == fs::read(&second).expect("baked"), "a second run matters");
}

#[test]
fn options_that_make_no_sense_are_refused() {
    let folder = folder();
    let scene = small_scene(&folder, "scene.glb");
    let output = folder.path().join("out.glb");
    build(&scene, &output, &["--hidden-clearance", "1"]).fails(2, &["--remove-hidden"]);
    build(&scene, &output, &["--remove-hidden=walls"]).fails(2, &["objects", "triangles"]);
    build(&scene, &output, &["--remove-hidden", "--hidden-clearance", "0"]).fails(2, &["--hidden-clearance"]);
    assert!(!output.exists());
}
