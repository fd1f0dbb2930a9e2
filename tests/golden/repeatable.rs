//! The same bytes, whatever the number of threads, and from the output once more.

use crate::baking::{document, options};
use std::path::Path;
use svs::bake::{self, BakeOptions, HierarchyChoice, Silent};
use svs::generate::{SampleKind, SampleOptions, generate};
use svs::gltf::Document;

fn automatic() -> BakeOptions {
    BakeOptions { hierarchy: HierarchyChoice::Auto, prune: None, ..options(1 << 19) }
}

/// Bakes a file with so many threads; all files of the output by name.
fn built(input: &Path, extension: &str, threads: usize) -> (tempfile::TempDir, Vec<(String, Vec<u8>)>) {
    let folder = tempfile::tempdir().expect("a folder");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    pool.install(|| {
        let mut doc = Document::read(input).expect("readable");
        bake::build(&mut doc, &automatic(), &Silent).expect("a bake");
        doc.write(&folder.path().join("scene").with_extension(extension)).expect("written");
    });
    let mut files: Vec<(String, Vec<u8>)> = std::fs::read_dir(folder.path())
        .expect("a folder")
        .map(|entry| {
            let path = entry.expect("a file").path();
            let name = path.file_name().expect("a name").to_string_lossy().into_owned();
            (name, std::fs::read(path).expect("readable"))
        })
        .collect();
    files.sort();
    (folder, files)
}

#[test]
fn threads_and_second_builds_change_no_byte() {
    for (kind, scale) in [(SampleKind::Plant, 0.05), (SampleKind::City, 0.05), (SampleKind::Cubes, 0.1)] {
        let folder = tempfile::tempdir().expect("a folder");
        for extension in ["glb", "gltf"] {
            let input = folder.path().join("scene").with_extension(extension);
            let sample = generate(&SampleOptions { scale, ..SampleOptions::new(kind) });
            document(sample).write(&input).expect("written");
            let (output, one) = built(&input, extension, 1);
            let names: Vec<&str> = one.iter().map(|(name, _)| name.as_str()).collect();
            let has_extension = |bytes: &[u8]| bytes.windows(24).any(|w| w == b"EXT_spherical_visibility");
            assert!(one.iter().any(|(_, bytes)| has_extension(bytes)), "{kind:?} {names:?}");
            let (_, two) = built(&input, extension, 2);
            assert!(one == two, "{kind:?} {extension}: threads change the result, {names:?}");
            let (_, again) = built(&output.path().join("scene").with_extension(extension), extension, 2);
            assert!(one == again, "{kind:?} {extension}: a second build changes the result, {names:?}");
        }
    }
}
