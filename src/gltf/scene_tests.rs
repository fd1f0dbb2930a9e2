//! Real scenes, where they are present: read, write, attach, strip.

use super::payload::{self, Table};
use super::{AccessorKind, Container, Document};
use serde_json::json;
use std::path::{Path, PathBuf};

/// Enough variety, and the tests stay fast.
const LARGEST: u64 = 6 << 20;

/// The smaller .glb files of the scene collection, or none with a message.
fn scenes() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/scenes");
    let mut found = Vec::new();
    let mut folders = vec![folder.clone()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).into_iter().flatten().flatten() {
            let path = entry.path();
            if path.is_dir() {
                folders.push(path);
            } else if Container::from_path(&path) == Some(Container::Glb)
                && entry.metadata().is_ok_and(|file| file.len() < LARGEST)
            {
                found.push(path);
            }
        }
    }
    if found.is_empty() {
        println!("skipped: no scenes in {}", folder.display());
    }
    found.sort();
    found
}

#[test]
fn real_scenes_survive_a_build_byte_for_byte() {
    for path in scenes() {
        let file = std::fs::read(&path).unwrap();
        let mut document = Document::from_glb(&file).unwrap();
        let plain = document.to_glb().unwrap();
        // Most exporters write JSON as this crate does; where not, only white space and escapes may differ.
        let same = if plain == file { "identical" } else { "equal" };
        if plain != file {
            let reread = Document::from_glb(&plain).unwrap();
            assert_eq!((&reread.json, &reread.buffers), (&document.json, &document.buffers));
        }

        let bytes = vec![7; 1001];
        let table = Table { bytes: &bytes, component_type: 5121, kind: "SCALAR", count: 1001, min_max: None };
        let extension = json!({"trees": [{"tables": {"LEVEL_ROW": document.next_accessor()}}]});
        payload::attach(&mut document, extension, &[table]).unwrap();
        let mut built = Document::from_glb(&document.to_glb().unwrap()).unwrap();
        assert!(payload::strip(&mut built));
        assert!(built.to_glb().unwrap() == plain, "{}: strip is not exact", path.display());
        println!("{}: {same}, {} bytes", path.display(), file.len());
    }
}

#[test]
fn positions_of_real_scenes_lie_in_their_declared_bounds() {
    for path in scenes() {
        let document = Document::read(&path).unwrap();
        if document.json.get("extensionsRequired").is_some() {
            // Compressed: the accessors hold no data of their own.
            continue;
        }
        let mut checked = 0;
        // A sample is enough: some scenes have tens of thousands.
        for index in (0..document.next_accessor()).step_by(37) {
            let Ok(accessor) = document.accessor(index) else { continue };
            if accessor.kind != AccessorKind::Vec3 {
                continue;
            }
            let Some((min, max)) = accessor.min_max() else { continue };
            for position in accessor.read_vec3_f64().unwrap() {
                for axis in 0..3 {
                    let bounds = min[axis] as f32 as f64..=max[axis] as f32 as f64;
                    assert!(bounds.contains(&position[axis]), "{} accessor {index}", path.display());
                }
            }
            checked += 1;
        }
        println!("{}: {checked} accessors", path.display());
    }
}
