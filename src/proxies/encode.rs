//! Meshes of proxies as glTF accessors, buffer views and meshes.

use super::options::ProxyFormat;
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

/// The kinds of data, each with a buffer view of its own: readers that map views to GPU buffers get few of them.
const POSITIONS: usize = 0;
const NORMALS: usize = 1;
const COLORS: usize = 2;
const UVS: usize = 3;
const SHORT_UVS: usize = 4;
const SHORT_INDICES: usize = 5;
const INDICES: usize = 6;

/// Meshes on their way into a file.
#[derive(Debug)]
pub(super) struct Encoder {
    format: ProxyFormat,
    first_accessor: usize,
    first_mesh: usize,
    views: [View; 7],
    accessors: Vec<Value>,
    meshes: Vec<Value>,
}

impl Encoder {
    /// Accessors and meshes get indices from these on.
    pub(super) fn new(format: ProxyFormat, first_accessor: usize, first_mesh: usize) -> Self {
        let vertices = |stride| View { bytes: Vec::new(), stride: Some(stride), target: Some(34962) };
        let indices = View { bytes: Vec::new(), stride: None, target: Some(34963) };
        let normals = if format == ProxyFormat::Float { 12 } else { 4 };
        Self {
            format,
            first_accessor,
            first_mesh,
            views: [
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
        let indices = triangles.indices;
        // The largest value of a component type would restart a strip.
        let index = if count <= 0xFFFF {
            let bytes = indices.iter().flat_map(|&v| (v as u16).to_le_bytes());
            self.add(
                SHORT_INDICES,
                bytes,
                json!({"componentType": 5123, "count": indices.len(), "type": "SCALAR"}),
            )
        } else {
            let bytes = indices.iter().flat_map(|&v| v.to_le_bytes());
            self.add(INDICES, bytes, json!({"componentType": 5125, "count": indices.len(), "type": "SCALAR"}))
        };
        let mut primitive = json!({"attributes": attributes, "indices": index});
        if let Some(material) = triangles.material {
            primitive["material"] = material.into();
        }
        primitive
    }

    fn positions(&mut self, positions: &[[f32; 3]]) -> usize {
        let mut bounds = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
        for position in positions {
            for axis in 0..3 {
                bounds[0][axis] = bounds[0][axis].min(position[axis]);
                bounds[1][axis] = bounds[1][axis].max(position[axis]);
            }
        }
        let number = |&value: &f32| Number::from_f64(f64::from(value)).map_or(Value::Null, Value::Number);
        let [min, max] = bounds.map(|corner| corner.iter().map(number).collect::<Vec<_>>());
        let bytes = positions.iter().flatten().flat_map(|v| v.to_le_bytes());
        let json =
            json!({"componentType": 5126, "count": positions.len(), "type": "VEC3", "min": min, "max": max});
        self.add(POSITIONS, bytes, json)
    }

    fn normals(&mut self, normals: &[[f32; 3]]) -> usize {
        let units = normals.iter().map(|&normal| unit(normal));
        let json = |component| json!({"componentType": component, "count": normals.len(), "type": "VEC3"});
        match self.format {
            ProxyFormat::Float => {
                let bytes = units.flatten().flat_map(f32::to_le_bytes);
                self.add(NORMALS, bytes, json(5126))
            }
            ProxyFormat::Quantized => {
                let byte = |c: f32| (c * 127.0).round() as i8 as u8;
                let bytes = units.flat_map(|[x, y, z]| [byte(x), byte(y), byte(z), 0]);
                let mut json = json(5120);
                json["normalized"] = true.into();
                self.add(NORMALS, bytes, json)
            }
        }
    }

    fn uvs(&mut self, uvs: &[[f32; 2]]) -> usize {
        let fits = uvs.iter().flatten().all(|c| (0.0..=1.0).contains(c));
        if self.format == ProxyFormat::Quantized && fits {
            let bytes = uvs.iter().flatten().flat_map(|c| ((c * 65535.0).round() as u16).to_le_bytes());
            let json = json!({"componentType": 5123, "normalized": true, "count": uvs.len(), "type": "VEC2"});
            return self.add(SHORT_UVS, bytes, json);
        }
        let bytes = uvs.iter().flatten().flat_map(|c| c.to_le_bytes());
        self.add(UVS, bytes, json!({"componentType": 5126, "count": uvs.len(), "type": "VEC2"}))
    }

    /// Appends an accessor over its part of a view.
    fn add(&mut self, view: usize, bytes: impl Iterator<Item = u8>, mut accessor: Value) -> usize {
        let own = &mut self.views[view].bytes;
        // Accessors begin on a multiple of their component's size.
        own.resize(own.len().next_multiple_of(4), 0);
        accessor["bufferView"] = view.into();
        accessor["byteOffset"] = own.len().into();
        own.extend(bytes);
        self.accessors.push(accessor);
        self.first_accessor + self.accessors.len() - 1
    }

    /// What is to be appended: views without data are left out.
    pub(super) fn finish(self) -> Additions {
        let mut places = [0; 7];
        let mut views = Vec::new();
        for (view, place) in self.views.into_iter().zip(&mut places) {
            *place = views.len();
            if !view.bytes.is_empty() {
                views.push(view);
            }
        }
        let mut accessors = self.accessors;
        for accessor in &mut accessors {
            let view = accessor["bufferView"].as_u64().unwrap_or(0) as usize;
            accessor["bufferView"] = places[view].into();
        }
        let quantized = self.format == ProxyFormat::Quantized && !accessors.is_empty();
        let extensions = if quantized { vec![("KHR_mesh_quantization", true)] } else { Vec::new() };
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
mod tests {
    use super::*;

    fn triangle(format: ProxyFormat) -> Additions {
        let mut encoder = Encoder::new(format, 10, 3);
        let triangles = Triangles {
            positions: &[[0.0, 0.5, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, -2.0]],
            normals: &[[0.0, 0.0, 2.0], [0.0; 3], [1.0, 0.0, 0.0]],
            colors: &[[255; 4]; 3],
            uvs: &[[0.0, 1.0], [0.5, 0.5], [1.0, 1.0]],
            indices: &[0, 1, 2],
            material: Some(4),
        };
        let empty = Triangles { indices: &[], ..triangles };
        assert_eq!(encoder.mesh([empty].into_iter()), None);
        assert_eq!(encoder.mesh([triangles, empty].into_iter()), Some(3));
        encoder.finish()
    }

    #[test]
    fn floats() {
        let additions = triangle(ProxyFormat::Float);
        assert_eq!(
            additions.meshes,
            [
                json!({"primitives": [{"attributes": {"POSITION": 10, "NORMAL": 11, "TEXCOORD_0": 12}, "indices": 13, "material": 4}]})
            ]
        );
        assert_eq!(additions.accessors[0]["max"], json!([1.0, 1.0, 0.0]));
        assert_eq!(additions.views.len(), 4, "white vertices need no colours");
        assert_eq!(additions.accessors[3]["bufferView"], 3);
        assert_eq!(additions.views[1].bytes[8..16], [0, 0, 0x80, 0x3F, 0, 0, 0, 0]);
        assert!(additions.extensions.is_empty());
    }

    #[test]
    fn bytes_and_shorts() {
        let additions = triangle(ProxyFormat::Quantized);
        assert_eq!(additions.views[1].bytes, [0, 0, 127, 0, 0, 127, 0, 0, 127, 0, 0, 0]);
        assert_eq!(additions.views[2].bytes[..4], [0, 0, 255, 255]);
        assert_eq!(additions.extensions, [("KHR_mesh_quantization", true)]);
    }
}
