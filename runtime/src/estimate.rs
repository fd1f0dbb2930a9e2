//! How much of an object may be seen, in pixels: what the budget is spent on.

use crate::bounds::Bounds;
use crate::camera::Camera;
use crate::cull::Instance;
use crate::traverse::Measured;

/// Estimated visible pixels of an object of a tree, at most those of the image.
///
/// The least of two estimates: the largest area that was seen of it from outside the sphere that answered (where the
/// frustum alone decided: from outside its highest sphere that saw it), and the area of its box as the eye sees it. An
/// object around the eye counts as much as the image.
pub(crate) fn visible_pixels(instance: &Instance, camera: &Camera, hit: Measured) -> f64 {
    let bounds = &instance.boxes.objects[hit.place as usize];
    let tree = &instance.tree;
    let baked = tree.objects.get(hit.place as usize).and_then(|object| {
        let height = if hit.height > 0 { hit.height } else { u32::from(object.max_level) };
        (height > 0).then(|| tree.area(object, height))
    });
    pixels(bounds, camera, baked.unwrap_or(f64::INFINITY))
}

/// Estimated pixels of a box of which at most `area` m² show towards any side.
pub(crate) fn pixels(bounds: &Bounds, camera: &Camera, area: f64) -> f64 {
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
