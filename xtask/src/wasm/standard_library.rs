//! Rust's standard library for wasm: rustup's target, or one made of rustup's or Debian's sources.

use crate::{run, system};
use std::path::{Path, PathBuf};
use std::process::Command;

const TARGET: &str = "wasm32-unknown-unknown";
/// Debian's compiler, in the version that builds web browsers, and the sources of its standard library.
const PACKAGES: &[&str] = &["rustc-web", "rust-web-src"];
const DEBIAN_RUSTC: &str = "/usr/bin/rustc";
/// How the small standard library and what uses it are compiled.
const SMALL: &str =
    "-Zunstable-options -Cpanic=immediate-abort -Zlocation-detail=none -Zfmt-debug=none -Cembed-bitcode=yes";

/// Where the standard library comes from.
#[derive(Debug)]
pub(super) enum StandardLibrary {
    /// `rustup target add wasm32-unknown-unknown` was done, or could be.
    Rustup { has_sources: bool },
    /// Debian's compiler with a sysroot of our own, and the linker that rustup's toolchain has.
    Debian { sysroot: PathBuf, linker: PathBuf },
}

impl StandardLibrary {
    /// Finds one, and installs one if there is none. With `debian` rustup's is not looked for.
    pub(super) fn find(debian: bool) -> Result<Self, String> {
        let toolchain = PathBuf::from(printed(Command::new("rustc").args(["--print", "sysroot"]))?);
        if !debian {
            let folder = toolchain.join("lib/rustlib").join(TARGET);
            if folder.is_dir() || run::succeeds(Command::new("rustup").args(["target", "add", TARGET])) {
                let sources = toolchain.join("lib/rustlib/src/rust/library");
                let has_sources = sources.is_dir()
                    || run::succeeds(Command::new("rustup").args(["component", "add", "rust-src"]));
                return Ok(Self::Rustup { has_sources });
            }
        }
        if !Path::new("/usr/src").is_dir() || !system::install_packages(missing())? {
            return Err(format!(
                "the standard library for {TARGET} is missing: run `rustup target add {TARGET}` and try again"
            ));
        }
        let host = printed(Command::new("rustc").args(["--print", "host-tuple"]))?;
        let linker = toolchain.join("lib/rustlib").join(host).join("bin/rust-lld");
        let sysroot = run::target().join("wasm-sysroot");
        build(&sysroot, &linker)?;
        Ok(Self::Debian { sysroot, linker })
    }

    /// Build outputs: compilers must not meet in one folder, for what one has built the other one builds anew.
    pub(super) fn target_folder(&self, small: bool) -> PathBuf {
        run::target().join(match (self, small) {
            (Self::Rustup { .. }, false) => "wasm",
            (Self::Rustup { .. }, true) => "wasm-small",
            (Self::Debian { .. }, false) => "wasm-debian",
            (Self::Debian { .. }, true) => "wasm-debian-small",
        })
    }

    /// Lets a `cargo build` for wasm use it.
    pub(super) fn apply(&self, cargo: &mut Command) {
        let Self::Debian { sysroot, linker } = self else { return };
        cargo
            .env("RUSTC", DEBIAN_RUSTC)
            .env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER", linker)
            .env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS", format!("--sysroot={}", sysroot.display()));
    }

    /// There are sources to build the small one from: without, `rustup component add rust-src` has failed.
    pub(super) fn can_be_small(&self) -> bool {
        matches!(self, Self::Debian { .. } | Self::Rustup { has_sources: true })
    }

    /// Lets a `cargo build` for wasm use a standard library of its own, which is 9 kB smaller, compressed: with the smaller of two
    /// algorithms wherever it has two, such as for sorting, and panics that trap at once, without a message, which nobody
    /// reads in a module that has no console.
    ///
    /// It asks the stable compiler for features that are not stable.
    pub(super) fn apply_small(&self, cargo: &mut Command) {
        cargo
            .args(["-Zbuild-std=std,panic_abort", "-Zbuild-std-features=optimize_for_size"])
            .env("RUSTC_BOOTSTRAP", "1")
            .env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS", SMALL);
        if let Self::Debian { linker, .. } = self {
            cargo.env("RUSTC", DEBIAN_RUSTC).env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER", linker);
        }
    }
}

fn missing() -> &'static [&'static str] {
    let sources = std::fs::read_dir("/usr/src").ok().into_iter().flatten().flatten();
    let has_sources =
        sources.into_iter().any(|entry| entry.file_name().to_string_lossy().starts_with("rustc-"));
    if has_sources && Path::new(DEBIAN_RUSTC).is_file() { &[] } else { PACKAGES }
}

/// Builds the standard library with Debian's compiler, once for each version of it: compiler and sources must be of one
/// version, so rustup's own compiler cannot do it.
///
/// After this, ordinary builds need no unstable feature.
fn build(sysroot: &Path, linker: &Path) -> Result<(), String> {
    let version = printed(Command::new(DEBIAN_RUSTC).arg("-vV"))?;
    let stamp = sysroot.join("built-with");
    if std::fs::read_to_string(&stamp).is_ok_and(|built| built == version) {
        return Ok(());
    }
    let failed = |error: std::io::Error| format!("the standard library for wasm: {error}");
    // A crate of nothing, for cargo to build the standard library for.
    let seed = run::target().join("wasm-sysroot-seed");
    std::fs::create_dir_all(seed.join("src")).map_err(failed)?;
    std::fs::write(seed.join("src/lib.rs"), "").map_err(failed)?;
    let manifest = "[package]\nname = \"seed\"\nversion = \"0.0.0\"\nedition = \"2021\"\n\
                    [workspace]\n[profile.release]\npanic = \"abort\"\n";
    std::fs::write(seed.join("Cargo.toml"), manifest).map_err(failed)?;
    let outputs = seed.join("target");
    run::step(
        "build the standard library for wasm",
        run::cargo()
            .current_dir(&seed)
            .args(["build", "--release", "-Zbuild-std=std,panic_abort", "--target", TARGET])
            .env("RUSTC", DEBIAN_RUSTC)
            // Debian's stable compiler takes unstable options only so.
            .env("RUSTC_BOOTSTRAP", "1")
            .env("CARGO_TARGET_DIR", &outputs)
            // Link-time optimisation wants it.
            .env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS", "-Cembed-bitcode=yes")
            .env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER", linker),
    )?;
    if sysroot.exists() {
        std::fs::remove_dir_all(sysroot).map_err(failed)?;
    }
    let libraries = sysroot.join("lib/rustlib").join(TARGET).join("lib");
    std::fs::create_dir_all(&libraries).map_err(failed)?;
    for entry in std::fs::read_dir(outputs.join(TARGET).join("release/deps")).map_err(failed)? {
        let file = entry.map_err(failed)?.path();
        let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if name.ends_with(".rlib") && !name.starts_with("libseed-") {
            std::fs::copy(&file, libraries.join(&name)).map_err(failed)?;
        }
    }
    std::fs::remove_dir_all(&seed).map_err(failed)?;
    std::fs::write(stamp, version).map_err(failed)
}

/// What a program prints, which must end well.
fn printed(command: &mut Command) -> Result<String, String> {
    let output = command.output().map_err(|error| format!("{:?}: {error}", command.get_program()))?;
    let text = String::from_utf8_lossy(&output.stdout).trim().to_owned();
    if output.status.success() { Ok(text) } else { Err(format!("{command:?} failed ({})", output.status)) }
}
