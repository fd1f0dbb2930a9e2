//! The commands on good input.

use crate::{build, folder, names, plant, run, small_scene};
use std::fs;
use std::path::Path;
use svs::gltf::Document;

/// JSON and buffers of a file.
fn contents(path: &Path) -> (String, Vec<Vec<u8>>) {
    let document = Document::read(path).expect("readable");
    // As text: the order of keys counts.
    (document.json.to_string(), document.buffers)
}

#[test]
fn build_then_strip_gives_the_input_back() {
    let folder = folder();
    let (baked, stripped) = (folder.path().join("baked.glb"), folder.path().join("stripped.glb"));
    build(&plant(), &baked, &["-q"]).ok();
    assert!(contents(&baked).0.contains("EXT_spherical_visibility"));
    run(&["strip".as_ref(), baked.as_os_str(), "-o".as_ref(), stripped.as_os_str()]).ok();
    assert!(contents(&stripped) == contents(&plant()), "JSON or buffers differ");
}

#[test]
fn build_gives_the_same_bytes_for_any_threads_and_on_its_own_output() {
    let folder = folder();
    let scene = small_scene(&folder, "scene.glb");
    let outputs = ["one.glb", "two.glb"].map(|name| folder.path().join(name));
    build(&scene, &outputs[0], &["--threads", "1"]).ok();
    build(&scene, &outputs[1], &["--threads", "2"]).ok();
    let bytes = fs::read(&outputs[0]).expect("baked");
    assert!(fs::read(&outputs[1]).expect("baked") == bytes, "threads change the result");
    build(&outputs[0], &outputs[0], &[]).ok();
    assert!(fs::read(&outputs[0]).expect("baked") == bytes, "a second build changes the result");
}

#[test]
fn build_reports_the_result() {
    let folder = folder();
    let scene = small_scene(&folder, "scene.glb");
    let (output, report) = (folder.path().join("out.glb"), folder.path().join("report.json"));
    let text = build(&scene, &output, &[]).ok().stdout;
    for word in ["out.glb written in", "missing pixels", "spheres", "objects", "added"] {
        assert!(text.contains(word), "{word:?} is not in {text}");
    }
    assert!(text.lines().count() < 25, "{text}");

    let finished = build(&scene, &output, &["--json", "--report", report.to_str().expect("UTF-8")]).ok();
    let json = finished.json();
    assert!(json["objects"].as_u64() > Some(0), "{json}");
    for field in ["bytes_added", "geometry_bytes", "estimated_missing_ppm", "wall_seconds", "triangles"] {
        assert!(json[field].is_number(), "{field} in {json}");
    }
    if cfg!(target_os = "linux") {
        assert!(json["peak_memory_bytes"].as_u64() > Some(1_000_000), "{json}");
    }
    assert_eq!(fs::read_to_string(report).expect("a report"), finished.stdout);

    assert_eq!(build(&scene, &output, &["-q"]).ok().stdout, "");
    build(&scene, &output, &["-q", "--json"]).ok().json();
    assert_eq!(names(folder.path()), ["out.glb", "report.json", "scene.glb"]);
}

#[test]
fn gltf_with_external_buffers_in_and_out() {
    let folder = folder();
    let scene = small_scene(&folder, "scene.gltf");
    let before = contents(&scene);
    let output = folder.path().join("out.gltf");
    build(&scene, &output, &[]).ok();
    run(&["validate".as_ref(), output.as_os_str()]).ok();
    run(&["strip".as_ref(), output.as_os_str(), "-o".as_ref(), output.as_os_str()]).ok();
    let after = contents(&output);
    assert!(after == before, "JSON or buffers differ");
}

#[test]
fn info_tells_what_is_there() {
    let folder = folder();
    let scene = small_scene(&folder, "scene.glb");
    assert!(run(&["info".as_ref(), scene.as_os_str()]).ok().stdout.contains("no baked visibility"));
    let output = folder.path().join("out.glb");
    build(&scene, &output, &["-q", "--directions", "dodecahedron"]).ok();
    let text = run(&["info".as_ref(), output.as_os_str()]).ok().stdout;
    assert!(text.contains("20 directions (dodecahedron)") && text.contains("NODE_SPHERE"), "{text}");
    let json = run(&["info".as_ref(), output.as_os_str(), "--json".as_ref()]).ok().json();
    let tree = &json["trees"][0];
    assert_eq!(tree["directions"]["count"], 20);
    assert!(tree["spheres"].as_u64() > Some(0), "{json}");
    let tables = tree["tables"].as_object().expect("tables");
    let sum: u64 = tables.values().filter_map(serde_json::Value::as_u64).sum();
    assert_eq!(tree["bytes"].as_u64(), Some(sum));
    // Closed shells in one another: most of it is hidden from outside.
    let culled = tree["levels"][0]["culled"].as_f64().expect("a share");
    assert!(culled > 0.3 && culled < 1.0, "{json}");
}

#[test]
fn validate_finds_what_is_wrong() {
    let folder = folder();
    let scene = small_scene(&folder, "scene.glb");
    let output = folder.path().join("out.glb");
    build(&scene, &output, &["-q"]).ok();
    let good = run(&["validate".as_ref(), output.as_os_str(), "--json".as_ref()]).ok().json();
    assert_eq!(
        (&good["issues"]["numErrors"], &good["issues"]["numWarnings"]),
        (&0.into(), &0.into()),
        "{good}"
    );

    let mut document = Document::read(&output).expect("readable");
    document.json["extensions"]["EXT_spherical_visibility"]["trees"][0]["directions"] =
        "cuboctahedron".into();
    document.write(&output).expect("written");
    let text = run(&["validate".as_ref(), output.as_os_str()]).fails(1, &[]);
    assert!(text.stdout.contains("/extensions/EXT_spherical_visibility/trees/0/directions"), "{text:?}");
    let bad = run(&["validate".as_ref(), output.as_os_str(), "--json".as_ref()]).fails(1, &[]).json();
    let first = &bad["issues"]["messages"][0];
    for field in ["code", "severity", "message", "pointer"] {
        assert!(!first[field].is_null(), "{field} in {bad}");
    }
    run(&["info".as_ref(), output.as_os_str()]).fails(1, &["svs validate"]);
}

#[test]
fn verify_measures_ours_and_the_published_method() {
    let folder = folder();
    let scene = small_scene(&folder, "scene.glb");
    let output = folder.path().join("out.glb");
    build(&scene, &output, &["-q"]).ok();
    let arguments =
        ["verify".as_ref(), output.as_os_str(), "--cameras".as_ref(), "2".as_ref(), "--json".as_ref()];
    let finished = run(&arguments).ok();
    let json = finished.json();
    for method in ["default", "published"] {
        for group in ["outside", "inside"] {
            let found = json["groups"].as_array().expect("groups").iter();
            let found = found.clone().find(|entry| entry["group"] == group && entry["method"] == method);
            let entry = found.unwrap_or_else(|| panic!("no {group} {method} in {json}"));
            for field in ["mean", "median", "p95", "worst"] {
                assert!(entry["missing_ppm"][field].is_number(), "{entry}");
            }
            assert!(entry["triangles"]["over_frustum"].is_number(), "{entry}");
        }
    }
    // Wall seconds and memory aside, the same cameras give the same figures.
    assert_eq!(run(&arguments).ok().json()["groups"], json["groups"]);
}

#[test]
fn samples_follow_from_their_seed() {
    let folder = folder();
    let paths = ["a.glb", "b.glb", "c.glb"].map(|name| folder.path().join(name));
    for (path, seed) in paths.iter().zip(["5", "5", "6"]) {
        let arguments = ["sample", "cubes", "--seed", seed, "-o"].map(std::ffi::OsStr::new);
        run(&[&arguments[..], &[path.as_os_str()]].concat()).ok();
    }
    let [a, b, c] = paths.map(|path| fs::read(path).expect("a sample"));
    assert!(a == b && a != c);
}
