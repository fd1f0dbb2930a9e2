//! The Khronos glTF validator on everything that is written: no errors and no warnings where the input has none.
//!
//! `cargo xtask test` installs the validator into `target/npm` and makes its absence an error; without it, these
//! tests pass over what they cannot check and say so.

use crate::{build, folder, plant, run};
use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Folder of the npm package, `None` (after saying so) if it is not installed.
fn npm() -> Option<PathBuf> {
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from);
    let folder = target.join("npm");
    if folder.join("node_modules/gltf-validator").is_dir() {
        return Some(folder);
    }
    assert!(std::env::var_os("SVS_REQUIRE_KHRONOS").is_none(), "no gltf-validator in {}", folder.display());
    eprintln!("not checked: no gltf-validator in {}; run `cargo xtask test`", folder.display());
    None
}

/// Reports of all files: `{file, errors, warnings, messages}`.
fn reports(npm: &Path, files: &[PathBuf]) -> Vec<serde_json::Value> {
    let output = Command::new("node")
        .arg(root().join("tests/cli/khronos_validator.mjs"))
        .arg(npm)
        .args(files)
        .output()
        .expect("node starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON from the validator")
}

/// Bakes every input and compares what the validator says of it before and after.
fn check(inputs: &[PathBuf], extension: &str) {
    let Some(npm) = npm() else { return };
    let folder = folder();
    let mut files = Vec::new();
    for (index, input) in inputs.iter().enumerate() {
        let output = folder.path().join(format!("{index}.{extension}"));
        build(input, &output, &["-q"]).ok();
        let proxies = folder.path().join(format!("{index}.proxies.{extension}"));
        let format = ["float", "quantized", "meshopt"][index % 3];
        let options =
            ["-q", "--proxies", "auto", "--proxy-triangles", "500", "--proxy-format", format, "--msft-lod"];
        build(input, &proxies, &options).ok();
        files.extend([input.clone(), output, proxies]);
    }
    for baked in reports(&npm, &files).chunks(3) {
        let issues = |report: &serde_json::Value| (report["errors"].as_u64(), report["warnings"].as_u64());
        if issues(&baked[0]) == (Some(0), Some(0)) {
            for report in &baked[1..] {
                assert_eq!(issues(report), (Some(0), Some(0)), "{} baked: {report}", baked[0]["file"]);
            }
        }
    }
}

#[test]
fn generated_scenes() {
    let folder = folder();
    let mut inputs = vec![plant()];
    for (kind, name) in
        [("plant", "p.gltf"), ("city", "c.glb"), ("cubes", "q.glb"), ("boxes", "b.glb"), ("shells", "s.gltf")]
    {
        let path = folder.path().join(name);
        let arguments = ["sample", kind, "-q", "-o"].map(std::ffi::OsStr::new);
        run(&[&arguments[..], &[path.as_os_str()]].concat()).ok();
        inputs.push(path);
    }
    check(&inputs, "glb");
    check(&inputs[..2], "gltf");
}

/// Larger public scenes are left to `cargo xtask bench scenes`, which runs this validator too.
const LARGEST: u64 = 5_000_000;

/// The smaller public scenes, where they lie beside the repository.
#[test]
fn public_scenes() {
    let scenes = root().join("../shared/scenes");
    let Ok(entries) = std::fs::read_dir(&scenes) else {
        eprintln!("not checked: there is no {}", scenes.display());
        return;
    };
    let files =
        |folder: &Path| std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut inputs: Vec<PathBuf> = entries
        .flatten()
        .flat_map(|entry| files(&entry.path()).collect::<Vec<_>>())
        .filter(|path| path.extension().is_some_and(|extension| extension == "glb"))
        .filter(|path| path.metadata().is_ok_and(|data| data.len() <= LARGEST))
        .collect();
    inputs.sort();
    check(&inputs, "glb");
}
