//! From a vector to its nearest direction and its triangle in constant time, exactly.
//!
//! The sphere is cut into the cells of an octahedral map (Meyer et al., *On Floating-Point Normal Vectors*,
//! 2010). A cell keeps every direction that is nearest somewhere in it (mostly one or two) and the triangle
//! that holds its middle, from which a short walk finds the right one.

use super::delaunay::EdgeMap;
use super::solid::Mesh;
use crate::sorting::insert;
use glam::DVec3;

/// A direction stays a candidate unless another one is nearer by this much all over the cell: far above what
/// rounding can move a vector out of its cell, far below what matters.
const MARGIN: f64 = 1e-9;

/// Weights down to this count as inside a triangle, so that a vector on an edge ends the walk.
const ON_EDGE: f64 = -1e-12;

/// Directions a cell holds in place. More meet only in a few cells, at corners where many bins meet.
const SLOTS: usize = 4;

/// In the last slot: the cell's directions are in the overflow list. No set has so many directions.
const OVERFLOW: u16 = u16::MAX;

/// The table of one direction set.
#[derive(Debug)]
pub(crate) struct Lookup {
    /// Cells per side of the octahedral square, even: the folds then run along cell borders and diagonals.
    side: usize,
    cells: Vec<Cell>,
    /// Candidates of the cells that have more than [`SLOTS`], by cell.
    overflow: Vec<(usize, Vec<u16>)>,
    /// The neighbour of each triangle across its edges (first-second, second-third, third-first).
    across: Vec<[u16; 3]>,
    /// Normals of the planes through the origin and the edges opposite each corner, pointing inwards.
    normals: Vec<[DVec3; 3]>,
}

#[derive(Clone, Copy, Debug)]
struct Cell {
    /// Candidates, ascending; free slots repeat the first, so that the common case needs no branch.
    candidates: [u16; SLOTS],
    /// Triangle that holds the middle of the cell.
    triangle: u16,
}

impl Lookup {
    /// `rings[i]` are the neighbours of `i` in `mesh`, which must be Delaunay: greedy walks rely on it.
    pub(crate) fn new(mesh: &Mesh, rings: &[Vec<u16>]) -> Self {
        let edges = EdgeMap::new(&mesh.triangles);
        let neighbours =
            |&[a, b, c]: &[u16; 3]| [(b, a), (c, b), (a, c)].map(|edge| edges.get(edge).unwrap_or(0) as u16);
        let across = mesh.triangles.iter().map(neighbours).collect();
        let planes = |triangle: &[u16; 3]| {
            let [a, b, c] = triangle.map(|i| mesh.vertices[i as usize]);
            [b.cross(c), c.cross(a), a.cross(b)]
        };
        let normals = mesh.triangles.iter().map(planes).collect();
        // About a hundred cells per bin, as long as the table stays small.
        let side = ((5.0 * (mesh.vertices.len() as f64).sqrt()) as usize).next_power_of_two().clamp(16, 256);
        let mut lookup = Self { side, cells: Vec::new(), overflow: Vec::new(), across, normals };
        let (mut near, mut triangle) = (0, 0);
        for row in 0..side {
            for column in 0..side {
                let corner = |dx: f64, dy: f64| {
                    let scale = 2.0 / side as f64;
                    unfold((column as f64 + dx) * scale - 1.0, (row as f64 + dy) * scale - 1.0)
                };
                let corners = [corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0), corner(1.0, 1.0)];
                let middle = corner(0.5, 0.5);
                near = walk_to_nearest(mesh, rings, near, middle);
                triangle = lookup.walk(triangle, middle).0;
                let found = seen_from(mesh, rings, near, middle, corners);
                let mut candidates = [found[0]; SLOTS];
                if found.len() > SLOTS {
                    candidates[SLOTS - 1] = OVERFLOW;
                    lookup.overflow.push((lookup.cells.len(), found));
                } else {
                    candidates[..found.len()].copy_from_slice(&found);
                }
                lookup.cells.push(Cell { candidates, triangle });
            }
        }
        lookup
    }

    /// Cell of `v`, which is `1 / scale` long in the sense of `|x| + |y| + |z|`.
    #[inline]
    fn cell(&self, v: DVec3, scale: f64) -> usize {
        let (u, v) = fold(v * scale);
        let half = self.side as f64 * 0.5;
        let index = |t: f64| (((t + 1.0) * half) as usize).min(self.side - 1);
        index(v) * self.side + index(u)
    }

    /// Index of the largest dot product with `v` (the lowest such index); `scale` is `1 / (|x| + |y| + |z|)`.
    #[inline]
    pub(crate) fn nearest(&self, vertices: &[DVec3], v: DVec3, scale: f64) -> usize {
        let index = self.cell(v, scale);
        let candidates = &self.cells[index].candidates;
        if candidates[SLOTS - 1] == OVERFLOW {
            let at = self.overflow.partition_point(|entry| entry.0 < index);
            return best(vertices, v, &self.overflow[at].1);
        }
        // Free slots repeat the first candidate: a third one is rare, and one branch is cheaper than four.
        let first = best(vertices, v, &candidates[..2]);
        if candidates[2] == candidates[0] { first } else { best(vertices, v, candidates) }
    }

    /// Triangle that holds `v` and the weights of its corners, which sum to 1; `scale` as in [`Self::nearest`].
    pub(crate) fn triangle(&self, v: DVec3, scale: f64) -> (u16, [f64; 3]) {
        self.walk(self.cells[self.cell(v, scale)].triangle, v * scale)
    }

    /// Steps across the most negative edge until none is negative (Devillers et al. 2001: ends on a Delaunay
    /// triangulation). The bound only guards against rounding.
    fn walk(&self, start: u16, p: DVec3) -> (u16, [f64; 3]) {
        let mut triangle = start;
        let mut weights = self.barycentric(triangle, p);
        for _ in 0..self.across.len() {
            // The weight of a corner is negative beyond the opposite edge.
            let [a, b, c] = weights;
            let (edge, least) = if c <= a && c <= b {
                (0, c)
            } else if a <= b {
                (1, a)
            } else {
                (2, b)
            };
            if least >= ON_EDGE {
                break;
            }
            triangle = self.across[triangle as usize][edge];
            weights = self.barycentric(triangle, p);
        }
        let clamped = weights.map(|w| w.max(0.0));
        let sum = clamped[0] + clamped[1] + clamped[2];
        (triangle, clamped.map(|w| w / sum))
    }

    /// Weights of the point where the ray along `p` meets the triangle's plane, times a positive factor.
    #[inline]
    fn barycentric(&self, triangle: u16, p: DVec3) -> [f64; 3] {
        self.normals[usize::from(triangle)].map(|normal| normal.dot(p))
    }
}

/// The lowest of the indices with the largest dot product.
#[inline]
fn best(vertices: &[DVec3], v: DVec3, candidates: &[u16]) -> usize {
    let (mut best, mut most) = (0, f64::NEG_INFINITY);
    for &i in candidates {
        let dot = vertices[usize::from(i)].dot(v);
        (best, most) = if dot > most { (usize::from(i), dot) } else { (best, most) };
    }
    best
}

/// On a Delaunay triangulation, always stepping to the best neighbour ends at the nearest vertex.
fn walk_to_nearest(mesh: &Mesh, rings: &[Vec<u16>], start: usize, p: DVec3) -> usize {
    let mut best = start;
    let mut best_dot = mesh.vertices[best].dot(p);
    loop {
        let here = best;
        for &i in &rings[here] {
            let dot = mesh.vertices[i as usize].dot(p);
            if dot > best_dot {
                (best, best_dot) = (i as usize, dot);
            }
        }
        if best == here {
            return best;
        }
    }
}

/// Every direction that is nearest to some vector of a cell, ascending.
fn seen_from(mesh: &Mesh, rings: &[Vec<u16>], near: usize, middle: DVec3, corners: [DVec3; 4]) -> Vec<u16> {
    let chord = |i: u16, p: DVec3| (mesh.vertices[i as usize] - p).length();
    let middle = middle.normalize();
    let corners = corners.map(DVec3::normalize);
    // A spherical cap cuts every plane in a convex set: the corners bound the cell's radius. Chords obey the
    // triangle inequality, so whatever is nearest within `radius` of the middle is at most this far from it.
    let radius = corners.iter().map(|&c| (c - middle).length()).fold(0.0, f64::max);
    let reach = chord(near as u16, middle) + 2.0 * radius + MARGIN;
    let mut found = vec![near as u16];
    let mut next = 0;
    while next < found.len() {
        for &i in &rings[found[next] as usize] {
            if chord(i, middle) <= reach && !found.contains(&i) {
                found.push(i);
            }
        }
        next += 1;
    }
    // Which of two directions is nearer is the sign of a linear function: its corners decide for a whole cell.
    let beaten = |loser: u16, winner: u16| {
        let difference = mesh.vertices[winner as usize] - mesh.vertices[loser as usize];
        corners.iter().all(|&c| difference.dot(c) > MARGIN)
    };
    let mut unbeaten = Vec::new();
    for &i in found.iter().filter(|&&i| !found.iter().any(|&other| beaten(i, other))) {
        insert(&mut unbeaten, i);
    }
    unbeaten
}

/// Octahedral map of a vector with `|x| + |y| + |z| = 1` to `[-1, 1]²`.
fn fold(p: DVec3) -> (f64, f64) {
    if p.z >= 0.0 {
        (p.x, p.y)
    } else {
        ((1.0 - p.y.abs()) * 1f64.copysign(p.x), (1.0 - p.x.abs()) * 1f64.copysign(p.y))
    }
}

/// Inverse of [`fold`].
fn unfold(u: f64, v: f64) -> DVec3 {
    let z = 1.0 - u.abs() - v.abs();
    if z >= 0.0 {
        DVec3::new(u, v, z)
    } else {
        DVec3::new((1.0 - v.abs()) * 1f64.copysign(u), (1.0 - u.abs()) * 1f64.copysign(v), z)
    }
}
