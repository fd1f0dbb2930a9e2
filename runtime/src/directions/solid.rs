//! The five base solids: unit vertices, and faces as counter-clockwise triangles.
//!
//! They are tables: what computes a convex hull is larger than the five hulls, which counts in WebAssembly. The tests compute
//! them. Only `+ - * /` and `sqrt` are used, which IEEE 754 rounds correctly: every machine has the same bits.

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

/// Corners before they are brought to the sphere: 0, ±1, ±golden ratio (2) and ±1 / golden ratio (3).
type Corner = [i8; 3];

/// A face's corner indices, counter-clockwise from the lowest; faces of more corners are fanned from there, and come in the
/// lexicographic order of their three lowest indices.
type Triangle = [u8; 3];

const TETRAHEDRON: [Corner; 4] = [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]];

/// Plus before minus.
const OCTAHEDRON: [Corner; 6] = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];

/// `(0, ±1, ±golden)`, then cyclically; plus before minus, the first sign changes fastest.
const ICOSAHEDRON: [Corner; 12] = [
    [0, 1, 2],
    [0, -1, 2],
    [0, 1, -2],
    [0, -1, -2],
    [2, 0, 1],
    [-2, 0, 1],
    [2, 0, -1],
    [-2, 0, -1],
    [1, 2, 0],
    [-1, 2, 0],
    [1, -2, 0],
    [-1, -2, 0],
];

/// The cube's corners, the first sign changing fastest, then `(0, ±1 / golden, ±golden)`, cyclically.
const CUBE_AND_DODECAHEDRON: [Corner; 20] = [
    [1, 1, 1],
    [-1, 1, 1],
    [1, -1, 1],
    [-1, -1, 1],
    [1, 1, -1],
    [-1, 1, -1],
    [1, -1, -1],
    [-1, -1, -1],
    [0, 3, 2],
    [0, -3, 2],
    [0, 3, -2],
    [0, -3, -2],
    [2, 0, 3],
    [-2, 0, 3],
    [2, 0, -3],
    [-2, 0, -3],
    [3, 2, 0],
    [-3, 2, 0],
    [3, -2, 0],
    [-3, -2, 0],
];
const CUBE_CORNERS: usize = 8;

const TETRAHEDRON_FACES: [Triangle; 4] = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];

const OCTAHEDRON_FACES: [Triangle; 8] =
    [[0, 2, 4], [0, 5, 2], [0, 4, 3], [0, 3, 5], [1, 4, 2], [1, 2, 5], [1, 3, 4], [1, 5, 3]];

const CUBE_FACES: [Triangle; 12] = [
    [0, 1, 3],
    [0, 3, 2],
    [0, 4, 5],
    [0, 5, 1],
    [0, 2, 6],
    [0, 6, 4],
    [1, 5, 7],
    [1, 7, 3],
    [2, 3, 7],
    [2, 7, 6],
    [4, 6, 7],
    [4, 7, 5],
];

const ICOSAHEDRON_FACES: [Triangle; 20] = [
    [0, 1, 4],
    [0, 5, 1],
    [0, 4, 8],
    [0, 9, 5],
    [0, 8, 9],
    [1, 10, 4],
    [1, 5, 11],
    [1, 11, 10],
    [2, 6, 3],
    [2, 3, 7],
    [2, 8, 6],
    [2, 7, 9],
    [2, 9, 8],
    [3, 6, 10],
    [3, 11, 7],
    [3, 10, 11],
    [4, 6, 8],
    [4, 10, 6],
    [5, 9, 7],
    [5, 7, 11],
];

const DODECAHEDRON_FACES: [Triangle; 36] = [
    [0, 16, 17],
    [0, 17, 1],
    [0, 1, 8],
    [0, 8, 9],
    [0, 9, 2],
    [0, 2, 12],
    [0, 12, 14],
    [0, 14, 4],
    [0, 4, 16],
    [1, 13, 3],
    [1, 3, 9],
    [1, 9, 8],
    [1, 17, 5],
    [1, 5, 15],
    [1, 15, 13],
    [2, 9, 3],
    [2, 3, 19],
    [2, 19, 18],
    [2, 18, 6],
    [2, 6, 14],
    [2, 14, 12],
    [3, 13, 15],
    [3, 15, 7],
    [3, 7, 19],
    [4, 10, 5],
    [4, 5, 17],
    [4, 17, 16],
    [4, 14, 6],
    [4, 6, 11],
    [4, 11, 10],
    [5, 10, 11],
    [5, 11, 7],
    [5, 7, 15],
    [6, 18, 19],
    [6, 19, 7],
    [6, 7, 11],
];

impl Solid {
    /// Vertices on the unit sphere, faces fanned into triangles.
    pub(crate) fn mesh(self) -> Mesh {
        let golden = (1.0 + 5f64.sqrt()) / 2.0;
        let (corners, faces) = self.tables();
        let lengths = [0.0, 1.0, golden, 1.0 / golden];
        let length = |code: i8| lengths[usize::from(code.unsigned_abs() & 3)] * f64::from(code.signum());
        let vertices = corners.iter().map(|corner| unit(DVec3::from_array(corner.map(length)))).collect();
        let triangles = faces.iter().map(|face| face.map(u16::from)).collect();
        Mesh { vertices, triangles }
    }

    fn tables(self) -> (&'static [Corner], &'static [Triangle]) {
        match self {
            Self::Tetrahedron => (&TETRAHEDRON, &TETRAHEDRON_FACES),
            Self::Octahedron => (&OCTAHEDRON, &OCTAHEDRON_FACES),
            Self::Cube => (&CUBE_AND_DODECAHEDRON[..CUBE_CORNERS], &CUBE_FACES),
            Self::Icosahedron => (&ICOSAHEDRON, &ICOSAHEDRON_FACES),
            Self::Dodecahedron => (&CUBE_AND_DODECAHEDRON, &DODECAHEDRON_FACES),
        }
    }
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
            let faces = hull_faces(&mesh.vertices);
            let hull: Vec<[u16; 3]> = faces.iter().flat_map(|face| fan(face)).collect();
            assert_eq!(mesh.triangles, hull, "{solid:?}");
            for [a, b, c] in mesh.triangles {
                let [a, b, c] = [a, b, c].map(|i| mesh.vertices[i as usize]);
                assert!(a.dot(b.cross(c)) > 0.0, "{solid:?}");
            }
        }
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
}
