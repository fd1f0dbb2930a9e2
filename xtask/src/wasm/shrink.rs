//! Makes a module smaller with Binaryen's `wasm-opt` (npm package `binaryen`, kept in `target/npm`), and measures it.

use crate::{npm, run};
use std::path::Path;
use std::process::Command;

/// One version, so that sizes do not change by themselves.
const PACKAGE: &str = "binaryen";
const VERSION: &str = "132.0.0";

/// Bytes of a module and of its bindings.
#[derive(Debug)]
pub(super) struct Sizes {
    pub(super) raw: u64,
    pub(super) gzip: u64,
    pub(super) brotli: u64,
    pub(super) bindings_gzip: u64,
}

/// Installs Binaryen if it is missing.
pub(super) fn install() -> Result<(), String> {
    npm::install(PACKAGE, VERSION)
}

/// Shrinks `module` in place.
pub(super) fn shrink(module: &Path, bindings: &Path) -> Result<Sizes, String> {
    let small = module.with_extension("small");
    // What Rust's compiler takes for granted of a browser; all have it since 2023.
    let features = [
        "bulk-memory",
        "bulk-memory-opt",
        "multivalue",
        "mutable-globals",
        "nontrapping-float-to-int",
        "reference-types",
        "sign-ext",
    ];
    let mut optimise = Command::new("node");
    optimise
        .arg(npm::folder().join("node_modules/binaryen/bin/wasm-opt"))
        .args(["-Oz", "--converge"])
        // One function of all that is called once is smaller, but not when it is compressed.
        .arg("--one-caller-inline-max-function-size=0")
        // Rust puts the stack first, so that the lowest addresses are only used where it is about to overflow.
        .arg("--low-memory-unused")
        .args(["--strip-debug", "--strip-producers", "--strip-target-features"])
        .args(features.map(|feature| format!("--enable-{feature}")))
        .arg(module)
        .arg("-o")
        .arg(&small);
    run::step("wasm-opt", &mut optimise)?;
    std::fs::rename(&small, module).map_err(|error| format!("{}: {error}", module.display()))?;
    let sizes = run::json(
        Command::new("node").arg(run::root().join("xtask/src/wasm/sizes.mjs")).arg(module).arg(bindings),
    )?;
    let size = |pointer: &str| {
        sizes
            .pointer(pointer)
            .and_then(serde_json::Value::as_u64)
            .ok_or_else(|| format!("no {pointer} in {sizes}"))
    };
    Ok(Sizes {
        raw: size("/0/raw")?,
        gzip: size("/0/gzip")?,
        brotli: size("/0/brotli")?,
        bindings_gzip: size("/1/gzip")?,
    })
}
