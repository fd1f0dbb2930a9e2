//! Proxies and mesh levels.

use super::sample::Sample;
use crate::validate::{ROOT, Severity};
use serde_json::json;

#[track_caller]
fn expect_table(sample: &Sample, code: &str, table: &str) {
    sample.expect_error(code, &format!("/proxies/tables/{table}"));
}

fn broken(change: impl Fn(&mut Sample)) -> Sample {
    let mut sample = Sample::with_proxies();
    change(&mut sample);
    sample
}

#[test]
fn tables_that_cannot_be() {
    for subtree in [[2, 1, 1], [3, 2, 2], [3, 0, 1]] {
        let sample = broken(|s| s.proxy_bytes("PROXY_SUBTREE", &subtree));
        assert!(
            ["PROXY_SUBTREE_INVALID", "PROXY_OBJECTS_INVALID"].contains(&sample.codes()[0]),
            "{subtree:?}: {:?}",
            sample.codes()
        );
    }
    let sample = broken(|s| s.proxy_bytes("PROXY_OBJECT_COUNT", &[4, 2, 1]));
    expect_table(&sample, "PROXY_OBJECTS_INVALID", "PROXY_FIRST_OBJECT");
    for error in [[0.5, 0.75, 0.5], [-0.5, -0.5, -0.5], [f32::NAN, 0.0, 0.0]] {
        let sample = broken(|s| s.proxy_floats("PROXY_ERROR", "SCALAR", &error));
        expect_table(&sample, "PROXY_ERROR_INVALID", "PROXY_ERROR");
    }
    let origins = [0.0, 0.0, 0.0, f32::INFINITY, 0.0, 0.0, 0.0, 0.0, 0.0];
    let sample = broken(|s| s.proxy_floats("PROXY_ORIGIN", "VEC3", &origins));
    expect_table(&sample, "PROXY_ORIGIN_INVALID", "PROXY_ORIGIN");
    let sample = broken(|s| s.proxy_floats("PROXY_SPHERE", "VEC4", &[-1.0; 12]));
    expect_table(&sample, "PROXY_SPHERE_INVALID", "PROXY_SPHERE");
    for order in [[0, 1, 2, 2], [0, 1, 2, 4]] {
        let sample = broken(|s| s.proxy_bytes("PROXY_OBJECT", &order));
        expect_table(&sample, "PROXY_OBJECT_INVALID", "PROXY_OBJECT");
    }
    let sample = broken(|s| s.proxy_bytes("PROXY_OBJECT", &[1, 0]));
    expect_table(&sample, "TABLE_LENGTH", "PROXY_OBJECT");
    let sample = broken(|s| s.proxy_bytes("PROXY_ERROR", &[0, 0, 0]));
    expect_table(&sample, "TABLE_TYPE", "PROXY_ERROR");
    let sample = broken(|s| s.tree(0)["proxies"]["tables"]["PROXY_MESH"] = json!(99));
    expect_table(&sample, "UNRESOLVED_REFERENCE", "PROXY_MESH");
    let sample = broken(|s| s.proxy_bytes("PROXY_COLOUR", &[1]));
    let at = format!("{ROOT}/trees/0/proxies/tables/PROXY_COLOUR");
    sample.expect(Severity::Information, "UNKNOWN_TABLE", &at);
    let sample = broken(|s| {
        s.tree(0)["proxies"]["tables"].as_object_mut().unwrap().remove("PROXY_MESH");
    });
    sample.expect_error("UNDEFINED_PROPERTY", "/proxies/tables");
}

#[test]
fn meshes_of_proxies() {
    let sample = broken(|s| s.proxy_bytes("PROXY_MESH", &[1, 1, 2]));
    expect_table(&sample, "UNRESOLVED_REFERENCE", "PROXY_MESH");
    let sample = broken(|s| s.proxy_bytes("PROXY_MESH", &[1, 1, 0]));
    expect_table(&sample, "PROXY_MESH_USED", "PROXY_MESH");
}

#[test]
fn spheres_of_proxies() {
    let at = format!("{ROOT}/trees/0/proxies/tables/PROXY_SPHERE");
    let sphere = |spheres: [[f32; 4]; 3]| {
        broken(|s| s.proxy_floats("PROXY_SPHERE", "VEC4", &spheres.concat())).validate()
    };
    let (root, second, third) = ([2.5, 0.5, 0.0, 3.0], [4.0, 0.5, 0.0, 1.25], [1.0, 0.5, 0.0, 1.25]);
    for (what, spheres) in [
        ("objects", [root, [3.6, 0.5, 0.0, 1.25], third]),
        ("spheres below", [[2.5, 0.5, 0.0, 2.6], second, [1.0, 0.5, 0.0, 1.25]]),
    ] {
        let report = sphere(spheres);
        assert_eq!(report.issues.len(), 1, "{report:#?}");
        let issue = &report.issues[0];
        assert_eq!((issue.code, &issue.pointer), ("PROXY_SPHERE_TOO_SMALL", &at));
        assert!(issue.message.contains(what), "{issue}");
    }
    // Its own vertices: moved out of the sphere by its origin.
    let origins = [[1.0, 0.0, 0.0], [3.0, 0.0, 0.0], [2.0, 0.0, 0.0]].concat();
    let report = broken(|s| s.proxy_floats("PROXY_ORIGIN", "VEC3", &origins)).validate();
    assert!(report.issues[0].message.contains("vertices of the proxies"), "{report:#?}");
}

#[test]
fn mesh_levels() {
    let expect = |level: serde_json::Value, code: &str, below: &str| {
        let sample = broken(|s| s.extension()["meshLevels"][0]["levels"] = json!([level]));
        sample.expect(Severity::Error, code, &format!("{ROOT}/meshLevels/0/levels/0/{below}"));
    };
    expect(json!({"mesh": 7, "error": 0.5}), "UNRESOLVED_REFERENCE", "mesh");
    expect(json!({"mesh": 1, "error": 1e300}), "MESH_LEVELS_INVALID", "error");
    for deviation in [[0.2, 0.1, 0.0], [0.1, 0.6, 0.0], [0.1, 0.2, 1.5]] {
        let level = json!({"mesh": 1, "error": 0.5, "deviation": deviation});
        expect(level, "MESH_LEVELS_INVALID", "deviation");
    }
    let sample = broken(|s| s.json["meshes"][1] = s.json["meshes"][0].clone());
    let at = format!("{ROOT}/meshLevels/0/levels/0/mesh");
    sample.expect(Severity::Error, "MESH_LEVEL_NOT_SIMPLER", &at);
    let sample = broken(|s| {
        let second = json!({"mesh": 1, "error": 0.25});
        s.extension()["meshLevels"][0]["levels"].as_array_mut().unwrap().push(second);
    });
    assert_eq!(sample.codes(), ["MESH_LEVELS_INVALID", "MESH_LEVEL_NOT_SIMPLER"]);
    let sample = broken(|s| {
        let again = s.extension()["meshLevels"][0].clone();
        s.extension()["meshLevels"].as_array_mut().unwrap().push(again);
    });
    sample.expect(Severity::Error, "MESH_LEVELS_INVALID", &format!("{ROOT}/meshLevels/1/mesh"));
    let with_node = |shown: bool| {
        broken(|s| {
            let nodes = s.json["nodes"].as_array_mut().unwrap();
            let node = nodes.len();
            nodes.push(json!({"mesh": 1}));
            if shown {
                s.json["scenes"][0]["nodes"].as_array_mut().unwrap().push(node.into());
            }
        })
    };
    assert!(with_node(false).codes().is_empty(), "MSFT_lod names such nodes");
    let sample = with_node(true);
    let codes = sample.codes();
    assert!(codes.contains(&"MESH_LEVEL_USED") && codes.contains(&"PROXY_MESH_USED"), "{codes:?}");
}
