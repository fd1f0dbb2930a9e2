//! The trees by themselves. The runtime's decoder checks them; here its errors get codes and places.

use super::ROOT;
use super::report::{Severity, ValidationReport};
use crate::gltf::DocumentTables;
use serde_json::{Value, json};
use std::collections::HashSet;
use std::sync::Arc;
use svs_runtime::encode::row_stride;
use svs_runtime::{AccessorSource, DecodeError, Tree, TreeError, Visibility};

/// Decodes each tree; `None` for those with errors, which are reported. Of trees that do not fit together there
/// are none: what they hold could not be told apart.
pub(super) fn decode(
    extension: &Value,
    tables: &DocumentTables<'_>,
    report: &mut ValidationReport,
) -> Vec<Option<Arc<Tree>>> {
    let json = extension["trees"].as_array().map_or(&[][..], Vec::as_slice);
    let errors = report.issues.iter().filter(|issue| issue.severity == Severity::Error);
    let reported: HashSet<usize> = errors.filter_map(|issue| tree_of(&issue.pointer)).collect();
    let trees: Vec<Option<Arc<Tree>>> = json
        .iter()
        .enumerate()
        .map(|(index, tree)| {
            let at = pointer(index);
            match decode_one(extension, tree, tables) {
                Ok(decoded) => {
                    check_padding(tree, &decoded, tables, &at, report);
                    Some(decoded)
                }
                Err(error) => {
                    // What is wrong already is not repeated in other words.
                    if !reported.contains(&index) {
                        report_error(&error, index, report);
                    }
                    None
                }
            }
        })
        .collect();
    let fit = trees.iter().any(Option::is_none) || check_together(extension, json, tables, report);
    if fit { trees } else { Vec::new() }
}

/// JSON pointer of a tree.
pub(super) fn pointer(index: usize) -> String {
    format!("{ROOT}/trees/{index}")
}

/// The tree that a pointer leads into.
fn tree_of(pointer: &str) -> Option<usize> {
    pointer.strip_prefix(ROOT)?.strip_prefix("/trees/")?.split('/').next()?.parse().ok()
}

/// One tree, as if it were alone.
fn decode_one(
    extension: &Value,
    tree: &Value,
    tables: &DocumentTables<'_>,
) -> Result<Arc<Tree>, DecodeError> {
    let mut tree = tree.clone();
    if let Some(tree) = tree.as_object_mut() {
        tree.remove("nested");
    }
    let alone = json!({ "version": extension["version"], "trees": [tree] });
    let visibility = Visibility::decode(&alone, tables)?;
    match visibility.trees() {
        [tree] => Ok(Arc::clone(tree)),
        _ => unreachable!("one tree was given"),
    }
}

/// What only shows when all trees are known: whether they nest.
fn check_together(
    extension: &Value,
    json: &[Value],
    tables: &DocumentTables<'_>,
    report: &mut ValidationReport,
) -> bool {
    if json.iter().all(|tree| tree.get("nested").is_none()) {
        return true;
    }
    let trees = json!({ "version": extension["version"], "trees": json });
    let Err(error) = Visibility::decode(&trees, tables) else { return true };
    match error {
        DecodeError::Tree { tree, source: TreeError::Nested { entry, problem } } if is_cyclic(json) => {
            report.error("NESTED_CYCLE", format!("{}/nested/{entry}", pointer(tree)), sentence(problem));
        }
        DecodeError::Tree { tree, .. } => report_error(&error, tree, report),
        _ => report_error(&error, 0, report),
    }
    false
}

/// Whether some tree contains itself, over any number of steps: trees that no remaining tree contains are taken away
/// until nothing changes (Kahn 1962).
fn is_cyclic(json: &[Value]) -> bool {
    let inner: Vec<Vec<usize>> = json
        .iter()
        .map(|tree| {
            let entries = tree["nested"].as_array().map_or(&[][..], Vec::as_slice);
            let trees = entries.iter().filter_map(|entry| entry["tree"].as_u64());
            trees.map(|tree| tree as usize).filter(|&tree| tree < json.len()).collect()
        })
        .collect();
    let mut containers = vec![0usize; json.len()];
    inner.iter().flatten().for_each(|&tree| containers[tree] += 1);
    let mut free: Vec<usize> = (0..json.len()).filter(|&tree| containers[tree] == 0).collect();
    let mut taken = 0;
    while let Some(tree) = free.pop() {
        taken += 1;
        for &tree in &inner[tree] {
            containers[tree] -= 1;
            if containers[tree] == 0 {
                free.push(tree);
            }
        }
    }
    taken < json.len()
}

fn report_error(error: &DecodeError, tree: usize, report: &mut ValidationReport) {
    let (code, place) = match error {
        DecodeError::Tree { source, .. } => place(source),
        _ => ("TREE_INVALID", String::new()),
    };
    let message = match error {
        DecodeError::Tree { source, .. } => source.to_string(),
        other => other.to_string(),
    };
    report.error(code, format!("{}{place}", pointer(tree)), sentence(&message));
}

/// Code of an error and where it is, below the tree.
fn place(error: &TreeError) -> (&'static str, String) {
    let table = |code, table: &str| {
        let of_proxies = if table.starts_with("PROXY_") { "/proxies" } else { "" };
        (code, format!("{of_proxies}/tables/{table}"))
    };
    // Their nodes are proxies.
    if let TreeError::Proxies(error) = error {
        return match &**error {
            TreeError::Subtree { .. } => table("PROXY_SUBTREE_INVALID", "PROXY_SUBTREE"),
            TreeError::ObjectRange { .. } => table("PROXY_OBJECTS_INVALID", "PROXY_FIRST_OBJECT"),
            TreeError::Sphere { .. } => table("PROXY_SPHERE_INVALID", "PROXY_SPHERE"),
            TreeError::ProxyError { .. } => table("PROXY_ERROR_INVALID", "PROXY_ERROR"),
            TreeError::ProxyDeviation { .. } => table("PROXY_DEVIATION_INVALID", "PROXY_DEVIATION"),
            TreeError::ProxyOrigin { .. } => table("PROXY_ORIGIN_INVALID", "PROXY_ORIGIN"),
            TreeError::ProxyOrder { .. } => table("PROXY_OBJECT_INVALID", "PROXY_OBJECT"),
            other => place(other),
        };
    }
    match error {
        TreeError::Placement => ("ONE_OF_MISMATCH", String::new()),
        TreeError::Directions { .. } => ("UNKNOWN_DIRECTION_SET", "/directions".to_owned()),
        TreeError::LevelBits { .. } => ("VALUE_NOT_IN_LIST", "/levelBits".to_owned()),
        TreeError::ImportanceArea => ("VALUE_NOT_IN_RANGE", "/importanceArea".to_owned()),
        TreeError::Quality => ("VALUE_NOT_IN_RANGE", "/recommended/quality".to_owned()),
        TreeError::Fingerprint => ("PATTERN_MISMATCH", "/fingerprint/hash".to_owned()),
        TreeError::TableMissing { .. } => ("UNSATISFIED_DEPENDENCY", "/tables".to_owned()),
        TreeError::Accessor { table: name, .. } => table("TABLE_UNREADABLE", name),
        TreeError::AccessorType { table: name, .. } => table("TABLE_TYPE", name),
        TreeError::TableLength { table: name, .. } => table("TABLE_LENGTH", name),
        TreeError::Subtree { .. } => table("NODE_SUBTREE_INVALID", "NODE_SUBTREE"),
        TreeError::ObjectRange { .. } => table("NODE_OBJECTS_INVALID", "NODE_FIRST_OBJECT"),
        TreeError::Sphere { .. } => table("NODE_SPHERE_INVALID", "NODE_SPHERE"),
        TreeError::Order { .. } => table("OBJECT_ORDER_DUPLICATE", "OBJECT_ORDER"),
        TreeError::Row { .. } => table("LEVEL_ROW_INDEX_OUT_OF_RANGE", "LEVEL_ROW_INDEX"),
        TreeError::Level { .. } => table("LEVEL_TOO_LARGE", "LEVEL_ROW"),
        TreeError::Nested { entry, .. } => ("NESTED_INVALID", format!("/nested/{entry}")),
        _ => ("TREE_INVALID", String::new()),
    }
}

fn sentence(message: &str) -> String {
    let mut chars = message.chars();
    let first = chars.next().map(char::to_uppercase);
    first.into_iter().flatten().chain(chars).chain(['.']).collect()
}

/// The unused bits at the end of each row must be zero; decoders do not care.
fn check_padding(
    json: &Value,
    tree: &Tree,
    tables: &DocumentTables<'_>,
    at: &str,
    report: &mut ValidationReport,
) {
    let rows = json["tables"]["LEVEL_ROW"].as_u64().and_then(|index| tables.accessor(index as usize));
    let (Some(rows), Some(bits)) = (rows, json["levelBits"].as_u64()) else { return };
    let directions = tree.direction_set().len();
    let used = directions * bits as usize % 8;
    let stride = row_stride(directions, bits as u8);
    let dirty = rows.bytes.chunks_exact(stride).position(|row| used != 0 && row[stride - 1] >> used != 0);
    if let Some(row) = dirty {
        let message = format!("The unused bits at the end of row {row} are not zero.");
        report.error("LEVEL_ROW_PADDING", format!("{at}/tables/LEVEL_ROW"), message);
    }
}
