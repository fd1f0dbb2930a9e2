//! End-to-end tests of the `svs` program.

mod bake;
mod broken_input;
#[cfg(feature = "render")]
#[path = "../common/handmade.rs"]
mod handmade;
mod khronos_validator;
mod process;
mod proxies;
mod remove_hidden;
#[cfg(feature = "render")]
mod render;
mod sample_grid;
mod usage;

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

/// The program under test.
fn svs() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_svs"));
    command.stdin(Stdio::null());
    // Mesa's layer that chooses among several GPUs complains on standard error where there is no display.
    command.env("NODEVICE_SELECT", "1");
    command
}

/// Runs the program to its end.
fn run<S: AsRef<OsStr>>(arguments: &[S]) -> Finished {
    Finished::from(svs().args(arguments).output().expect("svs starts"))
}

/// What a run left behind.
#[derive(Debug)]
struct Finished {
    code: Option<i32>,
    stdout: String,
    stderr: String,
}

impl From<Output> for Finished {
    fn from(output: Output) -> Self {
        Self {
            code: output.status.code(),
            stdout: String::from_utf8(output.stdout).expect("UTF-8 on stdout"),
            stderr: String::from_utf8(output.stderr).expect("UTF-8 on stderr"),
        }
    }
}

impl Finished {
    /// It must have succeeded, silently on standard error: no progress bars where there is no terminal.
    #[track_caller]
    fn ok(self) -> Self {
        assert_eq!(self.code, Some(0), "{self:?}");
        assert_eq!(self.stderr, "", "{self:?}");
        self
    }

    /// It must have failed with this code and said all of this.
    #[track_caller]
    fn fails(self, code: i32, words: &[&str]) -> Self {
        assert_eq!(self.code, Some(code), "{self:?}");
        for word in words {
            assert!(self.stderr.contains(word), "{word:?} is not in {self:?}");
        }
        assert!(!self.stderr.contains("panicked"), "{self:?}");
        self
    }

    #[track_caller]
    fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.stdout).unwrap_or_else(|error| panic!("{error} in {self:?}"))
    }
}

/// The sample scene of the repository.
fn plant() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/plant.glb")
}

/// A folder of its own for each test.
fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

/// A small generated scene in `folder`.
fn small_scene(folder: &TempDir, name: &str) -> PathBuf {
    let path = folder.path().join(name);
    run(&["sample".as_ref(), "shells".as_ref(), "-q".as_ref(), "-o".as_ref(), path.as_os_str()]).ok();
    path
}

/// Bakes with few rays.
fn build(input: &Path, output: &Path, more: &[&str]) -> Finished {
    let quick = ["--quality", "draft", "--rays", "200000"];
    Finished::from(
        svs()
            .arg("build")
            .arg(input)
            .arg("-o")
            .arg(output)
            .args(quick)
            .args(more)
            .output()
            .expect("svs starts"),
    )
}

/// Names of the files in a folder, sorted.
fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("the folder is there");
    let mut names: Vec<String> =
        entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}
