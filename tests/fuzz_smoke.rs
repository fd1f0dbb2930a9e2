//! The fuzz targets of `fuzz/` over fixed mutations of small documents: no nightly compiler needed.

#[path = "../fuzz/common/mod.rs"]
mod fuzz;

use fuzz::smoke::{SEEDS, smoke};
use fuzz::targets;
use std::path::Path;

#[test]
fn seeds_are_good() {
    for (target, seeds) in SEEDS.iter().filter(|(target, _)| *target != "camera_path") {
        for (number, seed) in seeds.iter().enumerate() {
            let document =
                fuzz::input::document(seed).unwrap_or_else(|| panic!("{target} {number} cannot be read"));
            if *target == "validate" {
                let report = svs::validate::validate(&document);
                assert!(!report.has_errors(), "{number}: {report:#?}");
            }
            if *target == "scene" {
                let options = svs::scene::ReadOptions::default();
                svs::scene::read_scene(&document, &options)
                    .unwrap_or_else(|error| panic!("{number}: {error}"));
            }
        }
    }
}

#[test]
#[ignore = "not a test: writes what libFuzzer starts from into fuzz/corpus"]
fn write_seeds() {
    for (target, seeds) in SEEDS.iter() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(target);
        std::fs::create_dir_all(&folder).expect("the folder");
        for (number, seed) in seeds.iter().enumerate() {
            std::fs::write(folder.join(format!("seed-{number}")), seed).expect("a seed");
        }
    }
}

#[test]
fn glb() {
    smoke("glb", targets::glb);
}

#[test]
fn accessors() {
    smoke("accessors", targets::accessors);
}

#[test]
fn scene() {
    smoke("scene", targets::scene);
}

#[test]
fn extension() {
    smoke("extension", targets::extension);
}

#[test]
fn validate() {
    smoke("validate", targets::validate);
}

#[test]
fn camera_path() {
    smoke("camera_path", targets::camera_path);
}
