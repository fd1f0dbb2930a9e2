//! Distances between a simplified surface and what it stands for, in pixels.

use crate::bake::rays::{LineHit, RayScene};
use crate::bake::tree::Part;
use crate::scene::{Mesh, Opacity, Surface};
use crate::verify::random::Random;
use glam::{DAffine3, DVec3, Vec3};

/// Sides that each is looked at from, and rays from each.
const SIDES: usize = 4;
const RAYS: usize = 32;
/// Pixels per radian: a screen of 1080 lines and 60 degrees has 935.
const PIXELS_PER_RADIAN: f64 = 1000.0;
/// Errors below this share of the radius are looked at as if they were this: rays are no more exact.
const LEAST_ERROR: f64 = 1e-5;

/// A simplified surface and what it stands for, in one space.
pub(super) struct Pair<'a> {
    pub(super) meshes: &'a [Mesh],
    pub(super) parts: Vec<Part>,
    pub(super) simplified: Mesh,
    pub(super) to_space: DAffine3,
    pub(super) center: DVec3,
    pub(super) radius: f64,
    pub(super) error: f64,
}

/// A drawn mesh for rays.
pub(super) fn mesh(drawn: &svs_render::Mesh, materials: &[svs_render::Material]) -> Mesh {
    let mut mesh = Mesh { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY, ..Mesh::default() };
    for primitive in &drawn.primitives {
        let base = mesh.positions.len() as u32;
        mesh.positions.extend(primitive.positions.iter().map(|&position| Vec3::from(position)));
        let first = mesh.triangles.len() as u32;
        mesh.triangles
            .extend(primitive.indices.as_chunks::<3>().0.iter().map(|corners| corners.map(|at| base + at)));
        mesh.surfaces.push(Surface {
            triangles: first..mesh.triangles.len() as u32,
            double_sided: materials
                .get(primitive.material as usize)
                .is_none_or(|material| material.double_sided),
            opacity: Opacity::Opaque,
        });
    }
    for position in &mesh.positions {
        (mesh.min, mesh.max) = (mesh.min.min(position.as_dvec3()), mesh.max.max(position.as_dvec3()));
    }
    mesh.drawn_triangles = mesh.triangles.len() as u32;
    mesh
}

impl Pair<'_> {
    /// Distances in pixels; infinite where nothing is near.
    pub(super) fn distances(&self, random: &mut Random) -> Vec<f64> {
        let meshes = std::slice::from_ref(&self.simplified);
        let part = Part { mesh: 0, member: 0, to_tree: self.to_space };
        let mut surfaces = [
            Surfaced { rays: RayScene::new(self.meshes, &self.parts), hits: Vec::new() },
            Surfaced { rays: RayScene::new(meshes, &[part]), hits: Vec::new() },
        ];
        let away = self.radius + self.error.max(self.radius * LEAST_ERROR) * PIXELS_PER_RADIAN;
        let mut distances = Vec::new();
        if !(away.is_finite() && self.radius > 0.0) {
            return distances;
        }
        for _ in 0..SIDES {
            let eye = self.center + random.on_sphere() * away;
            for _ in 0..RAYS {
                let direction = (self.center + random.in_ball() * self.radius - eye).normalize();
                for own in 0..2 {
                    if let Some(along) = surfaces[own].nearest(eye, direction) {
                        distances.push(surfaces[1 - own].off(eye, direction, along));
                    }
                }
            }
        }
        distances
    }
}

/// One of the two surfaces.
struct Surfaced<'a> {
    rays: RayScene<'a>,
    hits: Vec<LineHit>,
}

impl Surfaced<'_> {
    /// Calls `found` with the distance in metres of each crossing of the ray, and whether it is seen from there.
    fn cross(&mut self, eye: DVec3, direction: DVec3, mut found: impl FnMut(f64, bool)) {
        let from = (eye - self.rays.center()) / self.rays.radius();
        let along = -from.dot(direction);
        self.rays.line(from + direction * along, direction, &mut self.hits);
        for hit in &self.hits {
            found((f64::from(hit.t) + along) * self.rays.radius(), hit.seen_from_start);
        }
    }

    /// Distance to what a viewer sees there, metres.
    fn nearest(&mut self, eye: DVec3, direction: DVec3) -> Option<f64> {
        let mut nearest = f64::INFINITY;
        self.cross(eye, direction, |along, seen| {
            if seen && along > 0.0 {
                nearest = nearest.min(along);
            }
        });
        nearest.is_finite().then_some(nearest)
    }

    /// Distance in pixels of a point on a ray from the nearest place of this surface that is found.
    fn off(&mut self, eye: DVec3, direction: DVec3, along: f64) -> f64 {
        let point = eye + direction * along;
        let pixel = along / PIXELS_PER_RADIAN;
        let (right, up) = direction.any_orthonormal_pair();
        let mut best = (f64::INFINITY, 0.0, 0.0);
        let mut look = |x: f64, y: f64, best: &mut (f64, f64, f64)| {
            let direction = (point + (right * x + up * y) * pixel - eye).normalize();
            self.cross(eye, direction, |along, _| {
                let distance = (eye + direction * along - point).length() / pixel;
                if distance < best.0 {
                    *best = (distance, x, y);
                }
            });
        };
        for y in -2..=2 {
            for x in -2..=2 {
                look(f64::from(x), f64::from(y), &mut best);
            }
        }
        for step in [0.5, 0.25, 0.125, 0.0625] {
            let (_, x, y) = best;
            for (dx, dy) in [(-1, -1), (0, -1), (1, -1), (-1, 0), (1, 0), (-1, 1), (0, 1), (1, 1)] {
                look(x + f64::from(dx) * step, y + f64::from(dy) * step, &mut best);
            }
        }
        best.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::calibrate::report;

    /// A square of two triangles, at this height.
    fn square(y: f32) -> Mesh {
        let corner = |x: f32, z: f32| Vec3::new(x, y, z);
        Mesh {
            positions: vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            surfaces: vec![Surface { triangles: 0..2, double_sided: true, opacity: Opacity::Opaque }],
            drawn_triangles: 2,
            ..Mesh::default()
        }
    }

    fn distances(off: f32, error: f64) -> Vec<f64> {
        let meshes = [square(0.0)];
        let pair = Pair {
            meshes: &meshes,
            parts: vec![Part { mesh: 0, member: 0, to_tree: DAffine3::IDENTITY }],
            simplified: square(off),
            to_space: DAffine3::IDENTITY,
            center: DVec3::ZERO,
            radius: 1.5,
            error,
        };
        pair.distances(&mut Random::new(1, 2, 3))
    }

    #[test]
    fn a_surface_that_is_as_far_off_as_stated_is_off_by_a_pixel() {
        let all = distances(0.01, 0.01);
        assert!(all.len() > 50, "{}", all.len());
        // The far side of the sphere appears a little smaller than the near one.
        let worst = all.iter().copied().fold(0.0, f64::max);
        assert!((0.5..=1.02).contains(&worst), "{worst}");
        let middle = report((1, 0), &all);
        assert!(middle.median_px > 0.5 && middle.share_lost == 0.0, "{middle:?}");
    }

    #[test]
    fn what_is_off_by_more_than_stated_is_found() {
        let found = report((1, 0), &distances(0.05, 0.01));
        assert!(found.share_above > 0.9, "{found:?}");
        let exact = report((1, 0), &distances(0.0, 0.0));
        assert!(exact.points > 50 && exact.share_above == 0.0 && exact.worst_px < 0.1, "{exact:?}");
    }
}
