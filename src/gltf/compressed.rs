//! Buffer views whose only copy is compressed: `EXT_meshopt_compression`, and its successor `KHR_meshopt_compression`.
//!
//! Such a view lies in a buffer without bytes, its fallback; what fills it is in another buffer. It is decoded when it is
//! first read, beside the file's own bytes, which stay as they are. How much memory that may take is known from the JSON
//! before anything is decoded: a view may be no longer than the accessors in it need, nor than its compressed bytes can
//! stand for, and all views of a document together no longer than [`Decoded::LIMIT`] allows.

use super::buffers::BufferStorage;
use super::document::Document;
use super::error::AccessorError;
use super::json;
use super::kinds::{AccessorKind, ComponentType};
use serde_json::Value;
use std::collections::HashMap;
use std::sync::OnceLock;

/// The names of the extension, the one that is written first.
const NAMES: [&str; 2] = [MESHOPT, "KHR_meshopt_compression"];

/// Name of the extension as it is written.
pub(crate) const MESHOPT: &str = "EXT_meshopt_compression";

/// Bytes that a byte of a stream can stand for at most: attributes of version 1, all equal, take two bits for each of their
/// bytes and 256 elements.
const MOST_PER_BYTE: u64 = 1024;

/// The compression of a buffer view: the extension's name and object.
pub(super) fn of_view(view: &Value) -> Option<(&'static str, &Value)> {
    let extensions = view.get("extensions")?;
    NAMES.into_iter().find_map(|name| Some((name, extensions.get(name)?)))
}

/// What is in compressed buffer views, decoded where it was read.
#[derive(Clone, Debug, Default)]
pub(super) struct Decoded {
    /// By buffer view; none if no view needs decoding.
    views: Vec<OnceLock<Result<Vec<u8>, AccessorError>>>,
    /// Bytes that the accessors in a view need of it, of views that need decoding.
    needed: HashMap<usize, u64>,
    /// Bytes of all views that need decoding, as the JSON states them.
    bytes: u64,
    /// Bytes of all buffers.
    stored: u64,
}

impl Decoded {
    /// Bytes that all views of a document may have for each byte of its buffers: attributes of version 0 cannot have more.
    const LIMIT: u64 = 64;

    /// Looks at the views and accessors of a document; decodes nothing.
    pub(super) fn new(root: &Value, storage: &[BufferStorage], stored: u64) -> Self {
        let views = json::array(root, "bufferViews");
        let mut decoded = Self { stored, ..Self::default() };
        for (index, view) in views.iter().enumerate() {
            let buffer = view.get("buffer").and_then(json::index);
            let absent = buffer.and_then(|buffer| storage.get(buffer)) == Some(&BufferStorage::Absent);
            if absent && of_view(view).is_some() {
                decoded.needed.insert(index, 0);
                let length = view.get("byteLength").and_then(json::index).unwrap_or(0);
                decoded.bytes = decoded.bytes.saturating_add(length as u64);
            }
        }
        if decoded.needed.is_empty() {
            return decoded;
        }
        decoded.views.resize_with(views.len(), OnceLock::new);
        for accessor in json::array(root, "accessors") {
            let count = accessor.get("count");
            decoded.need(views, accessor, accessor, count);
            let sparse = accessor.get("sparse");
            let count = sparse.and_then(|sparse| sparse.get("count"));
            for key in ["indices", "values"] {
                if let Some(part) = sparse.and_then(|sparse| sparse.get(key)) {
                    decoded.need(views, accessor, part, count);
                }
            }
        }
        decoded
    }

    /// Notes what `part` (an accessor, or the indices or values of its sparse elements) needs of its view.
    fn need(&mut self, views: &[Value], accessor: &Value, part: &Value, count: Option<&Value>) {
        let number = |value: Option<&Value>| value.and_then(json::index).unwrap_or(0) as u64;
        let Some(view) = part.get("bufferView").and_then(json::index) else { return };
        let Some(needed) = self.needed.get_mut(&view) else { return };
        let component = part.get("componentType").or_else(|| accessor.get("componentType"));
        let component = component.and_then(json::index).and_then(ComponentType::from_code);
        let kind = accessor.get("type").and_then(Value::as_str).and_then(AccessorKind::from_name);
        let (Some(component), Some(kind)) = (component, kind) else { return };
        let stride = number(views[view].get("byteStride")).max(kind.element_size(component) as u64);
        let end = number(count).saturating_mul(stride).saturating_add(number(part.get("byteOffset")));
        *needed = end.max(*needed);
    }

    /// Bytes of all views that need decoding; 0 if they are so many that none is decoded.
    pub(super) fn described(&self) -> u64 {
        if self.bytes <= self.stored.saturating_mul(Self::LIMIT) { self.bytes } else { 0 }
    }

    /// There is nothing to decode.
    pub(super) fn is_empty(&self) -> bool {
        self.needed.is_empty()
    }

    /// Whether this view needs decoding.
    pub(super) fn has(&self, view: usize) -> bool {
        self.needed.contains_key(&view)
    }

    /// The bytes of a view that needs decoding.
    pub(super) fn view(&self, document: &Document, view: usize) -> Result<&[u8], AccessorError> {
        let cell = self.views.get(view).ok_or_else(|| AccessorError::Missing { pointer: pointer(view) })?;
        cell.get_or_init(|| self.decode(document, view)).as_deref().map_err(Clone::clone)
    }

    #[cfg(not(feature = "bake"))]
    fn decode(&self, document: &Document, view: usize) -> Result<Vec<u8>, AccessorError> {
        let extension =
            of_view(&json::array(&document.json, "bufferViews")[view]).map_or(MESHOPT, |(name, _)| name);
        Err(AccessorError::Compressed { pointer: pointer(view), extension })
    }

    /// Decodes a view, after its length was held against everything that can justify it.
    #[cfg(feature = "bake")]
    fn decode(&self, document: &Document, view: usize) -> Result<Vec<u8>, AccessorError> {
        use super::meshopt::Stream;
        let place = pointer(view);
        let json = &json::array(&document.json, "bufferViews")[view];
        let Some((name, extension)) = of_view(json) else {
            return Err(AccessorError::Missing { pointer: place });
        };
        let stream = Stream::read(extension, &format!("{place}/extensions/{name}"))?;
        let wrong = |key: &str, expected| {
            Err(AccessorError::Malformed { pointer: format!("{place}/{key}"), expected })
        };
        let length = json.get("byteLength").and_then(json::index);
        if length.is_none() || length != stream.length() {
            return wrong("byteLength", "count times byteStride of its compressed data");
        }
        let length = length.unwrap_or(0) as u64;
        if json.get("byteStride").is_some_and(|stride| json::index(stride) != Some(stream.stride)) {
            return wrong("byteStride", "byteStride of its compressed data");
        }
        let bytes = document.stored_bytes(extension, &format!("{place}/extensions/{name}"))?;
        let slack = stream.stride as u64 * 4;
        let justified = [
            (self.needed[&view].saturating_add(slack), "more than the accessors in it need"),
            (
                (bytes.len() as u64).saturating_mul(MOST_PER_BYTE),
                "more than its compressed bytes can stand for",
            ),
        ];
        let excess = justified.into_iter().find(|(limit, _)| length > *limit).map(|(_, what)| what);
        let total = self.stored.saturating_mul(Self::LIMIT);
        let excess = excess.or_else(|| {
            (self.bytes > total).then_some("with the other views more than a file of this size can hold")
        });
        if let Some(what) = excess {
            let problem = format!("is {length} bytes long, {what}");
            return Err(AccessorError::Stream { pointer: place, extension: name, problem });
        }
        stream.decode(bytes).map_err(|problem| AccessorError::Stream {
            pointer: place,
            extension: name,
            problem,
        })
    }
}

fn pointer(view: usize) -> String {
    format!("/bufferViews/{view}")
}

#[cfg(all(test, feature = "bake"))]
mod tests;
