//! Scenes of boxes.

use serde_json::{Value, json};
use svs::gltf::Document;

/// A document under construction.
pub(crate) struct Builder {
    pub(crate) json: Value,
    pub(crate) bin: Vec<u8>,
}

/// Triangles of a mesh before it becomes one.
pub(crate) struct Shape {
    pub(crate) points: Vec<[f32; 3]>,
    pub(crate) indices: Vec<u32>,
}

/// A box about the origin, faces outwards, each face of `cells` x `cells` squares; without the faces in `open`
/// (0 to 5: -x, +x, -y, +y, -z, +z).
pub(crate) fn shell(half: [f32; 3], cells: u32, open: &[usize]) -> Shape {
    let mut shape = Shape { points: Vec::new(), indices: Vec::new() };
    for face in (0..6).filter(|face| !open.contains(face)) {
        let (axis, side) = (face / 2, if face % 2 == 0 { -1.0 } else { 1.0 });
        let (u, v) =
            if side > 0.0 { ((axis + 1) % 3, (axis + 2) % 3) } else { ((axis + 2) % 3, (axis + 1) % 3) };
        let first = shape.points.len() as u32;
        for row in 0..=cells {
            for column in 0..=cells {
                let mut point = [0.0; 3];
                point[axis] = side * half[axis];
                point[u] = (2.0 * column as f32 / cells as f32 - 1.0) * half[u];
                point[v] = (2.0 * row as f32 / cells as f32 - 1.0) * half[v];
                shape.points.push(point);
            }
        }
        for row in 0..cells {
            for column in 0..cells {
                let a = first + row * (cells + 1) + column;
                let (b, c, d) = (a + 1, a + cells + 1, a + cells + 2);
                shape.indices.extend([a, b, d, a, d, c]);
            }
        }
    }
    shape
}

impl Builder {
    /// With three materials: 0 one-sided, 1 two-sided, 2 two-sided BLEND, 3 two-sided MASK.
    pub(crate) fn new() -> Self {
        let materials = json!([
            {"doubleSided": false},
            {"doubleSided": true},
            {"doubleSided": true, "alphaMode": "BLEND"},
            {"doubleSided": true, "alphaMode": "MASK"},
        ]);
        let json = json!({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [],
            "meshes": [], "materials": materials, "accessors": [], "bufferViews": []});
        Self { json, bin: Vec::new() }
    }

    fn push(&mut self, key: &str, item: Value) -> usize {
        let items = self.json.as_object_mut().expect("an object").entry(key).or_insert_with(|| json!([]));
        let items = items.as_array_mut().expect("an array");
        items.push(item);
        items.len() - 1
    }

    pub(crate) fn accessor(&mut self, bytes: &[u8], mut accessor: Value) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let view = json!({"buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len()});
        self.bin.extend_from_slice(bytes);
        accessor["bufferView"] = self.push("bufferViews", view).into();
        self.push("accessors", accessor)
    }

    pub(crate) fn positions(&mut self, points: &[[f32; 3]]) -> usize {
        let bytes: Vec<u8> = points.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        let bound = |pick: fn(f32, f32) -> f32| -> Vec<f32> {
            (0..3).map(|axis| points.iter().map(|p| p[axis]).reduce(pick).expect("points")).collect()
        };
        let accessor = json!({"componentType": 5126, "count": points.len(), "type": "VEC3",
            "min": bound(f32::min), "max": bound(f32::max)});
        self.accessor(&bytes, accessor)
    }

    /// A mesh of one primitive.
    pub(crate) fn mesh(&mut self, shape: &Shape, material: usize) -> usize {
        let position = self.positions(&shape.points);
        let bytes: Vec<u8> = shape.indices.iter().flat_map(|&index| (index as u16).to_le_bytes()).collect();
        let indices = self
            .accessor(&bytes, json!({"componentType": 5123, "count": shape.indices.len(), "type": "SCALAR"}));
        let primitive =
            json!({"attributes": {"POSITION": position}, "indices": indices, "material": material});
        self.push("meshes", json!({"primitives": [primitive]}))
    }

    /// A node of the scene with more properties than its mesh.
    pub(crate) fn node(&mut self, name: &str, mesh: usize, more: Value) -> usize {
        let mut node = json!({"name": name, "mesh": mesh});
        node.as_object_mut().expect("an object").extend(more.as_object().expect("an object").clone());
        let index = self.push("nodes", node);
        self.json["scenes"][0]["nodes"].as_array_mut().expect("an array").push(index.into());
        index
    }

    /// A closed box at a place.
    pub(crate) fn cube(&mut self, name: &str, half: f32, at: [f32; 3], material: usize) -> usize {
        let mesh = self.mesh(&shell([half; 3], 1, &[]), material);
        self.node(name, mesh, json!({"translation": at}))
    }

    /// An animation of a node's translation.
    pub(crate) fn animate(&mut self, node: usize) {
        let times = self.accessor(
            &[0f32, 1.0].map(f32::to_le_bytes).concat(),
            json!({"componentType": 5126, "count": 2, "type": "SCALAR", "min": [0.0], "max": [1.0]}),
        );
        let places = self.positions(&[[0.0; 3], [0.0, 0.0, 9.0]]);
        let animation = json!({"channels": [{"sampler": 0, "target": {"node": node, "path": "translation"}}],
            "samplers": [{"input": times, "output": places}]});
        self.push("animations", animation);
    }

    pub(crate) fn uses(&mut self, extension: &str) {
        self.push("extensionsUsed", extension.into());
    }

    pub(crate) fn document(&self) -> Document {
        let mut json = self.json.clone();
        json["buffers"] = json!([{"byteLength": self.bin.len()}]);
        Document::from_parts(json, Some(self.bin.clone())).expect("a document")
    }
}
