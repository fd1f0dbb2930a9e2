//! The fuzz targets of `fuzz/` over fixed mutations of small documents: no nightly compiler needed.

#[path = "../fuzz/common/mod.rs"]
mod fuzz;

use fuzz::mutate::{Random, mutate, scramble};
use fuzz::seeds::Seeds;
use fuzz::targets;
use std::path::Path;
use std::sync::LazyLock;

/// Target and documents; made once.
static SEEDS: LazyLock<Vec<Seeds>> = LazyLock::new(fuzz::seeds::all);

/// Mutations of each seed.
const ROUNDS: u64 = 400;

/// Runs a target over the mutations of its seeds; the last input is named if it panics.
fn smoke(name: &str, target: fn(&[u8])) {
    let (_, seeds) = SEEDS.iter().find(|(target, _)| *target == name).expect("a known target");
    for (number, seed) in seeds.iter().enumerate() {
        target(seed);
        for round in 0..ROUNDS {
            let mut random = Random(round);
            let input = match round % 4 {
                0 => scramble(seed, &mut random),
                _ => mutate(seed, &mut random).expect("a seed holds JSON"),
            };
            let panicked = std::panic::catch_unwind(|| target(&input)).is_err();
            assert!(!panicked, "target {name}, seed {number}, round {round}");
        }
    }
}

#[test]
fn seeds_are_good() {
    for (target, seeds) in SEEDS.iter() {
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
