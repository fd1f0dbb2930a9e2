//! Camera paths: recording and playing.

use crate::camera_path::{CameraPath, Pose, Recorder};
use std::path::Path;
use svs_render::View;

/// Frames between two poses of a path while it is played: poses are near each other.
const FRAMES_PER_POSE: usize = 10;
/// Frames per second of a path.
const FRAMES_PER_SECOND: f64 = 60.0;

/// What happens with camera paths at the moment.
#[derive(Debug, Default)]
pub(crate) enum Tape {
    /// Nothing.
    #[default]
    Idle,
    /// The camera is watched.
    Recording(Recorder),
    /// The camera is led.
    Playing {
        /// Every frame of the path.
        frames: Vec<View>,
        /// Frames played so far.
        position: f64,
    },
}

impl Tape {
    /// Begins to record in a scene of this radius (metres).
    pub(crate) fn record(&mut self, scene_radius: f64) {
        *self = Self::Recording(Recorder::new(scene_radius));
    }

    /// Ends recording and writes the path; says how many poses there are.
    pub(crate) fn save(&mut self, file: &Path, view: &View) -> Result<usize, String> {
        let Self::Recording(recorder) = std::mem::take(self) else {
            return Err("nothing was recorded".to_owned());
        };
        let path = recorder
            .finish("recorded", view.vertical_fov, view.near)
            .ok_or_else(|| "nothing was recorded".to_owned())?;
        path.write(file).map_err(|error| told(&error))?;
        Ok(path.poses.len())
    }

    /// Begins to play a path file; `near` (metres) is for paths that name none.
    pub(crate) fn play(&mut self, file: &Path, near: f64) -> Result<(), String> {
        let path = CameraPath::read(file).map_err(|error| told(&error))?.near_or(near);
        let count = (path.poses.len() - 1) * FRAMES_PER_POSE + 1;
        *self = Self::Playing { frames: path.frames(count), position: 0.0 };
        Ok(())
    }

    /// Ends whatever happens; a recording is lost.
    pub(crate) fn stop(&mut self) {
        *self = Self::Idle;
    }

    /// Some time has gone by with the camera at `view`: the recorder looks, or the player says where the camera is now.
    pub(crate) fn advance(&mut self, view: &View, seconds: f64) -> Option<View> {
        match self {
            Self::Idle => None,
            Self::Recording(recorder) => {
                recorder.observe(Pose { eye: view.eye, forward: view.forward });
                None
            }
            Self::Playing { frames, position } => {
                let next = frames.get(*position as usize).or(frames.last()).copied();
                *position += seconds * FRAMES_PER_SECOND;
                if *position >= frames.len() as f64 {
                    let last = frames.last().copied();
                    *self = Self::Idle;
                    return last;
                }
                next
            }
        }
    }

    /// A path is being recorded.
    pub(crate) fn is_recording(&self) -> bool {
        matches!(self, Self::Recording(_))
    }

    /// A path is being played.
    pub(crate) fn is_playing(&self) -> bool {
        matches!(self, Self::Playing { .. })
    }

    /// For people: how far it is.
    pub(crate) fn status(&self) -> String {
        match self {
            Self::Idle => String::new(),
            Self::Recording(recorder) => format!("recording, {} poses", recorder.len()),
            Self::Playing { frames, position } => {
                format!("playing, {:.0} %", 100.0 * position / frames.len().max(1) as f64)
            }
        }
    }
}

fn told(error: &dyn std::error::Error) -> String {
    let mut text = error.to_string();
    if let Some(cause) = error.source().map(ToString::to_string).filter(|cause| !text.contains(cause)) {
        text = format!("{text}: {cause}");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn at(x: f64) -> View {
        View::looking_along(DVec3::new(x, 0.0, 0.0), DVec3::NEG_Z, 1.0, 0.01)
    }

    #[test]
    fn what_was_recorded_is_played() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("path.json");
        let mut tape = Tape::default();
        tape.record(10.0);
        for step in 0..=20 {
            assert_eq!(tape.advance(&at(f64::from(step) * 0.1), 0.016), None);
        }
        assert!(tape.is_recording() && tape.status().contains("21 poses"));
        assert_eq!(tape.save(&file, &at(2.0)), Ok(21));
        assert!(!tape.is_recording());

        tape.play(&file, 0.1).expect("the file just written");
        let mut xs = Vec::new();
        while tape.is_playing() {
            let view = tape.advance(&at(0.0), 1.0 / 60.0).expect("a view per frame");
            assert!((view.vertical_fov - 1.0).abs() < 1e-9);
            xs.push(view.eye.x);
        }
        assert_eq!(xs.len(), 201);
        assert!(xs[0].abs() < 1e-9 && (xs[200] - 2.0).abs() < 1e-9);
        assert!(xs.windows(2).all(|pair| pair[1] >= pair[0]));
    }

    #[test]
    fn what_cannot_be_done_is_said() {
        let mut tape = Tape::default();
        assert!(tape.save(Path::new("x.json"), &at(0.0)).is_err());
        let message = tape.play(Path::new("/nowhere/path.json"), 0.1).expect_err("no such file");
        assert!(message.contains("path.json"), "{message}");
        tape.record(1.0);
        tape.advance(&at(0.0), 0.1);
        assert!(tape.save(Path::new("/nowhere/path.json"), &at(0.0)).is_err());
    }
}
