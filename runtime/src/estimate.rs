//! How much of an object may be seen, in pixels: what the budget is spent on.

use crate::bounds::Bounds;
use crate::camera::Camera;
use crate::cull::Instance;
use crate::hits::Measured;

/// What may be seen of an object, in pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Estimate {
    /// The least of the largest area that was seen of it from outside the sphere that answered (where the frustum alone
    /// decided: from outside its highest sphere that saw it), the area of its box as the eye sees it, and the image. This
    /// is the value of Eikel (2013). An object around the eye counts as much as the image.
    pub(crate) most: f32,
    /// As `most`, less where few of the bins around its direction see it: near the edge of where it is seen from, only a
    /// part of it is.
    pub(crate) expected: f32,
}

/// Share of [`Estimate::most`] that is left where hardly a bin around sees an object.
const LEAST_SHARE: f64 = 0.1;

impl Estimate {
    /// Of a box without any bake.
    pub(crate) fn of_box(bounds: &Bounds, camera: &Camera) -> Self {
        let most = pixels(bounds, camera, f64::INFINITY) as f32;
        Self { most, expected: most }
    }
}

/// Of an object of a tree.
pub(crate) fn visible_pixels(instance: &Instance, camera: &Camera, hit: Measured) -> Estimate {
    let bounds = &instance.boxes.objects[hit.place as usize];
    let tree = &instance.tree;
    let Some(object) = tree.objects.get(hit.place as usize).filter(|object| object.max_level > 0) else {
        return Estimate::of_box(bounds, camera);
    };
    if hit.height == 0 {
        let most = pixels(bounds, camera, tree.area(object, object.max_level.into())) as f32;
        return Estimate { most, expected: most };
    }
    let most = pixels(bounds, camera, tree.area(object, hit.height));
    let to_eye = camera.eye() - (bounds.min.as_dvec3() + bounds.max.as_dvec3()) * 0.5;
    let nearest = tree.directions.nearest_f64(to_eye);
    let ring = tree.directions.ring(nearest);
    let sees = |bin: usize| u32::from(tree.row_level(object, bin)) >= hit.height;
    let seen = ring.iter().filter(|&&bin| sees(bin.into())).count() + usize::from(sees(nearest));
    let share = seen as f64 / (ring.len() + 1) as f64;
    let expected = most * (LEAST_SHARE + (1.0 - LEAST_SHARE) * share * share);
    Estimate { most: most as f32, expected: expected as f32 }
}

/// Estimated pixels of a box of which at most `area` m² show towards any side.
fn pixels(bounds: &Bounds, camera: &Camera, area: f64) -> f64 {
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let (size, to_eye) = (max - min, camera.eye() - (min + max) * 0.5);
    let distance_squared = to_eye.length_squared();
    if is_around(bounds, distance_squared) || !distance_squared.is_finite() {
        return camera.image_area();
    }
    let direction = to_eye.abs() / distance_squared.sqrt();
    let silhouette =
        direction.x * size.y * size.z + direction.y * size.z * size.x + direction.z * size.x * size.y;
    let scale = camera.pixels_per_radian() * camera.pixels_per_radian() / distance_squared;
    // The smaller of two numbers: one that is none (0 m² at an infinite scale) leaves the other.
    (silhouette.min(area) * scale).min(camera.image_area())
}

/// The eye, so far from the middle of the box, may be in the box: the object has no direction, and no limit to its size.
#[inline]
pub(crate) fn is_around(bounds: &Bounds, distance_squared: f64) -> bool {
    let size = bounds.max.as_dvec3() - bounds.min.as_dvec3();
    distance_squared <= size.length_squared() * 0.25
}
