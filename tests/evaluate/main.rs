//! `svs evaluate`, end to end, on software Vulkan or whatever GPU there is.
#![cfg(feature = "render")]

#[path = "../common/handmade.rs"]
mod handmade;
mod proxies;
mod report;
mod usage;

use serde_json::Value;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use tempfile::TempDir;

/// Runs the program: exit code, standard output, standard error.
fn svs<S: AsRef<OsStr>>(arguments: &[S]) -> (Option<i32>, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_svs"));
    let output = command.stdin(Stdio::null()).args(arguments).output().expect("svs starts");
    let text = |bytes| String::from_utf8(bytes).expect("UTF-8");
    (output.status.code(), text(output.stdout), text(output.stderr))
}

#[track_caller]
fn succeeds<S: AsRef<OsStr>>(arguments: &[S]) -> (String, String) {
    let (code, stdout, stderr) = svs(arguments);
    assert_eq!(code, Some(0), "{stdout}{stderr}");
    (stdout, stderr)
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A scene baked with few rays.
fn baked(scene: &Path, folder: &TempDir) -> PathBuf {
    let output = folder.path().join("baked.glb");
    let arguments = [OsStr::new("build"), scene.as_os_str(), OsStr::new("-o"), output.as_os_str()];
    let quick = ["--quality", "draft", "--rays", "400000", "-q"].map(OsStr::new);
    succeeds(&[&arguments[..], &quick].concat());
    output
}

/// A small generated scene without a bake.
fn small(folder: &TempDir) -> PathBuf {
    let path = folder.path().join("shells.glb");
    succeeds(&["sample".as_ref(), "shells".as_ref(), "-q".as_ref(), "-o".as_ref(), path.as_os_str()]);
    path
}

/// Evaluates in tiny pictures and gives the summary and the rows of `frames.csv`.
fn evaluate(scene: &Path, report: &Path, more: &[&str]) -> (Value, Vec<Row>) {
    let arguments = [
        OsStr::new("evaluate"),
        scene.as_os_str(),
        OsStr::new("-o"),
        report.as_os_str(),
        OsStr::new("--json"),
    ];
    let more: Vec<&OsStr> =
        ["--size", "320x180", "--passes", "2"].iter().chain(more).map(OsStr::new).collect();
    let (stdout, _) = succeeds(&[&arguments[..], &more].concat());
    let read = |name: &str| std::fs::read_to_string(report.join(name)).expect(name);
    assert_eq!(read("summary.json"), stdout);
    let summary = serde_json::from_str(&stdout).expect("JSON");
    let csv = read("frames.csv");
    let mut lines = csv.lines();
    let columns: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let rows = lines.map(|line| {
        let fields: Vec<&str> = line.split(',').collect();
        assert_eq!(fields.len(), columns.len(), "{line}");
        Row(columns
            .iter()
            .zip(fields)
            .map(|(&column, field)| (column.to_owned(), field.to_owned()))
            .collect())
    });
    (summary, rows.collect())
}

/// A row of `frames.csv`.
#[derive(Debug)]
struct Row(Vec<(String, String)>);

impl Row {
    #[track_caller]
    fn text(&self, column: &str) -> &str {
        &self.0.iter().find(|(name, _)| name == column).expect("the column").1
    }

    #[track_caller]
    fn number(&self, column: &str) -> f64 {
        self.text(column).parse().unwrap_or_else(|_| panic!("{column} in {self:?}"))
    }

    fn key(&self) -> (String, String) {
        (self.text("path").to_owned(), self.text("frame").to_owned())
    }
}
