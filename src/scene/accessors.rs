//! Opens accessors: index range, byte counts.

use super::SceneError;
use super::json::array;
use crate::gltf::{Accessor, AccessorError, Document};

/// Opens accessor `index`, which `pointer` names.
pub(crate) fn open<'a>(doc: &'a Document, index: usize, pointer: &str) -> Result<Accessor<'a>, SceneError> {
    let accessors = array(&doc.json, "accessors", "")?;
    let pointer = pointer.to_owned();
    if index >= accessors.len() {
        return Err(SceneError::IndexOutOfRange {
            pointer,
            index,
            array: "accessors",
            count: accessors.len(),
        });
    }
    doc.accessor(index).map_err(|error| match error {
        AccessorError::Compressed { extension, .. } => SceneError::Compressed { pointer, extension },
        source => SceneError::Accessor { pointer, source },
    })
}

/// Whether accessor `index` holds data of its own, or only what a compression extension fills in.
pub(crate) fn has_data(doc: &Document, index: usize) -> bool {
    let accessor = doc.json.get("accessors").and_then(|accessors| accessors.get(index));
    accessor.is_some_and(|accessor| accessor.get("bufferView").is_some() || accessor.get("sparse").is_some())
}

/// Bytes of an accessor's elements, without padding.
pub(crate) fn bytes(accessor: &Accessor<'_>) -> u64 {
    accessor.count as u64 * accessor.kind.element_size(accessor.component_type) as u64
}
