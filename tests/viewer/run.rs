//! Runs the program on scenes made for it.

use crate::display::Display;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// A machine that is busy with other tests draws slowly.
const PATIENCE: Duration = Duration::from_secs(240);

/// A folder, a display, and the program between them.
pub(crate) struct Stand {
    pub(crate) folder: TempDir,
    pub(crate) display: Display,
}

impl Stand {
    pub(crate) fn new() -> Self {
        Self { folder: tempfile::tempdir().expect("a folder"), display: Display::start() }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// A factory hall of 400 objects with baked visibility.
    pub(crate) fn plant(&self) -> PathBuf {
        let (plain, baked) = (self.sample("plant", "0.1"), self.path("plant.svs.glb"));
        let build = ["build", "--quality", "draft", "--rays", "200000", "--prune", "0", "-q", "-o"];
        svs(&build, &[&baked, &plain]);
        baked
    }

    /// A generated scene without baked visibility.
    pub(crate) fn sample(&self, kind: &str, scale: &str) -> PathBuf {
        let path = self.path(&format!("{kind}.glb"));
        svs(&["sample", kind, "--scale", scale, "-q", "-o"], &[&path]);
        path
    }

    /// The viewer, not yet started.
    pub(crate) fn viewer(&self, file: &Path) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_svs"));
        command.arg("view").arg(file).env("DISPLAY", self.display.name()).env_remove("WAYLAND_DISPLAY");
        command.env_remove("WAYLAND_SOCKET").current_dir(self.folder.path());
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    /// Runs steps on a file to their end. Files in the steps are relative to the folder.
    pub(crate) fn script(&self, file: &Path, steps: &Value) {
        let output = self.try_script(file, steps);
        let text = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{text}");
        assert!(!text.contains("panicked"), "{text}");
    }

    pub(crate) fn try_script(&self, file: &Path, steps: &Value) -> Output {
        let script = self.path("script.json");
        std::fs::write(&script, steps.to_string()).expect("the script is written");
        let child = self.viewer(file).arg("--script").arg(script).spawn().expect("svs starts");
        finish(child)
    }

    /// What a step `dump` wrote.
    pub(crate) fn dump(&self, name: &str) -> Value {
        let text = std::fs::read_to_string(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
        serde_json::from_str(&text).expect("a dump is JSON")
    }
}

/// Waits for a program to end, for a while.
pub(crate) fn finish(mut child: Child) -> Output {
    let begin = Instant::now();
    while child.try_wait().expect("it can be asked").is_none() {
        if begin.elapsed() > PATIENCE {
            let _ = child.kill();
            let output = child.wait_with_output().expect("it was ended");
            panic!("svs view does not end: {}", String::from_utf8_lossy(&output.stderr));
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    child.wait_with_output().expect("it has ended")
}

/// A window that stays open while a test uses it.
pub(crate) struct Open<'a> {
    stand: &'a Stand,
    child: Child,
}

impl<'a> Open<'a> {
    /// Opens a window that writes what happens to `state.json`.
    pub(crate) fn new(stand: &'a Stand, file: &Path) -> Self {
        let script = stand.path("watch.json");
        std::fs::write(&script, r#"[{"watch": "state.json"}, "stay"]"#).expect("the script is written");
        let child = stand.viewer(file).arg("--script").arg(script).spawn().expect("svs starts");
        let mut open = Self { stand, child };
        open.until("a first frame", |state| state["frames"].as_u64() > Some(0));
        // There is no window manager here that would give it the keyboard.
        stand.display.xdotool("search --onlyvisible --name svs windowfocus");
        open
    }

    /// What the window did last.
    pub(crate) fn state(&self) -> Value {
        self.stand.dump("state.json")
    }

    /// Waits until something is so.
    #[track_caller]
    pub(crate) fn until(&mut self, what: &str, holds: impl Fn(&Value) -> bool) -> Value {
        let begin = Instant::now();
        let mut last = Value::Null;
        while begin.elapsed() < PATIENCE / 4 {
            assert!(
                self.child.try_wait().expect("it can be asked").is_none(),
                "the window is gone before {what}"
            );
            if self.stand.path("state.json").exists() {
                last = self.state();
                if holds(&last) {
                    return last;
                }
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        panic!("waited in vain for {what}: {last:#}");
    }

    /// The middle of a control, in pixels of the window (which fills the display).
    #[track_caller]
    pub(crate) fn middle(&self, control: &str) -> (i64, i64) {
        let place = &self.state()["places"][control];
        let at =
            |index: usize| place[index].as_f64().unwrap_or_else(|| panic!("there is no control {control}"));
        ((at(0) + at(2) * 0.5) as i64, (at(1) + at(3) * 0.5) as i64)
    }

    /// Clicks at a control with the mouse.
    #[track_caller]
    pub(crate) fn click(&self, control: &str) {
        let (x, y) = self.middle(control);
        self.stand.display.xdotool(&format!("mousemove {x} {y} sleep 0.2 click 1"));
    }

    /// Presses a key.
    pub(crate) fn key(&self, name: &str) {
        self.stand.display.xdotool(&format!("key {name}"));
    }
}

impl Drop for Open<'_> {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn svs(words: &[&str], paths: &[&Path]) {
    let output =
        Command::new(env!("CARGO_BIN_EXE_svs")).args(words).args(paths).output().expect("svs starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// A number of a dump.
#[track_caller]
pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// Three numbers of a dump.
#[track_caller]
pub(crate) fn vector(value: &Value) -> [f64; 3] {
    [0, 1, 2].map(|index| number(&value[index]))
}

pub(crate) fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt()
}
