//! The Khronos glTF validator, an npm package.

use crate::{npm, run};
use std::path::Path;
use std::process::Command;

/// One version, so that a new release does not change what passes.
const PACKAGE: &str = "gltf-validator";
const VERSION: &str = "2.0.0-dev.3.10";

/// Installs the validator if it is missing.
pub(crate) fn install() -> Result<(), String> {
    npm::install(PACKAGE, VERSION)
}

/// Whether the validator is there.
pub(crate) fn installed() -> bool {
    npm::installed(PACKAGE, VERSION)
}

/// Errors and warnings the validator finds in a file.
pub(crate) fn validate(file: &Path) -> Result<(u64, u64), String> {
    let script = run::root().join("tests/cli/khronos_validator.mjs");
    let report = run::json(Command::new("node").arg(script).arg(npm::folder()).arg(file))?;
    let count = |name: &str| report[0][name].as_u64().ok_or_else(|| format!("no `{name}` in {report}"));
    Ok((count("errors")?, count("warnings")?))
}
