//! Which triangles go into which buffers.

use crate::SceneData;
use crate::class::{Class, Textured};

/// What decides about buffers and merging.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Capacity {
    /// Vertices in one buffer.
    pub(crate) vertices: u32,
    /// Indices in one buffer.
    pub(crate) indices: u32,
    /// Meshes with several uses are written out once per use as long as all their uses together have this many vertices
    /// at most: an instanced draw call of a handful of triangles costs more than the triangles.
    pub(crate) merged_vertices: u64,
}

impl Capacity {
    /// 64 MiB and 48 MiB: far below every driver's limit, and still few buffers for large scenes.
    pub(crate) const DEFAULT: Self = Self { vertices: 1 << 21, indices: 3 << 22, merged_vertices: 2048 };
}

/// Triangles of a primitive that are written next, for an object or (object [`NONE`](crate::layout::NONE)) for instances.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Source {
    pub(crate) mesh: u32,
    pub(crate) primitive: u32,
    /// Range of its triangles.
    pub(crate) triangles: (u32, u32),
    pub(crate) object: u32,
    pub(crate) cluster: u32,
    pub(crate) chunk: u32,
}

/// Fills chunks in order.
pub(crate) struct Filler<'a> {
    data: &'a SceneData,
    capacity: Capacity,
    classes: &'a [Class],
    vertices: u64,
    indices: u32,
    pub(crate) chunk_textured: Vec<bool>,
    pub(crate) sources: Vec<Source>,
}

impl<'a> Filler<'a> {
    pub(crate) fn new(data: &'a SceneData, capacity: Capacity, classes: &'a [Class]) -> Self {
        Self {
            data,
            capacity,
            classes,
            vertices: 0,
            indices: 0,
            chunk_textured: Vec::new(),
            sources: Vec::new(),
        }
    }

    /// Gives a primitive its place, in several pieces when it is larger than a chunk.
    pub(crate) fn place(
        &mut self,
        class: u32,
        mesh: u32,
        primitive: u32,
        object: u32,
        cluster: u32,
        mut placed: impl FnMut(u32, u32, u32),
    ) {
        let source = &self.data.meshes[mesh as usize].primitives[primitive as usize];
        let (vertices, triangles) = (source.positions.len() as u64, (source.indices.len() / 3) as u32);
        let whole = vertices <= u64::from(self.capacity.vertices) && triangles <= self.capacity.indices / 3;
        let step =
            if whole { triangles } else { (self.capacity.indices.min(self.capacity.vertices) / 3).max(1) };
        let textured = self.classes[class as usize].textured != Textured::No;
        let mut first = 0;
        while first < triangles {
            let end = triangles.min(first + step);
            let count = (end - first) * 3;
            let more = if whole { vertices } else { u64::from(count) };
            if self.chunk_textured.last() != Some(&textured)
                || self.vertices + more > u64::from(self.capacity.vertices)
                || self.indices + count > self.capacity.indices
            {
                self.chunk_textured.push(textured);
                (self.vertices, self.indices) = (0, 0);
            }
            let chunk = (self.chunk_textured.len() - 1) as u32;
            self.sources.push(Source { mesh, primitive, triangles: (first, end), object, cluster, chunk });
            placed(chunk, self.indices, count);
            self.vertices += more;
            self.indices += count;
            first = end;
        }
    }
}
