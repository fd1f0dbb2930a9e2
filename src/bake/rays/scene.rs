//! Placed meshes under a top-level hierarchy.

use super::blas::{Blas, DOUBLE_SIDED, Merged, OPAQUE, has_mask};
use super::build::build;
use crate::bake::tree::{Aabb, Part};
use crate::scene::Mesh;
use glam::{DAffine3, DVec3, Mat3A, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::ray::{Ray, RayHit};
use rayon::prelude::*;
use std::cell::Cell;
use std::fmt;

/// A mesh drawn once costs nothing extra when its triangles are placed in the common hierarchy, where rays are
/// fastest. Meshes drawn more often are placed there too as long as the copies stay below this many triangles
/// (about 90 bytes each).
const COPIED_TRIANGLES: usize = 3 << 20;

/// What a scene of parts looks like to rays.
pub struct RayScene<'a> {
    center: DVec3,
    radius: f64,
    half_size: DVec3,
    merged: Blas<'a>,
    instances: Vec<Instance>,
    meshes: Vec<Blas<'a>>,
    top: Option<Bvh2>,
}

#[derive(Debug)]
struct Instance {
    blas: u32,
    member: u32,
    /// Place of the mesh's origin in the unit frame.
    center: DVec3,
    /// Unit frame to mesh frame, without translation.
    to_mesh: Mat3A,
    /// How far the mesh reaches from its origin in its own frame.
    reach: f32,
    mirrored: bool,
}

/// One crossing of a line and a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineHit {
    /// Place on the line, in half diagonals of the scene from the point nearest to its centre.
    pub t: f32,
    /// The member that was crossed.
    pub member: u32,
    /// The surface hides what is behind it.
    pub opaque: bool,
    /// A viewer at the line's start sees this surface (it faces there, or is double-sided).
    pub seen_from_start: bool,
    /// A viewer at the line's end sees this surface.
    pub seen_from_end: bool,
}

/// One triangle that a ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Crossing {
    /// Distance in half diagonals of the scene.
    pub t: f32,
    /// The member met.
    pub member: u32,
    /// Triangle in the member's mesh ([`Mesh::triangles`]).
    pub triangle: u32,
    /// The surface hides what is behind it.
    pub opaque: bool,
    /// The ray meets the front, as drawn (mirrored members considered).
    pub front: bool,
    /// Both sides are drawn.
    pub double_sided: bool,
}

/// What a camera ray sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance in half diagonals of the scene.
    pub t: f32,
    /// The member seen.
    pub member: u32,
}

impl<'a> RayScene<'a> {
    /// Builds the hierarchies. Parts of empty meshes are passed over; a scene without triangles is fine.
    pub fn new(meshes: &'a [Mesh], parts: &[Part]) -> Self {
        Self::build(meshes, parts, false)
    }

    /// A scene that can also tell which triangles rays meet ([`Self::visit`]); four bytes more per triangle. Of
    /// equal triangles of a member it may know only the first.
    pub(crate) fn with_triangles(meshes: &'a [Mesh], parts: &[Part]) -> Self {
        Self::build(meshes, parts, true)
    }

    fn build(meshes: &'a [Mesh], parts: &[Part], sources: bool) -> Self {
        let parts: Vec<&Part> = parts.iter().filter(|p| !meshes[p.mesh as usize].is_empty()).collect();
        let bounds = parts
            .par_iter()
            .map(|p| box_of_vertices(&meshes[p.mesh as usize], &p.to_tree))
            .reduce(|| Aabb::EMPTY, |a, b| a.union(&b));
        let (center, half_size) = if bounds.is_empty() {
            (DVec3::ZERO, DVec3::ONE)
        } else {
            (bounds.center(), (bounds.max - bounds.min) * 0.5)
        };
        // A scene of one point still needs a frame.
        let radius = half_size.length().max(f64::MIN_POSITIVE);
        let to_unit = |part: &Part| -> DAffine3 {
            let mesh = &meshes[part.mesh as usize];
            let origin = part.to_tree.transform_point3(mesh.origin);
            DAffine3 {
                matrix3: part.to_tree.matrix3 * (1.0 / radius),
                translation: (origin - center) / radius,
            }
        };

        let copied = meshes_to_copy(meshes, &parts);
        let merged: Vec<Merged<'a>> = parts
            .iter()
            .filter(|p| copied[p.mesh as usize])
            .map(|p| Merged { mesh: &meshes[p.mesh as usize], member: p.member, to_unit: to_unit(p) })
            .collect();

        let mut blas_of_mesh = vec![u32::MAX; meshes.len()];
        let mut shared = Vec::new();
        for part in parts.iter().filter(|p| !copied[p.mesh as usize]) {
            if blas_of_mesh[part.mesh as usize] == u32::MAX {
                blas_of_mesh[part.mesh as usize] = shared.len() as u32;
                shared.push(&meshes[part.mesh as usize]);
            }
        }
        let instances: Vec<Instance> = parts
            .iter()
            .filter(|p| !copied[p.mesh as usize])
            .filter_map(|p| {
                let mesh = &meshes[p.mesh as usize];
                Instance::new(p, blas_of_mesh[p.mesh as usize], mesh_radius(mesh), &to_unit(p))
            })
            .collect();
        let boxes: Vec<obvhs::aabb::Aabb> =
            instances.par_iter().map(|i| i.bounds(&to_unit_box(shared[i.blas as usize], i))).collect();
        let top = (!boxes.is_empty()).then(|| build(&boxes, BvhBuildParams::medium_build()).0);

        Self {
            center,
            radius,
            half_size: half_size / radius,
            merged: Blas::merged(&merged, sources),
            meshes: shared.par_iter().map(|mesh| Blas::of_mesh(mesh, mesh_radius(mesh), sources)).collect(),
            instances,
            top,
        }
    }

    /// Centre of the unit frame in tree space.
    pub fn center(&self) -> DVec3 {
        self.center
    }

    /// Metres per unit of the unit frame.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Half the size of the scene's box in the unit frame.
    pub fn half_size(&self) -> DVec3 {
        self.half_size
    }

    /// Collects every crossing of the line through `point` (unit frame, near the scene) along the unit vector
    /// `direction`; `t` counts from `point`. The order of the hits is arbitrary.
    pub fn line(&self, point: DVec3, direction: DVec3, hits: &mut Vec<LineHit>) {
        hits.clear();
        // Start outside the unit ball of the scene, whatever the point.
        let back = point.dot(direction) + 1.01;
        let start = point - direction * back;
        let offset = -back;
        self.trace(start, direction, f32::INFINITY, |t, member, _, flags, front| {
            let double = flags & DOUBLE_SIDED != 0;
            hits.push(LineHit {
                t: (offset + t) as f32,
                member,
                opaque: flags & OPAQUE != 0,
                seen_from_start: double || front,
                seen_from_end: double || !front,
            });
            f32::INFINITY
        });
    }

    /// What a viewer at `origin` (unit frame) sees along the unit vector `direction`: the nearest opaque surface
    /// and every transparent one in front of it, each member once. Ties go to the smaller member.
    pub fn view(&self, origin: DVec3, direction: DVec3, transparent: &mut Vec<Hit>) -> Option<Hit> {
        transparent.clear();
        let mut nearest: Option<Hit> = None;
        self.trace(origin, direction, f32::INFINITY, |t, member, _, flags, front| {
            let hit = Hit { t: t as f32, member };
            let limit = nearest.map_or(f32::INFINITY, |n| n.t);
            if !front && flags & DOUBLE_SIDED == 0 {
                return limit;
            }
            if flags & OPAQUE == 0 {
                transparent.push(hit);
                return limit;
            }
            if nearest.is_none_or(|n| hit.t < n.t || (hit.t == n.t && member < n.member)) {
                nearest = Some(hit);
            }
            nearest.map_or(f32::INFINITY, |n| n.t)
        });
        if let Some(nearest) = nearest {
            transparent.retain(|h| h.t <= nearest.t && h.member != nearest.member);
        }
        transparent.sort_unstable_by_key(|h| h.member);
        transparent.dedup_by_key(|h| h.member);
        nearest
    }

    /// Calls `found` for every triangle that the ray from `origin` (unit frame) along the unit vector `direction`
    /// meets at `0 <= t <= limit`, in any order; what it returns is the new limit.
    pub(crate) fn visit(
        &self,
        origin: DVec3,
        direction: DVec3,
        limit: f32,
        mut found: impl FnMut(Crossing) -> f32,
    ) {
        self.trace(origin, direction, limit, |t, member, triangle, flags, front| {
            found(Crossing {
                t: t as f32,
                member,
                triangle,
                opaque: flags & OPAQUE != 0,
                front,
                double_sided: flags & DOUBLE_SIDED != 0,
            })
        });
    }

    /// Calls `found(t, member, triangle, flags, front)` for each hit at `0 <= t <= limit`; the limit is what it
    /// returned last. `triangle` is 0 unless the scene was built to know.
    #[inline(always)]
    fn trace(
        &self,
        origin: DVec3,
        direction: DVec3,
        limit: f32,
        mut found: impl FnMut(f64, u32, u32, u8, bool) -> f32,
    ) {
        let limit = Cell::new(limit);
        let origin32 = origin.as_vec3a();
        let direction32 = direction.as_vec3a() + Vec3A::ZERO;
        self.merged.trace(origin32, direction32, limit.get(), |t, flags, member, source, front| {
            let (member, source) = (member.unwrap_or_default(), source.unwrap_or_default());
            limit.set(found(f64::from(t), member, source, flags, front));
            limit.get()
        });
        let Some(top) = &self.top else { return };
        let visit = |node: &obvhs::bvh2::node::Bvh2Node, ray: &mut Ray, _: &mut RayHit| {
            let first = node.first_index as usize;
            for &index in &top.primitive_indices[first..first + node.prim_count as usize] {
                let instance = &self.instances[index as usize];
                let blas = &self.meshes[instance.blas as usize];
                let local = instance.local_ray(origin, direction);
                let to_local =
                    |limit: f32| ((f64::from(limit) - local.start) * f64::from(local.length)) as f32;
                let local_limit = to_local(limit.get());
                if local_limit < 0.0 {
                    continue;
                }
                blas.trace(local.origin, local.direction, local_limit, |t, flags, _, source, front| {
                    let along = local.start + f64::from(t) / f64::from(local.length);
                    let front = front != instance.mirrored;
                    limit.set(found(along, instance.member, source.unwrap_or_default(), flags, front));
                    to_local(limit.get())
                });
                ray.tmax = limit.get();
            }
            true
        };
        let ray = Ray::new(origin32, direction32, 0.0, limit.get());
        obvhs::fast_stack!(u32, (96, 192), top.max_depth, stack, {
            top.ray_traverse_dynamic(&mut stack, ray, &mut RayHit::none(), visit)
        });
    }
}

impl fmt::Debug for RayScene<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RayScene")
            .field("center", &self.center)
            .field("radius", &self.radius)
            .field("instances", &self.instances.len())
            .finish_non_exhaustive()
    }
}

struct LocalRay {
    origin: Vec3A,
    direction: Vec3A,
    /// Mesh-frame lengths per unit-frame length along the ray.
    length: f32,
    /// Unit-frame parameter at which the local ray starts.
    start: f64,
}

impl Instance {
    /// `None` when the transform cannot be inverted.
    fn new(part: &Part, blas: u32, radius: f64, to_unit: &DAffine3) -> Option<Self> {
        let inverse = (to_unit.matrix3 * radius).inverse();
        if !inverse.is_finite() {
            return None;
        }
        Some(Self {
            blas,
            member: part.member,
            center: to_unit.translation,
            to_mesh: Mat3A::from_cols(
                inverse.x_axis.as_vec3a(),
                inverse.y_axis.as_vec3a(),
                inverse.z_axis.as_vec3a(),
            ),
            // The mesh's half diagonal is 1 in its own frame.
            reach: 1.01,
            mirrored: inverse.determinant() < 0.0,
        })
    }

    /// The ray in the mesh's frame, started next to the mesh so that f32 is precise there.
    #[inline(always)]
    fn local_ray(&self, origin: DVec3, direction: DVec3) -> LocalRay {
        let linear = self.to_mesh * direction.as_vec3a();
        let length = linear.length();
        let reach = f64::from(self.reach / length);
        let relative = origin - self.center;
        // The point of the line nearest to the centre in the mesh's own metric would be exact; in the unit frame
        // the start must be early enough for stretched meshes, hence the search in the mesh frame.
        let local_origin = self.to_mesh * relative.as_vec3a();
        let nearest = -f64::from(local_origin.dot(linear) / (length * length));
        let start = (nearest - reach).max(0.0);
        let near = relative + direction * start;
        LocalRay { origin: self.to_mesh * near.as_vec3a(), direction: linear / length, length, start }
    }

    fn bounds(&self, corners: &[DVec3; 8]) -> obvhs::aabb::Aabb {
        let mut min = DVec3::INFINITY;
        let mut max = DVec3::NEG_INFINITY;
        for corner in corners {
            min = min.min(*corner);
            max = max.max(*corner);
        }
        let padding = DVec3::splat(1.0 / 524_288.0);
        obvhs::aabb::Aabb::new((min - padding).as_vec3a(), (max + padding).as_vec3a())
    }
}

/// Corners of the mesh's box, placed in the unit frame.
fn to_unit_box(mesh: &Mesh, instance: &Instance) -> [DVec3; 8] {
    let bounds = box_of_vertices_local(mesh);
    let radius = mesh_radius(mesh);
    let to_unit = glam::DMat3::from_cols(
        instance.to_mesh.x_axis.as_dvec3(),
        instance.to_mesh.y_axis.as_dvec3(),
        instance.to_mesh.z_axis.as_dvec3(),
    )
    .inverse();
    std::array::from_fn(|i| {
        let pick = |bit: usize, low: f64, high: f64| if i & bit == 0 { low } else { high };
        let corner = DVec3::new(
            pick(1, bounds.min.x, bounds.max.x),
            pick(2, bounds.min.y, bounds.max.y),
            pick(4, bounds.min.z, bounds.max.z),
        );
        instance.center + to_unit * (corner / radius)
    })
}

/// Farthest vertex from the mesh's origin, metres in mesh space; never zero.
fn mesh_radius(mesh: &Mesh) -> f64 {
    let squared = mesh.positions.iter().map(|p| p.as_dvec3().length_squared()).fold(0.0, f64::max);
    squared.sqrt().max(f64::MIN_POSITIVE)
}

fn box_of_vertices_local(mesh: &Mesh) -> Aabb {
    mesh.positions.iter().fold(Aabb::EMPTY, |b, p| {
        let p = p.as_dvec3();
        Aabb { min: b.min.min(p), max: b.max.max(p) }
    })
}

fn box_of_vertices(mesh: &Mesh, to_tree: &DAffine3) -> Aabb {
    mesh.positions.iter().fold(Aabb::EMPTY, |b, p| {
        let p = to_tree.transform_point3(mesh.origin + p.as_dvec3());
        Aabb { min: b.min.min(p), max: b.max.max(p) }
    })
}

/// Which meshes are placed triangle by triangle: those drawn once, then the smallest, whose instances cost rays
/// the most for what they add.
fn meshes_to_copy(meshes: &[Mesh], parts: &[&Part]) -> Vec<bool> {
    let mut uses = vec![0usize; meshes.len()];
    for part in parts {
        uses[part.mesh as usize] += 1;
    }
    let mut reused: Vec<(usize, usize)> = Vec::new();
    let mut copied: Vec<bool> = Vec::with_capacity(meshes.len());
    for (index, mesh) in meshes.iter().enumerate() {
        let fits = !has_mask(mesh);
        copied.push(fits && uses[index] == 1);
        if fits && uses[index] > 1 {
            reused.push((mesh.triangles.len(), index));
        }
    }
    reused.sort_unstable();
    let mut budget = COPIED_TRIANGLES;
    for (triangles, index) in reused {
        let cost = triangles * uses[index];
        if cost > budget {
            break;
        }
        budget -= cost;
        copied[index] = true;
    }
    copied
}
