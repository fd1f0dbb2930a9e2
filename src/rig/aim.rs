//! A direction of view without roll.

use super::finite;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Straight up and down are left out: there, "right" would not be defined.
const STEEPEST: f64 = FRAC_PI_2 - 0.002;

/// Where a camera looks, +y up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aim {
    /// Radians in [-π, π]; 0 looks along -z, growing values turn left.
    yaw: f64,
    /// Radians; positive looks up.
    pitch: f64,
}

impl Aim {
    /// From angles in radians; what is not finite counts as 0.
    pub fn new(yaw: f64, pitch: f64) -> Self {
        let yaw = finite(yaw, 0.0);
        Self { yaw: yaw - (yaw / TAU).round() * TAU, pitch: finite(pitch, 0.0).clamp(-STEEPEST, STEEPEST) }
    }

    /// The aim along a vector of any length; along -z for a vector without a direction.
    pub fn along(direction: DVec3) -> Self {
        let Some(forward) = direction.try_normalize() else { return Self::new(0.0, 0.0) };
        let level = forward.x.hypot(forward.z);
        let yaw = if level > 1e-9 { (-forward.x).atan2(-forward.z) } else { 0.0 };
        Self::new(yaw, forward.y.atan2(level))
    }

    /// Turns by angles in radians.
    pub fn turn(&mut self, yaw: f64, pitch: f64) {
        *self = Self::new(self.yaw + finite(yaw, 0.0).clamp(-PI, PI), self.pitch + finite(pitch, 0.0));
    }

    /// Unit vector into the image.
    pub fn forward(&self) -> DVec3 {
        let (sin_yaw, cos_yaw) = self.yaw.sin_cos();
        let (sin_pitch, cos_pitch) = self.pitch.sin_cos();
        DVec3::new(-sin_yaw * cos_pitch, sin_pitch, -cos_yaw * cos_pitch)
    }

    /// Unit vector to the right, level.
    pub fn right(&self) -> DVec3 {
        let (sin, cos) = self.yaw.sin_cos();
        DVec3::new(cos, 0.0, -sin)
    }

    /// Unit vector to the upper edge of the image.
    pub fn up(&self) -> DVec3 {
        self.right().cross(self.forward())
    }

    /// Radians above the horizon.
    #[cfg(test)]
    pub fn pitch(&self) -> f64 {
        self.pitch
    }
}
