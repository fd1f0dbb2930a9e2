use super::*;
use crate::scene::{ReadOptions, read_scene};
use serde_json::{Value, json};
use svs_render::{AlphaMode, Filter, Material, Wrap};

/// A document under construction: one buffer, a view and an accessor for each array.
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
        self.bin.extend(bytes);
        self.views.len() - 1
    }

    fn add(&mut self, bytes: &[u8], component: u32, size: usize, kind: &str, normalized: bool) -> usize {
        let view = self.view(bytes);
        self.accessors.push(json!({"bufferView": view, "componentType": component,
            "count": bytes.len() / size, "type": kind, "normalized": normalized}));
        self.accessors.len() - 1
    }

    fn floats(&mut self, values: &[f32], kind: &str) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        let components = kind.strip_prefix("VEC").map_or(1, |n| n.parse().expect("a digit"));
        self.add(&bytes, 5126, 4 * components, kind, false)
    }

    fn read(self, more: Value) -> Appearance {
        let mut json = json!({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "buffers": [{"byteLength": self.bin.len()}], "bufferViews": self.views, "accessors": self.accessors});
        for (key, value) in more.as_object().expect("an object") {
            json[key] = value.clone();
        }
        let doc = Document::from_parts(json, Some(self.bin)).expect("a document");
        let scene = read_scene(&doc, &ReadOptions::default()).expect("a scene");
        let looks = read(&doc, &scene).expect("looks");
        assert_eq!(looks.data.objects.len(), scene.objects.len());
        assert_eq!(looks.data.meshes.len(), scene.meshes.len() + 1);
        looks
    }
}

const QUAD: [f32; 12] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0];

fn codes(looks: &Appearance) -> Vec<&str> {
    looks.notes.iter().map(|note| note.code).collect()
}

fn png(width: u32, height: u32) -> Vec<u8> {
    let mut png = std::io::Cursor::new(Vec::new());
    let image = image::RgbaImage::from_fn(width, height, |x, y| image::Rgba([x as u8, y as u8, 7, 128]));
    image.write_to(&mut png, image::ImageFormat::Png).expect("an image");
    png.into_inner()
}

#[test]
fn all_attributes_of_an_unindexed_strip_are_read() {
    let mut file = File::default();
    let position = file.floats(&QUAD, "VEC3");
    let normal = file.add(&[0, 0, 127, 0, 0, 127, 0, 127, 0, 0, 0, 64], 5120, 3, "VEC3", true);
    let color = file.add(&[255, 0, 0, 0, 255, 0, 0, 0, 255, 10, 20, 30], 5121, 3, "VEC3", true);
    let uv = file.floats(&[0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0], "VEC2");
    let image = file.view(&png(4, 2));
    let transform = json!({"KHR_texture_transform": {"offset": [0.5, 0.25], "scale": [2, 2]}});
    let looks = file.read(json!({
        "meshes": [{"primitives": [{"mode": 5, "material": 0, "attributes":
            {"POSITION": position, "NORMAL": normal, "COLOR_0": color, "TEXCOORD_1": uv}}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "texCoord": 1, "extensions": transform}},
            "emissiveTexture": {"index": 0}}],
        "textures": [{"source": 0, "sampler": 0}], "images": [{"bufferView": image}],
        "samplers": [{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728, "minFilter": 9987}],
    }));
    let primitive = &looks.data.meshes[0].primitives[0];
    assert_eq!(primitive.indices, [0, 1, 2, 1, 3, 2]);
    assert_eq!(primitive.positions.concat(), QUAD);
    assert_eq!(primitive.normals, [[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    assert_eq!(primitive.colors[0], [255, 0, 0, 255]);
    assert_eq!(primitive.colors[3], [10, 20, 30, 255]);
    assert_eq!(primitive.uvs[3], [2.5, 2.25]);
    let material = &looks.data.materials[primitive.material as usize];
    let texture = material.base_color_texture.expect("a texture");
    assert_eq!((texture.sampler.wrap_u, texture.sampler.wrap_v), (Wrap::Clamp, Wrap::Mirror));
    assert_eq!((texture.sampler.magnify, texture.sampler.minify), (Filter::Nearest, Filter::Linear));
    let image = &looks.data.images[texture.image as usize];
    assert_eq!((image.width, image.height, &image.rgba[4..8]), (4, 2, &[1, 0, 7, 128][..]));
    // The emissive texture wants other coordinates: one set is all a primitive has.
    assert_eq!(material.emissive_texture, None);
    assert_eq!(codes(&looks), ["TEXTURE_MAPPING"]);
}

#[test]
fn what_does_not_fit_is_left_out_and_counted() {
    let mut file = File::default();
    let position = file.floats(&QUAD, "VEC3");
    let short = file.floats(&QUAD[..9], "VEC3");
    let uv = file.floats(&[0.0; 8], "VEC2");
    let broken = file.view(b"\x89PNG\r\n\x1a\n nonsense");
    let looks = file.read(json!({
        "meshes": [{"primitives": [{"material": 0, "attributes":
            {"POSITION": position, "NORMAL": short, "COLOR_0": uv, "TEXCOORD_0": uv}}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "textures": [{"source": 0}], "images": [{"bufferView": broken}],
    }));
    let primitive = &looks.data.meshes[0].primitives[0];
    assert!(primitive.normals.is_empty() && primitive.colors.is_empty() && primitive.uvs.is_empty());
    assert_eq!((primitive.positions.len(), primitive.indices.as_slice()), (3, &[0, 1, 2][..]));
    assert_eq!(codes(&looks), ["TEXTURE_UNREADABLE", "ATTRIBUTE_UNUSABLE"]);
    assert_eq!(looks.notes[1].count, 2);
}

#[test]
fn only_vertices_in_use_are_taken_and_bad_triangles_are_not() {
    let mut file = File::default();
    let mut points = [QUAD, QUAD, QUAD].concat();
    points[0] = f32::NAN;
    let position = file.floats(&points, "VEC3");
    let indices = file.add(&[4, 5, 6, 0, 1, 2, 7, 5, 4], 5121, 1, "SCALAR", false);
    let looks = file.read(json!({"meshes": [{"primitives": [
        {"attributes": {"POSITION": position}, "indices": indices},
        {"attributes": {"POSITION": position}, "mode": 1}]}]}));
    let primitives = &looks.data.meshes[0].primitives;
    assert_eq!(primitives.len(), 1);
    assert_eq!(primitives[0].indices, [0, 1, 2, 3, 1, 0]);
    assert_eq!(primitives[0].positions.len(), 4);
}

#[test]
fn a_normal_without_direction_makes_faces_flat() {
    let mut file = File::default();
    let position = file.floats(&QUAD, "VEC3");
    let normal = file.floats(&[0.0, 0.0, 9.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0], "VEC3");
    let attributes = json!({"POSITION": position, "NORMAL": normal});
    let looks = file.read(json!({"meshes": [{"primitives": [{"mode": 5, "attributes": attributes}]}]}));
    assert!(looks.data.meshes[0].primitives[0].normals.is_empty());
}

#[test]
fn hidden_objects_get_the_empty_mesh() {
    let mut file = File::default();
    let position = file.floats(&QUAD, "VEC3");
    let hide = json!({"KHR_node_visibility": {"visible": false}});
    let looks = file.read(json!({
        "meshes": [{"primitives": [{"attributes": {"POSITION": position}}]}],
        "nodes": [{"mesh": 0, "children": [1, 3]}, {"mesh": 0, "extensions": hide, "children": [2]}, {"mesh": 0},
            {"mesh": 0, "scale": [1e300, 1e300, 1e300], "children": [4]}, {"mesh": 0, "scale": [1e300, 1, 1]}],
    }));
    let meshes: Vec<u32> = looks.data.objects.iter().map(|object| object.mesh).collect();
    assert_eq!(meshes, [0, 1, 1, 0, 1]);
    assert!(looks.data.meshes[1].primitives.is_empty());
}

#[test]
fn materials_say_what_gltf_says() {
    let mut file = File::default();
    let position = file.floats(&QUAD, "VEC3");
    let materials = json!([
        {},
        {"alphaMode": "MASK", "alphaCutoff": 0.25, "doubleSided": true, "emissiveFactor": [0, 0.5, 7],
            "pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, -3, 0.5], "metallicFactor": 0.5, "roughnessFactor": 0},
            "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 4}}},
        {"alphaMode": "BLEND", "extensions": {"KHR_materials_unlit": {}}},
        {"extensions": {"KHR_materials_transmission": {"transmissionFactor": 1}}},
        {"alphaMode": "GLASS"},
        {"extensions": {"KHR_materials_pbrSpecularGlossiness": {"diffuseFactor": [1, 0, 0, 1], "glossinessFactor": 0.25}}},
    ]);
    let primitive = |material: usize| json!({"attributes": {"POSITION": position}, "material": material});
    let primitives: Vec<Value> =
        (0..6).map(primitive).chain([json!({"attributes": {"POSITION": position}})]).collect();
    let looks = file.read(json!({"meshes": [{"primitives": primitives}], "materials": materials}));
    let of = |primitive: usize| {
        &looks.data.materials[looks.data.meshes[0].primitives[primitive].material as usize]
    };
    assert_eq!((of(0), of(6)), (&Material::default(), &Material::default()));
    assert_eq!(of(1).alpha, AlphaMode::Mask(0.25));
    assert_eq!((of(1).base_color, of(1).emissive), ([0.1, 0.2, 0.0, 0.5], [0.0, 2.0, 4.0]));
    assert!(of(1).double_sided && of(1).metallic == 0.5 && of(1).roughness == 0.0);
    assert!(of(2).unlit && of(2).alpha == AlphaMode::Blend);
    assert_eq!((of(3).alpha, of(3).base_color[3]), (AlphaMode::Blend, 0.25));
    assert_eq!(of(4).alpha, AlphaMode::Blend);
    assert_eq!((of(5).base_color, of(5).metallic, of(5).roughness), ([1.0, 0.0, 0.0, 1.0], 0.0, 0.75));
}

#[test]
fn a_scene_of_another_document_is_refused() {
    let sample = crate::generate::shells(&crate::generate::ShellOptions { depth: 2, hole: false });
    let doc = Document::from_parts(sample.json, Some(sample.bin)).expect("a document");
    let scene = read_scene(&doc, &ReadOptions::default()).expect("a scene");
    let other = Document::from_parts(json!({"asset": {"version": "2.0"}}), None).expect("a document");
    assert!(matches!(read(&other, &scene), Err(AppearanceError::OtherDocument { .. })));
    let triangles: Vec<usize> = (read(&doc, &scene).expect("looks").data.meshes.iter())
        .map(|mesh| mesh.primitives.iter().map(|p| p.indices.len() / 3).sum())
        .collect();
    let expected: Vec<usize> = scene.meshes.iter().map(|mesh| mesh.drawn_triangles as usize).collect();
    assert_eq!(triangles[..scene.meshes.len()], expected);
}
