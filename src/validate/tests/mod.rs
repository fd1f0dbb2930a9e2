//! One document for each code, and clean ones.

mod properties;
mod proxies;
mod sample;
mod specification;

use super::*;
use sample::{Sample, print};
use serde_json::json;

const TREE: &str = "/extensions/EXT_spherical_visibility/trees/0";

#[test]
fn the_examples_are_clean() {
    assert_eq!(Sample::example().validate().issues, []);
    assert_eq!(Sample::nested().validate().issues, []);
    assert_eq!(Sample::with_proxies().validate().issues, []);
}

#[test]
fn declaration() {
    let mut sample = Sample::example();
    sample.json["extensionsRequired"] = json!(["EXT_spherical_visibility"]);
    sample.expect(Severity::Warning, "EXTENSION_REQUIRED", "/extensionsRequired/0");

    let mut sample = Sample::example();
    sample.json.as_object_mut().unwrap().remove("extensionsUsed");
    sample.expect(Severity::Error, "UNDECLARED_EXTENSION", ROOT);

    let mut sample = Sample::example();
    sample.json.as_object_mut().unwrap().remove("extensions");
    sample.expect(Severity::Information, "EXTENSION_ABSENT", "/extensionsUsed/0");
}

#[test]
fn versions() {
    let mut sample = Sample::example();
    sample.extension()["version"] = json!("2.0");
    sample.expect(Severity::Error, "UNSUPPORTED_VERSION", &format!("{ROOT}/version"));
    sample.extension()["version"] = json!("1.7");
    sample.expect(Severity::Information, "NEWER_VERSION", &format!("{ROOT}/version"));
}

#[test]
fn schema_errors_are_reported_once() {
    let mut sample = Sample::example();
    sample.tree(0)["levelBits"] = json!(3);
    sample.expect_error("VALUE_NOT_IN_LIST", "/levelBits");
    sample.tree(0)["levelBits"] = json!("two");
    assert!(sample.validate().has_errors());
    *sample.extension() = json!(null);
    assert!(sample.validate().has_errors());
    *sample.extension() = json!({"version": "1.0", "trees": [null, 3, {"tables": 7}]});
    assert!(sample.validate().has_errors());
}

#[test]
fn unknown_direction_set() {
    let mut sample = Sample::example();
    sample.tree(0)["directions"] = json!("teapot-3");
    sample.expect_error("UNKNOWN_DIRECTION_SET", "/directions");
}

#[test]
fn unresolved_references() {
    let mut sample = Sample::example();
    sample.tree(0)["tables"]["IMPORTANCE"] = json!(99);
    sample.expect_error("UNRESOLVED_REFERENCE", "/tables/IMPORTANCE");

    let mut sample = Sample::example();
    sample.tree(0)["scene"] = json!(1);
    sample.expect_error("UNRESOLVED_REFERENCE", "/scene");

    let mut sample = Sample::nested();
    sample.tree(1)["anchors"] = json!([99]);
    sample.expect(
        Severity::Error,
        "UNRESOLVED_REFERENCE",
        "/extensions/EXT_spherical_visibility/trees/1/anchors/0",
    );
}

#[test]
fn tables() {
    let mut sample = Sample::example();
    sample.bytes(0, "NODE_COLOUR", &[1, 2]);
    sample.bytes(0, "_COLOUR", &[1, 2]);
    sample.expect(Severity::Information, "UNKNOWN_TABLE", &format!("{TREE}/tables/NODE_COLOUR"));

    // A misspelt name is information; that the table is missing must be said all the same.
    let mut sample = Sample::example();
    let tables = sample.tree(0)["tables"].as_object_mut().unwrap();
    let index = tables.remove("LEVEL_ROW_INDEX").unwrap();
    tables.insert("LEVEL_ROWS_INDEX".to_owned(), index);
    let codes = sample.codes();
    assert_eq!(codes, ["UNKNOWN_TABLE", "TABLE_LENGTH"]);

    let mut sample = Sample::example();
    sample.table("IMPORTANCE")["normalized"] = json!(true);
    sample.expect_error("TABLE_STORAGE", "/tables/IMPORTANCE");

    let mut sample = Sample::example();
    sample.table("LEVEL_ROW").as_object_mut().unwrap().remove("bufferView");
    sample.expect_error("TABLE_STORAGE", "/tables/LEVEL_ROW");

    let mut sample = Sample::example();
    sample.table("LEVEL_ROW")["count"] = json!(7);
    sample.expect_error("TABLE_UNREADABLE", "/tables/LEVEL_ROW");

    let mut sample = Sample::example();
    sample.table("LEVEL_ROW")["componentType"] = json!(5120);
    sample.expect_error("TABLE_TYPE", "/tables/LEVEL_ROW");

    let mut sample = Sample::example();
    sample.table("NODE_SPHERE")["type"] = json!("VEC2");
    sample.expect_error("TABLE_TYPE", "/tables/NODE_SPHERE");

    let mut sample = Sample::example();
    sample.bytes(0, "NODE_SUBTREE", &[3, 2, 1]);
    sample.expect_error("TABLE_LENGTH", "/tables/NODE_SUBTREE");

    // A row has two bytes.
    let mut sample = Sample::example();
    sample.bytes(0, "LEVEL_ROW", &[0x55, 0x05, 0x11, 0x01, 0x92]);
    sample.expect_error("TABLE_LENGTH", "/tables/LEVEL_ROW");

    let mut sample = Sample::example();
    sample.bytes(0, "IMPORTANCE", &[0; 5]);
    sample.expect_error("TABLE_LENGTH", "/tables/IMPORTANCE");

    let mut sample = Sample::example();
    sample.tree(0)["tables"].as_object_mut().unwrap().remove("LEVEL_ROW");
    let report = sample.validate();
    assert!(report.issues.iter().all(|issue| issue.code == "UNSATISFIED_DEPENDENCY"), "{report:#?}");
    assert!(report.has_errors());
}

#[test]
fn a_small_file_cannot_ask_for_endless_work() {
    let mut sample = Sample::example();
    sample.bytes(0, "_BIG", &vec![0; 1 << 17]);
    let tree = sample.tree(0).clone();
    let index = tree["tables"]["_BIG"].clone();
    let trees = (0..100)
        .map(|_| {
            let mut tree = tree.clone();
            tree["tables"]["LEVEL_ROW"] = index.clone();
            tree
        })
        .collect();
    sample.extension()["trees"] = serde_json::Value::Array(trees);
    let report = sample.validate();
    assert_eq!(report.issues.last().unwrap().code, "TABLES_TOO_LARGE");
}

#[test]
fn nodes_that_do_not_nest() {
    for subtree in [[0, 1], [3, 1], [2, 2], [2, 0]] {
        let mut sample = Sample::example();
        sample.bytes(0, "NODE_SUBTREE", &subtree);
        sample.expect_error("NODE_SUBTREE_INVALID", "/tables/NODE_SUBTREE");
    }
    // Beyond the parent's; not up to its end; beyond the tree's.
    for (first, count) in [([0, 2], [4, 3]), ([0, 1], [4, 2]), ([1, 2], [4, 2]), ([2, 0], [2, 2])] {
        let mut sample = Sample::example();
        sample.bytes(0, "NODE_FIRST_OBJECT", &first);
        sample.bytes(0, "NODE_OBJECT_COUNT", &count);
        sample.expect_error("NODE_OBJECTS_INVALID", "/tables/NODE_FIRST_OBJECT");
    }
    for bad in [[0.0, 0.0, f32::NAN, 3.0], [0.0, 0.0, 0.0, -1.0]] {
        let mut sample = Sample::example();
        sample.spheres(0, &[bad, [4.0, 0.5, 0.0, 1.5]]);
        sample.expect_error("NODE_SPHERE_INVALID", "/tables/NODE_SPHERE");
    }
}

#[test]
fn orders_and_levels() {
    let mut sample = Sample::example();
    sample.bytes(0, "OBJECT_ORDER", &[0, 1, 2, 2]);
    sample.expect_error("OBJECT_ORDER_DUPLICATE", "/tables/OBJECT_ORDER");

    let mut sample = Sample::example();
    sample.bytes(0, "LEVEL_ROW_INDEX", &[0, 1, 2, 3]);
    sample.expect_error("LEVEL_ROW_INDEX_OUT_OF_RANGE", "/tables/LEVEL_ROW_INDEX");

    let mut sample = Sample::example();
    sample.bytes(0, "LEVEL_ROW", &[0x55, 0x05, 0x11, 0x01, 0x92, 0x14]);
    sample.expect_error("LEVEL_ROW_PADDING", "/tables/LEVEL_ROW");

    // Object 0 hangs on the root: level 2 is too much.
    let mut sample = Sample::example();
    sample.bytes(0, "LEVEL_ROW", &[0x56, 0x05, 0x11, 0x01, 0x92, 0x04]);
    sample.expect_error("LEVEL_TOO_LARGE", "/tables/LEVEL_ROW");
}

#[test]
fn stale_bakes() {
    // A second triangle for everything.
    let mut sample = Sample::example();
    sample.json["meshes"][0]["primitives"] =
        json!([{"attributes": {"POSITION": 0}}, {"attributes": {"POSITION": 0}}]);
    sample.expect_error("FINGERPRINT_MISMATCH", "/fingerprint");

    // An object is gone.
    let mut sample = Sample::example();
    sample.json["nodes"][3]["children"] = json!([4]);
    sample.expect_error("OBJECT_COUNT_MISMATCH", "/scene");

    // As many objects, but the order names one that is not there.
    let mut sample = Sample::example();
    sample.bytes(0, "OBJECT_ORDER", &[0, 1, 2, 9]);
    sample.expect_error("OBJECT_COUNT_MISMATCH", "/scene");

    // A tree without tables does not say how many objects it can have.
    let mut sample = Sample::example();
    sample.tree(0)["tables"] = json!({});
    sample.tree(0)["objectCount"] = json!(u32::MAX);
    sample.expect_error("OBJECT_COUNT_MISMATCH", "/scene");

    // Other objects than those that were baked, although as many triangles.
    let mut sample = Sample::example();
    sample.tree(0)["fingerprint"]["hash"] = json!("0123456789abcdef");
    sample.expect_error("FINGERPRINT_MISMATCH", "/fingerprint");
}

#[test]
fn objects_that_must_not_be_in_a_tree() {
    let mut sample = Sample::example();
    sample.json["animations"] = json!([{"samplers": [{"input": 0, "output": 0}], "channels": [{"sampler": 0, "target": {"node": 3, "path": "translation"}}]}]);
    sample.expect(Severity::Error, "OBJECT_ANIMATED", "/nodes/4");

    let mut sample = Sample::example();
    sample.json["nodes"][2]["skin"] = json!(0);
    sample.json["skins"] = json!([{"joints": [1]}]);
    sample.expect(Severity::Error, "OBJECT_DEFORMS", "/nodes/2");

    let mut sample = Sample::example();
    let twice = sample.tree(0).clone();
    sample.extension()["trees"] = json!([twice, twice]);
    sample.expect(Severity::Error, "OBJECT_IN_TWO_TREES", "/nodes/1");
}

#[test]
fn spheres_that_do_not_hold_their_objects() {
    // The farthest vertex of node 1 is at (5, 0, 0).
    let mut sample = Sample::example();
    sample.spheres(0, &[[2.5, 0.5, 0.0, 3.0], [4.0, 0.0, 0.0, 0.99]]);
    sample.expect(Severity::Warning, "SPHERE_TOO_SMALL", &format!("{TREE}/tables/NODE_SPHERE"));

    // A tight sphere is not too small.
    let mut sample = Sample::example();
    sample.spheres(0, &[[2.5, 0.5, 0.0, 3.0], [4.0, 0.5, 0.0, 1.25f32.sqrt()]]);
    assert_eq!(sample.validate().issues, []);
}

#[test]
fn anchors() {
    // Nodes 1 and 3 do not hold the same: tree 1 has two objects.
    let mut sample = Sample::nested();
    sample.tree(1)["anchors"] = json!([3, 1]);
    sample.expect(
        Severity::Error,
        "OBJECT_COUNT_MISMATCH",
        "/extensions/EXT_spherical_visibility/trees/1/anchors/1",
    );

    let mut sample = Sample::nested();
    sample.tree(1)["anchors"] = json!([3, 0]);
    let codes = sample.codes();
    assert!(codes.contains(&"ANCHOR_BELOW_ANCHOR"), "{codes:?}");

    let mut sample = Sample::nested();
    sample.json["nodes"][0]["children"] = json!([1, 2]);
    let codes = sample.codes();
    assert!(codes.contains(&"ANCHOR_UNREACHABLE"), "{codes:?}");

    let mut sample = Sample::nested();
    sample.json["nodes"][3]["scale"] = json!([1, 0, 1]);
    let codes = sample.codes();
    assert!(codes.contains(&"ANCHOR_NOT_INVERTIBLE"), "{codes:?}");
}

#[test]
fn an_anchor_may_move_but_not_within_another_tree() {
    let animation = |node: usize| {
        json!([{"samplers": [{"input": 0, "output": 0}],
            "channels": [{"sampler": 0, "target": {"node": node, "path": "rotation"}}]}])
    };
    let mut sample = Sample::nested();
    sample.json["animations"] = animation(3);
    sample.expect_error("NESTED_MISPLACED", "/nested/0");

    let mut sample = Sample::nested();
    let inner = sample.tree(1).clone();
    sample.extension()["trees"] = json!([inner]);
    sample.json["animations"] = animation(3);
    assert_eq!(sample.validate().issues, []);
}

#[test]
fn nested_trees() {
    let mut sample = Sample::nested();
    sample.tree(0)["nested"][0]["tree"] = json!(7);
    sample.expect_error("NESTED_INVALID", "/nested/0");

    let mut sample = Sample::nested();
    sample.tree(0)["nested"][0]["object"] = json!(3);
    sample.expect_error("NESTED_INVALID", "/nested/0");

    // Object 1 is node 2; the first object below node 3 is node 4.
    let mut sample = Sample::nested();
    sample.tree(0)["nested"][0]["object"] = json!(1);
    sample.tree(0)["fingerprint"] = print(&[(0, 1), (1, 2), (2, 1)]);
    let codes = sample.codes();
    assert!(codes.contains(&"NESTED_MISPLACED"), "{codes:?}");

    let mut sample = Sample::nested();
    sample.tree(1)["nested"] = json!([{"object": 0, "tree": 1, "anchor": 0}]);
    sample.tree(0).as_object_mut().unwrap().remove("nested");
    sample.expect(Severity::Error, "NESTED_CYCLE", "/extensions/EXT_spherical_visibility/trees/1/nested/0");
}

#[test]
fn broken_scenes_are_a_warning() {
    let mut sample = Sample::example();
    sample.json["nodes"][5]["children"] = json!([0]);
    sample.expect(Severity::Warning, "SCENE_UNREADABLE", "/scenes/0");
}
