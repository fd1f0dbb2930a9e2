//! Small documents with the extension, made by hand, and ways to break them.

use crate::gltf::Document;
use crate::validate::{Severity, ValidationReport, validate};
use serde_json::{Value, json};
use svs_runtime::encode::{fingerprint, format_hash};

/// A document under construction: JSON, and the bytes of its buffer.
#[derive(Clone)]
pub(super) struct Sample {
    pub(super) json: Value,
    pub(super) bin: Vec<u8>,
}

impl Sample {
    /// One triangle, drawn by nodes 1, 2, 4 and 5; nodes 4 and 5 are below node 3, all below node 0. No extension.
    fn scene() -> Self {
        let mesh = |x: f64| json!({"mesh": 0, "translation": [x, 0, 0]});
        let json = json!({
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"children": [1, 2, 3]}, mesh(0.0), mesh(1.0), {"children": [4, 5]}, mesh(3.0), mesh(4.0)],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "buffers": [{"byteLength": 0}], "bufferViews": [], "accessors": [],
        });
        let mut sample = Self { json, bin: Vec::new() };
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0f32]];
        let positions = floats(corners.as_flattened());
        sample.accessor(&positions, 5126, "VEC3");
        sample.json["accessors"][0]["min"] = json!([0, 0, 0]);
        sample.json["accessors"][0]["max"] = json!([1, 1, 0]);
        sample
    }

    /// The example of the specification, with two spheres.
    pub(super) fn example() -> Self {
        let mut sample = Self::scene();
        sample.json["extensionsUsed"] = json!(["EXT_spherical_visibility"]);
        sample.json["extensions"]["EXT_spherical_visibility"] = json!({
            "version": "1.0",
            "trees": [{
                "scene": 0,
                "directions": "octahedron",
                "objectCount": 4,
                "levelBits": 2,
                "importanceArea": 4.0,
                "tables": {},
                "fingerprint": print(&[(0, 1), (1, 1), (2, 1), (3, 1)]),
            }],
        });
        sample.spheres(0, &[[2.5, 0.5, 0.0, 3.0], [4.0, 0.5, 0.0, 1.5]]);
        sample.bytes(0, "NODE_SUBTREE", &[2, 1]);
        sample.bytes(0, "NODE_FIRST_OBJECT", &[0, 2]);
        sample.bytes(0, "NODE_OBJECT_COUNT", &[4, 2]);
        sample.bytes(0, "LEVEL_ROW", &[0x55, 0x05, 0x11, 0x01, 0x92, 0x04]);
        sample.bytes(0, "LEVEL_ROW_INDEX", &[0, 1, 2, 2]);
        sample.bytes(0, "IMPORTANCE", &[0x00, 0x08, 0x10, 0x20, 0x18, 0x30]);
        sample
    }

    /// Tree 0 on the scene holds nodes 1 and 2 and, as object 2, tree 1, which hangs on node 3 and holds nodes 4 and 5.
    pub(super) fn nested() -> Self {
        let mut sample = Self::scene();
        let tree = json!({"directions": "octahedron", "levelBits": 1, "importanceArea": 1.0, "tables": {}});
        let (mut outer, mut inner) = (tree.clone(), tree);
        outer["scene"] = json!(0);
        outer["objectCount"] = json!(3);
        outer["nested"] = json!([{"object": 2, "tree": 1, "anchor": 0}]);
        outer["fingerprint"] = print(&[(0, 1), (1, 1), (2, 2)]);
        inner["anchors"] = json!([3]);
        inner["objectCount"] = json!(2);
        inner["fingerprint"] = print(&[(0, 1), (1, 1)]);
        sample.json["extensionsUsed"] = json!(["EXT_spherical_visibility"]);
        sample.json["extensions"]["EXT_spherical_visibility"] =
            json!({"version": "1.0", "trees": [outer, inner]});
        for (tree, sphere, objects) in [(0, [2.5, 0.5, 0.0, 3.0], 3u8), (1, [4.0, 0.5, 0.0, 1.5], 2)] {
            sample.spheres(tree, &[sphere]);
            sample.bytes(tree, "NODE_SUBTREE", &[1]);
            sample.bytes(tree, "NODE_FIRST_OBJECT", &[0]);
            sample.bytes(tree, "NODE_OBJECT_COUNT", &[objects]);
            sample.bytes(tree, "LEVEL_ROW", &vec![0x3F; usize::from(objects)]);
            sample.bytes(tree, "IMPORTANCE", &vec![0; usize::from(objects)]);
        }
        sample
    }

    /// The example with mesh 0 simplified to mesh 1, and with three proxies of mesh 1: a root, and below it one for objects
    /// 0 and 1 and one for objects 2 and 3, in reverse order.
    pub(super) fn with_proxies() -> Self {
        let mut sample = Self::example();
        let two = json!([{"attributes": {"POSITION": 0}}, {"attributes": {"POSITION": 0}}]);
        sample.json["meshes"] =
            json!([{"primitives": two}, {"primitives": [{"attributes": {"POSITION": 0}}]}]);
        sample.tree(0)["fingerprint"] = print(&[(0, 2), (1, 2), (2, 2), (3, 2)]);
        sample.extension()["meshLevels"] = json!([{"mesh": 0, "levels": [{"mesh": 1, "error": 0.5}]}]);
        sample.tree(0)["proxies"] = json!({"visible": true, "tables": {}});
        sample.proxy_floats(
            "PROXY_SPHERE",
            "VEC4",
            &[[2.5, 0.5, 0.0, 3.0], [4.0, 0.5, 0.0, 1.25], [1.0, 0.5, 0.0, 1.25]].concat(),
        );
        sample.proxy_floats("PROXY_ERROR", "SCALAR", &[0.5, 0.25, 0.5]);
        sample.proxy_floats("PROXY_ORIGIN", "VEC3", &[[1.0, 0.0, 0.0], [3.0, 0.0, 0.0], [0.0; 3]].concat());
        sample.proxy_bytes("PROXY_SUBTREE", &[3, 1, 1]);
        sample.proxy_bytes("PROXY_FIRST_OBJECT", &[0, 0, 2]);
        sample.proxy_bytes("PROXY_OBJECT_COUNT", &[4, 2, 2]);
        sample.proxy_bytes("PROXY_OBJECT", &[3, 2, 1, 0]);
        sample.proxy_bytes("PROXY_MESH", &[1, 1, 1]);
        sample
    }

    pub(super) fn proxy_floats(&mut self, name: &str, kind: &str, values: &[f32]) {
        let index = self.accessor(&floats(values), 5126, kind);
        self.tree(0)["proxies"]["tables"][name] = json!(index);
    }

    pub(super) fn proxy_bytes(&mut self, name: &str, values: &[u8]) {
        let index = self.accessor(values, 5121, "SCALAR");
        self.tree(0)["proxies"]["tables"][name] = json!(index);
    }

    pub(super) fn extension(&mut self) -> &mut Value {
        &mut self.json["extensions"]["EXT_spherical_visibility"]
    }

    pub(super) fn tree(&mut self, tree: usize) -> &mut Value {
        &mut self.extension()["trees"][tree]
    }

    /// Makes a table of unsigned bytes.
    pub(super) fn bytes(&mut self, tree: usize, name: &str, values: &[u8]) {
        let index = self.accessor(values, 5121, "SCALAR");
        self.tree(tree)["tables"][name] = json!(index);
    }

    pub(super) fn spheres(&mut self, tree: usize, spheres: &[[f32; 4]]) {
        let index = self.accessor(&floats(spheres.as_flattened()), 5126, "VEC4");
        self.tree(tree)["tables"]["NODE_SPHERE"] = json!(index);
    }

    /// The accessor object of a table.
    pub(super) fn table(&mut self, name: &str) -> &mut Value {
        let index = self.tree(0)["tables"][name].as_u64().unwrap() as usize;
        &mut self.json["accessors"][index]
    }

    fn accessor(&mut self, bytes: &[u8], component_type: u32, kind: &str) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let components = match kind {
            "SCALAR" => 1,
            "VEC3" => 3,
            _ => 4,
        };
        let size = if component_type == 5121 { 1 } else { 4 };
        let views = self.json["bufferViews"].as_array_mut().unwrap();
        let (view, offset) = (views.len(), self.bin.len());
        views.push(json!({"buffer": 0, "byteOffset": offset, "byteLength": bytes.len()}));
        self.bin.extend_from_slice(bytes);
        self.json["buffers"][0]["byteLength"] = json!(self.bin.len());
        let accessors = self.json["accessors"].as_array_mut().unwrap();
        let count = bytes.len() / (components * size);
        accessors
            .push(json!({"bufferView": view, "componentType": component_type, "count": count, "type": kind}));
        accessors.len() - 1
    }

    pub(super) fn validate(&self) -> ValidationReport {
        validate(&Document::from_parts(self.json.clone(), Some(self.bin.clone())).unwrap())
    }

    pub(super) fn codes(&self) -> Vec<&'static str> {
        self.validate().issues.iter().map(|issue| issue.code).collect()
    }

    /// Expects exactly one issue.
    #[track_caller]
    pub(super) fn expect(&self, severity: Severity, code: &str, pointer: &str) {
        let report = self.validate();
        let found: Vec<(Severity, &str, &str)> =
            report.issues.iter().map(|issue| (issue.severity, issue.code, issue.pointer.as_str())).collect();
        assert_eq!(found, [(severity, code, pointer)], "{report:#?}");
        assert_eq!(report.has_errors(), severity == Severity::Error);
    }

    /// Expects exactly one error, below tree 0.
    #[track_caller]
    pub(super) fn expect_error(&self, code: &str, below_tree: &str) {
        self.expect(
            Severity::Error,
            code,
            &format!("/extensions/EXT_spherical_visibility/trees/0{below_tree}"),
        );
    }
}

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// The fingerprint of objects given as document number and triangles.
pub(super) fn print(objects: &[(u32, u32)]) -> Value {
    let triangles: u32 = objects.iter().map(|(_, triangles)| triangles).sum();
    json!({"triangles": triangles, "hash": format_hash(fingerprint(objects.iter().copied()))})
}
