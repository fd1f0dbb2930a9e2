//! The five base solids: unit vertices, and faces as counter-clockwise triangles.
//!
//! Only `+ - * /` and `sqrt` are used, which IEEE 754 rounds correctly: every machine generates the same bits.

use glam::DVec3;

/// Points on the unit sphere and the triangles between them, counter-clockwise seen from outside.
#[derive(Clone, Debug)]
pub(crate) struct Mesh {
    /// Unit vectors.
    pub(crate) vertices: Vec<DVec3>,
    /// Triangles, counter-clockwise seen from outside.
    pub(crate) triangles: Vec<[u16; 3]>,
}

/// Which solid a set starts from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Solid {
    Tetrahedron,
    Octahedron,
    Cube,
    Icosahedron,
    Dodecahedron,
}

/// Unit vector along `v`, without `-0.0` components: some ray tracers miss everything along such a direction.
pub(crate) fn unit(v: DVec3) -> DVec3 {
    let length = (v.x * v.x + v.y * v.y + v.z * v.z).sqrt();
    DVec3::new(v.x / length + 0.0, v.y / length + 0.0, v.z / length + 0.0)
}

impl Solid {
    /// Vertices on the unit sphere, faces fanned into triangles.
    pub(crate) fn mesh(self) -> Mesh {
        let vertices: Vec<DVec3> = self.corners().into_iter().map(unit).collect();
        let triangles = hull_faces(&vertices).iter().flat_map(|face| fan(face)).collect();
        Mesh { vertices, triangles }
    }

    fn corners(self) -> Vec<DVec3> {
        let golden = (1.0 + 5f64.sqrt()) / 2.0;
        match self {
            Self::Tetrahedron => vec![
                DVec3::new(1.0, 1.0, 1.0),
                DVec3::new(1.0, -1.0, -1.0),
                DVec3::new(-1.0, 1.0, -1.0),
                DVec3::new(-1.0, -1.0, 1.0),
            ],
            Self::Octahedron => vec![
                DVec3::new(1.0, 0.0, 0.0),
                DVec3::new(-1.0, 0.0, 0.0),
                DVec3::new(0.0, 1.0, 0.0),
                DVec3::new(0.0, -1.0, 0.0),
                DVec3::new(0.0, 0.0, 1.0),
                DVec3::new(0.0, 0.0, -1.0),
            ],
            Self::Cube => cube_corners(),
            Self::Icosahedron => cyclic_rectangles(1.0, golden),
            Self::Dodecahedron => {
                let mut corners = cube_corners();
                corners.extend(cyclic_rectangles(1.0 / golden, golden));
                corners
            }
        }
    }
}

/// Signs in binary order, x fastest, plus before minus.
fn cube_corners() -> Vec<DVec3> {
    let sign = |bit: u32| if bit == 0 { 1.0 } else { -1.0 };
    (0..8).map(|i| DVec3::new(sign(i & 1), sign(i & 2), sign(i & 4))).collect()
}

/// `(0, ±short, ±long)`, then `(±long, 0, ±short)`, then `(±short, ±long, 0)`; plus before minus, the sign of
/// the first non-zero component changes fastest.
fn cyclic_rectangles(short: f64, long: f64) -> Vec<DVec3> {
    let signs = [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)];
    let mut corners = Vec::with_capacity(12);
    corners.extend(signs.map(|(a, b)| DVec3::new(0.0, a * short, b * long)));
    corners.extend(signs.map(|(a, b)| DVec3::new(a * long, 0.0, b * short)));
    corners.extend(signs.map(|(a, b)| DVec3::new(a * short, b * long, 0.0)));
    corners
}

/// Faces of the convex hull of a few points: each counter-clockwise from its lowest index, in the
/// lexicographic order of their three lowest indices.
fn hull_faces(vertices: &[DVec3]) -> Vec<Vec<u16>> {
    const COPLANAR: f64 = 1e-9;
    let mut faces: Vec<Vec<u16>> = Vec::new();
    let n = vertices.len();
    for i in 0..n {
        for j in i + 1..n {
            for k in j + 1..n {
                let mut normal = (vertices[j] - vertices[i]).cross(vertices[k] - vertices[i]);
                if normal.dot(vertices[i]) < 0.0 {
                    normal = -normal;
                }
                let height = |p: usize| normal.dot(vertices[p] - vertices[i]);
                if (0..n).any(|p| height(p) > COPLANAR) {
                    continue;
                }
                let on: Vec<usize> = (0..n).filter(|&p| height(p) > -COPLANAR).collect();
                if on[..3] == [i, j, k] {
                    faces.push(around(&on, normal, vertices));
                }
            }
        }
    }
    faces
}

/// Orders the corners of one convex face counter-clockwise about `normal`, lowest index first.
fn around(corners: &[usize], normal: DVec3, vertices: &[DVec3]) -> Vec<u16> {
    let mut ring = vec![corners[0]];
    while ring.len() < corners.len() {
        let a = *ring.last().unwrap_or(&corners[0]);
        let next = corners.iter().copied().find(|&b| {
            let edge = vertices[b] - vertices[a];
            // The face lies to the left of its boundary.
            b != a
                && corners
                    .iter()
                    .filter(|&&p| p != a && p != b)
                    .all(|&p| normal.dot(edge.cross(vertices[p] - vertices[a])) > 0.0)
        });
        match next {
            Some(b) => ring.push(b),
            None => break,
        }
    }
    ring.into_iter().map(|i| i as u16).collect()
}

fn fan(face: &[u16]) -> Vec<[u16; 3]> {
    face.windows(2).skip(1).map(|pair| [face[0], pair[0], pair[1]]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solids_are_closed_and_face_outwards() {
        let solids =
            [Solid::Tetrahedron, Solid::Octahedron, Solid::Cube, Solid::Icosahedron, Solid::Dodecahedron];
        for (solid, vertices) in solids.into_iter().zip([4, 6, 8, 12, 20]) {
            let mesh = solid.mesh();
            assert_eq!(mesh.vertices.len(), vertices, "{solid:?}");
            // Euler: a closed triangle mesh of a sphere has 2 V - 4 triangles.
            assert_eq!(mesh.triangles.len(), 2 * vertices - 4, "{solid:?}");
            for [a, b, c] in mesh.triangles {
                let [a, b, c] = [a, b, c].map(|i| mesh.vertices[i as usize]);
                assert!(a.dot(b.cross(c)) > 0.0, "{solid:?}");
            }
        }
    }
}
