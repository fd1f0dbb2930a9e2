//! Rays from surfaces that no camera ray has seen: what is small, deep or seen through a slit only is found from its
//! own side.

use super::regions::Regions;
use super::sample::Seen;
use super::subject::Subject;
use super::view;
use crate::bake::Progress;
use crate::bake::rays::RayScene;
use crate::bake::sample::random::Random;
use crate::scene::{Mesh, Scene};
use glam::{DAffine3, DVec3};
use rayon::prelude::*;

/// Rays from an object before it is taken for hidden.
const RAYS_PER_OBJECT: usize = 4_096;
/// Rays from a triangle, from each object that draws it, and in all at most.
const RAYS_PER_TRIANGLE: usize = 32;
const MOST_RAYS_PER_TRIANGLE: usize = 256;

struct Rays<'a> {
    scene: &'a RayScene<'a>,
    regions: &'a Regions<'a>,
}

/// Tries everything unseen that may be removed; returns the rays cast, and the objects and triangles found.
pub(super) fn run(
    scene: &RayScene<'_>,
    regions: &Regions<'_>,
    source: &Scene,
    subject: &Subject,
    seen: &Seen,
    seed: u64,
    progress: &dyn Progress,
) -> (u64, u64) {
    let rays = Rays { scene, regions };
    let objects: Vec<u32> = (0..source.objects.len() as u32)
        .filter(|&object| subject.judged[object as usize] && !seen.object(object))
        .collect();
    progress.stage("look out of hidden", Some(objects.len() as u64));
    let found = objects.par_iter().map(|&object| {
        let (cast, triangle) = rays.object_sees_out(source, object, seed);
        if let Some(triangle) = triangle {
            seen.mark_triangle(object, triangle);
        }
        progress.advance(1);
        (cast, u64::from(triangle.is_some()))
    });
    let objects = found.reduce(|| (0, 0), sum);

    // Objects of each mesh whose triangles may go.
    let mut users: Vec<Vec<u32>> = vec![Vec::new(); source.meshes.len()];
    for (index, object) in source.objects.iter().enumerate() {
        if subject.judged_meshes[object.mesh as usize] {
            users[object.mesh as usize].push(index as u32);
        }
    }
    let triangles: Vec<(u32, u32)> = users
        .iter()
        .enumerate()
        .filter(|(_, users)| !users.is_empty())
        .flat_map(|(mesh, _)| {
            let mesh_index = mesh as u32;
            let unseen = move |&triangle: &u32| !seen.triangle(mesh_index, triangle);
            (0..source.meshes[mesh].triangles.len() as u32)
                .filter(unseen)
                .map(move |triangle| (mesh_index, triangle))
        })
        .collect();
    progress.stage("look out of hidden", Some(triangles.len() as u64));
    let found = triangles.par_iter().map(|&(mesh, triangle)| {
        let (cast, object) = rays.triangle_sees_out(source, mesh, triangle, &users[mesh as usize], seed);
        if let Some(object) = object {
            seen.mark_triangle(object, triangle);
        }
        progress.advance(1);
        (cast, u64::from(object.is_some()))
    });
    sum(objects, found.reduce(|| (0, 0), sum))
}

fn sum(a: (u64, u64), b: (u64, u64)) -> (u64, u64) {
    (a.0 + b.0, a.1 + b.1)
}

impl Rays<'_> {
    /// Rays from all over an object; the triangle that can be seen, if any.
    fn object_sees_out(&self, source: &Scene, object: u32, seed: u64) -> (u64, Option<u32>) {
        let placed = &source.objects[object as usize];
        let mesh = &source.meshes[placed.mesh as usize];
        let to_unit = self.to_unit(&placed.to_world, mesh);
        // Areas in mesh space: where rays start need not be exact.
        let mut total = 0.0;
        let area = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|v| mesh.positions[v as usize].as_dvec3());
            (b - a).cross(c - a).length()
        };
        let sums: Vec<f64> = mesh
            .triangles
            .iter()
            .map(|triangle| {
                total += area(triangle);
                total
            })
            .collect();
        // By node and instance, which stay the same when other objects go.
        let place = (placed.node as u64) << 32 | u64::from(placed.instance.unwrap_or_default());
        let mut random = Random::new(seed ^ 2, place);
        for ray in 0..RAYS_PER_OBJECT {
            // Half of them by area, half in turn: a small part may be what sticks out.
            let triangle = if ray % 2 == 0 {
                let place = random.unit() * total;
                sums.partition_point(|&sum| sum <= place).min(sums.len() - 1)
            } else {
                (random.unit() * sums.len() as f64) as usize
            };
            if self.sees_out(mesh, triangle as u32, &to_unit, &mut random) {
                return (ray as u64 + 1, Some(triangle as u32));
            }
        }
        (RAYS_PER_OBJECT as u64, None)
    }

    /// Rays from a triangle in its objects; the object that shows it, if any.
    fn triangle_sees_out(
        &self,
        source: &Scene,
        mesh: u32,
        triangle: u32,
        users: &[u32],
        seed: u64,
    ) -> (u64, Option<u32>) {
        let geometry = &source.meshes[mesh as usize];
        // By its place in space, which stays the same when other triangles go.
        let place = geometry.triangles[triangle as usize]
            .iter()
            .flat_map(|&v| (geometry.positions[v as usize].as_dvec3() + geometry.origin).as_vec3().to_array())
            .fold(0u64, |hash, x| (hash ^ u64::from(x.to_bits())).wrapping_mul(0x0000_0100_0000_01B3));
        let mut random = Random::new(seed ^ 3, place);
        let count = (RAYS_PER_TRIANGLE * users.len()).min(MOST_RAYS_PER_TRIANGLE);
        for ray in 0..count {
            // In turn; where there are more objects than rays, evenly spread ones.
            let user = if users.len() <= count { ray % users.len() } else { ray * users.len() / count };
            let object = &source.objects[users[user] as usize];
            let to_unit = self.to_unit(&object.to_world, geometry);
            if self.sees_out(geometry, triangle, &to_unit, &mut random) {
                return (ray as u64 + 1, Some(users[user]));
            }
        }
        (count as u64, None)
    }

    /// Positions relative to the mesh's origin to the unit frame.
    fn to_unit(&self, to_world: &DAffine3, mesh: &Mesh) -> DAffine3 {
        let radius = self.scene.radius();
        let origin = to_world.transform_point3(mesh.origin);
        DAffine3 {
            matrix3: to_world.matrix3 * (1.0 / radius),
            translation: (origin - self.scene.center()) / radius,
        }
    }

    /// One ray from a random point of the triangle to where it is seen from: does it reach a camera?
    fn sees_out(&self, mesh: &Mesh, triangle: u32, to_unit: &DAffine3, random: &mut Random) -> bool {
        let corners = mesh.triangles[triangle as usize]
            .map(|v| to_unit.transform_point3(mesh.positions[v as usize].as_dvec3()));
        let (mut u, mut v) = random.pair();
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        let [a, b, c] = corners;
        let point = a + (b - a) * u + (c - a) * v;
        let mut direction: DVec3 = view::direction(random);
        let surface = mesh.surfaces.partition_point(|surface| surface.triangles.end <= triangle);
        if mesh.surfaces.get(surface).is_some_and(|surface| !surface.double_sided) {
            // A mirror turns the winding as drawn with it.
            let flip = if to_unit.matrix3.determinant() < 0.0 { -1.0 } else { 1.0 };
            if (b - a).cross(c - a).dot(direction) * flip < 0.0 {
                direction = -direction;
            }
        }
        let free = f64::from(view::free_length(self.scene, point, direction));
        if !free.is_finite() {
            return true;
        }
        let clearance = self.regions.clearance();
        let place = random.unit();
        // The middle has the best chance to be clear of both ends.
        free >= 2.0 * clearance
            && [0.5 * free, clearance + place * (free - 2.0 * clearance)]
                .iter()
                .any(|&along| self.regions.is_clear(point + direction * along))
    }
}
