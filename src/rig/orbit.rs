//! A camera that turns around a point.

use super::{Aim, finite};
use glam::DVec3;

/// Eye on a sphere around a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orbit {
    /// What the camera looks at, metres.
    pub target: DVec3,
    /// From the eye to the target, metres, above 0.
    pub distance: f64,
    /// Where it looks.
    pub aim: Aim,
}

impl Orbit {
    /// Position of the eye.
    pub fn eye(&self) -> DVec3 {
        self.target - self.aim.forward() * self.distance
    }

    /// Turns around the target by angles in radians; the distance stays.
    pub fn turn(&mut self, yaw: f64, pitch: f64) {
        self.aim.turn(yaw, pitch);
    }

    /// Moves the target (and the eye with it) in the plane of the image, metres at the target's distance.
    pub fn pan(&mut self, right: f64, up: f64) {
        let moved = self.target + self.aim.right() * right + self.aim.up() * up;
        if moved.is_finite() {
            self.target = moved;
        }
    }

    /// Multiplies the distance and keeps it within `limits` (metres).
    pub fn zoom(&mut self, factor: f64, limits: (f64, f64)) {
        self.distance = finite(self.distance * factor, self.distance).clamp(limits.0, limits.1);
    }

    /// Looks at a sphere from outside, so that it fills the image's smaller side.
    pub fn frame(&mut self, center: DVec3, radius: f64, smaller_fov: f64) {
        if center.is_finite() && radius.is_finite() {
            self.target = center;
            self.distance = radius.max(f64::MIN_POSITIVE) / (smaller_fov * 0.5).sin() * 1.05;
        }
    }
}
