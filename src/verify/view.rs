//! A pinhole camera as the item buffer and the frustum test see it.

use crate::bake::tree::Aabb;
use glam::DVec3;

/// Perspective camera in world space with square pixels and no near or far plane.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// Where the viewer stands, metres.
    pub eye: DVec3,
    /// Unit vector into the image.
    pub forward: DVec3,
    /// Unit vector to the right edge of the image.
    pub right: DVec3,
    /// Unit vector to the upper edge of the image.
    pub up: DVec3,
    /// Tangent of half the vertical field of view.
    pub half_height: f64,
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

/// The four side planes of a [`View`] and the plane that ends behind the viewer, all through its eye.
#[derive(Clone, Copy, Debug)]
pub struct Frustum {
    eye: DVec3,
    /// Unit vectors into the frustum.
    inward: [DVec3; 5],
}

impl View {
    /// Camera at `eye` that looks along `forward` (any length but zero) with +y up, as glTF has it; straight up or
    /// down, +z is up instead.
    pub fn new(eye: DVec3, forward: DVec3, half_height: f64, width: u32, height: u32) -> Self {
        let forward = forward.normalize();
        let vertical = if forward.y.abs() > 0.999_999 { DVec3::Z } else { DVec3::Y };
        let right = forward.cross(vertical).normalize();
        Self { eye, forward, right, up: right.cross(forward), half_height, width, height }
    }

    /// Unit vector through the centre of pixel (`x`, `y`); (0, 0) is the upper left one.
    pub fn ray(&self, x: u32, y: u32) -> DVec3 {
        let height = f64::from(self.height);
        let across = (2.0 * (f64::from(x) + 0.5) - f64::from(self.width)) / height;
        let down = (2.0 * (f64::from(y) + 0.5) - height) / height;
        let ray = self.forward + (self.right * across - self.up * down) * self.half_height;
        ray.normalize()
    }

    /// Number of pixels.
    pub fn pixels(&self) -> u64 {
        u64::from(self.width) * u64::from(self.height)
    }

    /// Planes for culling.
    pub fn frustum(&self) -> Frustum {
        let half_width = self.half_height * f64::from(self.width) / f64::from(self.height);
        let side = |axis: DVec3, half: f64| (self.forward * half + axis).normalize();
        Frustum {
            eye: self.eye,
            inward: [
                side(self.right, half_width),
                side(-self.right, half_width),
                side(self.up, self.half_height),
                side(-self.up, self.half_height),
                self.forward,
            ],
        }
    }
}

impl Frustum {
    /// The box is not wholly outside of one plane. An empty box is.
    pub fn touches(&self, bounds: &Aabb) -> bool {
        !bounds.is_empty()
            && self.inward.iter().all(|&normal| {
                let farthest = DVec3::select(normal.cmpge(DVec3::ZERO), bounds.max, bounds.min);
                normal.dot(farthest - self.eye) >= 0.0
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view() -> View {
        View::new(DVec3::new(0.0, 0.0, 10.0), DVec3::NEG_Z, 0.5, 200, 100)
    }

    fn cube(center: DVec3) -> Aabb {
        Aabb { min: center - 0.1, max: center + 0.1 }
    }

    #[test]
    fn pixel_rays_span_the_image() {
        let view = view();
        assert_eq!(view.right, DVec3::X);
        assert_eq!(view.up, DVec3::Y);
        let upper_left = view.ray(0, 0);
        assert!(upper_left.x < 0.0 && upper_left.y > 0.0);
        // Half a pixel inside the corner: tangents 0.995 and 0.495.
        assert!((upper_left.x / upper_left.z - 0.995).abs() < 1e-12);
        assert!((upper_left.y / -upper_left.z - 0.495).abs() < 1e-12);
        assert!(view.ray(100, 50).dot(DVec3::NEG_Z) > 0.999);
    }

    #[test]
    fn frustum_is_as_wide_as_the_image() {
        let frustum = view().frustum();
        assert!(frustum.touches(&cube(DVec3::ZERO)));
        assert!(frustum.touches(&cube(DVec3::new(9.9, 0.0, 0.0))));
        assert!(frustum.touches(&cube(DVec3::new(0.0, -5.0, 0.0))));
        assert!(!frustum.touches(&cube(DVec3::new(10.3, 0.0, 0.0))));
        assert!(!frustum.touches(&cube(DVec3::new(0.0, 5.2, 0.0))));
        assert!(!frustum.touches(&cube(DVec3::new(0.0, 0.0, 11.0))));
        let wide_behind = Aabb { min: DVec3::new(-50.0, -50.0, 10.1), max: DVec3::new(50.0, 50.0, 11.0) };
        assert!(!frustum.touches(&wide_behind));
        assert!(!frustum.touches(&Aabb::EMPTY));
    }

    #[test]
    fn looking_straight_up_has_axes() {
        let view = View::new(DVec3::ZERO, DVec3::Y, 0.5, 10, 10);
        assert!(view.right.is_finite() && (view.up.length() - 1.0).abs() < 1e-12);
        assert!(view.up.dot(DVec3::Y).abs() < 1e-12);
    }
}
