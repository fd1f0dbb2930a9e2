//! Triangle meshes of the samples: vertices with normals, 16-bit indices.

mod flat;
mod round;

/// Triangles in mesh space, metres or unit size; counter-clockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Shape {
    pub(super) name: String,
    pub(super) positions: Vec<[f32; 3]>,
    pub(super) normals: Vec<[f32; 3]>,
    pub(super) indices: Vec<u16>,
}

impl Shape {
    pub(super) fn new(name: impl Into<String>) -> Self {
        Shape { name: name.into(), ..Default::default() }
    }

    /// Adds a vertex; `normal` need not have unit length. A shape holds at most 65,535 vertices (the index
    /// 65,535 is reserved by glTF), which every generator keeps well below.
    fn vertex(&mut self, position: [f64; 3], normal: [f64; 3]) -> u16 {
        debug_assert!(self.positions.len() < 65_535, "a shape of {} vertices", self.positions.len());
        let length = dot(normal, normal).sqrt();
        // Adding zero turns -0.0 into 0.0: equal coordinates then have equal bits.
        self.positions.push(position.map(|x| x as f32 + 0.0));
        self.normals.push(normal.map(|x| (x / length) as f32 + 0.0));
        (self.positions.len() - 1) as u16
    }

    fn triangle(&mut self, a: u16, b: u16, c: u16) {
        self.indices.extend([a, b, c]);
    }

    /// Adds a flat, convex face of at least three corners with vertices of its own, counter-clockwise.
    pub(super) fn face(&mut self, corners: &[[f64; 3]]) {
        let normal = cross(sub(corners[1], corners[0]), sub(corners[2], corners[0]));
        let vertices: Vec<u16> = corners.iter().map(|&corner| self.vertex(corner, normal)).collect();
        for pair in vertices[1..].windows(2) {
            self.triangle(vertices[0], pair[0], pair[1]);
        }
    }

    /// Adds a flat quadrilateral, counter-clockwise.
    pub(super) fn quad(&mut self, corners: [[f64; 3]; 4]) {
        self.face(&corners);
    }

    /// Adds an axis-aligned box: six quads that meet in exactly equal coordinates.
    pub(super) fn cuboid(&mut self, min: [f64; 3], max: [f64; 3]) {
        let [[x0, y0, z0], [x1, y1, z1]] = [min, max];
        self.quad([[x1, y0, z1], [x1, y0, z0], [x1, y1, z0], [x1, y1, z1]]);
        self.quad([[x0, y0, z0], [x0, y0, z1], [x0, y1, z1], [x0, y1, z0]]);
        self.quad([[x0, y1, z1], [x1, y1, z1], [x1, y1, z0], [x0, y1, z0]]);
        self.quad([[x0, y0, z0], [x1, y0, z0], [x1, y0, z1], [x0, y0, z1]]);
        self.quad([[x0, y0, z1], [x1, y0, z1], [x1, y1, z1], [x0, y1, z1]]);
        self.quad([[x1, y0, z0], [x0, y0, z0], [x0, y1, z0], [x1, y1, z0]]);
    }

    /// Number of triangles.
    #[cfg(test)]
    pub(super) fn triangles(&self) -> usize {
        self.indices.len() / 3
    }
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;

    /// Every directed edge, by coordinates, is matched by its reverse: no hole, no crack, one orientation.
    pub(super) fn is_watertight(shape: &Shape) -> bool {
        let mut edges: HashMap<[[u32; 3]; 2], i32> = HashMap::new();
        for triangle in shape.indices.chunks_exact(3) {
            for k in 0..3 {
                let [a, b] = [triangle[k], triangle[(k + 1) % 3]]
                    .map(|i| shape.positions[usize::from(i)].map(f32::to_bits));
                assert_ne!(a, b, "a triangle has an edge of no length");
                *edges.entry([a, b]).or_default() += 1;
                *edges.entry([b, a]).or_default() -= 1;
            }
        }
        edges.values().all(|&n| n == 0)
    }

    /// Six times the enclosed volume; positive if the faces look outwards.
    fn volume(shape: &Shape) -> f64 {
        let corner = |i: u16| shape.positions[usize::from(i)].map(f64::from);
        let triangles = shape.indices.chunks_exact(3);
        triangles.map(|t| dot(corner(t[0]), cross(corner(t[1]), corner(t[2])))).sum()
    }

    #[test]
    fn closed_shapes_are_watertight_and_look_outwards() {
        let shapes = [
            Shape::unit_box("box"),
            Shape::cylinder("cylinder", 24, 5),
            Shape::sphere("sphere", 24, 12),
            Shape::torus("torus", 24, 12, 0.2),
            Shape::gear("gear", 14),
            Shape::profile("beam"),
            Shape::box_shell("shell", 3.0, 9, None),
        ];
        for shape in &shapes {
            assert!(is_watertight(shape), "{}", shape.name);
            assert!(volume(shape) > 0.0, "{}", shape.name);
        }
        assert!(!is_watertight(&Shape::box_shell("holed", 3.0, 9, Some(1))));
    }

    #[test]
    fn normals_have_unit_length_and_agree_with_the_winding() {
        for shape in [Shape::sphere("s", 16, 8), Shape::torus("t", 16, 8, 0.2), Shape::gear("g", 9)] {
            for t in shape.indices.chunks_exact(3) {
                let [a, b, c] = [t[0], t[1], t[2]].map(|i| shape.positions[usize::from(i)].map(f64::from));
                let face = cross(sub(b, a), sub(c, a));
                for &i in t {
                    let normal = shape.normals[usize::from(i)].map(f64::from);
                    assert!((dot(normal, normal) - 1.0).abs() < 1e-6);
                    assert!(dot(face, normal) > 0.0, "{} vertex {i}", shape.name);
                }
            }
        }
    }

    #[test]
    fn a_panel_with_open_cells_has_two_triangles_less_per_cell() {
        assert_eq!(Shape::panel("closed", 4, 3, |_, _| false).triangles(), 24);
        assert_eq!(Shape::panel("open", 4, 3, |x, y| x == 1 && y == 1).triangles(), 22);
    }
}
