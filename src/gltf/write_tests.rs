//! Files on disk: in-place writing, containers, resources, and what failures leave behind.

use super::payload::{self, Table};
use super::{BufferStorage, Container, Document, WriteError};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

/// A .gltf with two external buffers (one in a sub-folder, with a name to escape) and an image.
fn sample(folder: &Path) -> Value {
    fs::create_dir_all(folder.join("data")).unwrap();
    fs::write(folder.join("one.bin"), [1, 2, 3]).unwrap();
    fs::write(folder.join("data/zwei 2.bin"), [4, 5, 6, 7, 8]).unwrap();
    fs::write(folder.join("image.png"), b"png").unwrap();
    let json = json!({"asset": {"version": "2.0"},
        "images": [{"uri": "image.png"}, {"uri": "missing.png"}, {"uri": "https://example.org/x.png"}],
        "buffers": [{"byteLength": 3, "uri": "one.bin"}, {"uri": "data/zwei%202.bin", "byteLength": 4}],
        "bufferViews": [{"buffer": 0, "byteLength": 3}, {"buffer": 1, "byteOffset": 1, "byteLength": 3}]});
    fs::write(folder.join("scene.gltf"), serde_json::to_string_pretty(&json).unwrap() + "\n").unwrap();
    json
}

fn attach(document: &mut Document) {
    let extension = json!({"trees": [{"tables": {"LEVEL_ROW": document.next_accessor()}}]});
    let table = Table { bytes: &[9, 8, 7], component_type: 5121, kind: "SCALAR", count: 3, min_max: None };
    payload::attach(document, extension, &[table]).unwrap();
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_gltf_file_is_written_back_byte_for_byte() {
    let folder = tempfile::tempdir().unwrap();
    sample(folder.path());
    let path = folder.path().join("scene.gltf");
    let text = fs::read(&path).unwrap();
    for style in [
        text.clone(),
        text.strip_suffix(b"\n").unwrap().to_vec(),
        String::from_utf8(text).unwrap().replace("  ", "\t").into(),
    ] {
        fs::write(&path, &style).unwrap();
        let summary = Document::read(&path).unwrap().write(&path).unwrap();
        assert_eq!(fs::read(&path).unwrap(), style);
        assert_eq!((summary.bytes, summary.files.len()), (style.len() as u64, 0));
        assert!(summary.not_copied.is_empty(), "nothing has to be copied within a folder");
    }
    assert_eq!(names(folder.path()), ["data", "image.png", "one.bin", "scene.gltf"]);
}

#[test]
fn a_payload_beside_external_buffers_gets_its_own_file() {
    let folder = tempfile::tempdir().unwrap();
    let json = sample(folder.path());
    let mut document = Document::read(&folder.path().join("scene.gltf")).unwrap();
    attach(&mut document);
    let out = folder.path().join("mein bau.gltf");
    let summary = document.write(&out).unwrap();
    assert_eq!(summary.files, [folder.path().canonicalize().unwrap().join("mein bau.svs.bin")]);
    assert_eq!(fs::read(&summary.files[0]).unwrap(), [9, 8, 7]);
    assert_eq!(fs::read(folder.path().join("one.bin")).unwrap(), [1, 2, 3]);

    // A second build of the output, in place, gives the same bytes.
    let first = fs::read(&out).unwrap();
    let mut again = Document::read(&out).unwrap();
    assert_eq!(again.json["buffers"][2]["uri"], "mein%20bau.svs.bin");
    assert!(payload::strip(&mut again));
    assert_eq!(again.json, json);
    attach(&mut again);
    again.write(&out).unwrap();
    assert_eq!(fs::read(&out).unwrap(), first);
    assert!(payload::strip(&mut again));
    assert_eq!(again.json, json);
}

#[test]
fn resources_follow_into_another_folder() {
    let folder = tempfile::tempdir().unwrap();
    sample(folder.path());
    let document = Document::read(&folder.path().join("scene.gltf")).unwrap();
    let out = folder.path().join("out");
    fs::create_dir(&out).unwrap();
    let summary = document.write(&out.join("copy.gltf")).unwrap();
    assert_eq!(summary.files.len(), 3);
    assert_eq!(summary.not_copied, ["missing.png"]);
    assert_eq!(fs::read(out.join("data/zwei 2.bin")).unwrap(), [4, 5, 6, 7, 8], "copied whole");
    let copy = Document::read(&out.join("copy.gltf")).unwrap();
    assert_eq!((copy.json, copy.buffers), (document.json, document.buffers));
}

#[test]
fn gltf_becomes_glb_and_back() {
    let folder = tempfile::tempdir().unwrap();
    sample(folder.path());
    let document = Document::read(&folder.path().join("scene.gltf")).unwrap();
    let glb = folder.path().join("scene.glb");
    document.write(&glb).unwrap();
    let merged = Document::read(&glb).unwrap();
    assert_eq!(merged.container(), Container::Glb);
    assert_eq!(merged.buffers, [vec![1, 2, 3, 0, 4, 5, 6, 7]]);
    assert_eq!(merged.buffer_view(1).unwrap(), [5, 6, 7]);
    assert_eq!(document.to_glb().unwrap(), fs::read(&glb).unwrap());

    let back = folder.path().join("back.gltf");
    merged.write(&back).unwrap();
    let split = Document::read(&back).unwrap();
    assert_eq!(split.json["buffers"], json!([{"byteLength": 8, "uri": "back.bin"}]));
    assert_eq!(split.buffers, merged.buffers);
    assert_eq!(split.buffer_storage(0), Some(&BufferStorage::External));
}

#[test]
fn stripping_a_build_that_changed_container_gives_the_conversion() {
    let folder = tempfile::tempdir().unwrap();
    sample(folder.path());
    let plain = Document::read(&folder.path().join("scene.gltf")).unwrap();
    for (name, container) in [("a.glb", Container::Glb), ("a.gltf", Container::Gltf)] {
        let mut document = plain.clone();
        document.convert(container);
        let expected = document.clone();
        attach(&mut document);
        document.write(&folder.path().join(name)).unwrap();
        let mut document = Document::read(&folder.path().join(name)).unwrap();
        assert!(payload::strip(&mut document));
        assert_eq!(document.json, expected.json);
        assert_eq!(document.buffers, expected.buffers);
    }
}

#[test]
fn unknown_chunks_survive_and_are_counted_where_they_cannot() {
    let folder = tempfile::tempdir().unwrap();
    let mut document = Document::from_parts(json!({"asset": {"version": "2.0"}}), None).unwrap();
    document.extra_chunks.push(super::glb::Chunk { kind: 0x1234, bytes: vec![1, 2, 3, 4] });
    let path = folder.path().join("a.glb");
    document.write(&path).unwrap();
    let bytes = fs::read(&path).unwrap();
    let mut document = Document::read(&path).unwrap();
    attach(&mut document);
    document.write(&path).unwrap();
    let mut document = Document::read(&path).unwrap();
    assert!(payload::strip(&mut document));
    document.write(&path).unwrap();
    assert_eq!(fs::read(&path).unwrap(), bytes);
    assert_eq!(document.write(&folder.path().join("a.gltf")).unwrap().dropped_chunks, 1);
}

#[test]
fn failures_leave_the_old_output_and_no_litter() {
    let folder = tempfile::tempdir().unwrap();
    sample(folder.path());
    let before = names(folder.path());
    let mut document = Document::read(&folder.path().join("scene.gltf")).unwrap();

    let own = document.write(&folder.path().join("one.bin"));
    assert!(matches!(own, Err(WriteError::OwnResource { .. })));
    let nowhere = document.write(&folder.path().join("no/such/folder.gltf")).unwrap_err().to_string();
    assert!(nowhere.contains("create it"), "{nowhere}");
    assert!(matches!(document.write(&folder.path().join("data")), Err(WriteError::Io { .. })));
    document.buffers[0].push(0);
    let inconsistent = document.write(&folder.path().join("scene.gltf"));
    assert!(matches!(inconsistent, Err(WriteError::Inconsistent { .. })));
    document.buffers.pop();
    assert!(matches!(document.to_glb(), Err(WriteError::Inconsistent { .. })));

    assert_eq!(names(folder.path()), before);
    assert_eq!(fs::read(folder.path().join("one.bin")).unwrap(), [1, 2, 3]);
}

#[test]
fn the_payload_file_never_takes_the_name_of_another_buffer() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.svs.bin"), [1]).unwrap();
    let json = json!({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 1, "uri": "a.svs.bin"}]});
    let path = folder.path().join("a.gltf");
    fs::write(&path, json.to_string()).unwrap();
    let mut document = Document::read(&path).unwrap();
    attach(&mut document);
    document.write(&path).unwrap();
    assert_eq!(fs::read(folder.path().join("a.svs.bin")).unwrap(), [1]);
    assert_eq!(Document::read(&path).unwrap().buffers, [vec![1], vec![9, 8, 7]]);
}

#[cfg(unix)]
#[test]
fn links_and_rights_are_kept() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let document = Document::from_parts(json!({"asset": {"version": "2.0"}}), None).unwrap();
    let (file, link) = (folder.path().join("a.glb"), folder.path().join("link.glb"));
    fs::write(&file, "old").unwrap();
    fs::set_permissions(&file, fs::Permissions::from_mode(0o640)).unwrap();
    std::os::unix::fs::symlink("a.glb", &link).unwrap();
    document.write(&link).unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::metadata(&file).unwrap().permissions().mode() & 0o777, 0o640);
    assert!(Document::read(&file).is_ok());
    // A new file gets what any program would give it, not a temporary file's 0600.
    document.write(&folder.path().join("new.glb")).unwrap();
    fs::write(folder.path().join("reference"), "").unwrap();
    let mode = |name: &str| fs::metadata(folder.path().join(name)).unwrap().permissions().mode();
    assert_eq!(mode("new.glb"), mode("reference"));
}
