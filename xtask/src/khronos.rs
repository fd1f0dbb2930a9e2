//! The Khronos glTF validator: npm package `gltf-validator`, kept in `target/npm`.

use crate::run;
use std::path::{Path, PathBuf};
use std::process::Command;

/// One version, so that a new release does not change what passes.
const PACKAGE: &str = "gltf-validator@2.0.0-dev.3.10";

fn folder() -> PathBuf {
    run::target().join("npm")
}

/// Installs the validator if it is missing.
pub(crate) fn install() -> Result<(), String> {
    if installed() {
        return Ok(());
    }
    if !run::succeeds(Command::new("node").arg("--version")) {
        return Err("Node.js is missing: the Khronos glTF validator needs it. Install Node.js 18 or newer \
                    (`apt-get install nodejs npm`, https://nodejs.org) so that `node` and `npm` are on the PATH, \
                    and run this again"
            .to_owned());
    }
    let npm = if cfg!(windows) { "npm.cmd" } else { "npm" };
    run::step(
        "install the Khronos glTF validator",
        Command::new(npm)
            .args(["install", "--no-save", "--no-audit", "--no-fund", "--loglevel=error", "--prefix"])
            .arg(folder())
            .arg(PACKAGE),
    )
}

/// Whether the validator is there.
pub(crate) fn installed() -> bool {
    folder().join("node_modules/gltf-validator/package.json").is_file()
}

/// Errors and warnings the validator finds in a file.
pub(crate) fn validate(file: &Path) -> Result<(u64, u64), String> {
    let script = run::root().join("tests/cli/khronos_validator.mjs");
    let report = run::json(Command::new("node").arg(script).arg(folder()).arg(file))?;
    let count = |name: &str| report[0][name].as_u64().ok_or_else(|| format!("no `{name}` in {report}"));
    Ok((count("errors")?, count("warnings")?))
}
