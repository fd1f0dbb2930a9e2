//! The tables' accessors: is their data stored as it should be? And their bytes, for the decoder.

use super::ROOT;
use super::report::ValidationReport;
use crate::gltf::{Document, DocumentTables, TableError};
use serde_json::Value;
use svs_runtime::AccessorSource;
use svs_runtime::sharing::first_excess;

const KNOWN_OF_PROXIES: [&str; 11] = [
    "PROXY_SPHERE",
    "PROXY_SUBTREE",
    "PROXY_FIRST_OBJECT",
    "PROXY_OBJECT_COUNT",
    "PROXY_OBJECT",
    "PROXY_ERROR",
    "PROXY_DEVIATION",
    "PROXY_MESH",
    "PROXY_ORIGIN",
    "extensions",
    "extras",
];

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

/// Reads all tables of all trees; accessors that cannot be read are reported and left out. `None` if the trees share
/// tables so often that decoding them would take too much memory.
pub(super) fn read<'a>(
    doc: &'a Document,
    extension: &Value,
    report: &mut ValidationReport,
) -> Option<DocumentTables<'a>> {
    let mut tables = DocumentTables::new(doc);
    let mut named = Vec::new();
    let trees = extension["trees"].as_array().map_or(&[][..], Vec::as_slice);
    for (tree, json) in trees.iter().enumerate() {
        let of_tree = (&json["tables"], "", &KNOWN[..]);
        let of_proxies = (&json["proxies"]["tables"], "/proxies", &KNOWN_OF_PROXIES[..]);
        let entries = [of_tree, of_proxies].into_iter().flat_map(|(tables, below, known)| {
            let entries = tables.as_object().into_iter().flatten();
            entries.map(move |(name, index)| (name, index, below, known))
        });
        for (name, index, below, known) in entries {
            let pointer = || pointer(tree, below, name);
            if !known.contains(&name.as_str()) {
                if !name.starts_with('_') {
                    let message =
                        format!("{name:?} is not known; semantics of applications start with an underscore.");
                    report.information("UNKNOWN_TABLE", pointer(), message);
                }
                continue;
            }
            let Some(index) = index.as_u64() else { continue };
            let index = usize::try_from(index).unwrap_or(usize::MAX);
            match tables.read(index) {
                Ok(()) => named.push((pointer(), index)),
                Err(error) => report.error(code(&error), pointer(), error.to_string()),
            }
        }
    }
    if let Some(excess) = first_excess(named.iter().filter_map(|&(_, index)| tables.accessor(index))) {
        let at = std::mem::take(&mut named[excess].0);
        let message = "The trees share tables so often that they cannot be checked.".to_owned();
        report.error("TABLES_TOO_LARGE", at, message);
        return None;
    }
    Some(tables)
}

fn code(error: &TableError) -> &'static str {
    match error {
        TableError::Missing(_) => "UNRESOLVED_REFERENCE",
        TableError::Storage(_) => "TABLE_STORAGE",
        TableError::Unreadable(_) => "TABLE_UNREADABLE",
    }
}

/// JSON pointer (RFC 6901) of a table of a tree, or of what is `below` it.
fn pointer(tree: usize, below: &str, name: &str) -> String {
    format!("{ROOT}/trees/{tree}{below}/tables/{}", name.replace('~', "~0").replace('/', "~1"))
}
