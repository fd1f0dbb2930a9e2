//! What a bake adds beside its tables: meshes that the extension alone reaches.

use super::NodeLevels;
use crate::gltf::document::Document;
use crate::gltf::json;
use serde_json::Value;

/// Objects to append to the document. Indices in `materials` and `meshes` are final: those that `accessors` and `materials`
/// get are [`Document::next_accessor`] and [`Additions::first_material`] onwards.
#[derive(Clone, Debug, Default)]
pub struct Additions {
    /// Buffer views, in the order of their bytes.
    pub views: Vec<View>,
    /// glTF accessors; their `bufferView` counts from the first of `views`.
    pub accessors: Vec<Value>,
    /// glTF materials.
    pub materials: Vec<Value>,
    /// glTF meshes.
    pub meshes: Vec<Value>,
    /// glTF nodes, from [`Additions::first_node`] on: named by `levels` only, each of them, and showing `meshes`.
    pub nodes: Vec<Value>,
    /// Nodes of the document that get `MSFT_lod`.
    pub levels: Vec<NodeLevels>,
    /// Names for `extensionsUsed`, where they are not there yet; `true`: for `extensionsRequired` too.
    pub extensions: Vec<(&'static str, bool)>,
}

/// A buffer view to append.
#[derive(Clone, Debug, Default)]
pub struct View {
    /// Its bytes as they are stored; not none.
    pub bytes: Vec<u8>,
    /// glTF `byteStride`.
    pub stride: Option<u32>,
    /// glTF `target`: 34962 vertices, 34963 indices.
    pub target: Option<u32>,
    /// How `bytes` are compressed, if they are.
    pub compression: Option<Compression>,
}

/// Properties of `EXT_meshopt_compression` on a buffer view. The buffer that the view itself names is then a fallback
/// without bytes, so the extension must be required.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Compression {
    /// `ATTRIBUTES` or `TRIANGLES`.
    pub mode: &'static str,
    /// `OCTAHEDRAL` or `EXPONENTIAL`, if anything is done after decoding.
    pub filter: Option<&'static str>,
    /// Bytes of a decoded element.
    pub stride: usize,
    /// Elements.
    pub count: usize,
}

impl Additions {
    /// There is nothing to append.
    pub fn is_empty(&self) -> bool {
        self.views.is_empty()
            && self.accessors.is_empty()
            && self.materials.is_empty()
            && self.meshes.is_empty()
            && self.nodes.is_empty()
    }

    /// Bytes of all views.
    pub fn bytes(&self) -> u64 {
        self.views.iter().map(|view| view.bytes.len() as u64).sum()
    }

    /// Index of the first appended material.
    pub fn first_material(document: &Document) -> usize {
        json::array(&document.json, "materials").len()
    }

    /// Index of the first appended mesh.
    pub fn first_mesh(document: &Document) -> usize {
        json::array(&document.json, "meshes").len()
    }

    /// Index of the first appended node.
    pub fn first_node(document: &Document) -> usize {
        json::array(&document.json, "nodes").len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gltf::payload::{Table, attach_with, strip};
    use serde_json::json;

    /// A file with a mesh, and additions of another with a material.
    fn parts() -> (Document, Additions) {
        let json = json!({
            "asset": {"version": "2.0"}, "buffers": [{"byteLength": 38}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
            "materials": [{}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
            "nodes": [{"mesh": 0}],
        });
        let accessor = json!({"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"});
        let additions = Additions {
            views: vec![View {
                bytes: vec![1; 36],
                stride: Some(12),
                target: Some(34962),
                compression: None,
            }],
            accessors: vec![accessor],
            materials: vec![json!({"doubleSided": true})],
            meshes: vec![json!({"primitives": [{"attributes": {"POSITION": 1}, "material": 1}]})],
            nodes: vec![json!({"mesh": 1})],
            levels: vec![NodeLevels { node: 0, ids: vec![1], coverage: vec![0.1, 0.0] }],
            extensions: vec![("KHR_mesh_quantization", true), ("MSFT_lod", false)],
        };
        (Document::from_parts(json, Some(vec![7; 38])).unwrap(), additions)
    }

    fn attached() -> (Document, Document) {
        let (mut document, additions) = parts();
        let before = document.clone();
        let tables = [Table { bytes: &[1], component_type: 5121, kind: "SCALAR", count: 1, min_max: None }];
        let extension = json!({"trees": [{"tables": {}, "proxies": {"tables": {"PROXY_MESH": 2}}}]});
        assert_eq!(attach_with(&mut document, extension, &tables, additions), Ok(vec![2]));
        (before, document)
    }

    #[test]
    fn additions_are_removed_exactly() {
        let (before, mut document) = attached();
        assert_eq!(document.json["bufferViews"][1]["byteOffset"], 40);
        assert_eq!(document.json["bufferViews"][2]["byteOffset"], 76);
        assert_eq!(document.json["accessors"][1]["bufferView"], 1);
        assert_eq!(document.json["extensionsRequired"], json!(["KHR_mesh_quantization"]));
        assert_eq!(document.json["nodes"][0]["extensions"]["MSFT_lod"]["ids"], json!([1]));
        assert!(strip(&mut document));
        assert_eq!(document.json, before.json);
        assert_eq!(document.buffers, before.buffers);
    }

    #[test]
    fn what_others_use_stays() {
        for (pointer, value) in [
            ("/nodes/0/mesh", json!(1)),
            ("/nodes/1/mesh", json!(0)),
            ("/meshes/0/primitives/0/attributes/POSITION", json!(1)),
            ("/accessors/0/bufferView", json!(1)),
        ] {
            let (_, mut document) = attached();
            *document.json.pointer_mut(pointer).unwrap() = value;
            let kept = ["meshes", "accessors", "nodes"].map(|key| document.json[key].clone());
            assert!(strip(&mut document));
            assert_eq!(
                [&document.json["meshes"], &document.json["accessors"], &document.json["nodes"]],
                [&kept[0], &kept[1], &kept[2]],
                "{pointer}"
            );
            assert_eq!(document.json["extensionsRequired"], json!(["KHR_mesh_quantization"]));
        }
        let (before, mut document) = attached();
        document.json["meshes"][0]["primitives"][0]["material"] = json!(1);
        assert!(strip(&mut document));
        assert_eq!(document.json["materials"].as_array().unwrap().len(), 2);
        assert_eq!(document.buffers, before.buffers);
    }

    #[test]
    fn a_table_that_names_meshes_of_others_removes_none() {
        let (_, mut document) = attached();
        // Claims mesh 0, which a node shows.
        document.buffers[0][76] = 0;
        assert!(strip(&mut document));
        assert_eq!(document.json["meshes"].as_array().unwrap().len(), 2);
    }
}
