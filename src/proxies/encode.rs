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
mod tests {
    use super::*;

    /// The accessors of a primitive, read back as a loader does.
    fn read_back(additions: Additions) -> crate::gltf::Document {
        let mut document =
            crate::gltf::Document::from_parts(json!({"asset": {"version": "2.0"}}), None).unwrap();
        crate::gltf::payload::attach_with(&mut document, json!({}), &[], additions).unwrap();
        let mut file = Vec::new();
        file.extend(document.to_glb().unwrap());
        crate::gltf::Document::from_glb(&file).unwrap()
    }

    #[test]
    fn compressed_meshes_are_read_back_within_their_steps() {
        // A bumpy sheet, far from the origin, with texture coordinates beyond the texture, and a vertex that nothing uses.
        let side = 40_u32;
        let at = |k: u32| {
            [1000.0 + (k % side) as f32 * 0.25, (k * 7 % 13) as f32 * 0.01, (k / side) as f32 * 0.25]
        };
        let positions: Vec<[f32; 3]> = (0..=side * side).map(at).collect();
        let normals: Vec<[f32; 3]> =
            (0..=side * side).map(|k| [(k % 5) as f32 - 2.0, 3.0, (k % 3) as f32 - 1.0]).collect();
        let colors: Vec<[u8; 4]> = (0..=side * side).map(|k| [(k % 251) as u8, 7, 99, 255]).collect();
        let uvs: Vec<[f32; 2]> = positions.iter().map(|p| [p[0] - 1003.0, p[2] * 0.3]).collect();
        let quads = (0..side * (side - 1)).filter(|k| k % side + 1 < side);
        let indices: Vec<u32> =
            quads.flat_map(|k| [k, k + 1, k + side, k + side, k + 1, k + side + 1]).collect();
        let whole = Triangles {
            positions: &positions,
            normals: &normals,
            colors: &colors,
            uvs: &uvs,
            indices: &indices,
            material: None,
        };
        let small = Triangles { indices: &indices[..60], uvs: &[], ..whole };
        let mut encoder = Encoder::new(ProxyFormat::Meshopt, 0, 0);
        encoder.mesh([whole, small, small].into_iter());
        let additions = encoder.finish();
        assert_eq!(additions.extensions, [("KHR_mesh_quantization", true), (MESHOPT, true)]);
        let bytes = additions.bytes();
        assert!(bytes < 60_000, "{bytes}");
        let document = read_back(additions);
        assert_eq!(document.json["buffers"][1]["extensions"][MESHOPT], json!({"fallback": true}));

        // A vertex is known by its place: colours tell which it was.
        let step = side as f64 * 0.25 / 65536.0;
        for (primitive, original) in [whole, small, small].iter().enumerate() {
            let json = &document.json["meshes"][0]["primitives"][primitive];
            let accessor = |name: &str| {
                let index = json.pointer(name).and_then(Value::as_u64).expect(name) as usize;
                document.accessor(index).expect("readable")
            };
            let positions = accessor("/attributes/POSITION");
            let found = positions.read_vec3_f64().unwrap();
            let [min, max] = [0, 1].map(|end| {
                let values = found.iter().copied();
                let corner = values.reduce(|a, b| if end == 0 { a.min(b) } else { a.max(b) }).unwrap();
                corner.to_array().to_vec()
            });
            assert_eq!(positions.min_max(), Some((min, max)), "the bounds are exact");
            let normals = accessor("/attributes/NORMAL").read_vec3_f64().unwrap();
            let colors = accessor("/attributes/COLOR_0").read_vec4_f64().unwrap();
            let uvs = json
                .pointer("/attributes/TEXCOORD_0")
                .map(|_| accessor("/attributes/TEXCOORD_0").read_vec2_f32().unwrap());
            let own = accessor("/indices").read_indices_u32().unwrap();
            let used: std::collections::BTreeSet<u32> = original.indices.iter().copied().collect();
            assert_eq!(found.len(), used.len(), "what nothing uses is left out");
            let nearest: Vec<u32> = found
                .iter()
                .map(|p| {
                    let near = |v: &u32| original.positions[*v as usize].map(f64::from);
                    *used
                        .iter()
                        .min_by(|a, b| {
                            let distance = |v| p.distance_squared(near(v).into());
                            distance(a).total_cmp(&distance(b))
                        })
                        .unwrap()
                })
                .collect();
            for (k, &v) in nearest.iter().enumerate() {
                let v = v as usize;
                let off = found[k] - glam::DVec3::from_array(original.positions[v].map(f64::from));
                assert!(off.abs().max_element() <= step / 2.0, "{off}");
                let normal = glam::DVec3::from_array(original.normals[v].map(f64::from)).normalize();
                assert!(normals[k].normalize().distance(normal) < 0.02, "{} {normal}", normals[k]);
                assert_eq!((colors[k].x * 255.0).round() as u8, original.colors[v][0]);
                if let Some(uvs) = &uvs {
                    let off = uvs[k] - glam::Vec2::from_array(original.uvs[v]);
                    assert!(off.abs().max_element() <= 0.5 / 65536.0, "{off}");
                }
            }
            // The same triangles, each turned about as it may be.
            let turned = |t: &[u32]| {
                let first = (0..3).min_by_key(|&k| t[k]).unwrap();
                [t[first], t[(first + 1) % 3], t[(first + 2) % 3]]
            };
            let mut read: Vec<_> =
                own.chunks_exact(3).map(|t| turned(&[0, 1, 2].map(|k| nearest[t[k] as usize]))).collect();
            let mut expected: Vec<_> = original.indices.chunks_exact(3).map(turned).collect();
            read.sort_unstable();
            expected.sort_unstable();
            assert!(read == expected, "primitive {primitive}");
        }
        let own_views = document.json["bufferViews"].as_array().unwrap().iter();
        let modes: Vec<_> =
            own_views.map(|view| view["extensions"][MESHOPT]["mode"].as_str().unwrap()).collect();
        assert_eq!(modes, ["ATTRIBUTES", "ATTRIBUTES", "ATTRIBUTES", "ATTRIBUTES", "TRIANGLES", "TRIANGLES"]);
    }

    #[test]
    fn flat_and_tiny_meshes_compress() {
        for scale in [0.0, 1e-30, 1e30] {
            let positions = [[0.0; 3], [scale, 0.0, 0.0], [0.0, -scale, 0.0]];
            let triangles = Triangles {
                positions: &positions,
                normals: &[],
                colors: &[],
                uvs: &[[0.0; 2]; 3],
                indices: &[0, 1, 2],
                material: None,
            };
            let mut encoder = Encoder::new(ProxyFormat::Meshopt, 0, 0);
            encoder.mesh([triangles].into_iter());
            let document = read_back(encoder.finish());
            let found = document.accessor(0).unwrap().read_vec3_f64().unwrap();
            for (found, expected) in found.iter().zip(positions) {
                let expected = glam::DVec3::from_array(expected.map(f64::from));
                assert!(found.distance(expected) <= f64::from(scale) / 65536.0, "{found} {expected}");
            }
        }
    }

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
