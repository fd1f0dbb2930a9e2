//! All triangles of a node in one list: classes are kept apart by vertices, which belong to one class each.

use super::class::{Class, ClassMesh};
use super::measure::Surface;
use glam::Vec3;

/// Triangles with everything that their vertices carry. All vertex vectors are of one length.
#[derive(Clone, Debug, Default)]
pub(super) struct Soup {
    /// Relative to the node's origin, metres, finite.
    pub(super) positions: Vec<[f32; 3]>,
    /// Unit vectors; zero in flat classes.
    pub(super) normals: Vec<[f32; 3]>,
    /// Multiply the class material's base colour.
    pub(super) colors: Vec<[u8; 4]>,
    /// Zero in plain classes.
    pub(super) uvs: Vec<[f32; 2]>,
    /// Index into `classes`.
    pub(super) vertex_class: Vec<u32>,
    /// Three a triangle, in range, all of one class.
    pub(super) indices: Vec<u32>,
    /// Distinct, sorted.
    pub(super) classes: Vec<Class>,
}

impl Soup {
    pub(super) fn triangle_count(&self) -> usize {
        self.indices.len() / 3
    }

    pub(super) fn corners(&self, triangle: usize) -> [u32; 3] {
        [0, 1, 2].map(|c| self.indices[triangle * 3 + c])
    }

    /// Class of a triangle.
    pub(super) fn class(&self, triangle: usize) -> usize {
        self.vertex_class[self.indices[triangle * 3] as usize] as usize
    }

    /// Square metres of a triangle.
    pub(super) fn area(&self, triangle: usize) -> f64 {
        area(self.corners(triangle).map(|v| self.positions[v as usize]))
    }

    /// Its triangles alone.
    pub(super) fn surface(&self) -> Surface<'_> {
        Surface { positions: &self.positions, indices: &self.indices }
    }

    /// The same vertices with other triangles.
    pub(super) fn with_indices(&self, indices: Vec<u32>) -> Soup {
        Soup { indices, ..self.clone() }
    }

    /// The triangles for which `keep` holds; vertices stay.
    pub(super) fn filtered(&self, keep: impl Fn(usize) -> bool) -> Vec<u32> {
        (0..self.triangle_count()).filter(|&t| keep(t)).flat_map(|t| self.corners(t)).collect()
    }

    /// Appends a copy of a vertex, in a class of its own choice; returns its index.
    pub(super) fn push_copy(&mut self, vertex: usize, class: u32) -> u32 {
        let index = self.positions.len() as u32;
        self.positions.push(self.positions[vertex]);
        self.normals.push(self.normals[vertex]);
        self.colors.push(self.colors[vertex]);
        self.uvs.push(self.uvs[vertex]);
        self.vertex_class.push(class);
        index
    }

    /// One mesh per class in use, vertices in order of their first use.
    pub(super) fn split(&self) -> Vec<ClassMesh> {
        let empty = |class: &Class| ClassMesh {
            class: *class,
            positions: Vec::new(),
            normals: Vec::new(),
            colors: Vec::new(),
            uvs: Vec::new(),
            indices: Vec::new(),
        };
        let mut meshes: Vec<ClassMesh> = self.classes.iter().map(empty).collect();
        let mut places = vec![u32::MAX; self.positions.len()];
        for triangle in 0..self.triangle_count() {
            let mesh = &mut meshes[self.class(triangle)];
            let flat = mesh.class.is_flat();
            let kept = matches!(mesh.class, Class::Kept { .. });
            for vertex in self.corners(triangle) {
                let vertex = vertex as usize;
                if places[vertex] == u32::MAX {
                    places[vertex] = mesh.positions.len() as u32;
                    mesh.positions.push(self.positions[vertex]);
                    mesh.colors.push(self.colors[vertex]);
                    if !flat {
                        mesh.normals.push(unit_or_up(self.normals[vertex]));
                    }
                    if kept {
                        mesh.uvs.push(self.uvs[vertex]);
                    }
                }
                mesh.indices.push(places[vertex]);
            }
        }
        meshes.retain(|mesh| !mesh.indices.is_empty());
        for mesh in &mut meshes {
            if mesh.colors.iter().all(|&color| color == [255; 4]) {
                mesh.colors.clear();
            }
        }
        meshes
    }
}

/// Square metres of a triangle.
pub(super) fn area(corners: [[f32; 3]; 3]) -> f64 {
    let [a, b, c] = corners.map(|p| Vec3::from_array(p).as_dvec3());
    (b - a).cross(c - a).length() * 0.5
}

fn unit_or_up(normal: [f32; 3]) -> [f32; 3] {
    let unit = Vec3::from_array(normal).try_normalize().unwrap_or(Vec3::Y);
    unit.to_array()
}
