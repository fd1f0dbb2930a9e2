//! The frustum against boxes in tree order: a plane that has a whole node on its inner side is not asked again below it.

use crate::bounds::Bounds;
use crate::camera::Camera;

/// The planes of a camera, and up to where in tree order everything is known to be on their inner sides.
///
/// Boxes must be asked in ascending order of their places, and a node before what is below it.
#[derive(Debug)]
pub(crate) struct Frustum<'a> {
    camera: &'a Camera,
    ends: [u32; 6],
    /// The least of `ends`.
    inside: u32,
}

impl<'a> Frustum<'a> {
    /// Without `test` everything is inside.
    pub(crate) fn new(camera: &'a Camera, test: bool) -> Self {
        let end = if test { 0 } else { u32::MAX };
        Self { camera, ends: [end; 6], inside: end }
    }

    /// Everything before `end` that has not been passed yet is inside.
    #[inline]
    pub(crate) fn is_inside(&self, end: u32) -> bool {
        end <= self.inside
    }

    /// The box around the next objects up to `end` may be in sight.
    #[inline]
    pub(crate) fn enter(&mut self, bounds: &Bounds, end: u32) -> bool {
        if end <= self.inside {
            return true;
        }
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        for (plane, inside) in self.camera.planes().iter().zip(&mut self.ends) {
            if end <= *inside {
                continue;
            }
            if Camera::farthest(plane, min, max) < 0.0 {
                return false;
            }
            // A distance that is no number is on no side, and an object's box may have one that is.
            if Camera::farthest(plane, max, min) >= 0.0 {
                *inside = end;
            }
        }
        self.inside = self.ends.iter().fold(u32::MAX, |least, &end| least.min(end));
        true
    }

    /// The box of the object at `place` may be in sight.
    #[inline]
    pub(crate) fn sees(&self, bounds: &Bounds, place: u32) -> bool {
        if place < self.inside {
            return true;
        }
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let mut planes = self.camera.planes().iter().zip(&self.ends);
        !planes.any(|(plane, inside)| place >= *inside && Camera::farthest(plane, min, max) < 0.0)
    }
}
