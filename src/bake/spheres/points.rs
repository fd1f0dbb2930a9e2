//! Vertices in small boxes, so that the farthest or most extreme one is found without looking at most of them.

use crate::bake::hierarchy::COORDINATE_LIMIT;
use crate::scene::Mesh;
use glam::{DAffine3, DMat3, DVec3, Vec3};
use std::ops::Range;

/// Vertices per box.
const BLOCK: usize = 32;

/// Bounds are enlarged by this part, against rounding.
const SLACK: f64 = 1e-13;

/// The vertices of a mesh's triangles, in mesh space.
#[derive(Debug, Default)]
pub(super) struct MeshPoints {
    origin: DVec3,
    /// Relative to `origin`, distinct, along a space-filling curve.
    points: Vec<Vec3>,
    blocks: Vec<Block>,
    all: Block,
}

/// A box (relative to the origin) and the points in it.
#[derive(Clone, Debug, Default)]
struct Block {
    center: DVec3,
    half: DVec3,
    points: Range<usize>,
}

impl MeshPoints {
    pub(super) fn new(mesh: &Mesh) -> Self {
        let mut is_used = vec![false; mesh.positions.len()];
        for &corner in mesh.triangles.as_flattened() {
            if let Some(is_used) = is_used.get_mut(corner as usize) {
                *is_used = true;
            }
        }
        let used = mesh.positions.iter().zip(is_used).filter(|(point, used)| *used && point.is_finite());
        let used = used.map(|(&point, _)| point);
        let min = used.clone().fold(Vec3::INFINITY, Vec3::min).as_dvec3();
        let max = used.clone().fold(Vec3::NEG_INFINITY, Vec3::max).as_dvec3();
        let cells = 1023.0 / (max - min).max_element().max(f64::MIN_POSITIVE);
        let key = |point: Vec3| {
            let cell = ((point.as_dvec3() - min) * cells).as_uvec3();
            spread(cell.x) | spread(cell.y) << 1 | spread(cell.z) << 2
        };
        let mut keyed: Vec<(u32, [f32; 3])> = used.map(|point| (key(point), point.to_array())).collect();
        keyed.sort_unstable_by(|a, b| {
            let points = a.1.iter().zip(&b.1).map(|(a, b)| a.total_cmp(b));
            a.0.cmp(&b.0).then(points.fold(std::cmp::Ordering::Equal, std::cmp::Ordering::then))
        });
        keyed.dedup();
        let points: Vec<Vec3> = keyed.into_iter().map(|(_, point)| point.into()).collect();
        let starts = (0..points.len()).step_by(BLOCK);
        let blocks =
            starts.map(|start| Block::new(&points, start..points.len().min(start + BLOCK))).collect();
        let all = Block::new(&points, 0..points.len());
        Self { origin: mesh.origin, points, blocks, all }
    }
}

impl Block {
    fn new(points: &[Vec3], range: Range<usize>) -> Self {
        let inside = &points[range.clone()];
        let min = inside.iter().copied().fold(Vec3::INFINITY, Vec3::min).as_dvec3();
        let max = inside.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max).as_dvec3();
        Self { center: (min + max) * 0.5, half: (max - min) * 0.5, points: range }
    }
}

/// Puts two zero bits between the lowest ten.
fn spread(value: u32) -> u32 {
    (0..10).fold(0, |spread, bit| spread | (value >> bit & 1) << (3 * bit))
}

/// A mesh with its place in tree space; it has at least one vertex, and all are finite.
#[derive(Debug)]
pub(super) struct PlacedPart<'a> {
    points: &'a MeshPoints,
    to_tree: DAffine3,
    /// Absolute values of the linear part: turns half sizes of boxes in mesh space into those in tree space.
    reach: DMat3,
    /// Largest rounding error of a vertex in tree space.
    error: DVec3,
}

impl<'a> PlacedPart<'a> {
    /// `None` if there are no vertices or they are not finite or beyond [`COORDINATE_LIMIT`] in tree space.
    pub(super) fn new(points: &'a MeshPoints, to_tree: DAffine3) -> Option<Self> {
        let reach = DMat3::from_cols(
            to_tree.matrix3.x_axis.abs(),
            to_tree.matrix3.y_axis.abs(),
            to_tree.matrix3.z_axis.abs(),
        );
        let largest = points.origin.abs() + points.all.center.abs() + points.all.half;
        let error = (reach * largest + to_tree.translation.abs()) * (4.0 * f64::EPSILON);
        let placed = Self { points, to_tree, reach, error };
        let (center, half) = placed.block(&points.all);
        let is_finite = (center.abs() + half).cmple(DVec3::splat(COORDINATE_LIMIT)).all();
        (!points.points.is_empty() && is_finite).then_some(placed)
    }

    /// A vertex in tree space.
    fn point(&self, index: usize) -> DVec3 {
        self.to_tree.transform_point3(self.points.origin + self.points.points[index].as_dvec3())
    }

    /// A box in tree space that holds a box in mesh space: centre and half size.
    fn block(&self, block: &Block) -> (DVec3, DVec3) {
        (
            self.to_tree.transform_point3(self.points.origin + block.center),
            self.reach * block.half + self.error,
        )
    }

    /// Squared distance that no vertex of the block exceeds.
    fn bound(&self, block: &Block, center: DVec3) -> f64 {
        let (middle, half) = self.block(block);
        ((middle - center).abs() + half).length_squared() * (1.0 + SLACK)
    }

    /// A vertex whose squared distance from `center` is the largest of those above `squared`.
    pub(super) fn farthest(&self, center: DVec3, squared: f64) -> Option<(DVec3, f64)> {
        if self.bound(&self.points.all, center) <= squared {
            return None;
        }
        let mut best = None;
        let mut limit = squared;
        for block in &self.points.blocks {
            if self.bound(block, center) <= limit {
                continue;
            }
            for index in block.points.clone() {
                let point = self.point(index);
                let squared = point.distance_squared(center);
                if squared > limit {
                    limit = squared;
                    best = Some((point, squared));
                }
            }
        }
        best
    }

    /// The vertex farthest along `direction` (tree space, any length); the first of equal ones.
    pub(super) fn extreme(&self, direction: DVec3) -> Option<DVec3> {
        // In mesh space and relative to the origin: fewer operations and less rounding.
        let local = self.to_tree.matrix3.transpose() * direction;
        let size = local.abs();
        let mut best: Option<(usize, f64)> = None;
        for block in &self.points.blocks {
            let bound = local.dot(block.center) + size.dot(block.half);
            if best.is_some_and(|(_, best)| bound <= best) {
                continue;
            }
            for index in block.points.clone() {
                let along = local.dot(self.points.points[index].as_dvec3());
                if best.is_none_or(|(_, best)| along > best) {
                    best = Some((index, along));
                }
            }
        }
        best.map(|(index, _)| self.point(index))
    }
}
