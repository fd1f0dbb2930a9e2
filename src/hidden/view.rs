//! What one ray of a camera sees.

use super::MARGIN;
use crate::bake::rays::{Crossing, RayScene};
use crate::bake::sample::random::Random;
use glam::DVec3;

/// Everything that may be in the pixel of a ray from `origin` (unit frame) along the unit vector `direction`: the
/// nearest opaque surface that faces the viewer, what is less than [`MARGIN`] behind it, and transparent surfaces
/// before. `hits` is emptied first; the order is arbitrary.
pub(super) fn look(scene: &RayScene<'_>, origin: DVec3, direction: DVec3, hits: &mut Vec<Crossing>) {
    hits.clear();
    let mut limit = f32::INFINITY;
    scene.visit(origin, direction, limit, |crossing| {
        if crossing.front || crossing.double_sided {
            if crossing.opaque {
                limit = limit.min(crossing.t + MARGIN);
            }
            hits.push(crossing);
        }
        limit
    });
    hits.retain(|hit| hit.t <= limit);
}

/// How far a viewer somewhere on the ray from `point` along `direction` can be from `point` and still see it:
/// the place of the first opaque surface that faces back; infinite if nothing is in the way.
pub(super) fn free_length(scene: &RayScene<'_>, point: DVec3, direction: DVec3) -> f32 {
    let mut nearest = f32::INFINITY;
    scene.visit(point, direction, nearest, |crossing| {
        // A viewer out there looks the other way: what the ray leaves by its front, they see.
        let faces_viewer = crossing.double_sided || !crossing.front;
        if crossing.opaque && faces_viewer && crossing.t > MARGIN {
            nearest = nearest.min(crossing.t);
        }
        nearest
    });
    nearest
}

/// Uniform on the unit sphere (Marsaglia 1972: no trigonometry, so the same on every machine).
pub(super) fn direction(random: &mut Random) -> DVec3 {
    loop {
        let (x, y) = random.pair();
        let (x, y) = (2.0 * x - 1.0, 2.0 * y - 1.0);
        let s = x * x + y * y;
        if s < 1.0 {
            let ring = 2.0 * (1.0 - s).sqrt();
            return DVec3::new(x * ring, y * ring, 1.0 - 2.0 * s).normalize();
        }
    }
}
