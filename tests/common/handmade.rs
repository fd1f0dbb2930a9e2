//! A scene of balls with proxies and a simplified level, made by hand to the letter of the format: what draws is tested with
//! it without what builds proxies.
#![allow(dead_code, reason = "not every test needs all of it")]

use glam::{DVec3, Vec3};
use serde_json::{Value, json};
use std::f32::consts::{PI, TAU};
use svs::bake::{self, BakeOptions, Silent};
use svs::gltf::{Document, DocumentTables};
use svs_runtime::Visibility;
use svs_runtime::format::{EXTENSION_NAME, Extension};

/// Balls along x and z.
pub(crate) const SIDE: usize = 6;
/// Distance of neighbours, metres; balls have radius 1.
pub(crate) const STEP: f32 = 2.5;
/// Rings and sectors of a ball as it is, at its level, and in proxies.
const FINE: (u32, u32) = (16, 32);
const LEVEL: (u32, u32) = (8, 16);
const COARSE: (u32, u32) = (4, 8);
/// How far the coarse balls are from round, metres: the level, the proxies.
pub(crate) const ERRORS: [f32; 2] = [0.06, 0.2];

/// Triangles of a ball: as it is, at its level, in proxies.
pub(crate) fn triangles() -> [u32; 3] {
    [FINE, LEVEL, COARSE].map(|(rings, sectors)| 2 * sectors * (rings - 1))
}

/// The baked scene with proxies: a root, two halves of the objects below it, and nothing below these. Mesh 1 is a level of
/// mesh 0.
pub(crate) fn document() -> Document {
    let mut scene = Builder::default();
    scene.mesh(&[Vec3::ZERO], FINE);
    let nodes: Vec<Value> = places().map(|at| json!({"mesh": 0, "translation": at.to_array()})).collect();
    let mut doc = scene.document(nodes);
    let options = BakeOptions { rays: Some(100_000), verify: false, ..BakeOptions::default() };
    bake::build(&mut doc, &options, &Silent).expect("a bake");
    let order = order(&doc);
    let half = order.len() / 2;
    let places: Vec<Vec3> = places().collect();
    let balls =
        |range: std::ops::Range<usize>| -> Vec<Vec3> { order[range].iter().map(|&at| places[at]).collect() };
    let mut more = Builder::of(&doc);
    let level = more.mesh(&[Vec3::ZERO], LEVEL);
    let meshes = [0..order.len(), 0..half, half..order.len()].map(|range| more.mesh(&balls(range), COARSE));
    let reach = STEP * SIDE as f32;
    let tables = json!({
        "PROXY_SPHERE": more.accessor("VEC4", 5126, &[[0.0, 0.0, 0.0, reach]; 3].concat().map_bytes()),
        "PROXY_SUBTREE": more.accessor("SCALAR", 5125, &[3_u32, 1, 1].map_bytes()),
        "PROXY_FIRST_OBJECT": more.accessor("SCALAR", 5125, &[0, 0, half as u32].map_bytes()),
        "PROXY_OBJECT_COUNT":
            more.accessor("SCALAR", 5125, &[order.len(), half, order.len() - half].map(|n| n as u32).map_bytes()),
        "PROXY_ERROR": more.accessor("SCALAR", 5126, &[ERRORS[1] * 2.0, ERRORS[1], ERRORS[1]].map_bytes()),
        "PROXY_MESH": more.accessor("SCALAR", 5125, &meshes.map_bytes()),
        "PROXY_ORIGIN": more.accessor("VEC3", 5126, &[0.0_f32; 9].map_bytes()),
    });
    let extension = &mut more.json["extensions"][EXTENSION_NAME];
    extension["meshLevels"] = json!([{"mesh": 0, "levels": [{"mesh": level, "error": ERRORS[0]}]}]);
    extension["trees"][0]["proxies"] = json!({"visible": false, "tables": tables});
    more.document_as_it_is()
}

/// Where the balls are, around the origin.
fn places() -> impl Iterator<Item = Vec3> {
    let at = |index: usize| (index as f32 - (SIDE - 1) as f32 * 0.5) * STEP;
    (0..SIDE * SIDE).map(move |index| Vec3::new(at(index % SIDE), 0.0, at(index / SIDE)))
}

/// Document index of the object at each place of the only tree.
fn order(doc: &Document) -> Vec<usize> {
    let json = &doc.json["extensions"][EXTENSION_NAME];
    let extension: Extension = serde_json::from_value(json.clone()).expect("an extension");
    let decoded = Visibility::decode(json, &DocumentTables::of_extension(doc, &extension)).expect("a bake");
    assert_eq!(decoded.trees().len(), 1);
    let tree = &decoded.trees()[0];
    (0..tree.object_count()).map(|place| tree.document_index(place)).map(|index| index as usize).collect()
}

/// Numbers as the bytes of a buffer.
trait Bytes {
    fn map_bytes(&self) -> Vec<u8>;
}

impl<const N: usize> Bytes for [u32; N] {
    fn map_bytes(&self) -> Vec<u8> {
        self.iter().flat_map(|value| value.to_le_bytes()).collect()
    }
}

impl Bytes for [f32] {
    fn map_bytes(&self) -> Vec<u8> {
        self.iter().flat_map(|value| value.to_le_bytes()).collect()
    }
}

/// A document in the making.
#[derive(Default)]
struct Builder {
    json: Value,
    bin: Vec<u8>,
}

impl Builder {
    fn of(doc: &Document) -> Self {
        Self { json: doc.json.clone(), bin: doc.buffers[0].clone() }
    }

    fn push(&mut self, list: &str, entry: Value) -> u32 {
        if self.json.get(list).is_none() {
            self.json[list] = json!([]);
        }
        let entries = self.json[list].as_array_mut().expect("a list");
        entries.push(entry);
        entries.len() as u32 - 1
    }

    fn accessor(&mut self, kind: &str, component_type: u32, bytes: &[u8]) -> u32 {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        let (offset, length) = (self.bin.len(), bytes.len());
        self.bin.extend_from_slice(bytes);
        let view = self.push("bufferViews", json!({"buffer": 0, "byteOffset": offset, "byteLength": length}));
        let components = match kind {
            "SCALAR" => 1,
            "VEC3" => 3,
            _ => 4,
        };
        let count = length / 4 / components;
        let accessor =
            json!({"bufferView": view, "componentType": component_type, "count": count, "type": kind});
        self.push("accessors", accessor)
    }

    /// A mesh of balls.
    fn mesh(&mut self, centers: &[Vec3], (rings, sectors): (u32, u32)) -> u32 {
        let (mut positions, mut normals, mut indices): (Vec<f32>, Vec<f32>, Vec<u8>) = Default::default();
        for &center in centers {
            let first = (positions.len() / 3) as u32;
            for ring in 0..=rings {
                let (down, around) = (PI * ring as f32 / rings as f32).sin_cos();
                for sector in 0..sectors {
                    let (sin, cos) = (TAU * sector as f32 / sectors as f32).sin_cos();
                    let normal = Vec3::new(down * cos, around, down * sin);
                    positions.extend((center + normal).to_array());
                    normals.extend(normal.to_array());
                }
            }
            let at = |ring: u32, sector: u32| first + ring * sectors + sector % sectors;
            let mut push = |corners: [u32; 3]| indices.extend(corners.map_bytes());
            for ring in 0..rings {
                for sector in 0..sectors {
                    let [a, b] = [at(ring, sector), at(ring, sector + 1)];
                    let [c, d] = [at(ring + 1, sector), at(ring + 1, sector + 1)];
                    if ring > 0 {
                        push([a, b, d]);
                    }
                    if ring + 1 < rings {
                        push([a, d, c]);
                    }
                }
            }
        }
        let (low, high) = positions
            .as_chunks::<3>()
            .0
            .iter()
            .map(|&p| Vec3::from(p))
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        let position = self.accessor("VEC3", 5126, &positions.map_bytes());
        self.json["accessors"][position as usize]["min"] = json!(low.to_array());
        self.json["accessors"][position as usize]["max"] = json!(high.to_array());
        let normal = self.accessor("VEC3", 5126, &normals.map_bytes());
        let index = self.accessor("SCALAR", 5125, &indices);
        let attributes = json!({"POSITION": position, "NORMAL": normal});
        let primitive = json!({"attributes": attributes, "indices": index, "material": 0});
        self.push("meshes", json!({"primitives": [primitive]}))
    }

    fn document(mut self, nodes: Vec<Value>) -> Document {
        self.json["asset"] = json!({"version": "2.0"});
        self.json["scene"] = json!(0);
        self.json["scenes"] = json!([{"nodes": (0..nodes.len()).collect::<Vec<_>>()}]);
        self.json["nodes"] = json!(nodes);
        let color = json!({"baseColorFactor": [0.8, 0.3, 0.2, 1.0], "metallicFactor": 0.0});
        self.json["materials"] = json!([{"pbrMetallicRoughness": color}]);
        self.document_as_it_is()
    }

    fn document_as_it_is(mut self) -> Document {
        self.json["buffers"] = json!([{"byteLength": self.bin.len()}]);
        Document::from_parts(self.json, Some(self.bin)).expect("a document")
    }
}

/// A place from which the whole scene is seen, `radii` scene radii from its middle.
pub(crate) fn eye(radii: f64) -> DVec3 {
    DVec3::new(0.5, 0.6, 0.7).normalize() * f64::from(STEP) * SIDE as f64 * 0.7 * radii
}
