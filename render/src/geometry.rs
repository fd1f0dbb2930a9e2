//! Writes vertices and indices chunk by chunk.

use glam::{DAffine3, DMat3, DVec3, Vec3};

use crate::layout::{Layout, NONE, Source, is_mirrored};
use crate::vertex::{Vertex, normal_matrix, pack_color, pack_material, pack_normal, turn_normal};
use crate::{Primitive, SceneData};

/// One chunk's content, reused for the next.
#[derive(Debug, Default)]
pub(crate) struct Geometry {
    pub(crate) vertices: Vec<Vertex>,
    pub(crate) uvs: Vec<[f32; 2]>,
    pub(crate) indices: Vec<u32>,
    /// For parts of a primitive: new number of each old vertex.
    renumbered: Vec<u32>,
}

/// Mesh space to what the vertex buffer holds.
struct Placement {
    to_cluster: DAffine3,
    normals: DMat3,
    flip: bool,
    identity: bool,
}

impl Placement {
    fn of(data: &SceneData, layout: &Layout, source: &Source) -> Self {
        if source.object == NONE {
            let (to_cluster, normals) = (DAffine3::IDENTITY, DMat3::IDENTITY);
            return Self { to_cluster, normals, flip: false, identity: true };
        }
        let mut to_cluster = data.objects[source.object as usize].to_world;
        to_cluster.translation -= layout.clusters[source.cluster as usize];
        let normals = normal_matrix(to_cluster.matrix3);
        Self { to_cluster, normals, flip: is_mirrored(&to_cluster), identity: false }
    }

    fn position(&self, p: [f32; 3]) -> [f32; 3] {
        if self.identity {
            p
        } else {
            self.to_cluster.transform_point3(Vec3::from(p).as_dvec3()).as_vec3().to_array()
        }
    }
}

impl Geometry {
    pub(crate) fn clear(&mut self) {
        self.vertices.clear();
        self.uvs.clear();
        self.indices.clear();
    }

    /// Appends the triangles of one source.
    pub(crate) fn append(&mut self, data: &SceneData, layout: &Layout, source: &Source, textured: bool) {
        let primitive = &data.meshes[source.mesh as usize].primitives[source.primitive as usize];
        let placement = Placement::of(data, layout, source);
        let object = if source.object == NONE { 0 } else { source.object };
        let (first, end) = (source.triangles.0 as usize * 3, source.triangles.1 as usize * 3);
        let indices = &primitive.indices[first..end];
        let base = self.vertices.len() as u32;
        let whole = indices.len() == primitive.indices.len();
        let writer = Writer::new(data, primitive, &placement, object);
        if whole {
            self.vertices.extend((0..primitive.positions.len()).map(|i| writer.vertex(i)));
            if textured {
                self.uvs.extend_from_slice(&primitive.uvs);
            }
        } else {
            self.renumbered.clear();
            self.renumbered.resize(primitive.positions.len(), NONE);
            for &index in indices {
                if self.renumbered[index as usize] == NONE {
                    self.renumbered[index as usize] = self.vertices.len() as u32 - base;
                    self.vertices.push(writer.vertex(index as usize));
                    if textured {
                        self.uvs.push(primitive.uvs[index as usize]);
                    }
                }
            }
        }
        let renumbered = &self.renumbered;
        let number = |index: u32| base + if whole { index } else { renumbered[index as usize] };
        for triangle in indices.chunks_exact(3) {
            let [a, b, c] = [number(triangle[0]), number(triangle[1]), number(triangle[2])];
            // Mirrored triangles would show their backs.
            self.indices.extend(if placement.flip { [a, c, b] } else { [a, b, c] });
        }
    }
}

struct Writer<'a> {
    primitive: &'a Primitive,
    placement: &'a Placement,
    base: [f32; 4],
    color: [u8; 4],
    surface: [u8; 4],
    emissive: [u8; 4],
    object: u32,
}

impl<'a> Writer<'a> {
    fn new(data: &SceneData, primitive: &'a Primitive, placement: &'a Placement, object: u32) -> Self {
        let (base, surface, emissive) = pack_material(&data.materials[primitive.material as usize]);
        Self { primitive, placement, base, color: pack_color(base, None), surface, emissive, object }
    }

    fn vertex(&self, index: usize) -> Vertex {
        let normal = match self.primitive.normals.get(index) {
            None => DVec3::ZERO.as_vec3(),
            Some(&normal) if self.placement.identity => Vec3::from(normal),
            Some(&normal) => turn_normal(&self.placement.normals, normal),
        };
        let color = self.primitive.colors.get(index);
        Vertex {
            position: self.placement.position(self.primitive.positions[index]),
            normal: pack_normal(normal),
            color: color.map_or(self.color, |&color| pack_color(self.base, Some(color))),
            surface: self.surface,
            emissive: self.emissive,
            object: self.object,
        }
    }
}
