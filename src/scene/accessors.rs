//! Opens accessors: index range, compressed data, byte counts.

use super::SceneError;
use super::json::{array, extension};
use crate::gltf::{Accessor, BufferStorage, Document};
use serde_json::Value;

/// Names of one and the same buffer view compression (meshoptimizer).
const MESHOPT: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];

/// Opens accessor `index`, which `pointer` names.
pub(crate) fn open<'a>(doc: &'a Document, index: usize, pointer: &str) -> Result<Accessor<'a>, SceneError> {
    let accessors = array(&doc.json, "accessors", "")?;
    let Some(json) = accessors.get(index) else {
        let (pointer, count) = (pointer.to_owned(), accessors.len());
        return Err(SceneError::IndexOutOfRange { pointer, index, array: "accessors", count });
    };
    if let Some(extension) = compressed_only(doc, json) {
        return Err(SceneError::Compressed { pointer: pointer.to_owned(), extension });
    }
    doc.accessor(index).map_err(|source| SceneError::Accessor { pointer: pointer.to_owned(), source })
}

/// Whether accessor `index` holds data of its own, or only what a compression extension fills in.
pub(crate) fn has_data(doc: &Document, index: usize) -> bool {
    let accessor = doc.json.get("accessors").and_then(|accessors| accessors.get(index));
    accessor.is_some_and(|accessor| accessor.get("bufferView").is_some() || accessor.get("sparse").is_some())
}

/// The extension that holds the only copy of an accessor's data. A compressed buffer view refers to a buffer
/// with the same data uncompressed, but that buffer may be a mere placeholder without bytes.
fn compressed_only(doc: &Document, accessor: &Value) -> Option<&'static str> {
    let view = doc.json.get("bufferViews")?.get(accessor.get("bufferView")?.as_u64()? as usize)?;
    let name = MESHOPT.into_iter().find(|name| extension(view, name).is_some())?;
    let buffer = view.get("buffer")?.as_u64()? as usize;
    (doc.buffer_storage(buffer) == Some(&BufferStorage::Absent)).then_some(name)
}

/// Bytes of an accessor's elements, without padding.
pub(crate) fn bytes(accessor: &Accessor<'_>) -> u64 {
    accessor.count as u64 * accessor.kind.element_size(accessor.component_type) as u64
}
