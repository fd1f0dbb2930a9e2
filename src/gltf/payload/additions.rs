//! What a bake adds beside its tables: meshes that the extension alone reaches.

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
}

impl Additions {
    /// There is nothing to append.
    pub fn is_empty(&self) -> bool {
        self.views.is_empty()
            && self.accessors.is_empty()
            && self.materials.is_empty()
            && self.meshes.is_empty()
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
}
