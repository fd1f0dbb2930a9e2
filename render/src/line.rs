//! Lines on top of a scene.

use glam::DVec3;

/// A line of the overlay, hidden by what is before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// One end, world space, metres.
    pub from: DVec3,
    /// The other end.
    pub to: DVec3,
    /// sRGB and alpha.
    pub color: [u8; 4],
}
