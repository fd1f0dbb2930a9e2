//! Records where a camera goes.

use super::{CameraPath, Pose};

/// A camera has turned if its direction has, by this many radians (2 degrees).
const TURN: f64 = 0.034_906_585;

/// A camera has moved by this share of the scene's radius.
const MOVE: f64 = 0.002;

/// Records a pose only after the camera has moved or turned a little since the last one: files stay small, the path
/// smooth, and pauses are left out.
#[derive(Clone, Debug)]
pub struct Recorder {
    distance: f64,
    poses: Vec<Pose>,
    /// Where the camera was seen last, though that was too near to be recorded.
    latest: Option<Pose>,
}

impl Recorder {
    /// A recorder for a scene of this radius (metres).
    pub fn new(scene_radius: f64) -> Self {
        Self { distance: scene_radius.abs() * MOVE, poses: Vec::new(), latest: None }
    }

    /// Call it every frame. Says whether the pose was recorded; one that is not finite never is.
    pub fn observe(&mut self, pose: Pose) -> bool {
        if !(pose.eye.is_finite() && pose.forward.is_finite()) {
            return false;
        }
        self.latest = Some(pose);
        let moved = self.poses.last().is_none_or(|last| {
            last.eye.distance(pose.eye) >= self.distance.max(f64::MIN_POSITIVE)
                || last.forward.angle_between(pose.forward) >= TURN
        });
        if moved {
            self.poses.push(pose);
        }
        moved
    }

    /// Poses recorded so far.
    pub fn len(&self) -> usize {
        self.poses.len()
    }

    /// Nothing has been recorded yet.
    pub fn is_empty(&self) -> bool {
        self.poses.is_empty()
    }

    /// The path, to where the camera stands now. `None` if nothing was observed. `vertical_fov` in radians, `near` in metres.
    pub fn finish(mut self, name: &str, vertical_fov: f64, near: f64) -> Option<CameraPath> {
        let latest = self.latest?;
        if self.poses.last() != Some(&latest) {
            self.poses.push(latest);
        }
        Some(CameraPath { name: name.to_owned(), vertical_fov, near: Some(near), poses: self.poses })
    }
}
