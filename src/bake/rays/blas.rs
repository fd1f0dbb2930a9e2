//! The triangles of one mesh, or of many meshes drawn once each, under one `obvhs` hierarchy.

use super::build::build;
use super::triangle::{PACKET, Packet, ShearedRay, TriangleHit};
use crate::scene::{Mesh, Opacity};
use glam::{DAffine3, Vec2, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::ray::{Ray, RayHit};
use rayon::prelude::*;

/// Boxes are widened by this share of the hierarchy's half diagonal: the slab test rounds, and a box missed by
/// rounding would be a leak. 2^-19 is 16 steps of f32 at 1.
const BOX_PADDING: f32 = 1.0 / 524_288.0;

/// Hides what is behind it.
pub(super) const OPAQUE: u8 = 1;
/// Both sides are drawn.
pub(super) const DOUBLE_SIDED: u8 = 2;
/// Is there only where its alpha texture passes.
const MASKED: u8 = 4;

/// Triangles in their own frame of half diagonal about 1.
pub(super) struct Blas<'a> {
    /// A leaf's `first_index` is its packet.
    bvh: Bvh2,
    packets: Vec<Packet>,
    /// By packet and place in it, like the vectors below.
    flags: Vec<u8>,
    /// Member of each triangle, for triangles of several members; else empty.
    members: Vec<u32>,
    /// Triangle index in its mesh of each triangle; empty if nobody asks (no MASK surfaces, no triangle queries).
    sources: Vec<u32>,
    masked_mesh: Option<&'a Mesh>,
}

/// One placed mesh on its way into a merged hierarchy.
pub(super) struct Merged<'a> {
    pub mesh: &'a Mesh,
    pub member: u32,
    /// From positions relative to the mesh's origin to the unit frame.
    pub to_unit: DAffine3,
}

impl<'a> Blas<'a> {
    /// One mesh in its own frame: positions divided by `radius`; `sources`: triangle queries are to come.
    pub(super) fn of_mesh(mesh: &'a Mesh, radius: f64, sources: bool) -> Self {
        let scale = |v: u32| (mesh.positions[v as usize].as_dvec3() / radius).as_vec3().to_array();
        let corners: Vec<_> = mesh.triangles.iter().map(|t| t.map(scale)).collect();
        let flags = triangle_flags(mesh);
        let masked = flags.iter().any(|f| f & MASKED != 0);
        let mut blas = Self::build(corners, flags, Vec::new());
        if masked {
            blas.masked_mesh = Some(mesh);
        } else if !sources {
            blas.sources = Vec::new();
        }
        blas
    }

    /// Many meshes, each drawn once, in the unit frame of the scene; `sources`: triangle queries are to come.
    pub(super) fn merged(parts: &[Merged<'a>], sources: bool) -> Self {
        let total = parts.iter().map(|p| p.mesh.triangles.len()).sum();
        let mut corners = Vec::with_capacity(total);
        let mut flags = Vec::with_capacity(total);
        let mut members = Vec::with_capacity(total);
        for part in parts {
            let placed: Vec<[f32; 3]> = part
                .mesh
                .positions
                .iter()
                .map(|p| part.to_unit.transform_point3(p.as_dvec3()).as_vec3().to_array())
                .collect();
            let mirrored = part.to_unit.matrix3.determinant() < 0.0;
            for triangle in &part.mesh.triangles {
                let [a, b, c] = triangle.map(|v| placed[v as usize]);
                corners.push(if mirrored { [a, c, b] } else { [a, b, c] });
                members.push(part.member);
            }
            flags.extend(triangle_flags(part.mesh));
        }
        let mut blas = Self::build(corners, flags, members);
        if sources {
            let starts: Vec<u32> = parts
                .iter()
                .scan(0u32, |start, part| {
                    let this = *start;
                    *start += part.mesh.triangles.len() as u32;
                    Some(this)
                })
                .collect();
            for source in &mut blas.sources {
                let part = starts.partition_point(|&start| start <= *source).saturating_sub(1);
                *source -= starts.get(part).copied().unwrap_or_default();
            }
        } else {
            blas.sources = Vec::new();
        }
        blas
    }

    fn build(corners: Vec<[[f32; 3]; 3]>, flags: Vec<u8>, members: Vec<u32>) -> Self {
        let padding = Vec3A::splat(BOX_PADDING);
        let boxes: Vec<Aabb> = corners
            .iter()
            .map(|c| {
                let mut aabb = Aabb::from_points(&c.map(Vec3A::from));
                aabb.min -= padding;
                aabb.max += padding;
                aabb
            })
            .collect();
        let params = BvhBuildParams {
            max_prims_per_leaf: PACKET as u32,
            // A packet costs about as much as one of its triangles would, so leaves may as well be full.
            collapse_traversal_cost: 8.0,
            ..BvhBuildParams::fast_build()
        };
        let (mut bvh, is_trap) = build(&boxes, params);
        if is_trap && let Some(kept) = distinct(&corners, &flags, &members) {
            let pick = |i: &u32| corners[*i as usize];
            let mut blas = Self::build(
                kept.iter().map(pick).collect(),
                kept.iter().map(|&i| flags[i as usize]).collect(),
                kept.iter().filter_map(|&i| members.get(i as usize).copied()).collect(),
            );
            for source in &mut blas.sources {
                *source = kept[*source as usize];
            }
            return blas;
        }
        // Lines are far apart, so most of their time is spent waiting for nodes: keep those of a path together.
        bvh.reorder_in_stack_traversal_order();
        let mut packets = Vec::new();
        // Source triangle of every place in the packets.
        let mut places = Vec::new();
        for leaf in bvh.nodes.iter_mut().filter(|n| n.is_leaf()) {
            let first = leaf.first_index as usize;
            let sources = &bvh.primitive_indices[first..first + leaf.prim_count as usize];
            leaf.first_index = packets.len() as u32;
            for chunk in sources.chunks(PACKET) {
                let triangles: Vec<_> = chunk.iter().map(|&i| corners[i as usize]).collect();
                packets.push(Packet::new(&triangles));
                places.extend((0..PACKET).map(|lane| chunk.get(lane).copied().unwrap_or(0)));
            }
        }
        bvh.primitive_indices = Vec::new();
        Self {
            packets,
            flags: places.iter().map(|&i| flags[i as usize]).collect(),
            members: places.iter().filter_map(|&i| members.get(i as usize).copied()).collect(),
            sources: places,
            masked_mesh: None,
            bvh,
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.packets.is_empty()
    }

    /// Calls `found(t, flags, member, source, front)` for every triangle that the ray from `origin` meets at
    /// `0 <= t <= limit`; what it returns is the new limit. `source` is the triangle's index in its mesh, if kept.
    #[inline(always)]
    pub(super) fn trace(
        &self,
        origin: Vec3A,
        direction: Vec3A,
        limit: f32,
        mut found: impl FnMut(f32, u8, Option<u32>, Option<u32>, bool) -> f32,
    ) {
        if self.is_empty() {
            return;
        }
        // Adding +0.0 turns -0.0 into +0.0, which the slab test needs to choose the right infinity.
        let direction = direction + Vec3A::ZERO;
        let sheared = ShearedRay::new(origin, direction);
        let ray = Ray::new(origin, direction, 0.0, limit);
        let test_leaf = |node: &obvhs::bvh2::node::Bvh2Node, ray: &mut Ray, _: &mut RayHit| {
            let first = node.first_index as usize;
            let count = (node.prim_count as usize).div_ceil(PACKET);
            for packet in first..first + count {
                let hit = sheared.intersect_packet(&self.packets[packet], ray.tmax);
                let mut lanes = hit.lanes;
                while lanes != 0 {
                    let lane = lanes.trailing_zeros() as usize;
                    lanes &= lanes - 1;
                    let index = packet * PACKET + lane;
                    let hit = hit.get(lane);
                    if hit.t <= ray.tmax && self.is_there(index, &hit) {
                        let member = self.members.get(index).copied();
                        let source = self.sources.get(index).copied();
                        ray.tmax = found(hit.t, self.flags[index], member, source, hit.front);
                    }
                }
            }
            true
        };
        obvhs::fast_stack!(u32, (96, 192), self.bvh.max_depth, stack, {
            self.bvh.ray_traverse_dynamic(&mut stack, ray, &mut RayHit::none(), test_leaf)
        });
    }

    /// A MASK surface is there only where its texture passes.
    #[inline(always)]
    fn is_there(&self, index: usize, hit: &TriangleHit) -> bool {
        if self.flags[index] & MASKED == 0 {
            return true;
        }
        self.mask_passes(index, hit)
    }

    #[cold]
    fn mask_passes(&self, index: usize, hit: &TriangleHit) -> bool {
        let Some(mesh) = self.masked_mesh else { return true };
        let source = self.sources[index];
        let surface = mesh.surfaces.partition_point(|s| s.triangles.end <= source);
        let Opacity::Mask(mask) = &mesh.surfaces[surface].opacity else { return true };
        let uv: Vec2 = mesh.triangles[source as usize]
            .iter()
            .zip(hit.weights)
            .map(|(&v, weight)| mesh.uvs.get(v as usize).copied().unwrap_or_default() * weight)
            .sum();
        mask.passes_at(uv)
    }
}

fn triangle_flags(mesh: &Mesh) -> Vec<u8> {
    let mut flags = vec![OPAQUE | DOUBLE_SIDED; mesh.triangles.len()];
    for surface in &mesh.surfaces {
        let mut value = match surface.opacity {
            Opacity::Opaque => OPAQUE,
            Opacity::Transparent => 0,
            Opacity::Mask(_) => OPAQUE | MASKED,
        };
        if surface.double_sided {
            value |= DOUBLE_SIDED;
        }
        flags[surface.triangles.start as usize..surface.triangles.end as usize].fill(value);
    }
    flags
}

/// The first of all triangles that equal each other (corners, kind, member), in order; `None` if all are distinct or
/// some have an alpha texture, whose coordinates may tell them apart.
fn distinct(corners: &[[[f32; 3]; 3]], flags: &[u8], members: &[u32]) -> Option<Vec<u32>> {
    if flags.iter().any(|f| f & MASKED != 0) {
        return None;
    }
    let key = |i: u32| {
        let i = i as usize;
        (corners[i].map(|corner| corner.map(f32::to_bits)), flags[i], members.get(i))
    };
    let mut order: Vec<u32> = (0..corners.len() as u32).collect();
    order.par_sort_unstable_by(|&a, &b| key(a).cmp(&key(b)).then(a.cmp(&b)));
    order.dedup_by(|b, a| key(*b) == key(*a));
    order.sort_unstable();
    (order.len() < corners.len()).then_some(order)
}

/// A mesh with an alpha texture keeps its own hierarchy: its hits need texture coordinates.
pub(super) fn has_mask(mesh: &Mesh) -> bool {
    mesh.surfaces.iter().any(|s| matches!(s.opacity, Opacity::Mask(_)))
}
