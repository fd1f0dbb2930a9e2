//! Small hand-made documents.

use glam::DVec3;
use serde_json::{Value, json};
use svs::gltf::Document;

/// Triangles with four or eight corners, indexed.
#[derive(Clone, Debug, Default)]
pub(crate) struct Shape {
    pub(crate) positions: Vec<[f32; 3]>,
    pub(crate) uvs: Vec<[f32; 2]>,
    pub(crate) indices: Vec<u32>,
}

/// A box about the origin, faces outwards.
pub(crate) fn cuboid(half: [f32; 3]) -> Shape {
    let positions = (0..8)
        .map(|i| [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { -half[axis] } else { half[axis] }))
        .collect();
    let faces: [[u32; 4]; 6] =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let indices = faces.iter().flat_map(|[a, b, c, d]| [*a, *b, *c, *a, *c, *d]).collect();
    Shape { positions, uvs: Vec::new(), indices }
}

/// A sheet of side 2 in the y-z plane about the origin that faces +x, with texture coordinates from 0 to 1.
pub(crate) fn sheet() -> Shape {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    Shape {
        positions: corners.map(|[y, z]| [0.0, y, z]).to_vec(),
        uvs: corners.map(|[y, z]| [(y + 1.0) / 2.0, (1.0 - z) / 2.0]).to_vec(),
        indices: vec![0, 1, 2, 0, 2, 3],
    }
}

/// Collects meshes and nodes.
#[derive(Debug)]
pub(crate) struct Builder {
    pub(crate) json: Value,
    pub(crate) bin: Vec<u8>,
}

impl Builder {
    pub(crate) fn new() -> Self {
        Self {
            json: json!({
                "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [] }], "nodes": [],
                "meshes": [], "accessors": [], "bufferViews": [],
            }),
            bin: Vec::new(),
        }
    }

    /// Adds to a list of the document; returns the index.
    pub(crate) fn push(&mut self, list: &str, value: Value) -> usize {
        if self.json.get(list).is_none() {
            self.json[list] = json!([]);
        }
        let list = self.json[list].as_array_mut().expect("a list");
        list.push(value);
        list.len() - 1
    }

    /// A buffer view of its own for some bytes.
    pub(crate) fn view(&mut self, bytes: &[u8]) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let offset = self.bin.len();
        self.bin.extend(bytes);
        self.push("bufferViews", json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() }))
    }

    /// A mesh of one primitive.
    pub(crate) fn mesh(&mut self, shape: &Shape, material: Option<usize>) -> usize {
        let bytes: Vec<u8> = shape.positions.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        let view = self.view(&bytes);
        let bound = |pick: fn(f32, f32) -> f32| -> Vec<f32> {
            (0..3).filter_map(|k| shape.positions.iter().map(|p| p[k]).reduce(pick)).collect()
        };
        let positions = self.push(
            "accessors",
            json!({
                "bufferView": view, "componentType": 5126, "count": shape.positions.len(), "type": "VEC3",
                "min": bound(f32::min), "max": bound(f32::max),
            }),
        );
        let bytes: Vec<u8> = shape.indices.iter().flat_map(|i| i.to_le_bytes()).collect();
        let view = self.view(&bytes);
        let indices = self.push(
            "accessors",
            json!({ "bufferView": view, "componentType": 5125, "count": shape.indices.len(), "type": "SCALAR" }),
        );
        let mut primitive = json!({ "attributes": { "POSITION": positions }, "indices": indices });
        if !shape.uvs.is_empty() {
            let bytes: Vec<u8> = shape.uvs.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
            let view = self.view(&bytes);
            primitive["attributes"]["TEXCOORD_0"] = self
                .push(
                    "accessors",
                    json!({ "bufferView": view, "componentType": 5126, "count": shape.uvs.len(), "type": "VEC2" }),
                )
                .into();
        }
        if let Some(material) = material {
            primitive["material"] = material.into();
        }
        self.push("meshes", json!({ "primitives": [primitive] }))
    }

    /// A node below `parent`, or a root of the scene.
    pub(crate) fn node(&mut self, parent: Option<usize>, node: Value) -> usize {
        let index = self.push("nodes", node);
        let list = match parent {
            Some(parent) => {
                let parent = &mut self.json["nodes"][parent];
                if parent.get("children").is_none() {
                    parent["children"] = json!([]);
                }
                &mut parent["children"]
            }
            None => &mut self.json["scenes"][0]["nodes"],
        };
        list.as_array_mut().expect("a list").push(index.into());
        index
    }

    /// An object with its centre somewhere.
    pub(crate) fn object(&mut self, parent: Option<usize>, mesh: usize, at: DVec3) -> usize {
        self.node(parent, json!({ "mesh": mesh, "translation": at.to_array() }))
    }

    pub(crate) fn finish(mut self) -> Document {
        if !self.bin.is_empty() {
            self.json["buffers"] = json!([{ "byteLength": self.bin.len() }]);
        }
        for list in ["meshes", "accessors", "bufferViews", "nodes"] {
            if self.json[list].as_array().is_some_and(Vec::is_empty) {
                self.json.as_object_mut().expect("an object").remove(list);
            }
        }
        if self.json["scenes"][0]["nodes"].as_array().is_some_and(Vec::is_empty) {
            self.json["scenes"][0].as_object_mut().expect("an object").remove("nodes");
        }
        Document::from_parts(self.json, Some(self.bin).filter(|bin| !bin.is_empty())).expect("a document")
    }
}
