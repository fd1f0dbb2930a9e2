//! Checks `EXT_spherical_visibility` in a document: against its schema, by itself, and against the scene.
//!
//! | Code | Severity | Meaning |
//! | --- | --- | --- |
//! | `EXTENSION_ABSENT` | Information | there is nothing to check |
//! | `UNDECLARED_EXTENSION` | Error | not in `extensionsUsed` |
//! | `EXTENSION_REQUIRED` | Warning | in `extensionsRequired` though it is optional |
//! | `UNSUPPORTED_VERSION`, `NEWER_VERSION` | Error, Information | of another major, of a later minor version |
//! | `TYPE_MISMATCH`, `UNDEFINED_PROPERTY`, `UNSATISFIED_DEPENDENCY`, `VALUE_NOT_IN_LIST`, `VALUE_NOT_IN_RANGE`, `PATTERN_MISMATCH`, `EMPTY_ENTITY`, `DUPLICATE_ELEMENTS`, `ONE_OF_MISMATCH`, `SCHEMA_VIOLATION` | Error | not as the JSON Schema says |
//! | `UNRESOLVED_REFERENCE` | Error | an accessor, scene or anchor that does not exist |
//! | `UNKNOWN_TABLE` | Information | a table semantic that is neither known nor an application's |
//! | `TABLE_STORAGE`, `TABLE_UNREADABLE`, `TABLE_TYPE`, `TABLE_LENGTH`, `TABLES_TOO_LARGE` | Error | a table's accessor is sparse or normalized, broken, of the wrong type or length; all together are too large for the file |
//! | `UNKNOWN_DIRECTION_SET` | Error | no direction set has that name |
//! | `NODE_SUBTREE_INVALID`, `NODE_OBJECTS_INVALID`, `NODE_SPHERE_INVALID` | Error | nodes do not nest; a sphere is not finite |
//! | `OBJECT_ORDER_DUPLICATE` | Error | the same object twice |
//! | `LEVEL_ROW_INDEX_OUT_OF_RANGE`, `LEVEL_ROW_PADDING`, `LEVEL_TOO_LARGE` | Error | levels that cannot be |
//! | `NESTED_CYCLE`, `NESTED_INVALID`, `NESTED_MISPLACED` | Error | a tree within itself; an entry that names what is not there, or twice; an anchor that is not where the outer tree has it |
//! | `PROXY_SUBTREE_INVALID`, `PROXY_OBJECTS_INVALID`, `PROXY_SPHERE_INVALID`, `PROXY_ERROR_INVALID`, `PROXY_DEVIATION_INVALID`, `PROXY_ORIGIN_INVALID`, `PROXY_OBJECT_INVALID` | Error | proxies do not nest; numbers that are not finite, errors that are negative or rise; deviations above the errors; an order that is no permutation |
//! | `PROXY_MESH_USED`, `MESH_LEVEL_USED` | Error | a node draws what stands for others |
//! | `MESH_LEVELS_INVALID`, `MESH_LEVEL_NOT_SIMPLER` | Error | a mesh with two entries, or levels of levels; errors that fall, triangles that do not, deviations out of order |
//! | `TREE_INVALID` | Error | refused by the decoder for another reason |
//! | `SCENE_UNREADABLE` | Warning | the scene has errors of its own, so trees are not checked against it |
//! | `ANCHOR_UNREACHABLE`, `ANCHOR_NOT_INVERTIBLE` | Information, Warning | an anchor no scene shows; one whose tree cannot be used |
//! | `ANCHOR_BELOW_ANCHOR` | Error | an anchor below another one of the same tree |
//! | `OBJECT_COUNT_MISMATCH`, `FINGERPRINT_MISMATCH` | Error | the bake is stale |
//! | `OBJECT_ANIMATED`, `OBJECT_DEFORMS` | Error | an object that must not be in a tree |
//! | `OBJECT_IN_TWO_TREES` | Error | culled twice |
//! | `SPHERE_TOO_SMALL`, `PROXY_SPHERE_TOO_SMALL` | Warning | a sphere does not hold all vertices below it, or the sphere of a proxy below it |

mod against_scene;
mod document;
mod nested;
mod places;
mod proxies;
mod report;
mod schema;
mod spheres;
mod tables;
#[cfg(test)]
mod tests;
mod trees;

pub use report::{Issue, Severity, ValidationReport};

use crate::gltf::Document;

/// JSON pointer of the extension object.
const ROOT: &str = "/extensions/EXT_spherical_visibility";

/// Checks everything the specification says about `EXT_spherical_visibility` in `doc`; nothing else of the document.
///
/// A tree with errors is not looked at further, so repairing one may bring up others. Never fails: what
/// cannot be checked is reported.
pub fn validate(doc: &Document) -> ValidationReport {
    let mut report = ValidationReport::default();
    document::check_declaration(&doc.json, &mut report);
    let Some(extension) = doc.json.pointer(ROOT) else { return report };
    if !document::check_version(extension, &mut report) {
        return report;
    }
    schema::check(extension, &mut report);
    let Some(tables) = tables::read(doc, extension, &mut report) else { return report };
    let trees = trees::decode(extension, &tables, &mut report);
    let mut scenes = places::Scenes::new(doc);
    let placed: Vec<_> = trees
        .into_iter()
        .enumerate()
        .map(|(index, tree)| {
            let tree = tree?;
            let places = scenes.places(tree.placement(), &trees::pointer(index), &mut report);
            Some(places::PlacedTree { at: trees::pointer(index), tree, places })
        })
        .collect();
    against_scene::check(doc, extension, &placed, &mut report);
    nested::check(extension, &placed, &mut report);
    report
}
