//! A camera that goes where it is sent.

use super::Aim;
use glam::DVec3;

/// Eye and aim, independent of any target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Walk {
    /// Where the viewer stands, metres.
    pub eye: DVec3,
    /// Where it looks.
    pub aim: Aim,
}

impl Walk {
    /// Goes some metres along its own axes. Ahead is where it looks, up is +y: as in most fly cameras.
    pub fn go(&mut self, right: f64, up: f64, ahead: f64) {
        let moved = self.eye + self.aim.right() * right + DVec3::Y * up + self.aim.forward() * ahead;
        if moved.is_finite() {
            self.eye = moved;
        }
    }

    /// Turns the head by angles in radians; the eye stays.
    pub fn turn(&mut self, yaw: f64, pitch: f64) {
        self.aim.turn(yaw, pitch);
    }
}
