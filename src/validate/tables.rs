//! The tables' accessors: is their data stored as it should be? And their bytes, for the decoder.

use super::ROOT;
use super::report::ValidationReport;
use crate::gltf::Document;
use serde_json::Value;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use svs_runtime::{AccessorSource, AccessorView};

/// Together, tables may be so many times as large as the file's buffers: trees may share tables, but a small file
/// must not ask for unbounded work.
const MOST_SHARING: u64 = 16;
/// Bytes of tables that are accepted in any file.
const ALWAYS_ACCEPTED: u64 = 1 << 20;

const KNOWN: [&str; 10] = [
    "NODE_SPHERE",
    "NODE_SUBTREE",
    "NODE_FIRST_OBJECT",
    "NODE_OBJECT_COUNT",
    "OBJECT_ORDER",
    "LEVEL_ROW",
    "LEVEL_ROW_INDEX",
    "IMPORTANCE",
    "extensions",
    "extras",
];

/// Bytes of the accessors that tables are in, each once.
pub(super) struct Tables<'a> {
    accessors: BTreeMap<usize, Stored<'a>>,
}

struct Stored<'a> {
    bytes: Cow<'a, [u8]>,
    component_type: u32,
    components: u32,
    count: usize,
}

impl AccessorSource for Tables<'_> {
    fn accessor(&self, index: usize) -> Option<AccessorView<'_>> {
        let Stored { bytes, component_type, components, count } = self.accessors.get(&index)?;
        let (component_type, components, count) = (*component_type, *components, *count);
        Some(AccessorView { bytes, component_type, components, count })
    }
}

/// Reads all tables of all trees; accessors that cannot be read are reported and left out. `None` if the tables are
/// too large for the file.
pub(super) fn read<'a>(
    doc: &'a Document,
    extension: &Value,
    report: &mut ValidationReport,
) -> Option<Tables<'a>> {
    let mut tables = Tables { accessors: BTreeMap::new() };
    let file: u64 = doc.buffers.iter().map(|buffer| buffer.len() as u64).sum();
    let mut allowed = file.saturating_mul(MOST_SHARING).max(ALWAYS_ACCEPTED);
    let trees = extension["trees"].as_array().map_or(&[][..], Vec::as_slice);
    for (tree, json) in trees.iter().enumerate() {
        let Some(entries) = json["tables"].as_object() else { continue };
        for (name, index) in entries {
            let pointer = || format!("{ROOT}/trees/{tree}/tables/{}", escape(name));
            if !KNOWN.contains(&name.as_str()) {
                if !name.starts_with('_') {
                    let message =
                        format!("{name:?} is not known; semantics of applications start with an underscore.");
                    report.information("UNKNOWN_TABLE", pointer(), message);
                }
                continue;
            }
            let Some(index) = index.as_u64() else { continue };
            let index = usize::try_from(index).unwrap_or(usize::MAX);
            let length = match tables.accessors.entry(index) {
                Entry::Occupied(stored) => stored.get().bytes.len(),
                Entry::Vacant(place) => match open(doc, index) {
                    Ok(stored) => place.insert(stored).bytes.len(),
                    Err((code, message)) => {
                        report.error(code, pointer(), message);
                        continue;
                    }
                },
            };
            let Some(rest) = allowed.checked_sub(length as u64) else {
                let message = "The trees share tables so often that they cannot be checked.".to_owned();
                report.error("TABLES_TOO_LARGE", pointer(), message);
                return None;
            };
            allowed = rest;
        }
    }
    Some(tables)
}

fn open(doc: &Document, index: usize) -> Result<Stored<'_>, (&'static str, String)> {
    let json = doc.json.get("accessors").and_then(|accessors| accessors.get(index));
    let json =
        json.ok_or_else(|| ("UNRESOLVED_REFERENCE", format!("Unresolved reference: accessor {index}.")))?;
    if json.get("bufferView").is_none() || json.get("sparse").is_some() {
        return Err(("TABLE_STORAGE", "A table must have a bufferView and no sparse values.".to_owned()));
    }
    let unreadable = |why: String| ("TABLE_UNREADABLE", format!("The accessor cannot be read: {why}."));
    let accessor = doc.accessor(index).map_err(|error| unreadable(error.to_string()))?;
    if accessor.normalized {
        return Err(("TABLE_STORAGE", "A table must not be normalized.".to_owned()));
    }
    let bytes = accessor.bytes().ok_or_else(|| unreadable("it holds matrices".to_owned()))?;
    let components = accessor.kind.components() as u32;
    Ok(Stored { bytes, component_type: accessor.component_type.code(), components, count: accessor.count })
}

/// One token of a JSON pointer (RFC 6901).
fn escape(name: &str) -> String {
    name.replace('~', "~0").replace('/', "~1")
}
