//! `cargo xtask wasm`: builds the web modules, and fails if one is too large.

mod shrink;
mod standard_library;

use crate::run;
use crate::table;
use standard_library::StandardLibrary;
use std::path::Path;

/// A crate that becomes a wasm module with JavaScript bindings.
struct Module {
    /// Package of the workspace; the library of type `cdylib` is named after it.
    package: &'static str,
    /// Feature that it is built with, if it has several shapes.
    feature: Option<&'static str>,
    /// Optimisation level of the compiler: 2 where time counts, s where size does.
    opt_level: &'static str,
    /// Where the module and its bindings go, from the repository's root.
    folder: &'static str,
    /// Largest size in bytes after brotli, which all browsers with WebAssembly read.
    limit: u64,
    /// Built with a small standard library where that can be done, see [`StandardLibrary::apply_small`]; where it cannot, this
    /// is the limit.
    small: Option<u64>,
}

const MODULES: &[Module] = &[
    Module {
        package: "svs-runtime-wasm",
        feature: None,
        opt_level: "2",
        folder: "viewer-web/runtime/wasm",
        limit: 60_000,
        small: Some(72_000),
    },
    Module {
        package: "svs-viewer-web",
        feature: Some("webgpu"),
        opt_level: "s",
        folder: "viewer-web/dist/webgpu",
        limit: 1_000_000,
        small: None,
    },
    Module {
        package: "svs-viewer-web",
        feature: Some("webgl"),
        opt_level: "s",
        folder: "viewer-web/dist/webgl",
        limit: 1_000_000,
        small: None,
    },
];

/// The page of the viewer, and where it lies with its modules.
const PAGE: [&str; 2] = ["viewer-web/viewer/page", "viewer-web/dist"];

impl Module {
    /// Package and feature.
    fn name(&self) -> String {
        self.feature.map_or_else(|| self.package.to_owned(), |feature| format!("{}, {feature}", self.package))
    }
}

/// What `cargo xtask wasm` was asked for.
#[derive(Debug, Default)]
pub(crate) struct Options {
    only: Option<String>,
    debian: bool,
}

impl Options {
    /// Modules whose name contains this.
    pub(crate) fn only(name: &str) -> Self {
        Self { only: Some(name.to_owned()), ..Self::default() }
    }

    /// Reads the arguments after `wasm`.
    pub(crate) fn parse(mut arguments: &[&str]) -> Result<Self, String> {
        let mut options = Self::default();
        while let [first, rest @ ..] = arguments {
            arguments = match (*first, rest) {
                ("--only", [name, rest @ ..]) => {
                    options.only = Some((*name).to_owned());
                    rest
                }
                ("--std", ["debian", rest @ ..]) => {
                    options.debian = true;
                    rest
                }
                ("--std", ["auto", rest @ ..]) => rest,
                _ => {
                    return Err(format!(
                        "`wasm` does not know `{}`; see `cargo xtask help`",
                        arguments.join(" ")
                    ));
                }
            };
        }
        Ok(options)
    }
}

/// Builds the modules and prints their sizes.
pub(crate) fn wasm(options: &Options) -> Result<(), String> {
    let wanted = |module: &&Module| options.only.as_deref().is_none_or(|name| module.name().contains(name));
    let modules: Vec<&Module> = MODULES.iter().filter(wanted).collect();
    if modules.is_empty() {
        let all: Vec<String> = MODULES.iter().map(Module::name).collect();
        return Err(format!("no module of that name; there are {}", all.join(", ")));
    }
    shrink::install()?;
    let library = StandardLibrary::find(options.debian)?;
    let (mut rows, mut too_large) = (Vec::new(), Vec::new());
    for module in modules {
        let small = module.small.is_some() && library.can_be_small();
        let limit = module.small.filter(|_| !small).unwrap_or(module.limit);
        let sizes = build(module, &library, small)?;
        let bytes = |size: u64| table::count(size as f64);
        rows.push(vec![
            module.name(),
            if small { "small" } else { "as delivered" }.to_owned(),
            bytes(sizes.raw),
            bytes(sizes.gzip),
            bytes(sizes.brotli),
            bytes(sizes.bindings_gzip),
            bytes(limit),
        ]);
        if sizes.brotli > limit {
            too_large.push(format!("{} by {} bytes", module.name(), sizes.brotli - limit));
        }
    }
    page()?;
    let head =
        ["module", "standard library", "bytes", "gzip -9", "brotli", "bindings, gzip -9", "limit of brotli"];
    print!("{}", table::markdown(&head, &rows));
    if too_large.is_empty() { Ok(()) } else { Err(format!("too large: {}", too_large.join(", "))) }
}

/// Puts the page beside its modules.
fn page() -> Result<(), String> {
    let [from, to] = PAGE.map(|folder| run::root().join(folder));
    let failed = |error: std::io::Error| format!("{}: {error}", to.display());
    std::fs::create_dir_all(&to).map_err(failed)?;
    for entry in std::fs::read_dir(from).map_err(failed)? {
        let file = entry.map_err(failed)?;
        std::fs::copy(file.path(), to.join(file.file_name())).map_err(failed)?;
    }
    Ok(())
}

fn build(module: &Module, library: &StandardLibrary, small: bool) -> Result<shrink::Sizes, String> {
    let target = library.target_folder(small);
    let mut cargo = run::cargo();
    cargo
        .args(["build", "--profile", "wasm", "--lib", "--target", "wasm32-unknown-unknown"])
        .args(["--package", module.package])
        .args(module.feature.map(|feature| format!("--features={feature}")))
        .env("CARGO_PROFILE_WASM_OPT_LEVEL", module.opt_level)
        .env("CARGO_TARGET_DIR", &target);
    if small {
        library.apply_small(&mut cargo)
    } else {
        library.apply(&mut cargo)
    }
    run::step(&format!("build {}", module.name()), &mut cargo)?;
    let name = module.package.replace('-', "_");
    let built = target.join("wasm32-unknown-unknown/wasm").join(format!("{name}.wasm"));
    let folder = run::root().join(module.folder);
    bindings(&built, &folder)?;
    shrink::shrink(&folder.join(format!("{name}_bg.wasm")), &folder.join(format!("{name}.js")))
}

fn bindings(module: &Path, folder: &Path) -> Result<(), String> {
    // Nothing of an earlier build stays.
    if folder.exists() {
        std::fs::remove_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    }
    run::step(
        "bindings",
        run::cargo()
            .args(["run", "--quiet", "--release", "--package", "svs-bindgen", "--"])
            .args([module, folder]),
    )
}
