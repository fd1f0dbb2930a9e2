//! Poses as the renderer's cameras.

use super::{CameraPath, FALLBACK_NEAR};
use svs_render::View;

impl CameraPath {
    /// `count` cameras along the path in equal steps, see [`CameraPath::steps`]. A path without a near plane gets
    /// [`FALLBACK_NEAR`]; set one that fits the scene with [`CameraPath::near_or`] before.
    pub fn frames(&self, count: usize) -> Vec<View> {
        let near = self.near.unwrap_or(FALLBACK_NEAR);
        let view = |pose: super::Pose| View::looking_along(pose.eye, pose.forward, self.vertical_fov, near);
        self.steps(count).into_iter().map(view).collect()
    }
}
