//! Direction sets: the sample directions of a tree, and the look-up from any vector to its bin.
//!
//! The twenty sets are those of Eikel, *Spherical Visibility Sampling* (dissertation, Paderborn 2013): a Platonic
//! solid's vertices, or an edge subdivision of them. A **direction** points from the sphere's centre (or the
//! object's) towards the viewer, in the tree's space. The **bin** of a direction is the part of the sphere that is
//! nearest to it.
//!
//! Base vertices, before they are scaled to length 1 (φ is the golden ratio; of two signs plus comes first, the
//! first changes fastest):
//!
//! - tetrahedron: (1,1,1), (1,-1,-1), (-1,1,-1), (-1,-1,1)
//! - octahedron: +x, -x, +y, -y, +z, -z
//! - cube: (±1,±1,±1)
//! - icosahedron: (0,±1,±φ), (±φ,0,±1), (±1,±φ,0)
//! - dodecahedron: (±1,±1,±1), (0,±1/φ,±φ), (±φ,0,±1/φ), (±1/φ,±φ,0)
//!
//! Faces are listed in the lexicographic order of their three lowest indices, each counter-clockwise seen from
//! outside from its lowest index, and fanned into triangles from there. A subdivision adds the normalised midpoint
//! of every edge, in the order in which the triangles (a, b, c) meet their edges ab, bc, ca, and replaces each
//! triangle by (a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca).

mod delaunay;
mod lookup;
mod solid;
mod subdivide;

use crate::sorting::insert;
use glam::{DVec3, Vec3};
use lookup::Lookup;
use solid::{Mesh, Solid};
use std::sync::OnceLock;

/// Names of all direction sets, by number of directions.
pub const DIRECTION_SETS: [&str; 20] = [
    "tetrahedron",
    "octahedron",
    "cube",
    "tetrahedron-1",
    "icosahedron",
    "octahedron-1",
    "dodecahedron",
    "tetrahedron-2",
    "icosahedron-1",
    "octahedron-2",
    "tetrahedron-3",
    "icosahedron-2",
    "octahedron-3",
    "tetrahedron-4",
    "icosahedron-3",
    "octahedron-4",
    "tetrahedron-5",
    "icosahedron-4",
    "octahedron-5",
    "icosahedron-5",
];

/// How far inside its triangle a centre must be: far above rounding.
const ACUTE: f64 = 1e-6;

/// Each set is generated once per process, when it is first asked for.
static SETS: [OnceLock<DirectionSet>; 20] = [const { OnceLock::new() }; 20];

/// A set of unit vectors, their spherical Delaunay triangulation and a constant-time look-up.
#[derive(Debug)]
pub struct DirectionSet {
    name: &'static str,
    mesh: Mesh,
    rings: Vec<Vec<u16>>,
    /// Per direction, the unit normals of the planes between its bin and those of its neighbours, pointing inwards.
    walls: Vec<Vec<DVec3>>,
    acute: bool,
    lookup: Lookup,
}

impl DirectionSet {
    /// The set of that name, one of [`DIRECTION_SETS`]; `None` for any other name.
    ///
    /// The first call for a name generates the set (microseconds to tens of milliseconds); it then stays.
    pub fn by_name(name: &str) -> Option<&'static Self> {
        let index = DIRECTION_SETS.iter().position(|&known| known == name)?;
        Some(SETS[index].get_or_init(|| Self::generate(DIRECTION_SETS[index])))
    }

    fn generate(name: &'static str) -> Self {
        let (solid, subdivisions) = match name.split_once('-') {
            Some((solid, count)) => (solid, count.parse::<u32>().unwrap_or(0)),
            None => (name, 0),
        };
        let mut mesh = match solid {
            "tetrahedron" => Solid::Tetrahedron,
            "octahedron" => Solid::Octahedron,
            "cube" => Solid::Cube,
            "dodecahedron" => Solid::Dodecahedron,
            _ => Solid::Icosahedron,
        }
        .mesh();
        for _ in 0..subdivisions {
            mesh = subdivide::subdivide(&mesh);
        }
        delaunay::make_delaunay(&mesh.vertices, &mut mesh.triangles);
        let mut rings = vec![Vec::new(); mesh.vertices.len()];
        for &[a, b, c] in &mesh.triangles {
            // Closed and counter-clockwise: every edge is met once in each direction.
            for (from, to) in [(a, b), (b, c), (c, a)] {
                insert(&mut rings[from as usize], to);
            }
        }
        let lookup = Lookup::new(&mesh, &rings);
        let walls = rings.iter().enumerate().map(|(index, ring)| {
            let wall = |&other: &u16| (mesh.vertices[index] - mesh.vertices[usize::from(other)]).normalize();
            ring.iter().map(wall).collect()
        });
        let walls = walls.collect();
        let acute = mesh.triangles.iter().all(|triangle| {
            let [a, b, c] = triangle.map(|index| mesh.vertices[usize::from(index)]);
            let center = (b - a).cross(c - a).normalize();
            [(a, b), (b, c), (c, a)].iter().all(|(from, to)| from.cross(*to).dot(center) > ACUTE)
        });
        Self { name, mesh, rings, walls, acute, lookup }
    }

    /// Name, one of [`DIRECTION_SETS`].
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Number of directions, 4 to 10,242.
    #[expect(clippy::len_without_is_empty, reason = "no set is empty")]
    pub fn len(&self) -> usize {
        self.mesh.vertices.len()
    }

    /// Direction `index`: a unit vector without `-0.0` components.
    ///
    /// # Panics
    /// If `index >= self.len()`.
    pub fn direction(&self, index: usize) -> Vec3 {
        self.mesh.vertices[index].as_vec3()
    }

    /// Direction `index` before it is rounded to `f32`.
    ///
    /// # Panics
    /// If `index >= self.len()`.
    pub fn direction_f64(&self, index: usize) -> DVec3 {
        self.mesh.vertices[index]
    }

    /// The bin of `vector`: the direction with the largest dot product (of equal ones the lowest index).
    ///
    /// Any length will do; the zero vector, NaN and infinities give 0.
    pub fn nearest(&self, vector: Vec3) -> usize {
        self.nearest_f64(vector.as_dvec3())
    }

    /// [`Self::nearest`] for an `f64` vector.
    pub fn nearest_f64(&self, vector: DVec3) -> usize {
        match on_octahedron(vector) {
            Some((v, scale)) => self.lookup.nearest(&self.mesh.vertices, v, scale),
            None => 0,
        }
    }

    /// The bin of `vector`, if it is also that of every vector within `radius` of it.
    ///
    /// Bins are bounded by their neighbours in the Delaunay triangulation alone.
    pub(crate) fn bin_around(&self, vector: DVec3, radius: f64) -> Option<usize> {
        let bin = self.nearest_f64(vector);
        self.walls[bin].iter().all(|wall| wall.dot(vector) > radius).then_some(bin)
    }

    /// No triangle is obtuse. The triangle that holds a vector is then one of those at the vector's bin: a bin's corners are
    /// the centres of its triangles, and these are in the triangles.
    pub(crate) fn is_acute(&self) -> bool {
        self.acute
    }

    /// The three directions whose Delaunay triangle holds `vector`; on an edge or a corner, one of the triangles
    /// that meet there. The zero vector, NaN and infinities give the first triangle.
    pub fn triangle(&self, vector: Vec3) -> [u16; 3] {
        self.weights(vector).0
    }

    /// [`Self::triangle`] and the barycentric weights of its corners: not negative, of sum 1.
    pub fn weights(&self, vector: Vec3) -> ([u16; 3], [f32; 3]) {
        self.weights_f64(vector.as_dvec3())
    }

    /// [`Self::weights`] for an `f64` vector.
    pub fn weights_f64(&self, vector: DVec3) -> ([u16; 3], [f32; 3]) {
        match on_octahedron(vector) {
            Some((v, scale)) => {
                let (triangle, weights) = self.lookup.triangle(v, scale);
                (self.mesh.triangles[triangle as usize], weights.map(|w| w as f32))
            }
            None => (self.mesh.triangles[0], [1.0, 0.0, 0.0]),
        }
    }

    /// Neighbours of direction `index` in the triangulation, ascending.
    ///
    /// # Panics
    /// If `index >= self.len()`.
    pub fn ring(&self, index: usize) -> &[u16] {
        &self.rings[index]
    }

    /// All triangles of the triangulation, counter-clockwise seen from outside.
    pub fn triangles(&self) -> &[[u16; 3]] {
        &self.mesh.triangles
    }
}

/// The vector and the factor that brings it to `|x| + |y| + |z| = 1`; `None` for zero, NaN and infinities. Vectors near the
/// ends of the number range are brought into its middle first.
#[inline]
fn on_octahedron(v: DVec3) -> Option<(DVec3, f64)> {
    let sum = v.x.abs() + v.y.abs() + v.z.abs();
    if (1e-290..1e290).contains(&sum) {
        return Some((v, 1.0 / sum));
    }
    let largest = v.abs().max_element();
    if !v.is_finite() || largest == 0.0 {
        return None;
    }
    let v = v / largest;
    Some((v, 1.0 / (v.x.abs() + v.y.abs() + v.z.abs())))
}

#[cfg(test)]
mod tests;
