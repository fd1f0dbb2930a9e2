//! The camera.

use glam::{DMat4, DVec3};

/// A perspective camera in world space with square pixels and an infinite far plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Where the viewer stands, metres.
    pub eye: DVec3,
    /// Unit vector into the image.
    pub forward: DVec3,
    /// Unit vector to the upper edge of the image, at right angles to `forward`.
    pub up: DVec3,
    /// Full vertical opening angle, radians, in (0, π).
    pub vertical_fov: f64,
    /// Distance of the near plane, metres, above 0.
    pub near: f64,
}

impl View {
    /// A camera at `eye` that looks along `forward` (any length but zero) with +y up, as glTF has it; straight up or down,
    /// +z is up instead.
    pub fn looking_along(eye: DVec3, forward: DVec3, vertical_fov: f64, near: f64) -> Self {
        let forward = forward.normalize();
        let vertical = if forward.y.abs() > 0.999_999 { DVec3::Z } else { DVec3::Y };
        let right = forward.cross(vertical).normalize();
        Self { eye, forward, up: right.cross(forward), vertical_fov, near }
    }

    /// Unit vector to the right edge of the image.
    pub fn right(&self) -> DVec3 {
        self.forward.cross(self.up)
    }

    /// World space to eye space (x right, y up, looking along -z): a rotation and a shift.
    pub fn view_matrix(&self) -> DMat4 {
        glam::dcamera::rh::view::look_to_mat4(self.eye, self.forward, self.up)
    }
}
