//! Small documents to start from: generated ones, baked ones, and one with many features of glTF.

use super::input;
use serde_json::{Value, json};
use svs::bake::hierarchy::HierarchyKind;
use svs::bake::{BakeOptions, HierarchyChoice, Silent, build};
use svs::generate::{SampleKind, SampleOptions, ShellOptions, generate, shells};
use svs::gltf::Document;
use svs_runtime::encode::{fingerprint, format_hash};

/// Name of a target and what it starts from.
pub(crate) type Seeds = (&'static str, Vec<Vec<u8>>);

/// The seeds of each target.
pub(crate) fn all() -> Vec<Seeds> {
    let baked = baked();
    let glb = |(json, bin): &(Value, Vec<u8>)| input::glb(&json.to_string(), bin);
    let text = |(json, bin): &(Value, Vec<u8>)| input::join(b"{", &json.to_string(), bin);
    let [ext, khr] = packed();
    let plain = [generated(SampleKind::Cubes, 0.004), features(), ext, khr];
    let every: Vec<(Value, Vec<u8>)> = plain.iter().chain(&baked).cloned().collect();
    vec![
        ("glb", every.iter().map(glb).collect()),
        ("accessors", plain.iter().map(text).collect()),
        ("scene", plain.iter().map(text).collect()),
        ("extension", baked.iter().map(text).collect()),
        ("validate", baked.iter().map(text).collect()),
        ("stage", every.iter().map(text).collect()),
        ("camera_path", vec![input::join(b"{", &camera_path().to_string(), &[])]),
    ]
}

fn camera_path() -> Value {
    json!({"version": 1, "name": "turn", "vertical_fov": 60.0, "near": 0.1, "poses": [
        {"eye": [0.0, 1.7, 0.0], "forward": [1.0, 0.0, 0.0]},
        {"eye": [1.0, 1.7, 0.5], "forward": [0.0, 0.0, -2.0]},
        {"eye": [2.0, 1.8, 3.5], "forward": [-1.0, 0.5, 0.0]},
    ]})
}

fn generated(kind: SampleKind, scale: f64) -> (Value, Vec<u8>) {
    let sample = generate(&SampleOptions { kind, scale, seed: 1 });
    (sample.json, sample.bin)
}

fn baked() -> Vec<(Value, Vec<u8>)> {
    let hole = shells(&ShellOptions { depth: 3, hole: true });
    let mut baked: Vec<_> = [(hole.json, hole.bin), generated(SampleKind::Boxes, 0.02), features()]
        .into_iter()
        .map(|(json, bin)| {
            let mut document = Document::from_parts(json, Some(bin)).expect("a sample can be read");
            let options = BakeOptions {
                directions: "octahedron".to_owned(),
                rays: Some(20_000),
                hierarchy: HierarchyChoice::Kind(HierarchyKind::Scene),
                prune: Some(0.0),
                verify: false,
                ..BakeOptions::default()
            };
            build(&mut document, &options, &Silent).expect("a sample can be baked");
            // For the target `extension`: where the eye is, and more.
            document.json["extras"] = json!([7.0, 1.0, 2.0, 1.0, 1.0, 0.1]);
            let bin = document.buffers.swap_remove(0);
            (document.json, bin)
        })
        .collect();
    baked.push(nested());
    baked
}

/// Tree 0 holds nodes 1 and 2 and, as object 2, tree 1, which hangs on node 3 and holds nodes 4 and 5.
fn nested() -> (Value, Vec<u8>) {
    let mesh = |x: f64| json!({"mesh": 0, "translation": [x, 0, 0]});
    let mut json = json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"children": [1, 2, 3]}, mesh(0.0), mesh(1.0), {"children": [4, 5]}, mesh(3.0), mesh(4.0)],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}, {"primitives": [{"mode": 1, "attributes": {"POSITION": 0}}]}],
        "extensionsUsed": ["EXT_spherical_visibility"],
        "extensions": {"EXT_spherical_visibility": {"version": "1.0", "trees": [
            {"scene": 0, "directions": "octahedron", "objectCount": 3, "levelBits": 1, "importanceArea": 1.0,
                "nested": [{"object": 2, "tree": 1, "anchor": 0}], "recommended": {"quality": 0.5}, "tables": {},
                "fingerprint": {"triangles": 4, "hash": format_hash(fingerprint([(0, 1), (1, 1), (2, 2)]))}},
            {"anchors": [3], "directions": "octahedron", "objectCount": 2, "levelBits": 1, "importanceArea": 1.0, "tables": {},
                "fingerprint": {"triangles": 2, "hash": format_hash(fingerprint([(0, 1), (1, 1)]))}},
        ], "meshLevels": [{"mesh": 0, "levels": [{"mesh": 1, "error": 0.25}]}]}},
    });
    let mut file = File::default();
    file.add(&floats(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]), 5126, "VEC3");
    file.accessors[0]["min"] = json!([0, 0, 0]);
    file.accessors[0]["max"] = json!([1, 1, 0]);
    for (tree, sphere, objects) in [(0, [2.5, 0.5, 0.0, 3.0], 3_u8), (1, [4.0, 0.5, 0.0, 1.5], 2)] {
        let mut table = |name: &str, bytes: &[u8], component: u32, kind: &str| {
            let index = file.add(bytes, component, kind);
            json["extensions"]["EXT_spherical_visibility"]["trees"][tree]["tables"][name] = json!(index);
        };
        table("NODE_SPHERE", &floats(&sphere), 5126, "VEC4");
        table("NODE_SUBTREE", &[1], 5121, "SCALAR");
        table("NODE_FIRST_OBJECT", &[0], 5121, "SCALAR");
        table("NODE_OBJECT_COUNT", &[objects], 5121, "SCALAR");
        table("LEVEL_ROW", &[0x3F, 0x15], 5121, "SCALAR");
        table("LEVEL_ROW_INDEX", &[0, 1, 1][..usize::from(objects)], 5121, "SCALAR");
        table("OBJECT_ORDER", &[1, 0, 2][..usize::from(objects)], 5121, "SCALAR");
        table("IMPORTANCE", &vec![9; usize::from(objects)], 5121, "SCALAR");
    }
    // A root with one proxy below it, in each tree.
    for (tree, objects) in [(0, 3_u8), (1, 2)] {
        json["extensions"]["EXT_spherical_visibility"]["trees"][tree]["proxies"] =
            json!({"visible": true, "tables": {}});
        let mut table = |name: &str, bytes: &[u8], component: u32, kind: &str| {
            let index = file.add(bytes, component, kind);
            json["extensions"]["EXT_spherical_visibility"]["trees"][tree]["proxies"]["tables"][name] =
                json!(index);
        };
        table("PROXY_SPHERE", &floats(&[2.5, 0.5, 0.0, 3.0, 4.0, 0.5, 0.0, 1.5]), 5126, "VEC4");
        table("PROXY_SUBTREE", &[2, 1], 5121, "SCALAR");
        table("PROXY_FIRST_OBJECT", &[0, 1], 5121, "SCALAR");
        table("PROXY_OBJECT_COUNT", &[objects, objects - 1], 5121, "SCALAR");
        table("PROXY_OBJECT", &[2, 0, 1][usize::from(3 - objects)..], 5121, "SCALAR");
        table("PROXY_ERROR", &floats(&[0.5, 0.25]), 5126, "SCALAR");
        table("PROXY_MESH", &[1, 1], 5121, "SCALAR");
        table("PROXY_ORIGIN", &floats(&[0.0, 0.0, 0.0, 3.0, 0.0, 0.0]), 5126, "VEC3");
    }
    file.finish(json)
}

/// A MASK texture, sparse and interleaved and quantized accessors, instances, strips, a skin, morph targets, animation,
/// hidden nodes, transparency, mirrored and degenerate transforms.
fn features() -> (Value, Vec<u8>) {
    let mut file = File::default();
    let corners = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.5];
    let positions = file.add(&floats(&corners), 5126, "VEC3");
    let uvs = file.add(&floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0]), 5126, "VEC2");
    let indices = file.add(&[0, 0, 1, 0, 2, 0, 2, 0, 1, 0, 3, 0], 5123, "SCALAR");
    let quantized = file.add(&[0, 0, 0, 0, 127, 0, 0, 0, 0, 127, 0, 0, 127, 127, 60, 0], 5120, "VEC4");
    file.accessors[quantized]["type"] = json!("VEC3");
    file.views[quantized]["byteStride"] = json!(4);
    let instances = file.add(&floats(&[0.0, 0.0, 2.0, 0.0, 0.0, 4.0]), 5126, "VEC3");
    let times = file.add(&floats(&[0.0, 1.0]), 5126, "SCALAR");
    let joints = file.add(&[0; 16], 5121, "VEC4");
    let sparse_indices = file.add(&[1, 0, 3, 0], 5123, "SCALAR");
    let sparse_values = file.add(&floats(&[2.0, 0.0, 0.0, 2.0, 2.0, 0.0]), 5126, "VEC3");
    file.accessors.push(json!({"bufferView": positions, "componentType": 5126, "count": 4, "type": "VEC3",
        "sparse": {"count": 2, "indices": {"bufferView": sparse_indices, "componentType": 5123},
            "values": {"bufferView": sparse_values}}}));
    let sparse = file.accessors.len() - 1;
    let image = file.view(&checkers());
    let primitive = |more: Value| {
        let mut primitive =
            json!({"attributes": {"POSITION": positions, "TEXCOORD_0": uvs}, "indices": indices});
        for (key, value) in more.as_object().into_iter().flatten() {
            primitive[key] = value.clone();
        }
        json!({"primitives": [primitive]})
    };
    let strip = json!({"mode": 5, "attributes": {"POSITION": sparse}});
    let json = json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 7, 8]}, {"nodes": [1]}],
        "extensionsUsed": ["EXT_mesh_gpu_instancing", "KHR_node_visibility", "KHR_texture_transform", "KHR_mesh_quantization"],
        "nodes": [
            {"children": [1, 2, 3], "scale": [-1, 1, 2]},
            {"mesh": 0, "rotation": [0, 0.6, 0, 0.8]},
            {"mesh": 1, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": instances}}}},
            {"children": [4, 5, 6], "matrix": [1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 3, 0, 0, 1]},
            {"mesh": 2, "extensions": {"KHR_node_visibility": {"visible": false}}},
            {"mesh": 3, "skin": 0, "translation": [1, 2, 3]},
            {"mesh": 4, "weights": [0.5]},
            {"mesh": 2, "scale": [0, 1, 1]},
            {"mesh": 3, "translation": [0, 0, -2]},
        ],
        "meshes": [
            primitive(json!({"material": 0})),
            primitive(json!({"material": 1, "attributes": {"POSITION": quantized}})),
            {"primitives": [strip, {"mode": 1, "attributes": {"POSITION": positions}}]},
            primitive(json!({"material": 2, "attributes": {"POSITION": positions, "JOINTS_0": joints, "WEIGHTS_0": joints}})),
            primitive(json!({"mode": 6, "targets": [{"POSITION": positions}]})),
        ],
        "materials": [
            {"alphaMode": "MASK", "alphaCutoff": 0.5, "doubleSided": true, "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.9],
                "baseColorTexture": {"index": 0, "texCoord": 0, "extensions": {"KHR_texture_transform": {"offset": [0.5, 0], "rotation": 0.3, "scale": [2, 2]}}}}},
            {"alphaMode": "BLEND", "extensions": {"KHR_materials_transmission": {"transmissionFactor": 0.5}}},
            {"alphaMode": "MASK", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.2]}},
        ],
        "textures": [{"source": 0, "sampler": 0}], "samplers": [{"wrapS": 33071, "wrapT": 33648}],
        "images": [{"bufferView": image, "mimeType": "image/png"}],
        "skins": [{"joints": [1, 2]}],
        "animations": [{"samplers": [{"input": times, "output": instances}], "channels": [
            {"sampler": 0, "target": {"node": 3, "path": "translation"}},
            {"sampler": 0, "target": {"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": "/nodes/8/scale"}}}}]}],
        "extras": {"any": [1.50, "thing"]},
    });
    file.finish(json)
}

/// Files whose geometry is compressed with `EXT_meshopt_compression` and `KHR_meshopt_compression`.
fn packed() -> [(Value, Vec<u8>); 2] {
    let files: [&[u8]; 2] = [
        include_bytes!("../../tests/cli/packed/cubes.ext.glb"),
        include_bytes!("../../tests/cli/packed/cubes.khr.glb"),
    ];
    files.map(|file| {
        let mut document = Document::from_glb(file).expect("a GLB");
        let bin = document.buffers.swap_remove(0);
        (document.json, bin)
    })
}

/// A PNG of 4 x 4 pixels, every other one clear.
fn checkers() -> Vec<u8> {
    let mut png = std::io::Cursor::new(Vec::new());
    let image = image::RgbaImage::from_fn(4, 4, |x, y| {
        image::Rgba([200, 100, 50, if (x + y) % 2 == 0 { 255 } else { 0 }])
    });
    image.write_to(&mut png, image::ImageFormat::Png).expect("a small image can be encoded");
    png.into_inner()
}

/// Buffer views and accessors under construction.
#[derive(Default)]
struct File {
    bin: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl File {
    fn view(&mut self, bytes: &[u8]) -> usize {
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        self.views.push(json!({"buffer": 0, "byteOffset": self.bin.len(), "byteLength": bytes.len()}));
        self.bin.extend_from_slice(bytes);
        self.views.len() - 1
    }

    /// One view and its accessor; they have the same index until a view is made alone.
    fn add(&mut self, bytes: &[u8], component: u32, kind: &str) -> usize {
        let view = self.view(bytes);
        let components = match kind {
            "SCALAR" => 1,
            "VEC2" => 2,
            "VEC3" => 3,
            _ => 4,
        };
        let size = match component {
            5120 | 5121 => 1,
            5123 => 2,
            _ => 4,
        };
        let count = bytes.len() / (components * size);
        self.accessors
            .push(json!({"bufferView": view, "componentType": component, "count": count, "type": kind}));
        self.accessors.len() - 1
    }

    fn finish(self, mut json: Value) -> (Value, Vec<u8>) {
        json["buffers"] = json!([{"byteLength": self.bin.len()}]);
        json["bufferViews"] = json!(self.views);
        json["accessors"] = json!(self.accessors);
        (json, self.bin)
    }
}

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}
