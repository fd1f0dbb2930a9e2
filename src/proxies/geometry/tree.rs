//! A hierarchy over triangles that answers two questions: what a ray meets, and which point is nearest.

use crate::bake::rays::build::build;
use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::ray::{Ray, RayHit};
use obvhs::triangle::Triangle;

/// Boxes are widened by this share of the whole: the slab test rounds.
const BOX_PADDING: f32 = 1.0 / 524_288.0;

/// Triangles under an `obvhs` hierarchy.
pub(super) struct TriangleTree {
    bvh: Bvh2,
    /// In the order of the leaves.
    triangles: Vec<Triangle>,
    /// Index of each in the list that the tree was built of.
    sources: Vec<u32>,
}

impl TriangleTree {
    /// Builds it; triangles must be finite.
    pub(super) fn new(triangles: &[Triangle]) -> Self {
        let all = triangles.iter().fold(Aabb::empty(), |all, t| all.union(&t.aabb()));
        let padding = Vec3A::splat(all.diagonal().max_element().max(0.0) * BOX_PADDING);
        let boxes: Vec<Aabb> = triangles
            .iter()
            .map(|t| {
                let mut aabb = t.aabb();
                aabb.min -= padding;
                aabb.max += padding;
                aabb
            })
            .collect();
        if boxes.is_empty() {
            return Self { bvh: Bvh2::default(), triangles: Vec::new(), sources: Vec::new() };
        }
        let params = BvhBuildParams { max_prims_per_leaf: 4, ..BvhBuildParams::fast_build() };
        let (bvh, _) = build(&boxes, params);
        let sources = bvh.primitive_indices.clone();
        Self { triangles: sources.iter().map(|&i| triangles[i as usize]).collect(), sources, bvh }
    }

    /// Calls `found(t, index, front)` for the triangles that the ray from `origin` meets at `0 <= t <= limit`; what it
    /// returns is the new limit.
    pub(super) fn trace(
        &self,
        origin: Vec3A,
        direction: Vec3A,
        limit: f32,
        mut found: impl FnMut(f32, u32, bool) -> f32,
    ) {
        if self.triangles.is_empty() {
            return;
        }
        // Adding +0.0 turns -0.0 into +0.0, which the slab test needs.
        let ray = Ray::new(origin, direction + Vec3A::ZERO, 0.0, limit);
        let test_leaf = |node: &Bvh2Node, ray: &mut Ray, _: &mut RayHit| {
            let first = node.first_index as usize;
            for place in first..first + node.prim_count as usize {
                let triangle = &self.triangles[place];
                let t = triangle.intersect(ray);
                if t <= ray.tmax {
                    let normal = (triangle.v1 - triangle.v0).cross(triangle.v2 - triangle.v0);
                    ray.tmax = found(t, self.sources[place], normal.dot(ray.direction) < 0.0);
                }
            }
            true
        };
        obvhs::fast_stack!(u32, (96, 192), self.bvh.max_depth, stack, {
            self.bvh.ray_traverse_dynamic(&mut stack, ray, &mut RayHit::none(), test_leaf)
        });
    }

    /// Distance from a point to the nearest triangle, and its index; `None` if there is none.
    pub(super) fn nearest(&self, point: Vec3A, stack: &mut Vec<(f32, u32)>) -> Option<(f32, u32)> {
        let root = self.bvh.nodes.first()?;
        let mut best = (f32::INFINITY, 0u32);
        stack.clear();
        stack.push((box_distance(root, point), 0));
        while let Some((squared, index)) = stack.pop() {
            if squared > best.0 {
                continue;
            }
            let node = &self.bvh.nodes[index as usize];
            if node.is_leaf() {
                let first = node.first_index as usize;
                for place in first..first + node.prim_count as usize {
                    let squared = triangle_distance(&self.triangles[place], point);
                    if squared < best.0 || (squared == best.0 && self.sources[place] < best.1) {
                        best = (squared, self.sources[place]);
                    }
                }
                continue;
            }
            let children = [node.first_index, node.first_index + 1]
                .map(|child| (box_distance(&self.bvh.nodes[child as usize], point), child));
            let near = usize::from(children[1].0 < children[0].0);
            for child in [children[1 - near], children[near]] {
                if child.0 <= best.0 {
                    stack.push(child);
                }
            }
        }
        best.0.is_finite().then_some((best.0.sqrt(), best.1))
    }
}

fn box_distance(node: &Bvh2Node, point: Vec3A) -> f32 {
    let aabb = node.aabb();
    (point - point.clamp(aabb.min, aabb.max)).length_squared()
}

/// Square of the distance from a point to a triangle (Ericson: Real-Time Collision Detection, 2005, 5.1.5).
fn triangle_distance(triangle: &Triangle, point: Vec3A) -> f32 {
    let (a, b, c) = (triangle.v0 - point, triangle.v1 - point, triangle.v2 - point);
    let (ab, ac) = (b - a, c - a);
    let (d1, d2) = (-ab.dot(a), -ac.dot(a));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a.length_squared();
    }
    let (d3, d4) = (-ab.dot(b), -ac.dot(b));
    if d3 >= 0.0 && d4 <= d3 {
        return b.length_squared();
    }
    let (d5, d6) = (-ab.dot(c), -ac.dot(c));
    if d6 >= 0.0 && d5 <= d6 {
        return c.length_squared();
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return (a + ab * share(d1, d1 - d3)).length_squared();
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return (a + ac * share(d2, d2 - d6)).length_squared();
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        return (b + (c - b) * share(d4 - d3, (d4 - d3) + (d5 - d6))).length_squared();
    }
    let sum = va + vb + vc;
    (a + ab * share(vb, sum) + ac * share(vc, sum)).length_squared()
}

/// A quotient that is 0 for needles without length.
fn share(part: f32, whole: f32) -> f32 {
    if whole.abs() > 0.0 { part / whole } else { 0.0 }
}
