//! Small documents made by hand.

use crate::gltf::Document;
use crate::scene::{ReadOptions, Scene, SceneError, read_scene};
use serde_json::{Value, json};

/// A document under construction: JSON and the bytes of buffer 0.
pub(super) struct Builder {
    pub(super) json: Value,
    bin: Vec<u8>,
}

impl Builder {
    pub(super) fn new() -> Builder {
        Builder { json: json!({"asset": {"version": "2.0"}}), bin: Vec::new() }
    }

    /// Appends to a top-level array.
    pub(super) fn push(&mut self, array: &str, value: Value) -> usize {
        let array = self.json.as_object_mut().unwrap().entry(array).or_insert_with(|| json!([]));
        let array = array.as_array_mut().unwrap();
        array.push(value);
        array.len() - 1
    }

    pub(super) fn view(&mut self, bytes: &[u8]) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let offset = self.bin.len();
        self.bin.extend_from_slice(bytes);
        self.push("bufferViews", json!({"buffer": 0, "byteOffset": offset, "byteLength": bytes.len()}))
    }

    pub(super) fn accessor(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize) -> usize {
        let view = self.view(bytes);
        let accessor = json!({"bufferView": view, "componentType": component, "type": kind, "count": count});
        self.push("accessors", accessor)
    }

    pub(super) fn floats<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        let kind = ["", "SCALAR", "VEC2", "VEC3", "VEC4"][N];
        let bytes: Vec<u8> = values.iter().flatten().flat_map(|value| value.to_le_bytes()).collect();
        self.accessor(&bytes, 5126, kind, values.len())
    }

    /// POSITION with the `min` and `max` that glTF asks for.
    pub(super) fn positions(&mut self, points: &[[f32; 3]]) -> usize {
        let accessor = self.floats(points);
        let extreme = |pick: fn(f32, f32) -> f32| -> Vec<f32> {
            (0..3).map(|axis| points.iter().map(|point| point[axis]).reduce(pick).unwrap()).collect()
        };
        self.json["accessors"][accessor]["min"] = json!(extreme(f32::min));
        self.json["accessors"][accessor]["max"] = json!(extreme(f32::max));
        accessor
    }

    pub(super) fn indices(&mut self, indices: &[u16]) -> usize {
        let bytes: Vec<u8> = indices.iter().flat_map(|index| index.to_le_bytes()).collect();
        self.accessor(&bytes, 5123, "SCALAR", indices.len())
    }

    /// A mesh of the given primitives.
    pub(super) fn mesh(&mut self, primitives: Value) -> usize {
        self.push("meshes", json!({"primitives": primitives}))
    }

    /// The triangle (0,0,0), (1,0,0), (0,1,0).
    pub(super) fn triangle(&mut self) -> usize {
        let position = self.positions(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        self.mesh(json!([{"attributes": {"POSITION": position}}]))
    }

    pub(super) fn node(&mut self, node: Value) -> usize {
        self.push("nodes", node)
    }

    /// A scene of these nodes.
    pub(super) fn scene(&mut self, nodes: &[usize]) -> usize {
        self.push("scenes", json!({"nodes": nodes}))
    }

    /// One mesh of these primitives, one node, one scene.
    pub(super) fn with_primitives(mut self, primitives: Value) -> Builder {
        let mesh = self.mesh(primitives);
        let node = self.node(json!({"mesh": mesh}));
        self.scene(&[node]);
        self
    }

    pub(super) fn document(&self) -> Document {
        let mut json = self.json.clone();
        if self.bin.is_empty() {
            return Document::from_parts(json, None).unwrap();
        }
        json["buffers"] = json!([{"byteLength": self.bin.len()}]);
        Document::from_parts(json, Some(self.bin.clone())).unwrap()
    }

    pub(super) fn read(&self) -> Result<Scene, SceneError> {
        read_scene(&self.document(), &ReadOptions::default())
    }

    /// The text of the error that reading ends with.
    pub(super) fn error(&self) -> String {
        self.read().unwrap_err().to_string()
    }
}

/// Count of the note with this code.
pub(super) fn noted(scene: &Scene, code: &str) -> usize {
    scene.notes.iter().find(|note| note.code == code).map_or(0, |note| note.count)
}

/// All triangles as points in mesh space.
pub(super) fn points(scene: &Scene, mesh: usize) -> Vec<[[f64; 3]; 3]> {
    let mesh = &scene.meshes[mesh];
    let point = |v: u32| (mesh.positions[v as usize].as_dvec3() + mesh.origin).to_array();
    mesh.triangles.iter().map(|triangle| triangle.map(point)).collect()
}
