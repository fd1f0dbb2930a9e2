//! Accessors as the runtime's decoder wants them: the tables of `EXT_spherical_visibility`.

use super::document::Document;
use serde_json::Value;
use std::borrow::Cow;
use std::collections::BTreeMap;
use svs_runtime::format::Extension;
use svs_runtime::{AccessorSource, AccessorView};
use thiserror::Error;

/// The bytes of the accessors that have been read so far, each once.
#[derive(Debug)]
pub struct DocumentTables<'a> {
    doc: &'a Document,
    accessors: BTreeMap<usize, Stored<'a>>,
    /// Bytes that may still be copied, because they do not lie in the file without gaps: as many as the file's
    /// buffers have, so that many accessors of one interleaved view cannot ask for more memory than that.
    copies_left: usize,
}

#[derive(Debug)]
struct Stored<'a> {
    bytes: Cow<'a, [u8]>,
    component_type: u32,
    components: u32,
    count: usize,
}

/// Why an accessor cannot be a table.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum TableError {
    /// There is no such accessor.
    #[error("Unresolved reference: accessor {0}.")]
    Missing(usize),
    /// The specification forbids to store a table like this.
    #[error("A table must {0}.")]
    Storage(&'static str),
    /// The accessor is broken.
    #[error("The accessor cannot be read: {0}.")]
    Unreadable(String),
}

impl<'a> DocumentTables<'a> {
    /// No table of `doc` yet.
    pub fn new(doc: &'a Document) -> Self {
        let copies_left = doc.buffers.iter().map(Vec::len).sum();
        Self { doc, accessors: BTreeMap::new(), copies_left }
    }

    /// All tables that `extension` names. Those that cannot be read are left out, and the decoder says which it
    /// misses.
    pub fn of_extension(doc: &'a Document, extension: &Extension) -> Self {
        let mut tables = Self::new(doc);
        for index in extension.trees.iter().flat_map(|tree| tree.accessors()) {
            // The error comes again, in the decoder's words.
            let _ = tables.read(index as usize);
        }
        tables
    }

    /// Reads accessor `index`, unless that has been done.
    ///
    /// # Errors
    /// [`TableError`] if it cannot be a table.
    pub fn read(&mut self, index: usize) -> Result<(), TableError> {
        if self.accessors.contains_key(&index) {
            return Ok(());
        }
        let stored = self.open(index)?;
        if let Cow::Owned(copied) = &stored.bytes {
            let left = self.copies_left.checked_sub(copied.len());
            let too_many = || TableError::Unreadable("too much of the file is interleaved".to_owned());
            self.copies_left = left.ok_or_else(too_many)?;
        }
        self.accessors.insert(index, stored);
        Ok(())
    }

    fn open(&self, index: usize) -> Result<Stored<'a>, TableError> {
        let json = self.doc.json.get("accessors").and_then(|accessors| accessors.get(index));
        let json: &Value = json.ok_or(TableError::Missing(index))?;
        if json.get("bufferView").is_none() || json.get("sparse").is_some() {
            return Err(TableError::Storage("have a bufferView and no sparse values"));
        }
        let accessor = self.doc.accessor(index).map_err(|error| TableError::Unreadable(error.to_string()))?;
        if accessor.normalized {
            return Err(TableError::Storage("not be normalized"));
        }
        let matrices = || TableError::Unreadable("it holds matrices".to_owned());
        Ok(Stored {
            bytes: accessor.bytes().ok_or_else(matrices)?,
            component_type: accessor.component_type.code(),
            components: accessor.kind.components() as u32,
            count: accessor.count,
        })
    }
}

impl AccessorSource for DocumentTables<'_> {
    fn accessor(&self, index: usize) -> Option<AccessorView<'_>> {
        let Stored { bytes, component_type, components, count } = self.accessors.get(&index)?;
        let (component_type, components, count) = (*component_type, *components, *count);
        Some(AccessorView { bytes, component_type, components, count })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn document(accessors: &Value) -> Document {
        let json = json!({
            "asset": {"version": "2.0"}, "buffers": [{"byteLength": 8}], "accessors": accessors,
            "bufferViews": [
                {"buffer": 0, "byteLength": 8},
                {"buffer": 0, "byteLength": 8, "byteStride": 2},
            ],
        });
        Document::from_parts(json, Some((0..8).collect())).unwrap()
    }

    #[test]
    fn plain_and_interleaved_tables() {
        let bytes = |view: usize, count: usize| json!({"bufferView": view, "componentType": 5121, "count": count, "type": "SCALAR"});
        let doc = document(&json!([bytes(0, 3), bytes(1, 4), bytes(1, 3), bytes(1, 2)]));
        let mut tables = DocumentTables::new(&doc);
        assert!(tables.accessor(0).is_none());
        for index in [0, 1, 2, 0, 1, 2] {
            assert_eq!(tables.read(index), Ok(()));
        }
        assert_eq!(tables.accessor(0).unwrap().bytes, [0, 1, 2]);
        assert_eq!(tables.accessor(1).unwrap().bytes, [0, 2, 4, 6]);
        // 4 + 3 + 2 bytes of copies are more than the file has.
        assert!(matches!(tables.read(3), Err(TableError::Unreadable(_))));
        assert!(tables.accessor(3).is_none());
    }

    #[test]
    fn what_cannot_be_a_table() {
        let plain = json!({"bufferView": 0, "componentType": 5121, "count": 3, "type": "SCALAR"});
        let with = |key: &str, value: Value| {
            let mut accessor = plain.clone();
            accessor[key] = value;
            accessor
        };
        let doc = document(&json!([
            with("sparse", json!({})), with("normalized", json!(true)), with("count", json!(9)),
            {"componentType": 5121, "count": 3, "type": "SCALAR"},
        ]));
        let mut tables = DocumentTables::new(&doc);
        assert!(matches!(tables.read(0), Err(TableError::Storage(_))));
        assert!(matches!(tables.read(1), Err(TableError::Storage(_))));
        assert!(matches!(tables.read(2), Err(TableError::Unreadable(_))));
        assert!(matches!(tables.read(3), Err(TableError::Storage(_))));
        assert_eq!(tables.read(4), Err(TableError::Missing(4)));
    }
}
