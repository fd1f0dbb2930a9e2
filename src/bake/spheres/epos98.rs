//! Extreme points along 49 directions: Thomas Larsson, Fast and Tight Fitting Bounding Spheres, SIGRAD 2008 (EPOS-98).
//!
//! The extreme points of a union are among those of its parts, so they are found once per placed mesh and merged
//! up the tree: the cost is that of one pass over the vertices, not of one per level.

use super::points::PlacedPart;
use crate::bake::tree::Aabb;
use glam::DVec3;

/// Number of directions; each gives two extreme points.
pub(super) const DIRECTIONS: usize = 49;

/// The paper's directions, one of each opposite pair, not normalised (only the order along each matters): all
/// permutations and signs of (1,0,0), (1,1,0), (1,1,1), (0,1,2), (1,1,2), (1,2,2). The first three are x, y, z.
#[rustfmt::skip]
pub(super) const NORMALS: [[i8; 3]; DIRECTIONS] = [
    [1, 0, 0], [0, 1, 0], [0, 0, 1],
    [1, 1, 0], [1, -1, 0], [1, 0, 1], [1, 0, -1], [0, 1, 1], [0, 1, -1],
    [1, 1, 1], [1, 1, -1], [1, -1, 1], [1, -1, -1],
    [0, 1, 2], [0, 2, 1], [1, 0, 2], [2, 0, 1], [1, 2, 0], [2, 1, 0],
    [0, 1, -2], [0, 2, -1], [1, 0, -2], [2, 0, -1], [1, -2, 0], [2, -1, 0],
    [1, 1, 2], [2, 1, 1], [1, 2, 1], [1, -1, 2], [1, 1, -2], [1, -1, -2],
    [2, -1, 1], [2, 1, -1], [2, -1, -1], [1, -2, 1], [1, 2, -1], [1, -2, -1],
    [2, 2, 1], [1, 2, 2], [2, 1, 2], [2, -2, 1], [2, 2, -1], [2, -2, -1],
    [1, -2, 2], [1, 2, -2], [1, -2, -2], [2, -1, 2], [2, 1, -2], [2, -1, -2],
];

/// The extreme points of a set of vertices, in tree space.
#[derive(Clone, Debug)]
pub(super) struct Extremes {
    /// Per direction, smallest and largest first coordinate along it.
    reach: [[f64; 2]; DIRECTIONS],
    /// The points that have it.
    points: [[DVec3; 2]; DIRECTIONS],
}

impl Extremes {
    /// Of no vertices.
    pub(super) const EMPTY: Self = Self {
        reach: [[f64::INFINITY, f64::NEG_INFINITY]; DIRECTIONS],
        points: [[DVec3::ZERO; 2]; DIRECTIONS],
    };

    pub(super) fn is_empty(&self) -> bool {
        self.reach[0][0] > self.reach[0][1]
    }

    /// Adds the vertices of a placed mesh.
    pub(super) fn add_part(&mut self, part: &PlacedPart<'_>) {
        for (i, normal) in NORMALS.iter().enumerate() {
            let normal = DVec3::from(normal.map(f64::from));
            for (side, sign) in [(0, -1.0), (1, 1.0)] {
                if let Some(point) = part.extreme(normal * sign) {
                    self.add(i, side, normal.dot(point), point);
                }
            }
        }
    }

    /// Adds the vertices of another set.
    pub(super) fn merge(&mut self, other: &Self) {
        for i in 0..DIRECTIONS {
            for side in 0..2 {
                self.add(i, side, other.reach[i][side], other.points[i][side]);
            }
        }
    }

    fn add(&mut self, i: usize, side: usize, reach: f64, point: DVec3) {
        let old = self.reach[i][side];
        // Strictly: of equal ones the first stays.
        let is_farther = if side == 0 { reach < old } else { reach > old };
        if is_farther {
            self.reach[i][side] = reach;
            self.points[i][side] = point;
        }
    }

    /// Box of the vertices.
    pub(super) fn bounds(&self) -> Aabb {
        let corner = |side: usize| DVec3::from([0, 1, 2].map(|axis| self.reach[axis][side]));
        Aabb { min: corner(0), max: corner(1) }
    }

    /// The distinct points, at most 98.
    pub(super) fn points(&self) -> Vec<DVec3> {
        let mut points = Vec::with_capacity(2 * DIRECTIONS);
        if !self.is_empty() {
            for point in self.points.as_flattened() {
                if !points.contains(point) {
                    points.push(*point);
                }
            }
        }
        points
    }
}
