//! Scripts: a JSON list of steps that set what the controls set, for tests and for repeatable pictures.
//!
//! ```json
//! [{"method": "frustum"}, {"quality": 0.3}, {"drag": [200, 0]}, {"frames": 2}, {"dump": "state.json"}, "measure"]
//! ```
//!
//! Each step takes one frame; loading is waited for. After the last step the window closes, unless a step was `"stay"`.

use super::state::Colours;
use crate::rig::CameraMode;
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// One step. Pixels count from the upper left corner of the part of the window that shows the scene.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Step {
    /// `nothing`, `frustum`, `visibility` or `exact`.
    Method(String),
    /// 0 to 1.
    Quality(f32),
    /// Degrees.
    SphereLimit(f32),
    /// Triangles per frame.
    TriangleBudget(u64),
    /// Milliseconds per frame.
    TimeBudget(f64),
    /// Unlimited.
    NoBudget,
    /// Draw proxies and simplified objects.
    Proxies(bool),
    /// Largest error of what is simplified, pixels.
    Detail(f32),
    /// `sse`, `linear`, `sigmoid` or `sigmoid:S,T`.
    Metric(String),
    /// Freeze culling.
    Freeze(bool),
    /// Show what is skipped.
    Skipped(bool),
    /// Show boxes of what is skipped.
    SkippedBoxes(bool),
    /// Show spheres.
    Spheres(bool),
    /// What colours mean.
    Colours(Colours),
    /// Draw all the time.
    Continuous(bool),
    /// Open or close the graphs.
    Graphs(bool),
    /// Open or close the panel.
    Panel(bool),
    /// Open or close the help.
    Help(bool),
    /// `orbit` or `walk`.
    Camera(CameraMode),
    /// A drag with the left button, pixels right and down.
    Drag([f64; 2]),
    /// A drag with the right button, pixels right and down.
    Pan([f64; 2]),
    /// Notches of the wheel.
    Wheel(f64),
    /// Holds keys (named as in `w`, `shift`, `space`, `up`) for some seconds of 60 frames each.
    Hold {
        /// Which.
        keys: Vec<String>,
        /// How long.
        seconds: f64,
    },
    /// Presses a key of the help once, by its name there.
    Key(String),
    /// Puts the camera somewhere.
    LookFrom {
        /// Metres.
        eye: [f64; 3],
        /// Any length.
        forward: [f64; 3],
    },
    /// A click of the left button at a pixel.
    Click([f64; 2]),
    /// Selects the object of a node by name.
    Select(String),
    /// Hides or shows the selected object.
    Hide(bool),
    /// Shows all hidden objects.
    ShowAll,
    /// Measures what is missing now.
    Measure,
    /// Starts or ends recording; the end writes the path file.
    Record(bool),
    /// Starts or ends playing the path file.
    Play(bool),
    /// Waits until the path was played.
    WaitForPlay,
    /// Names the path file.
    PathFile(String),
    /// A file was dropped on the window.
    Drop(PathBuf),
    /// Asks for another size of the window, pixels.
    Resize([u32; 2]),
    /// Draws some frames.
    Frames(u32),
    /// Writes a PNG of the whole window.
    Screenshot(PathBuf),
    /// Writes settings and figures as JSON.
    Dump(PathBuf),
    /// Writes them after every frame from now on.
    Watch(PathBuf),
    /// Keeps the window open after the last step.
    Stay,
}

/// Why a script cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ScriptError {
    /// The file cannot be read.
    #[error("cannot read the script {}: {source}", path.display())]
    Read {
        /// Which file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// It is no list of known steps.
    #[error("the script {} is not understood: {source}", path.display())]
    Parse {
        /// Which file.
        path: PathBuf,
        /// Where and why.
        source: serde_json::Error,
    },
}

/// Reads a script.
pub(crate) fn read(path: &Path) -> Result<Vec<Step>, ScriptError> {
    let text = std::fs::read_to_string(path)
        .map_err(|source| ScriptError::Read { path: path.to_owned(), source })?;
    parse(&text).map_err(|source| ScriptError::Parse { path: path.to_owned(), source })
}

fn parse(text: &str) -> Result<Vec<Step>, serde_json::Error> {
    serde_json::from_str(text)
}

/// What `--screenshot OUT --after N` does.
pub(crate) fn for_screenshot(output: &Path, frames: u32) -> Vec<Step> {
    vec![Step::Frames(frames), Step::Screenshot(output.to_owned())]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_read() {
        let steps = parse(
            r#"[{"method": "frustum"}, {"quality": 0.25}, {"colours": "level"}, {"camera": "walk"}, "measure",
                {"hold": {"keys": ["w", "shift"], "seconds": 0.5}}, {"click": [10, 20.5]}, {"triangle_budget": 5},
                {"look_from": {"eye": [0, 1, 2], "forward": [0, 0, -1]}}, {"screenshot": "a.png"}, "stay"]"#,
        )
        .expect("a good script");
        assert_eq!(steps.len(), 11);
        assert_eq!(steps[0], Step::Method("frustum".to_owned()));
        assert_eq!(steps[2], Step::Colours(Colours::Level));
        assert_eq!(steps[4], Step::Measure);
        assert_eq!(steps[6], Step::Click([10.0, 20.5]));
        assert_eq!(steps[10], Step::Stay);
    }

    #[test]
    fn what_is_no_step_is_refused_by_name() {
        for (text, word) in [
            (r#"[{"qualty": 1}]"#, "qualty"),
            (r#"[{"colours": "plaid"}]"#, "plaid"),
            (r#"[{"click": [1]}]"#, "length"),
            (r#"{"quality": 1}"#, "sequence"),
            ("[", "EOF"),
        ] {
            let message = parse(text).expect_err(text).to_string();
            assert!(message.contains(word), "{message}");
        }
    }
}
