//! Accessors, checked: once an [`Accessor`] exists, reading it cannot leave the file's bytes.

use super::document::Document;
use super::error::AccessorError;
use super::json;
use super::kinds::{AccessorKind, ComponentType};
use serde_json::Value;

/// Elements without a buffer view that are accepted in any file, however small.
const ZEROS_ALWAYS_ACCEPTED: usize = 65_536;

/// A checked view of `/accessors/N`.
///
/// Its data are `count` elements in a buffer view (or zeros, if it has none) with sparse substitutions on top.
#[derive(Clone, Debug)]
pub struct Accessor<'a> {
    /// Index in `/accessors`.
    pub index: usize,
    /// Number of elements.
    pub count: usize,
    /// Type of the components as stored.
    pub component_type: ComponentType,
    /// Shape of the elements.
    pub kind: AccessorKind,
    /// Integers stand for fractions: unsigned 0..=max for 0..=1, signed for -1..=1.
    pub normalized: bool,
    pub(super) json: &'a Value,
    pub(super) base: Option<Strided<'a>>,
    pub(super) sparse: Option<Sparse<'a>>,
}

/// Elements at a fixed distance. `bytes` starts with the first element and reaches at least to the last one's end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strided<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) stride: usize,
}

/// Substituted elements: `values` holds one tightly packed element for each index, each below the accessor's count.
#[derive(Clone, Debug)]
pub(super) struct Sparse<'a> {
    pub(super) indices: Vec<usize>,
    pub(super) values: &'a [u8],
}

impl Document {
    /// Looks an accessor up and checks all its offsets, its sparse indices included.
    ///
    /// An accessor without buffer view stands for zeros; its count may not exceed the number of bytes in the file's
    /// buffers (or 65,536), so that a few bytes of JSON cannot ask for gigabytes.
    ///
    /// # Errors
    /// [`AccessorError`] with the JSON pointer of what is wrong.
    pub fn accessor(&self, index: usize) -> Result<Accessor<'_>, AccessorError> {
        let at = Place { pointer: format!("/accessors/{index}") };
        let json = json::array(&self.json, "accessors").get(index);
        let json = json.ok_or_else(|| AccessorError::Missing { pointer: at.pointer.clone() })?;
        let count = at.index(json, "count", None)?;
        let component_type = at.component_type(json)?;
        let kind = json.get("type").and_then(Value::as_str).and_then(AccessorKind::from_name);
        let kind =
            kind.ok_or_else(|| at.malformed("type", "SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4"))?;
        let normalized = match json.get("normalized") {
            None => false,
            Some(value) => value.as_bool().ok_or_else(|| at.malformed("normalized", "true or false"))?,
        };
        let element = kind.element_size(component_type);
        let base = match json.get("bufferView") {
            None => {
                if count as u64 > self.read_bytes.max(ZEROS_ALWAYS_ACCEPTED as u64) {
                    return Err(AccessorError::TooManyZeros { pointer: at.pointer, count });
                }
                None
            }
            Some(_) => {
                let view = at.index(json, "bufferView", None)?;
                let offset = at.index(json, "byteOffset", Some(0))?;
                let stride = self.stride(view)?.unwrap_or(element);
                if stride < element {
                    let expected = "at least the size of one element";
                    return Err(AccessorError::Malformed {
                        pointer: format!("/bufferViews/{view}/byteStride"),
                        expected,
                    });
                }
                let bytes = at.tail(self.buffer_view(view)?, offset, count, stride, element)?;
                Some(Strided { bytes, stride })
            }
        };
        let sparse = match json.get("sparse") {
            None => None,
            Some(sparse) => Some(self.sparse(&at, sparse, count, element)?),
        };
        Ok(Accessor { index, count, component_type, kind, normalized, json, base, sparse })
    }

    /// Where an accessor's data lie: buffers and ranges of them, of a sparse accessor several.
    ///
    /// # Errors
    /// As [`Self::accessor`].
    pub fn accessor_ranges(
        &self,
        index: usize,
    ) -> Result<Vec<(usize, std::ops::Range<usize>)>, AccessorError> {
        let at = Place { pointer: format!("/accessors/{index}") };
        let json = json::array(&self.json, "accessors").get(index);
        let json = json.ok_or_else(|| AccessorError::Missing { pointer: at.pointer.clone() })?;
        let mut ranges = Vec::new();
        if json.get("bufferView").is_some() {
            let view = at.index(json, "bufferView", None)?;
            let (buffer, range) = self.buffer_view_range(view)?;
            let offset = at.index(json, "byteOffset", Some(0))?;
            let count = at.index(json, "count", None)?;
            let kind = json.get("type").and_then(Value::as_str).and_then(AccessorKind::from_name);
            let kind = kind.ok_or_else(|| at.malformed("type", "a type"))?;
            let element = kind.element_size(at.component_type(json)?);
            let stride = self.stride(view)?.unwrap_or(element);
            let bytes = self.buffer_view(view)?;
            at.tail(bytes, offset, count, stride, element)?;
            let length = count.checked_sub(1).map_or(0, |last| last * stride + element);
            ranges.push((buffer, range.start + offset..range.start + offset + length));
        }
        for key in ["indices", "values"] {
            let view = json.get("sparse").and_then(|sparse| sparse.get(key)?.get("bufferView"));
            if let Some(view) = view.and_then(json::index) {
                ranges.push(self.buffer_view_range(view)?);
            }
        }
        Ok(ranges)
    }

    fn sparse(
        &self,
        at: &Place,
        json: &Value,
        elements: usize,
        element: usize,
    ) -> Result<Sparse<'_>, AccessorError> {
        let at = at.below("sparse");
        let count = at.index(json, "count", None)?;
        let part = |key: &str, stride: usize| {
            let at = at.below(key);
            let part = json.get(key).unwrap_or(&Value::Null);
            let view = self.buffer_view(at.index(part, "bufferView", None)?)?;
            at.tail(view, at.index(part, "byteOffset", Some(0))?, count, stride, stride)
        };
        let index_at = at.below("indices");
        let index_type = index_at.component_type(json.get("indices").unwrap_or(&Value::Null))?;
        if !matches!(index_type, ComponentType::U8 | ComponentType::U16 | ComponentType::U32) {
            return Err(index_at.malformed("componentType", "5121, 5123 or 5125"));
        }
        let packed = part("indices", index_type.size())?;
        let values = part("values", element)?;
        let indices: Vec<usize> = packed
            .chunks_exact(index_type.size())
            .take(count)
            .map(|bytes| bytes.iter().rev().fold(0, |word, &byte| word << 8 | usize::from(byte)))
            .collect();
        if indices.iter().any(|&index| index >= elements) {
            return Err(AccessorError::Malformed {
                pointer: index_at.pointer,
                expected: "indices below the accessor's count",
            });
        }
        Ok(Sparse { indices, values })
    }

    /// The view's `byteStride`; 0, which old exporters write for "tightly packed", counts as none.
    fn stride(&self, view: usize) -> Result<Option<usize>, AccessorError> {
        let at = Place { pointer: format!("/bufferViews/{view}") };
        let Some(json) = json::array(&self.json, "bufferViews").get(view) else {
            return Err(AccessorError::Missing { pointer: at.pointer });
        };
        Ok(Some(at.index(json, "byteStride", Some(0))?).filter(|&stride| stride > 0))
    }
}

impl Accessor<'_> {
    /// The accessor's declared `min` and `max` as stored: of normalized accessors the integers, not the fractions.
    /// `None` if either is missing, is not finite, or has the wrong length.
    pub fn min_max(&self) -> Option<(Vec<f64>, Vec<f64>)> {
        let bound = |key| {
            let values = json::numbers(self.json.get(key)?)?;
            (values.len() == self.kind.components() && values.iter().all(|value| value.is_finite()))
                .then_some(values)
        };
        Some((bound("min")?, bound("max")?))
    }

    /// JSON pointer of the accessor.
    pub fn pointer(&self) -> String {
        format!("/accessors/{}", self.index)
    }
}

/// A JSON pointer that makes errors.
struct Place {
    pointer: String,
}

impl Place {
    fn below(&self, key: &str) -> Place {
        Place { pointer: format!("{}/{key}", self.pointer) }
    }

    fn malformed(&self, key: &str, expected: &'static str) -> AccessorError {
        AccessorError::Malformed { pointer: format!("{}/{key}", self.pointer), expected }
    }

    fn index(&self, json: &Value, key: &str, default: Option<usize>) -> Result<usize, AccessorError> {
        let value = match json.get(key) {
            None => default,
            Some(value) => json::index(value),
        };
        value.ok_or_else(|| self.malformed(key, "a non-negative integer"))
    }

    fn component_type(&self, json: &Value) -> Result<ComponentType, AccessorError> {
        let code = json.get("componentType").and_then(json::index);
        code.and_then(ComponentType::from_code)
            .ok_or_else(|| self.malformed("componentType", "5120, 5121, 5122, 5123, 5125 or 5126"))
    }

    /// What follows `offset`, if `count` elements fit there. The last element needs no full stride.
    fn tail<'a>(
        &self,
        view: &'a [u8],
        offset: usize,
        count: usize,
        stride: usize,
        element: usize,
    ) -> Result<&'a [u8], AccessorError> {
        let data = match count.checked_sub(1) {
            None => Some(0),
            Some(last) => last.checked_mul(stride).and_then(|start| start.checked_add(element)),
        };
        let end = data.and_then(|data| data.checked_add(offset));
        if end.is_none_or(|end| end > view.len()) {
            return Err(AccessorError::OutOfBounds {
                pointer: self.pointer.clone(),
                needed: end.map_or(u64::MAX, |end| end as u64),
                available: view.len() as u64,
            });
        }
        Ok(&view[offset..])
    }
}
