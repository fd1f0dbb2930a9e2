//! Camera paths: where a camera goes, recorded or generated, and the JSON files that hold them.
//!
//! A file is one JSON object, and a file with one pose is a single camera:
//!
//! ```json
//! {
//!   "version": 1,
//!   "name": "round trip",
//!   "vertical_fov": 60,
//!   "near": 0.05,
//!   "poses": [{"eye": [10, 2, 0], "forward": [-1, 0, 0]}, {"eye": [0, 2, 10], "forward": [0, 0, -1]}]
//! }
//! ```
//!
//! `vertical_fov` is the full vertical opening angle in degrees (60 if missing), `near` the distance of the near plane in
//! metres (by scene size if missing), `eye` is in metres of the scene, `forward` points into the image and may have any
//! length but zero; +y is up. Anything else in the file is an error, so that a misspelt name is not silently ignored.

mod error;
mod generate;
mod inspection;
mod json;
mod recorder;
mod spline;
#[cfg(test)]
mod tests;
#[cfg(feature = "render")]
mod views;

pub use error::CameraPathError;
pub use generate::near_plane;
pub use recorder::Recorder;

use glam::DVec3;

/// A place of the camera and where it looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Where the viewer stands, metres.
    pub eye: DVec3,
    /// Unit vector into the image.
    pub forward: DVec3,
}

/// Where a camera goes, from pose to pose.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraPath {
    /// What the path is called in reports; may be empty.
    pub name: String,
    /// Full vertical opening angle, radians, in (0, π).
    pub vertical_fov: f64,
    /// Distance of the near plane, metres, above 0; `None`: by scene size, see [`near_plane`].
    pub near: Option<f64>,
    /// At least one pose. If the last equals the first, the path is a closed loop and goes round without a corner.
    pub poses: Vec<Pose>,
}

/// Opening angle of generated paths and of files that name none: 60 degrees, in radians.
pub const DEFAULT_FOV: f64 = std::f64::consts::FRAC_PI_3;

/// Near plane, in metres, of a path that names none and whose user does not know the scene's size either.
pub const FALLBACK_NEAR: f64 = 0.01;

impl CameraPath {
    /// The same path, with this near plane (metres) if it names none.
    #[must_use]
    pub fn near_or(self, near: f64) -> Self {
        Self { near: self.near.or(Some(near)), ..self }
    }

    /// `count` poses along the path in equal steps, from its first pose to its last; between poses it follows a
    /// Catmull-Rom spline. Every pose takes equally long, however far it is to the next. `count` 1 gives the first pose.
    pub fn steps(&self, count: usize) -> Vec<Pose> {
        let last = self.poses.len().saturating_sub(1) as f64;
        let step = |index: usize| match count {
            0 | 1 => 0.0,
            _ => last * index as f64 / (count - 1) as f64,
        };
        (0..count).filter_map(|index| spline::pose(&self.poses, step(index))).collect()
    }
}
