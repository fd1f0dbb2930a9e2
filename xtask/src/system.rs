//! What the tests need of the system: a C++ compiler, software Vulkan, and a display for the viewer.

use crate::run;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Packages of Debian and its relatives. The libraries are those that the viewer loads at run time on X11.
/// For `meshopt`, which is C++.
const COMPILER: &[&str] = &["g++"];
const VULKAN: &[&str] = &["mesa-vulkan-drivers"];
const DISPLAY: &[&str] =
    &["xvfb", "xdotool", "libx11-6", "libx11-xcb1", "libxcursor1", "libxi6", "libxkbcommon-x11-0"];

/// Installs what is missing. Nothing is done where there is no `apt-get`: the tests then say what they lack.
pub(crate) fn install() -> Result<(), String> {
    if !cfg!(target_os = "linux") {
        return Ok(());
    }
    let mut missing: Vec<&str> = Vec::new();
    if std::env::var_os("CXX").is_none()
        && !["c++", "g++", "clang++"].iter().any(|cxx| on_path(cxx).is_some())
    {
        missing.extend(COMPILER);
    }
    if !has_vulkan() {
        missing.extend(VULKAN);
    }
    if !["Xvfb", "xdotool"].iter().all(|program| on_path(program).is_some()) {
        missing.extend(DISPLAY);
    }
    install_packages(&missing).map(drop)
}

/// Installs packages of Debian and its relatives; `false` if some are asked for and there is no `apt-get`.
pub(crate) fn install_packages(packages: &[&str]) -> Result<bool, String> {
    if packages.is_empty() {
        return Ok(true);
    }
    if on_path("apt-get").is_none() {
        return Ok(false);
    }
    // Package lists may be missing or old; an error here shows up as one of the installation.
    let _ = apt(&["update", "-qq"]).status();
    let mut install = apt(&["install", "-y", "-qq", "--no-install-recommends"]);
    run::step(&format!("install {}", packages.join(" ")), install.args(packages))?;
    Ok(true)
}

/// A Vulkan driver has left its description where loaders look for it.
fn has_vulkan() -> bool {
    if std::env::var_os("VK_DRIVER_FILES").is_some() || std::env::var_os("VK_ICD_FILENAMES").is_some() {
        return true;
    }
    ["/usr/share/vulkan/icd.d", "/usr/local/share/vulkan/icd.d", "/etc/vulkan/icd.d"]
        .iter()
        .filter_map(|folder| std::fs::read_dir(folder).ok())
        .flatten()
        .flatten()
        .any(|entry| entry.path().extension().is_some_and(|extension| extension == "json"))
}

/// Where a program is.
pub(crate) fn on_path(program: &str) -> Option<PathBuf> {
    let paths = std::env::var_os("PATH")?;
    std::env::split_paths(&paths).map(|folder| folder.join(program)).find(|file| file.is_file())
}

/// `apt-get` as root: by itself, or through `sudo` where that asks no password.
fn apt(arguments: &[&str]) -> Command {
    let is_root = std::fs::metadata("/proc/self").is_ok_and(|own| uid(&own) == 0);
    let mut command = if is_root || on_path("sudo").is_none() {
        Command::new("apt-get")
    } else {
        let mut sudo = Command::new("sudo");
        sudo.args(["-n", "apt-get"]);
        sudo
    };
    command.args(arguments).env("DEBIAN_FRONTEND", "noninteractive").current_dir(Path::new("/"));
    command
}

#[cfg(unix)]
fn uid(metadata: &std::fs::Metadata) -> u32 {
    std::os::unix::fs::MetadataExt::uid(metadata)
}

#[cfg(not(unix))]
fn uid(_: &std::fs::Metadata) -> u32 {
    0
}
