//! Meshes of proxies as glTF accessors, buffer views and meshes.

use super::compress::{self, Reordered};
use super::options::ProxyFormat;
use crate::gltf::compressed::MESHOPT;
use crate::gltf::payload::{Additions, View};
use serde_json::{Map, Number, Value, json};

/// The triangles of one primitive. Attributes have one entry per position or are empty.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangles<'a> {
    pub(super) positions: &'a [[f32; 3]],
    pub(super) normals: &'a [[f32; 3]],
    pub(super) colors: &'a [[u8; 4]],
    pub(super) uvs: &'a [[f32; 2]],
    pub(super) indices: &'a [u32],
    /// glTF material.
    pub(super) material: Option<usize>,
}

/// JSON of a primitive and its accessors, about.
const PRIMITIVE_JSON: u64 = 560;

/// JSON of a compressed buffer view, at most but for very large files.
pub(super) const COMPRESSED_VIEW_JSON: u64 = 240;

/// Primitives of this many triangles have a compressed view of indices each. In one for several the codec takes about
/// two thirds of a byte more for each triangle, for it expects vertices to be new: less than the view's JSON if they are few.
const OWN_VIEW_TRIANGLES: usize = 384;

/// The kinds of data, each with a buffer view of its own: readers that map views to GPU buffers get few of them.
const POSITIONS: usize = 0;
const NORMALS: usize = 1;
const COLORS: usize = 2;
const UVS: usize = 3;
const SHORT_UVS: usize = 4;
const SHORT_INDICES: usize = 5;
const INDICES: usize = 6;
/// So many; views of single primitives come after them.
const SHARED_VIEWS: usize = 7;

/// Meshes on their way into a file.
#[derive(Debug)]
pub(super) struct Encoder {
    format: ProxyFormat,
    first_accessor: usize,
    first_mesh: usize,
    views: Vec<View>,
    accessors: Vec<Value>,
    meshes: Vec<Value>,
}

impl Encoder {
    /// Accessors and meshes get indices from these on.
    pub(super) fn new(format: ProxyFormat, first_accessor: usize, first_mesh: usize) -> Self {
        let vertices = |stride| View { stride: Some(stride), target: Some(34962), ..View::default() };
        let indices = View { target: Some(34963), ..View::default() };
        let normals = if format == ProxyFormat::Float { 12 } else { 4 };
        Self {
            format,
            first_accessor,
            first_mesh,
            views: vec![
                vertices(12),
                vertices(normals),
                vertices(4),
                vertices(8),
                vertices(4),
                indices.clone(),
                indices,
            ],
            accessors: Vec::new(),
            meshes: Vec::new(),
        }
    }

    /// Adds a mesh; returns its index. Primitives without triangles are left out; `None` if none is left.
    pub(super) fn mesh<'a>(&mut self, primitives: impl Iterator<Item = Triangles<'a>>) -> Option<usize> {
        let primitives: Vec<Value> =
            primitives.filter(|p| !p.indices.is_empty()).map(|p| self.primitive(&p)).collect();
        if primitives.is_empty() {
            return None;
        }
        self.meshes.push(json!({"primitives": primitives}));
        Some(self.first_mesh + self.meshes.len() - 1)
    }

    fn primitive(&mut self, triangles: &Triangles<'_>) -> Value {
        if self.format == ProxyFormat::Meshopt {
            let reordered = Reordered::new(triangles);
            return self.ordered(&reordered.triangles(triangles.material));
        }
        self.ordered(triangles)
    }

    fn ordered(&mut self, triangles: &Triangles<'_>) -> Value {
        let count = triangles.positions.len();
        let mut attributes = Map::new();
        attributes.insert("POSITION".into(), self.positions(triangles.positions).into());
        if triangles.normals.len() == count {
            attributes.insert("NORMAL".into(), self.normals(triangles.normals).into());
        }
        if triangles.colors.len() == count && triangles.colors.iter().any(|&color| color != [255; 4]) {
            let bytes = triangles.colors.iter().flatten().copied();
            let index = self.add(
                COLORS,
                bytes,
                json!({"componentType": 5121, "normalized": true, "count": count, "type": "VEC4"}),
            );
            attributes.insert("COLOR_0".into(), index.into());
        }
        if triangles.uvs.len() == count {
            attributes.insert("TEXCOORD_0".into(), self.uvs(triangles.uvs).into());
        }
        let index = self.indices(triangles.indices, count);
        let mut primitive = json!({"attributes": attributes, "indices": index});
        if let Some(material) = triangles.material {
            primitive["material"] = material.into();
        }
        primitive
    }

    fn indices(&mut self, indices: &[u32], vertices: usize) -> usize {
        // The largest value of a component type would restart a strip.
        let short = vertices <= 0xFFFF;
        let component = if short { 5123 } else { 5125 };
        let json = json!({"componentType": component, "count": indices.len(), "type": "SCALAR"});
        if self.format == ProxyFormat::Meshopt && indices.len() >= 3 * OWN_VIEW_TRIANGLES {
            self.views.push(compress::triangles(indices, vertices, if short { 2 } else { 4 }));
            return self.add(self.views.len() - 1, std::iter::empty(), json);
        }
        if short {
            self.add(SHORT_INDICES, indices.iter().flat_map(|&v| (v as u16).to_le_bytes()), json)
        } else {
            self.add(INDICES, indices.iter().flat_map(|&v| v.to_le_bytes()), json)
        }
    }

    fn positions(&mut self, positions: &[[f32; 3]]) -> usize {
        let filtered = (self.format == ProxyFormat::Meshopt).then(|| compress::positions(positions));
        let (words, positions) = match &filtered {
            Some((words, positions)) => (Some(words), positions.as_slice()),
            None => (None, positions),
        };
        let mut bounds = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
        for position in positions {
            for axis in 0..3 {
                bounds[0][axis] = bounds[0][axis].min(position[axis]);
                bounds[1][axis] = bounds[1][axis].max(position[axis]);
            }
        }
        let number = |&value: &f32| Number::from_f64(f64::from(value)).map_or(Value::Null, Value::Number);
        let [min, max] = bounds.map(|corner| corner.iter().map(number).collect::<Vec<_>>());
        let json =
            json!({"componentType": 5126, "count": positions.len(), "type": "VEC3", "min": min, "max": max});
        match words {
            Some(words) => self.add(POSITIONS, words.iter().flatten().flat_map(|v| v.to_le_bytes()), json),
            None => self.add(POSITIONS, positions.iter().flatten().flat_map(|v| v.to_le_bytes()), json),
        }
    }

    fn normals(&mut self, normals: &[[f32; 3]]) -> usize {
        let units = normals.iter().map(|&normal| unit(normal));
        let json = |component| json!({"componentType": component, "count": normals.len(), "type": "VEC3"});
        match self.format {
            ProxyFormat::Float => {
                let bytes = units.flatten().flat_map(f32::to_le_bytes);
                self.add(NORMALS, bytes, json(5126))
            }
            ProxyFormat::Quantized | ProxyFormat::Meshopt => {
                let mut json = json(5120);
                json["normalized"] = true.into();
                if self.format == ProxyFormat::Meshopt {
                    let bytes = compress::normals(units).into_iter().flatten().map(|c| c as u8);
                    return self.add(NORMALS, bytes, json);
                }
                let byte = |c: f32| (c * 127.0).round() as i8 as u8;
                self.add(NORMALS, units.flat_map(|[x, y, z]| [byte(x), byte(y), byte(z), 0]), json)
            }
        }
    }

    fn uvs(&mut self, uvs: &[[f32; 2]]) -> usize {
        let fits = uvs.iter().flatten().all(|c| (0.0..=1.0).contains(c));
        if self.format != ProxyFormat::Float && fits {
            let bytes = uvs.iter().flatten().flat_map(|c| ((c * 65535.0).round() as u16).to_le_bytes());
            let json = json!({"componentType": 5123, "normalized": true, "count": uvs.len(), "type": "VEC2"});
            return self.add(SHORT_UVS, bytes, json);
        }
        let json = json!({"componentType": 5126, "count": uvs.len(), "type": "VEC2"});
        if self.format == ProxyFormat::Meshopt {
            let words = compress::uvs(uvs);
            return self.add(UVS, words.into_iter().flatten().flat_map(u32::to_le_bytes), json);
        }
        self.add(UVS, uvs.iter().flatten().flat_map(|c| c.to_le_bytes()), json)
    }

    /// Appends an accessor over its part of a view.
    fn add(&mut self, view: usize, bytes: impl Iterator<Item = u8>, mut accessor: Value) -> usize {
        let own = &mut self.views[view].bytes;
        accessor["bufferView"] = view.into();
        if view < SHARED_VIEWS {
            // Accessors begin on a multiple of their component's size. Indices that are compressed have no gaps.
            if !(self.format == ProxyFormat::Meshopt && view == SHORT_INDICES) {
                own.resize(own.len().next_multiple_of(4), 0);
            }
            accessor["byteOffset"] = own.len().into();
            own.extend(bytes);
        }
        self.accessors.push(accessor);
        self.first_accessor + self.accessors.len() - 1
    }

    /// What is to be appended: views without data are left out.
    pub(super) fn finish(self) -> Additions {
        let mut places = Vec::with_capacity(self.views.len());
        let mut views = Vec::new();
        for (kind, view) in self.views.into_iter().enumerate() {
            places.push(views.len());
            if view.bytes.is_empty() {
                continue;
            }
            let is_done = self.format != ProxyFormat::Meshopt || view.compression.is_some();
            views.push(match kind {
                _ if is_done => view,
                POSITIONS | UVS => compress::attributes(view, Some("EXPONENTIAL")),
                NORMALS => compress::attributes(view, Some("OCTAHEDRAL")),
                SHORT_INDICES => compress::index_bytes::<2>(&view.bytes),
                INDICES => compress::index_bytes::<4>(&view.bytes),
                _ => compress::attributes(view, None),
            });
        }
        let mut accessors = self.accessors;
        for accessor in &mut accessors {
            let view = accessor["bufferView"].as_u64().unwrap_or(0) as usize;
            accessor["bufferView"] = places[view].into();
        }
        let extensions = match self.format {
            ProxyFormat::Quantized if !accessors.is_empty() => vec![("KHR_mesh_quantization", true)],
            ProxyFormat::Meshopt if !accessors.is_empty() => {
                vec![("KHR_mesh_quantization", true), (MESHOPT, true)]
            }
            _ => Vec::new(),
        };
        Additions { views, accessors, meshes: self.meshes, extensions, ..Additions::default() }
    }
}

/// About the bytes that triangles take in a file, JSON counted.
pub(super) fn size(triangles: &Triangles<'_>, format: ProxyFormat) -> u64 {
    if triangles.indices.is_empty() {
        return 0;
    }
    let count = triangles.positions.len();
    let has = |length: usize, bytes: usize| if length == count { bytes } else { 0 };
    if format == ProxyFormat::Meshopt {
        // Measured in three scenes and rounded up, texture coordinates guessed: bytes of a vertex, and one and a half of a
        // triangle.
        let vertex = 6
            + has(triangles.normals.len(), 2)
            + has(triangles.colors.len(), 1)
            + has(triangles.uvs.len(), 3);
        return (count * vertex + triangles.indices.len() / 2) as u64 + PRIMITIVE_JSON;
    }
    let normal = if format == ProxyFormat::Float { 12 } else { 4 };
    let vertex = 12
        + has(triangles.normals.len(), normal)
        + has(triangles.colors.len(), 4)
        + has(triangles.uvs.len(), 8);
    let index = if count <= 0xFFFF { 2 } else { 4 };
    (count * vertex + triangles.indices.len() * index) as u64 + PRIMITIVE_JSON
}

/// Length 1; upwards for what has no direction.
fn unit(normal: [f32; 3]) -> [f32; 3] {
    glam::Vec3::from_array(normal).try_normalize().unwrap_or(glam::Vec3::Y).to_array()
}

#[cfg(test)]
mod tests;
