//! Broken files: exit code 1, and a message that names the file and what is wrong.

use crate::{folder, run, small_scene};
use std::fs;

const READERS: [&[&str]; 5] =
    [&["info"], &["validate"], &["verify"], &["build", "-o", "OUT"], &["strip", "-o", "OUT"]];

/// Every command that reads `bytes` must fail in the same way and write nothing.
#[track_caller]
fn all_fail(name: &str, bytes: Option<&[u8]>, words: &[&str]) {
    let folder = folder();
    let file = folder.path().join(name);
    let output = folder.path().join("out.glb");
    if let Some(bytes) = bytes {
        fs::write(&file, bytes).expect("the file is written");
    }
    let mut words = words.to_vec();
    words.push(name);
    for reader in READERS {
        let arguments =
            reader.iter().map(|&word| if word == "OUT" { output.as_os_str() } else { word.as_ref() });
        let arguments: Vec<_> = arguments.chain([file.as_os_str()]).collect();
        let finished = run(&arguments).fails(1, &words);
        assert_eq!(finished.stdout, "", "{reader:?}");
        assert!(!output.exists(), "{reader:?} has written something");
    }
}

#[test]
fn a_missing_file() {
    all_fail("missing.glb", None, &["error: cannot read"]);
}

#[test]
fn not_gltf() {
    all_fail("picture.png", Some(b"\x89PNG\r\n\x1a\n and more"), &["not a glTF file"]);
    all_fail("empty.glb", Some(b""), &[]);
    all_fail("list.gltf", Some(b"[1, 2]"), &[]);
    all_fail("old.gltf", Some(br#"{"asset": {"version": "1.0"}}"#), &["1.0", "2.0"]);
}

#[test]
fn a_truncated_glb() {
    let folder = folder();
    let whole = fs::read(small_scene(&folder, "whole.glb")).expect("the sample");
    for length in [5, 12, 19, 40, whole.len() / 2, whole.len() - 1] {
        all_fail("cut.glb", Some(&whole[..length]), &[]);
    }
}

#[test]
fn a_missing_buffer_file() {
    let text = br#"{"asset": {"version": "2.0"}, "buffers": [{"uri": "lost.bin", "byteLength": 12}]}"#;
    all_fail("scene.gltf", Some(text), &["lost.bin"]);
}

#[test]
fn a_cyclic_node_graph() {
    let text = br#"{"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [
        {"children": [1]}, {"children": [0]}]}"#;
    let folder = folder();
    let file = folder.path().join("cycle.gltf");
    fs::write(&file, text).expect("the file is written");
    let output = folder.path().join("out.gltf");
    let arguments = ["build".as_ref(), file.as_os_str(), "-o".as_ref(), output.as_os_str()];
    run(&arguments).fails(1, &["cycle.gltf", "/nodes/"]);
}
