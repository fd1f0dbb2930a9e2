//! `svs build --proxies` on files.

use crate::{build, folder, plant, run};
use std::fs;
use std::path::Path;
use svs::gltf::Document;

const SMALL: [&str; 5] = ["-q", "--proxies", "auto", "--proxy-triangles", "500"];

fn contents(path: &Path) -> (String, Vec<Vec<u8>>) {
    let document = Document::read(path).expect("readable");
    (document.json.to_string(), document.buffers)
}

#[test]
fn proxies_are_stripped_and_baked_again_to_the_same_bytes() {
    let folder = folder();
    let [one, two, stripped] = ["one.glb", "two.glb", "stripped.glb"].map(|name| folder.path().join(name));
    build(&plant(), &one, &SMALL).ok();
    assert!(contents(&one).0.contains("PROXY_MESH"));
    build(&plant(), &two, &[&SMALL[..], &["--threads", "1"]].concat()).ok();
    let bytes = fs::read(&one).expect("baked");
    assert!(fs::read(&two).expect("baked") == bytes, "threads change the result");
    build(&one, &two, &SMALL).ok();
    assert!(fs::read(&two).expect("baked") == bytes, "a second build changes the result");
    run(&["strip".as_ref(), one.as_os_str(), "-o".as_ref(), stripped.as_os_str()]).ok();
    assert!(contents(&stripped) == contents(&plant()), "JSON or buffers differ");
    run(&["validate".as_ref(), one.as_os_str()]).ok();

    // Without proxies the bytes are those of a build that never had any.
    build(&one, &two, &["-q", "--proxies", "off"]).ok();
    build(&plant(), &stripped, &["-q"]).ok();
    assert!(fs::read(&two).expect("baked") == fs::read(&stripped).expect("baked"));
}

#[test]
fn proxies_beside_gltf_with_external_buffers() {
    let folder = folder();
    let scene = folder.path().join("scene.gltf");
    run(&["sample", "plant", "-q", "--scale", "0.2", "-o", scene.to_str().expect("UTF-8")]).ok();
    let before = contents(&scene);
    let output = folder.path().join("out.gltf");
    for (format, required) in [
        ("quantized", "[\"KHR_mesh_quantization\"]"),
        ("meshopt", "[\"KHR_mesh_quantization\",\"EXT_meshopt_compression\"]"),
    ] {
        let options = ["-q", "--proxies", "all", "--proxy-triangles", "200", "--proxy-format", format];
        build(&scene, &output, &options).ok();
        let json = contents(&output).0;
        assert!(json.contains("PROXY_MESH") && json.contains(&format!("\"extensionsRequired\":{required}")));
        run(&["validate".as_ref(), output.as_os_str()]).ok();
        run(&["strip".as_ref(), output.as_os_str(), "-o".as_ref(), output.as_os_str()]).ok();
        assert!(contents(&output) == before, "JSON or buffers differ");
    }
}

#[test]
fn compressed_proxies_are_smaller_stripped_and_baked_again_to_the_same_bytes() {
    let folder = folder();
    let [scene, one, two, stripped, other] =
        ["scene.glb", "one.glb", "two.glb", "stripped.glb", "other.gltf"]
            .map(|name| folder.path().join(name));
    run(&["sample", "plant", "-q", "--scale", "0.2", "-o", scene.to_str().expect("UTF-8")]).ok();
    let options = ["-q", "--proxies", "all", "--proxy-triangles", "200", "--proxy-format", "meshopt"];
    let told = build(&scene, &one, &[&options[1..], &["--json"]].concat()).ok().json();
    build(&one, &two, &options).ok();
    assert!(
        fs::read(&two).expect("baked") == fs::read(&one).expect("baked"),
        "a second build changes the result"
    );
    run(&["validate".as_ref(), one.as_os_str()]).ok();
    run(&["strip".as_ref(), one.as_os_str(), "-o".as_ref(), stripped.as_os_str()]).ok();
    assert!(contents(&stripped) == contents(&scene), "JSON or buffers differ");

    // What is reported is about what the file grew by, and not less.
    build(&scene, &two, &["-q"]).ok();
    let size = |path: &Path| fs::metadata(path).expect("a file").len();
    let (grown, told) = (size(&one) - size(&two), told["proxies"]["bytes"].as_u64().expect("bytes"));
    assert!(grown <= told && told <= grown + 40_000, "{grown} bytes, {told} reported");

    // The other way of storing files: the fallback stays without a file.
    build(&one, &other, &options).ok();
    let document = Document::read(&other).expect("readable");
    assert!(document.has_compressed_views());
    let buffers = document.json["buffers"].as_array().expect("buffers");
    assert!(buffers.last().expect("buffers").get("uri").is_none());
    for accessor in 0..document.next_accessor() {
        document.accessor(accessor).expect("readable");
    }

    build(&scene, &two, &[&options[..], &["--layout", "stream"]].concat())
        .fails(2, &["--proxy-format quantized"]);
}

/// `gltfpack -c -kn -vpf` and `gltfpack -cc -ce khr -kn` of `svs sample cubes --scale 0.004`.
#[test]
fn files_of_gltfpack_are_baked_and_stay_as_they_are() {
    let folder = folder();
    let packed = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cli/packed");
    for name in ["cubes.ext.glb", "cubes.khr.glb"] {
        let input = packed.join(name);
        let [output, stripped] = ["out.glb", "stripped.glb"].map(|name| folder.path().join(name));
        let told = build(&input, &output, &["--json"]).ok().json();
        assert_eq!([&told["objects"], &told["triangles"]], [4, 48], "{told}");
        run(&["validate".as_ref(), output.as_os_str()]).ok();
        run(&["strip".as_ref(), output.as_os_str(), "-o".as_ref(), stripped.as_os_str()]).ok();
        assert!(fs::read(&stripped).expect("stripped") == fs::read(&input).expect("packed"), "{name}");

        // A broken stream is told, and nothing is written.
        let mut broken = fs::read(&input).expect("packed");
        let json = u32::from_le_bytes(broken[12..16].try_into().expect("a length")) as usize;
        broken[28 + json] ^= 0xFF;
        let path = folder.path().join("broken.glb");
        fs::write(&path, broken).expect("written");
        let none = folder.path().join("none.glb");
        build(&path, &none, &[]).fails(1, &["/bufferViews/0", "meshopt_compression", "broken"]);
        assert!(!none.exists());
    }
}

#[test]
fn reports_tell_of_proxies_and_their_bytes() {
    let folder = folder();
    let output = folder.path().join("out.glb");
    let json =
        build(&plant(), &output, &["--proxies", "auto", "--proxy-triangles", "500", "--json"]).ok().json();
    let proxies = &json["proxies"];
    assert!(proxies["nodes"].as_u64() > Some(0), "{proxies}");
    assert!(proxies["share"].as_f64().is_some_and(|share| share > 0.0 && share <= 0.2), "{proxies}");
    let fewer = folder.path().join("fewer.glb");
    let words = ["--proxies", "auto", "--proxy-triangles", "500", "--proxy-share", "5", "--json"];
    let fewer = build(&plant(), &fewer, &words).ok().json();
    let share = fewer["proxies"]["share"].as_f64().expect("a share");
    assert!(share > 0.0 && share <= 0.05, "{fewer}");
    // What is reported is about what the file grew by, and not less.
    let without = folder.path().join("without.glb");
    build(&plant(), &without, &["-q"]).ok();
    let size = |path: &Path| fs::metadata(path).expect("a file").len();
    let grown = size(&output) - size(&without);
    let told = proxies["bytes"].as_u64().expect("bytes");
    assert!(grown <= told && told <= grown + 4_000, "{grown} bytes, {told} reported");

    let info = run(&["info".as_ref(), output.as_os_str(), "--json".as_ref()]).ok().json();
    assert_eq!(info["trees"][0]["proxies"]["nodes"], proxies["nodes"]);
    assert_eq!(info["mesh_levels"]["count"], proxies["mesh_levels"]);
    let text = run(&["info".as_ref(), output.as_os_str()]).ok().stdout;
    assert!(text.contains("of what is visible from outside") && text.contains("PROXY_SPHERE"), "{text}");
}

#[test]
fn msft_lod_comes_with_proxies_only() {
    for more in [&[][..], &["--proxies", "off"]] {
        let arguments = [&["build", "in.glb", "-o", "out.glb", "--msft-lod"], more].concat();
        run(&arguments).fails(2, &["--msft-lod", "--proxies auto"]);
    }
}

#[test]
fn simplified_meshes_are_named_for_other_loaders_and_stripped_again() {
    let folder = folder();
    let [scene, one, two, without, stripped] =
        ["scene.glb", "one.glb", "two.glb", "without.glb", "stripped.glb"]
            .map(|name| folder.path().join(name));
    run(&["sample", "plant", "-q", "--scale", "0.2", "-o", scene.to_str().expect("UTF-8")]).ok();
    // One node has extras of its own, one an empty object, one LODs of its own, one a child.
    let mut document = Document::read(&scene).expect("readable");
    let options = ["--proxies", "auto", "--proxy-triangles", "200", "--msft-lod"];
    let json = build(&scene, &one, &[&options[..], &["--json"]].concat()).ok().json();
    let all = json["proxies"]["msft_lod"]["nodes"].as_u64().expect("nodes") as usize;
    assert_eq!(json["proxies"]["msft_lod"]["left"], 0);
    let baked = Document::read(&one).expect("readable");
    let lods = |document: &Document| -> Vec<usize> {
        let nodes = document.json["nodes"].as_array().expect("nodes").iter().enumerate();
        nodes.filter(|(_, node)| !node["extensions"]["MSFT_lod"].is_null()).map(|(index, _)| index).collect()
    };
    let carriers = lods(&baked);
    assert!(all > 4 && carriers.len() == all, "{all} {carriers:?}");
    let count = document.json["nodes"].as_array().expect("nodes").len();
    let nodes = document.json["nodes"].as_array_mut().expect("nodes");
    nodes[carriers[0]]["extras"] = serde_json::json!({"id": "a"});
    nodes[carriers[1]]["extras"] = serde_json::json!({});
    nodes[carriers[2]]["extensions"] = serde_json::json!({"MSFT_lod": {"ids": [count]}});
    nodes[carriers[3]]["children"] = serde_json::json!([count + 1]);
    nodes.extend([serde_json::json!({"mesh": 0}), serde_json::json!({})]);
    document.json["extensionsUsed"] = serde_json::json!(["MSFT_lod"]);
    document.write(&scene).expect("written");

    let json = build(&scene, &one, &[&options[..], &["--json"]].concat()).ok().json();
    let told = &json["proxies"]["msft_lod"];
    assert_eq!([&told["nodes"], &told["left"]], [all - 2, 2], "{told}");
    let note = json["notes"].as_array().expect("notes").iter().find(|note| note["code"] == "MSFT_LOD_LEFT");
    assert_eq!(note.expect("a note")["count"], 2);

    let baked = Document::read(&one).expect("readable");
    let nodes = baked.json["nodes"].as_array().expect("nodes");
    assert_eq!(nodes.len(), count + 2 + told["appended"].as_u64().expect("appended") as usize);
    let reached: Vec<u64> = nodes
        .iter()
        .chain(baked.json["scenes"].as_array().expect("scenes"))
        .flat_map(|object| [&object["children"], &object["nodes"]])
        .filter_map(|list| list.as_array())
        .flatten()
        .filter_map(|node| node.as_u64())
        .collect();
    assert!(reached.iter().all(|&node| node < count as u64 + 2), "an appended node is in the scene");
    for carrier in lods(&baked).into_iter().filter(|&carrier| carrier != carriers[2]) {
        let node = &nodes[carrier];
        let ids = node["extensions"]["MSFT_lod"]["ids"].as_array().expect("ids");
        let coverage: Vec<f64> = node["extras"]["MSFT_screencoverage"]
            .as_array()
            .expect("thresholds")
            .iter()
            .map(|share| share.as_f64().expect("a number"))
            .collect();
        assert_eq!(coverage.len(), ids.len() + 1);
        assert_eq!(coverage.last(), Some(&0.0), "the coarsest is never left out");
        assert!(coverage.is_sorted_by(|a, b| a >= b) && coverage[0] <= 1.0, "{coverage:?}");
        for id in ids {
            let version = &nodes[id.as_u64().expect("an index") as usize];
            for key in ["translation", "rotation", "scale", "matrix"] {
                assert_eq!(version.get(key), node.get(key));
            }
        }
    }
    assert_eq!(nodes[carriers[0]]["extras"]["id"], "a");
    run(&["validate".as_ref(), one.as_os_str()]).ok();

    // That of the file itself counts too.
    let info = run(&["info".as_ref(), one.as_os_str(), "--json".as_ref()]).ok().json();
    let versions = told["appended"].as_u64().expect("appended") + 1;
    assert_eq!(
        [&info["msft_lod"]["nodes"], &info["msft_lod"]["versions"]],
        [all as u64 - 1, versions],
        "{info}"
    );
    let shown: std::collections::BTreeSet<u64> =
        lods(&baked).iter().filter_map(|&node| nodes[node]["mesh"].as_u64()).collect();
    assert_eq!(info["msft_lod"]["meshes"], shown.len());
    let text = run(&["info".as_ref(), one.as_os_str()]).ok().stdout;
    assert!(text.contains(&format!("MSFT_lod: {} nodes with", all - 1)), "{text}");
    let text = run(&["info".as_ref(), scene.as_os_str()]).ok().stdout;
    assert!(
        text.contains("no baked visibility") && text.contains("MSFT_lod: 1 node with 1 mesh, 1 version"),
        "{text}"
    );

    build(&one, &two, &[&options[..], &["-q", "--threads", "1"]].concat()).ok();
    assert!(
        fs::read(&two).expect("baked") == fs::read(&one).expect("baked"),
        "a second build changes the result"
    );
    // Everything but the nodes is as without the flag.
    build(&scene, &without, &[&options[..4], &["-q"]].concat()).ok();
    build(&one, &two, &[&options[..4], &["-q"]].concat()).ok();
    assert!(fs::read(&two).expect("baked") == fs::read(&without).expect("baked"));
    run(&["strip".as_ref(), one.as_os_str(), "-o".as_ref(), stripped.as_os_str()]).ok();
    assert!(contents(&stripped) == contents(&scene), "JSON or buffers differ");
}
