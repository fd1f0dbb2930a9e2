//! The web packages in `viewer-web`: what they need, their tests.

use crate::{npm, run, system, wasm};
use std::path::PathBuf;
use std::process::Command;

/// The folder of the web packages.
pub(crate) fn folder() -> PathBuf {
    run::root().join("viewer-web")
}

/// Installs what the web packages and their tests need from npm, as their lock file says, and a browser.
pub(crate) fn install() -> Result<(), String> {
    npm::require_node()?;
    let lock = folder().join("package-lock.json");
    let installed = folder().join("node_modules/.package-lock.json");
    let age = |file: PathBuf| file.metadata().and_then(|metadata| metadata.modified()).ok();
    let is_current = age(installed).is_some_and(|installed| Some(installed) >= age(lock));
    if !is_current {
        let mut npm = npm::npm();
        npm.args(["ci", "--no-audit", "--no-fund", "--loglevel=error"]).current_dir(folder());
        run::step("install the packages of viewer-web", &mut npm)?;
    }
    if std::env::var_os("SVS_CHROMIUM").is_none() && !PathBuf::from("/usr/bin/chromium").is_file() {
        system::install_packages(&["chromium"])?;
    }
    Ok(())
}

/// Builds the modules, checks the types and runs the tests in Node.js and in a browser.
pub(crate) fn test() -> Result<(), String> {
    install()?;
    wasm::wasm(&wasm::Options::default())?;
    run::step("types of viewer-web", npm::npm().args(["run", "--silent", "check"]).current_dir(folder()))?;
    // What they run themselves: built here, so that the build counts for no test's time.
    run::step("svs", run::cargo().args(["build", "--release", "--package", "svs", "--bin", "svs"]))?;
    run::step("draws", run::cargo().args(["build", "--release", "--package", "svs", "--example", "draws"]))?;
    let tests =
        std::fs::read_dir(folder().join("tests")).map_err(|error| format!("viewer-web/tests: {error}"))?;
    let mut tests: Vec<PathBuf> = tests.flatten().map(|entry| entry.path()).collect();
    tests.retain(|file| file.to_string_lossy().ends_with(".test.mjs"));
    tests.sort();
    // One file after the other: browsers without a GPU use all cores.
    let mut node = Command::new("node");
    node.args(["--test", "--test-concurrency=1", "--test-reporter=spec"]).args(tests).current_dir(folder());
    run::step("tests of viewer-web", &mut node)
}
