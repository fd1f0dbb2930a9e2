//! Measurements over whole scenes.

pub(crate) mod frames;
pub(crate) mod proxies;
pub(crate) mod scenes;
pub(crate) mod viewer;
pub(crate) mod web;

use crate::run;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// `svs`, as it was just built.
fn svs() -> Command {
    Command::new(run::target().join("release").join(format!("svs{}", std::env::consts::EXE_SUFFIX)))
}

fn build_svs() -> Result<(), String> {
    run::step("build svs", run::cargo().args(["build", "--release", "--package", "svs", "--bin", "svs"]))
}

/// A folder below `target/bench`, made if it is not there.
fn folder(name: &str) -> Result<PathBuf, String> {
    let folder = run::target().join("bench").join(name);
    std::fs::create_dir_all(&folder)
        .map_err(|error| format!("cannot create {}: {error}", folder.display()))?;
    Ok(folder)
}

/// Name and file of each public scene: a folder's GLB.
fn find_scenes(scenes: &Path, only: &str) -> Result<Vec<(String, PathBuf)>, String> {
    let entries = |folder: &Path| -> Result<Vec<PathBuf>, String> {
        let list = std::fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        let mut paths: Vec<PathBuf> = list.filter_map(|entry| entry.ok().map(|entry| entry.path())).collect();
        paths.sort();
        Ok(paths)
    };
    let mut found = Vec::new();
    for folder in entries(scenes)? {
        let name = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if !folder.is_dir() || !name.contains(only) {
            continue;
        }
        let glb = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "glb");
        found.extend(entries(&folder)?.into_iter().find(glb).map(|file| (name, file)));
    }
    Ok(found)
}

/// Number at a JSON pointer, NaN if there is none.
fn at(value: &Value, pointer: &str) -> f64 {
    value.pointer(pointer).and_then(Value::as_f64).unwrap_or(f64::NAN)
}

/// After each scene: an interrupted run loses nothing.
fn save(path: &Path, value: &Value) -> Result<(), String> {
    std::fs::write(path, format!("{value:#}\n"))
        .map_err(|error| format!("cannot write {}: {error}", path.display()))
}
