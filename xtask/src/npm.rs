//! Tools from npm, kept in `target/npm`.

use crate::run;
use std::path::PathBuf;
use std::process::Command;

/// Where the packages are.
pub(crate) fn folder() -> PathBuf {
    run::target().join("npm")
}

/// `npm` itself.
pub(crate) fn npm() -> Command {
    Command::new(if cfg!(windows) { "npm.cmd" } else { "npm" })
}

/// Fails with what to do if there is no Node.js.
pub(crate) fn require_node() -> Result<(), String> {
    if run::succeeds(Command::new("node").arg("--version")) && run::succeeds(npm().arg("--version")) {
        return Ok(());
    }
    Err("Node.js is missing: the web packages, their tests and the Khronos glTF validator need it. Install Node.js 20 or \
         newer with npm (`apt-get install nodejs npm`, https://nodejs.org) so that `node` and `npm` are on the PATH, and \
         run this again"
        .to_owned())
}

/// Whether this version of a package is there.
pub(crate) fn installed(package: &str, version: &str) -> bool {
    let manifest = folder().join("node_modules").join(package).join("package.json");
    let manifest = std::fs::read(manifest).ok();
    let manifest: Option<serde_json::Value> = manifest.and_then(|bytes| serde_json::from_slice(&bytes).ok());
    manifest.is_some_and(|manifest| manifest["version"] == version)
}

/// Installs a package if it is missing.
pub(crate) fn install(package: &str, version: &str) -> Result<(), String> {
    require_node()?;
    if installed(package, version) {
        return Ok(());
    }
    run::step(
        &format!("install {package} {version}"),
        npm()
            .args(["install", "--no-audit", "--no-fund", "--loglevel=error", "--save-exact", "--prefix"])
            .arg(folder())
            .arg(format!("{package}@{version}")),
    )
}
