//! Whether proxies and simplified meshes are as near to what they stand for as the file says.
//!
//! Each of a sample of them is looked at from random sides, from exactly as far away as its stated error is one pixel:
//! the nearest from which it is drawn for its error alone at a threshold of one pixel. A ray through a random place of its
//! sphere meets it, or the originals, at a point. How far the other surface is from there is found by rays beside the
//! first one, up to two pixels off, ever closer to the best: each of their crossings with the other surface is a place of
//! it, so the distance to the nearest of them is never less than the true one. In pixels it should be at most 1, and the
//! same at any other threshold and distance, for pixels and stated error shrink alike.
//!
//! Both directions count: what is drawn and not there, and what is there and not drawn. Surfaces are taken as opaque.

use super::random::Random;
use super::statistics::{median, nearest_rank};
use crate::appearance::{self, AppearanceError};
use crate::bake::rays::{LineHit, RayScene};
use crate::bake::tree::Part;
use crate::baked::Baked;
use crate::gltf::Document;
use crate::scene::{Mesh, Opacity, Scene, Surface};
use glam::{DAffine3, DVec3, Vec3};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Proxies, and levels of meshes, that are looked at: the first and then evenly spread over the file's.
const MOST_PROXIES: usize = 64;
const MOST_LEVELS: usize = 32;
/// Sides that each is looked at from, and rays from each.
const SIDES: usize = 4;
const RAYS: usize = 32;
/// Pixels per radian: a screen of 1080 lines and 60 degrees has 935.
const PIXELS_PER_RADIAN: f64 = 1000.0;
/// Errors below this share of the radius are looked at as if they were this: rays are no more exact.
const LEAST_ERROR: f64 = 1e-5;

/// How far simplified surfaces are from what they stand for, in pixels where the stated error is one pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CalibrationReport {
    /// Proxies looked at.
    pub proxies: usize,
    /// Simplified levels of meshes looked at.
    pub levels: usize,
    /// Points whose distance from the other surface was measured.
    pub points: usize,
    /// Middle of the distances, pixels.
    pub median_px: f64,
    /// 99 % of them are at most this, pixels.
    pub p99_px: f64,
    /// Largest, pixels, of those that found the other surface within about two pixels.
    pub worst_px: f64,
    /// Share of the points from which the other surface is farther than one pixel, those included that found nothing.
    pub share_above: f64,
    /// Share of the points that found nothing within about two pixels.
    pub share_lost: f64,
}

impl fmt::Display for CalibrationReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { proxies, levels, points, median_px, p99_px, worst_px, share_above, share_lost } = self;
        writeln!(f, "{proxies} proxies and {levels} simplified meshes, where their stated error is 1 px:")?;
        writeln!(
            f,
            "  off by {median_px:.2} px (median), {p99_px:.2} px (99 %), {worst_px:.2} px (worst); {:.2} % of {points} points by \
             more than 1 px, {:.2} % by more than about 2 px",
            share_above * 100.0,
            share_lost * 100.0,
        )
    }
}

/// A simplified surface and what it stands for, in one space.
struct Pair<'a> {
    meshes: &'a [Mesh],
    parts: Vec<Part>,
    simplified: Mesh,
    to_space: DAffine3,
    center: DVec3,
    radius: f64,
    error: f64,
}

/// Looks at the proxies and levels of a file; `None` if it has none.
///
/// # Errors
/// If the meshes of proxies cannot be read.
pub(super) fn calibrate(
    doc: &Document,
    scene: &Scene,
    baked: &Baked,
    seed: u64,
) -> Result<Option<CalibrationReport>, AppearanceError> {
    let mut wanted: Vec<Wanted> = Vec::new();
    let proxies = spread(all_proxies(baked), MOST_PROXIES);
    let levels = spread(all_levels(doc, scene, baked), MOST_LEVELS);
    let counts = (proxies.len(), levels.len());
    wanted.extend(proxies.into_iter().chain(levels));
    if wanted.is_empty() {
        return Ok(None);
    }
    let meshes: Vec<u32> = wanted.iter().map(|wanted| wanted.mesh).collect();
    let looks = appearance::read_with(doc, scene, &meshes)?;
    let first = looks.data.meshes.len() - meshes.len();
    let distances: Vec<Vec<f64>> = wanted
        .par_iter()
        .enumerate()
        .map(|(index, wanted)| {
            let drawn = mesh(&looks.data.meshes[first + index], &looks.data.materials);
            let pair = wanted.pair(scene, baked, drawn);
            pair.distances(&mut Random::new(seed, 0x0CA1_1B4A, index as u64))
        })
        .collect();
    let all: Vec<f64> = distances.into_iter().flatten().collect();
    Ok(Some(report(counts, &all)))
}

fn report((proxies, levels): (usize, usize), all: &[f64]) -> CalibrationReport {
    let mut found: Vec<f64> = all.iter().copied().filter(|distance| distance.is_finite()).collect();
    found.sort_unstable_by(f64::total_cmp);
    let share = |count: usize| count as f64 / all.len().max(1) as f64;
    CalibrationReport {
        proxies,
        levels,
        points: all.len(),
        median_px: median(&found),
        p99_px: nearest_rank(&found, 99),
        worst_px: nearest_rank(&found, 100),
        share_above: share(all.iter().filter(|&&distance| distance > 1.0).count()),
        share_lost: share(all.len() - found.len()),
    }
}

/// Something simplified.
#[derive(Clone, Copy, Debug)]
struct Wanted {
    /// Its glTF mesh.
    mesh: u32,
    of: Of,
    error: f64,
}

#[derive(Clone, Copy, Debug)]
enum Of {
    Proxy {
        tree: usize,
        anchor: usize,
        node: usize,
    },
    /// Index of the scene's mesh.
    Level {
        mesh: u32,
    },
}

fn all_proxies(baked: &Baked) -> Vec<Wanted> {
    let mut all = Vec::new();
    for (tree, data) in baked.trees().iter().enumerate() {
        let Some((anchor, _)) = baked.places(tree).next() else { continue };
        let nodes = data.proxies().map_or(&[][..], |proxies| proxies.nodes());
        all.extend(nodes.iter().enumerate().map(|(node, proxy)| Wanted {
            mesh: proxy.mesh,
            of: Of::Proxy { tree, anchor, node },
            error: f64::from(proxy.error),
        }));
    }
    all
}

fn all_levels(doc: &Document, scene: &Scene, baked: &Baked) -> Vec<Wanted> {
    let mut all = Vec::new();
    let nodes = doc.json.get("nodes");
    for entry in baked.visibility().mesh_levels() {
        let has_it = |node: usize| {
            let mesh = nodes.and_then(|nodes| nodes.get(node)?.get("mesh")?.as_u64());
            mesh == Some(u64::from(entry.mesh))
        };
        let Some(object) = scene.objects.iter().find(|object| has_it(object.node)) else { continue };
        all.extend(entry.levels.iter().map(|level| Wanted {
            mesh: level.mesh,
            of: Of::Level { mesh: object.mesh },
            error: f64::from(level.error),
        }));
    }
    all
}

/// At most `count` of them, evenly spread, the first among them.
fn spread(all: Vec<Wanted>, count: usize) -> Vec<Wanted> {
    let step = all.len().div_ceil(count).max(1);
    all.into_iter().step_by(step).collect()
}

impl Wanted {
    fn pair<'a>(&self, scene: &'a Scene, baked: &Baked, simplified: Mesh) -> Pair<'a> {
        let (parts, to_space, center, radius) = match self.of {
            Of::Level { mesh } => {
                let part = Part { mesh, member: 0, to_tree: DAffine3::IDENTITY };
                let Mesh { min, max, .. } = scene.meshes[mesh as usize];
                (vec![part], DAffine3::IDENTITY, (min + max) * 0.5, (max - min).length() * 0.5)
            }
            Of::Proxy { tree, anchor, node } => {
                let from_world =
                    baked.places(tree).find(|&(at, _)| at == anchor).map(|(_, to_world)| to_world.inverse());
                let from_world = from_world.unwrap_or(DAffine3::IDENTITY);
                let mut parts = Vec::new();
                let mut at = (DAffine3::IDENTITY, DVec3::ZERO, 0.0);
                if let Some(proxies) = baked.trees()[tree].proxies() {
                    let proxy = &proxies.nodes()[node];
                    at = (
                        DAffine3::from_translation(proxy.origin.as_dvec3()),
                        proxy.center.as_dvec3(),
                        f64::from(proxy.radius),
                    );
                    for position in proxy.first_object..proxy.first_object + proxy.object_count {
                        for object in baked.below(tree, anchor, proxies.object(position)) {
                            let object = &scene.objects[object as usize];
                            let to_tree = from_world * object.to_world;
                            parts.push(Part { mesh: object.mesh, member: parts.len() as u32, to_tree });
                        }
                    }
                }
                (parts, at.0, at.1, at.2)
            }
        };
        Pair { meshes: &scene.meshes, parts, simplified, to_space, center, radius, error: self.error }
    }
}

/// A drawn mesh for rays.
fn mesh(drawn: &svs_render::Mesh, materials: &[svs_render::Material]) -> Mesh {
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
    fn distances(&self, random: &mut Random) -> Vec<f64> {
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
        let report = report((1, 0), &distances(0.05, 0.01));
        assert!(report.share_above > 0.9, "{report:?}");
        let exact = self::report((1, 0), &distances(0.0, 0.0));
        assert!(exact.points > 50 && exact.share_above == 0.0 && exact.worst_px < 0.1, "{exact:?}");
    }
}
