//! Generated paths: a round trip outside, a walk inside. They depend on the scene alone.

use super::spline::{self, direction};
use super::{CameraPath, DEFAULT_FOV, Pose};
use crate::bake::tree::Aabb;
use crate::verify::Surroundings;
use crate::verify::random::Random;
use glam::DVec3;
use std::f64::consts::TAU;

/// Poses of the round trip, the last one (which is the first again) not counted.
const ROUND: usize = 96;

/// Smallest and largest distance of the round trip from the scene's centre, in bounding-sphere radii.
const NEAREST: f64 = 1.05;
const FARTHEST: f64 = 3.0;

/// Places that the walk visits.
const STOPS: usize = 16;

/// Poses from one place to the next.
const POSES_PER_LEG: usize = 8;

/// Places from which the next stop is chosen: the one with the freest way.
const CANDIDATES: usize = 12;

/// Where a way is looked at for small objects in it.
const LOOKS: usize = 12;

/// Lowest and highest eye of the walk, in shares of the scene's height.
const LOW: f64 = 0.06;
const HIGH: f64 = 0.45;

/// Near plane (metres) for a camera that may come close to things, in a scene of this radius (metres): a ten-thousandth
/// of it, so that nothing that one could tell from a wall is cut open. With a floating-point depth buffer that stores
/// nearest as 1 this costs no precision far away.
pub fn near_plane(scene_radius: f64) -> f64 {
    let near = scene_radius.abs() * 1e-4;
    if near.is_finite() && near > 0.0 { near } else { super::FALLBACK_NEAR }
}

impl CameraPath {
    /// A closed loop around the scene that nears it twice to 1.05 radii of its bounding sphere and leaves to 3, up and
    /// down between 10 degrees below and 50 above the horizon, looking at its middle.
    pub fn outside(around: &Surroundings<'_>) -> CameraPath {
        let radius = usable(around.sphere.radius);
        let poses = (0..=ROUND).map(|index| {
            let angle = TAU * (index % ROUND) as f64 / ROUND as f64;
            let distance = radius * (NEAREST + (FARTHEST - NEAREST) * (0.5 + 0.5 * (2.0 * angle).cos()));
            let elevation = (20.0 + 30.0 * (3.0 * angle).sin()).to_radians();
            let level = DVec3::new(angle.cos(), 0.0, angle.sin());
            let outward = level * elevation.cos() + DVec3::Y * elevation.sin();
            Pose { eye: around.sphere.center + outward * distance, forward: -outward }
        });
        CameraPath {
            name: "outside".to_owned(),
            vertical_fov: DEFAULT_FOV,
            // The scene is 0.05 radii away at the least.
            near: Some(radius * 0.01),
            poses: poses.collect(),
        }
    }

    /// A walk through the scene between free places, at eye heights from 6 to 45 % of its height and back, looking ahead.
    /// Stops are never in the box of a small object if there is room elsewhere; the way between two may cross walls, for
    /// what is a door and what a wall is not known.
    pub fn inside(around: &Surroundings<'_>) -> CameraPath {
        let radius = usable(around.sphere.radius);
        let small: Vec<Aabb> = around.objects.iter().filter(|b| around.is_small(b)).copied().collect();
        let walk = Surroundings { objects: &small, ..*around };
        let way: Vec<Pose> =
            stops(&walk).into_iter().map(|eye| Pose { eye, forward: DVec3::NEG_Z }).collect();
        let at = |step: usize| {
            spline::pose(&way, step as f64 / POSES_PER_LEG as f64).map_or(DVec3::ZERO, |pose| pose.eye)
        };
        let steps = way.len().saturating_sub(1) * POSES_PER_LEG;
        let mut forward = DVec3::NEG_Z;
        let poses = (0..=steps).map(|step| {
            // Ahead by half a leg, so that turns begin before the corner; a little up and down only.
            let ahead = at((step + POSES_PER_LEG / 2).min(steps)) - at(step);
            let level = direction(DVec3::new(ahead.x, ahead.y * 0.3, ahead.z) / radius);
            forward = level.unwrap_or(forward);
            Pose { eye: at(step), forward }
        });
        CameraPath {
            name: "inside".to_owned(),
            vertical_fov: DEFAULT_FOV,
            near: Some(near_plane(radius)),
            poses: poses.collect(),
        }
    }
}

/// Free places, each with a way from the one before that is as free as can be found.
fn stops(around: &Surroundings<'_>) -> Vec<DVec3> {
    let height = around.bounds.max.y - around.bounds.min.y;
    let mut stops: Vec<DVec3> = Vec::with_capacity(STOPS);
    for stop in 0..STOPS {
        let share = 1.0 - (2.0 * stop as f64 / (STOPS - 1) as f64 - 1.0).abs();
        let y = around.bounds.min.y + height * (LOW + (HIGH - LOW) * share);
        let mut random = Random::new(1, stop as u64, 0);
        let mut place = || DVec3 { y, ..around.standing_place(&mut random) };
        let mut best = (usize::MAX, place());
        for _ in 0..CANDIDATES {
            let candidate = place();
            let from = stops.last().copied().unwrap_or(candidate);
            let is_blocked =
                |look: &usize| !around.is_free(from.lerp(candidate, *look as f64 / LOOKS as f64));
            let blocked = (1..=LOOKS).filter(is_blocked).count();
            if blocked < best.0 {
                best = (blocked, candidate);
            }
        }
        stops.push(best.1);
    }
    stops
}

/// A radius that a path can be made with.
pub(super) fn usable(radius: f64) -> f64 {
    if radius.is_finite() && radius > 0.0 { radius } else { 1.0 }
}
