//! Opacity, sidedness and alpha textures.

use super::builder::{Builder, noted};
use crate::scene::{AlphaMask, MaskMode, Opacity, ReadOptions, Role, Scene, read_scene};
use base64::Engine;
use glam::Vec2;
use image::{ImageFormat, Luma, Rgb, Rgba};
use serde_json::{Value, json};
use std::io::Cursor;

/// Left half transparent, right half opaque.
fn half_png() -> Vec<u8> {
    let image = image::RgbaImage::from_fn(4, 2, |x, _| Rgba([255, 0, 0, if x < 2 { 0 } else { 200 }]));
    encode(&image.into())
}

fn encode(image: &image::DynamicImage) -> Vec<u8> {
    let mut png = Cursor::new(Vec::new());
    image.write_to(&mut png, ImageFormat::Png).unwrap();
    png.into_inner()
}

/// A triangle with one material. Image 0 is `png`, texture 0 shows it.
fn masked(png: &[u8], material: Value) -> Builder {
    let mut b = Builder::new();
    let view = b.view(png);
    b.push("images", json!({"bufferView": view, "mimeType": "image/png"}));
    b.push("textures", json!({"source": 0}));
    b.push("materials", material);
    let position = b.positions(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    let uv = b.floats(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
    b.with_primitives(json!([{"attributes": {"POSITION": position, "TEXCOORD_0": uv}, "material": 0}]))
}

fn mask_material() -> Value {
    json!({"alphaMode": "MASK", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}})
}

fn kind(scene: &Scene) -> &'static str {
    match scene.meshes[0].surfaces.first().map(|surface| &surface.opacity) {
        None => "nothing",
        Some(Opacity::Opaque) => "opaque",
        Some(Opacity::Transparent) => "transparent",
        Some(Opacity::Mask(_)) => "mask",
    }
}

fn mask(scene: &Scene) -> &AlphaMask {
    match &scene.meshes[0].surfaces[0].opacity {
        Opacity::Mask(mask) => mask,
        other => panic!("{other:?}"),
    }
}

#[test]
fn opacity_follows_the_material() {
    for (material, expected) in [
        (json!({}), "opaque"),
        (
            json!({"alphaMode": "OPAQUE", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.1]}}),
            "opaque",
        ),
        (json!({"alphaMode": "BLEND"}), "transparent"),
        (json!({"alphaMode": "SOMETHING"}), "transparent"),
        (json!({"extensions": {"KHR_materials_transmission": {}}}), "opaque"),
        (json!({"extensions": {"KHR_materials_transmission": {"transmissionFactor": 0.1}}}), "transparent"),
        (json!({"extensions": {"KHR_materials_volume": {}}}), "transparent"),
        (json!({"alphaMode": "MASK"}), "opaque"),
        (
            json!({"alphaMode": "MASK", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.4]}}),
            "nothing",
        ),
        (
            json!({"alphaMode": "MASK", "alphaCutoff": 0.3, "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.4]}}),
            "opaque",
        ),
        (json!({"alphaMode": "MASK", "alphaCutoff": 1.1}), "nothing"),
    ] {
        let text = material.to_string();
        let scene = masked(&half_png(), material).read().unwrap();
        assert_eq!(kind(&scene), expected, "{text}");
        let role = if expected == "nothing" { Role::Excluded } else { Role::Static };
        assert_eq!((scene.objects[0].role, scene.meshes[0].drawn_triangles), (role, 1));
        assert!(scene.meshes[0].uvs.is_empty());
    }
}

#[test]
fn sides_follow_the_material() {
    for (material, expected) in [(json!({}), false), (json!({"doubleSided": true}), true)] {
        let scene = masked(&half_png(), material).read().unwrap();
        assert_eq!(scene.meshes[0].surfaces[0].double_sided, expected);
    }
}

#[test]
fn masks_are_read_from_views_and_data_uris() {
    let mut b = masked(&half_png(), mask_material());
    b.push("samplers", json!({"wrapS": 33071}));
    b.json["textures"][0]["sampler"] = json!(0);
    let uri =
        format!("data:image/png;base64,{}", base64::engine::general_purpose::STANDARD.encode(half_png()));
    for image in [b.json["images"][0].clone(), json!({"uri": uri})] {
        b.json["images"][0] = image;
        let scene = b.read().unwrap();
        let mask = mask(&scene);
        assert_eq!((mask.width, mask.height, mask.wrap), (4, 2, [33071, 10497]));
        assert_eq!(mask.passes, [false, false, true, true, false, false, true, true]);
        assert_eq!(scene.meshes[0].uvs, [Vec2::ZERO, Vec2::X, Vec2::Y]);
        assert!(scene.notes.is_empty());
    }
}

#[test]
fn external_images_are_read_beside_the_file() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a b.png"), half_png()).unwrap();
    let mut b = masked(&half_png(), mask_material());
    b.json["images"][0] = json!({"uri": "a%20b.png"});
    assert_eq!(noted(&b.read().unwrap(), "MASK_TEXTURE_UNREADABLE"), 1, "no folder to find it in");
    // The same as a .gltf with its buffer in a data URI.
    let mut doc = b.document();
    let buffer = base64::engine::general_purpose::STANDARD.encode(&doc.buffers[0]);
    doc.json["buffers"][0]["uri"] = json!(format!("data:application/octet-stream;base64,{buffer}"));
    let path = folder.path().join("scene.gltf");
    std::fs::write(&path, doc.json.to_string()).unwrap();
    let doc = crate::gltf::Document::read(&path).unwrap();
    let scene = read_scene(&doc, &ReadOptions::default()).unwrap();
    assert_eq!(mask(&scene).width, 4);
}

#[test]
fn factor_and_cutoff_decide_where_a_texture_passes() {
    let with = |factor: f64, cutoff: f64| {
        let mut material = mask_material();
        material["alphaCutoff"] = json!(cutoff);
        material["pbrMetallicRoughness"]["baseColorFactor"] = json!([1, 1, 1, factor]);
        kind(&masked(&half_png(), material).read().unwrap())
    };
    // Alpha 200 of 255 is 0.784.
    assert_eq!(with(1.0, 0.78), "mask");
    assert_eq!(with(1.0, 0.79), "nothing");
    assert_eq!(with(0.6, 0.5), "nothing");
    assert_eq!(with(0.7, 0.5), "mask");
    assert_eq!(with(1.0, 0.0), "opaque");
}

#[test]
fn images_of_other_kinds() {
    let rgb = image::RgbImage::from_pixel(2, 2, Rgb([0, 0, 0])).into();
    assert_eq!(kind(&masked(&encode(&rgb), mask_material()).read().unwrap()), "opaque");
    let grey = image::ImageBuffer::from_pixel(2, 2, Luma([0_u16])).into();
    assert_eq!(kind(&masked(&encode(&grey), mask_material()).read().unwrap()), "opaque");
    let deep =
        image::ImageBuffer::from_fn(2, 1, |x, _| Rgba([0_u16, 0, 0, if x == 0 { 0x7fff } else { 0x8000 }]));
    let scene = masked(&encode(&deep.into()), mask_material()).read().unwrap();
    assert_eq!(mask(&scene).passes, [false, true]);
}

#[test]
fn what_cannot_be_tested_hides_nothing() {
    let mut huge = half_png();
    // The width in the header of a PNG, and the header's checksum left wrong: refused either way.
    huge[16..20].copy_from_slice(&[0, 1, 0, 0]);
    for png in [b"not an image".to_vec(), half_png()[..40].to_vec(), huge] {
        let scene = masked(&png, mask_material()).read().unwrap();
        assert_eq!((kind(&scene), noted(&scene, "MASK_TEXTURE_UNREADABLE")), ("transparent", 1));
    }

    let mut b = masked(&half_png(), mask_material());
    b.json["textures"][0] = json!({"extensions": {"KHR_texture_basisu": {"source": 0}}});
    assert_eq!(kind(&b.read().unwrap()), "transparent");

    let mut b = masked(&half_png(), mask_material());
    b.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = json!(1);
    let scene = b.read().unwrap();
    assert_eq!((kind(&scene), noted(&scene, "MASK_WITHOUT_UV")), ("transparent", 1));

    let options = ReadOptions { mask: MaskMode::Transparent, ..ReadOptions::default() };
    let scene = read_scene(&masked(&half_png(), mask_material()).document(), &options).unwrap();
    assert_eq!((kind(&scene), scene.notes.len()), ("transparent", 0));

    let mut b = masked(&half_png(), mask_material());
    let target = json!({"extensions": {"KHR_animation_pointer": {"pointer": "/materials/0/alphaCutoff"}}});
    b.push("animations", json!({"channels": [{"target": target}]}));
    let scene = b.read().unwrap();
    assert_eq!((kind(&scene), noted(&scene, "MASK_ANIMATED")), ("transparent", 1));
}

/// A PNG chunk of this type and data, with its length and CRC-32.
fn chunk(content: &[u8]) -> Vec<u8> {
    let crc = content.iter().fold(u32::MAX, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| (crc >> 1) ^ (0xEDB8_8320 * (crc & 1)))
    });
    let length = (content.len() - 4) as u32;
    [&length.to_be_bytes(), content, &(!crc).to_be_bytes()].concat()
}

#[test]
fn textures_with_too_many_texels_are_not_decoded() {
    // 16384 x 8192 texels in a few bytes; only the header is looked at.
    let mut png = b"\x89PNG\r\n\x1a\n".to_vec();
    png.extend(chunk(b"IHDR\0\0\x40\0\0\0\x20\0\x08\x06\0\0\0"));
    png.extend(chunk(b"IDAT"));
    let scene = masked(&png, mask_material()).read().unwrap();
    assert_eq!((kind(&scene), noted(&scene, "MASK_TEXTURE_TOO_LARGE")), ("transparent", 1));
}

#[test]
fn vertex_alpha_counts() {
    for (alpha, expected) in [(255, "mask"), (100, "transparent")] {
        let mut b = masked(&half_png(), mask_material());
        let color = b.accessor(&[9, 9, 9, alpha, 9, 9, 9, 255, 9, 9, 9, 255], 5121, "VEC4", 3);
        b.json["accessors"][color]["normalized"] = json!(true);
        b.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(color);
        assert_eq!(kind(&b.read().unwrap()), expected);
    }
}

#[test]
fn texture_transforms_are_baked_and_other_sets_used() {
    let mut b = masked(&half_png(), mask_material());
    let second = b.floats(&[[0.5, 0.5], [1.0, 0.5], [0.5, 1.0]]);
    b.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_3"] = json!(second);
    let transform = json!({"KHR_texture_transform": {"offset": [10, 20], "scale": [2, -4], "texCoord": 3}});
    b.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] = transform;
    let scene = b.read().unwrap();
    assert_eq!(scene.meshes[0].uvs, [Vec2::new(11.0, 18.0), Vec2::new(12.0, 18.0), Vec2::new(11.0, 16.0)]);
}

#[test]
fn surfaces_are_grouped_and_vertices_shared_where_they_agree() {
    let mut b = masked(&half_png(), mask_material());
    b.push("materials", json!({"alphaMode": "BLEND"}));
    let solid = json!({"attributes": {"POSITION": 0, "TEXCOORD_0": 1}});
    let masked = b.json["meshes"][0]["primitives"][0].clone();
    let mut blend = solid.clone();
    blend["material"] = json!(1);
    b.json["meshes"][0]["primitives"] = json!([solid, masked, blend, solid, masked]);
    let scene = b.read().unwrap();
    let mesh = &scene.meshes[0];
    let ranges: Vec<_> = mesh.surfaces.iter().map(|s| s.triangles.clone()).collect();
    assert_eq!(ranges, [0..2, 2..4, 4..5]);
    assert_eq!((mesh.positions.len(), mesh.uvs.len()), (6, 6));
    assert_eq!(mesh.triangles[0], mesh.triangles[4]);
    assert_ne!(mesh.triangles[0], mesh.triangles[2], "mapped to the texture");
}

#[test]
fn variants_that_disagree_hide_nothing() {
    let mut b = masked(&half_png(), json!({}));
    b.push("materials", json!({"name": "the same"}));
    b.push("materials", json!({"alphaMode": "BLEND"}));
    for (variant, expected) in [(1, "opaque"), (2, "transparent")] {
        let mappings = json!([{"material": variant, "variants": [0]}]);
        b.json["meshes"][0]["primitives"][0]["extensions"] =
            json!({"KHR_materials_variants": {"mappings": mappings}});
        assert_eq!(kind(&b.read().unwrap()), expected);
    }
}

#[test]
fn primitives_that_share_positions_keep_their_own_texture_coordinates() {
    let mut b = masked(&half_png(), mask_material());
    let other = b.floats(&[[5.0, 5.0], [6.0, 5.0], [5.0, 6.0]]);
    let first = b.json["meshes"][0]["primitives"][0].clone();
    let mut second = first.clone();
    second["attributes"]["TEXCOORD_0"] = json!(other);
    b.json["meshes"][0]["primitives"] = json!([first, second]);
    let scene = b.read().unwrap();
    let mesh = &scene.meshes[0];
    let corner = |triangle: usize| mesh.uvs[mesh.triangles[triangle][0] as usize];
    assert_eq!((corner(0), corner(1)), (Vec2::ZERO, Vec2::splat(5.0)));
    assert_eq!(mesh.surfaces.len(), 1, "the same material");
}

#[test]
fn unusable_texture_coordinates_hide_nothing() {
    let mut b = masked(&half_png(), mask_material());
    let broken = b.floats(&[[0.0, 0.0], [f32::NAN, 0.0], [0.0, 1.0]]);
    let short = b.floats(&[[0.0, 0.0]; 2]);
    let uv = "/meshes/0/primitives/0/attributes/TEXCOORD_0";
    *b.json.pointer_mut(uv).unwrap() = json!(broken);
    let scene = b.read().unwrap();
    assert_eq!((kind(&scene), noted(&scene, "MASK_WITHOUT_UV")), ("transparent", 1));
    *b.json.pointer_mut(uv).unwrap() = json!(short);
    assert!(b.error().starts_with(uv), "{}", b.error());

    let mut b = masked(&half_png(), mask_material());
    let transform = json!({"KHR_texture_transform": {"scale": [1e300, 1]}});
    b.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] = transform;
    let scene = b.read().unwrap();
    assert_eq!((kind(&scene), noted(&scene, "TEXTURE_TRANSFORM_UNUSABLE")), ("transparent", 1));
}
