//! A generated path from the overview to close-ups and back.

use super::generate::usable;
use super::{CameraPath, DEFAULT_FOV, Pose, near_plane};
use crate::bake::tree::Aabb;
use crate::verify::Surroundings;
use glam::DVec3;
use std::f64::consts::TAU;

/// Poses of the whole path, the last one (which is the first again) not counted.
const POSES: usize = 120;

/// Close-ups, evenly spread over the path.
const CLOSE_UPS: f64 = 3.0;

/// Distance of the overview from the scene's centre, bounding-sphere radii.
const FAR: f64 = 3.0;

/// Distance of a close-up, in distances from the centre to where the scene's box ends in that direction.
const CLOSE: f64 = 1.05;

impl CameraPath {
    /// An inspection, as one turns a thing about and looks at it from near: twice around the scene, up and down between
    /// 10 degrees below and 40 above the horizon, looking at its middle; three times from an overview at 3 radii of its
    /// bounding sphere to just before the scene's box.
    pub fn inspection(around: &Surroundings<'_>) -> CameraPath {
        let radius = usable(around.sphere.radius);
        let poses = (0..=POSES).map(|index| {
            let share = (index % POSES) as f64 / POSES as f64;
            let turn = TAU * 2.0 * share;
            let elevation = (15.0 + 25.0 * (TAU * 3.0 * share).sin()).to_radians();
            let outward =
                DVec3::new(turn.cos(), 0.0, turn.sin()) * elevation.cos() + DVec3::Y * elevation.sin();
            let near = until_outside(&around.bounds, around.sphere.center, outward, radius) * CLOSE;
            // A geometric mean: each metre counts more the nearer it is.
            let closeness = 0.5 - 0.5 * (TAU * CLOSE_UPS * share).cos();
            let distance = (radius * FAR) * (near / (radius * FAR)).powf(closeness);
            Pose { eye: around.sphere.center + outward * distance, forward: -outward }
        });
        CameraPath {
            name: "inspection".to_owned(),
            vertical_fov: DEFAULT_FOV,
            near: Some(near_plane(radius)),
            poses: poses.collect(),
        }
    }
}

/// How far it is from a place in a box to its border; at most `radius`, and not nothing.
fn until_outside(bounds: &Aabb, from: DVec3, direction: DVec3, radius: f64) -> f64 {
    let border = DVec3::select(direction.cmpge(DVec3::ZERO), bounds.max, bounds.min);
    let distances = ((border - from) / direction).to_array();
    let nearest = distances.into_iter().filter(|distance| *distance >= 0.0).fold(radius, f64::min);
    nearest.max(radius * 0.01)
}
