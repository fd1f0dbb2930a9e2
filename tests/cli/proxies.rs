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
    build(
        &scene,
        &output,
        &["-q", "--proxies", "all", "--proxy-triangles", "200", "--proxy-format", "quantized"],
    )
    .ok();
    let json = contents(&output).0;
    assert!(
        json.contains("PROXY_MESH") && json.contains("\"extensionsRequired\":[\"KHR_mesh_quantization\"]")
    );
    run(&["validate".as_ref(), output.as_os_str()]).ok();
    run(&["strip".as_ref(), output.as_os_str(), "-o".as_ref(), output.as_os_str()]).ok();
    assert!(contents(&output) == before, "JSON or buffers differ");
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
