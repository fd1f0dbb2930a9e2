//! What glass and fences hide.

use crate::baking::{Unpruned, bake, options, rows};
use crate::document::{Builder, cuboid, sheet};
use base64::Engine;
use glam::DVec3;
use serde_json::{Value, json};
use std::io::Cursor;
use svs::bake::hierarchy::HierarchyKind;

/// Pane (object 0) at x = 2 in a frame of nothing, facing +x; a box (object 1) behind it at the origin; a small box
/// (object 2) inside the first one.
fn behind(material: Value, prepare: impl FnOnce(&mut Builder)) -> Unpruned {
    Unpruned::new(&behind_document(material, prepare), HierarchyKind::Octree)
}

fn behind_document(material: Value, prepare: impl FnOnce(&mut Builder)) -> svs::gltf::Document {
    let mut builder = Builder::new();
    prepare(&mut builder);
    let material = builder.push("materials", material);
    let pane = builder.mesh(&sheet(), Some(material));
    let large = builder.mesh(&cuboid([0.5; 3]), None);
    let small = builder.mesh(&cuboid([0.25; 3]), None);
    builder.object(None, pane, DVec3::X * 2.0);
    builder.object(None, large, DVec3::ZERO);
    builder.object(None, small, DVec3::ZERO);
    builder.finish()
}

fn levels_from_front(scene: &Unpruned) -> Vec<u8> {
    scene.levels_from(DVec3::X, 10_000)
}

#[test]
fn opaque_panes_hide() {
    assert_eq!(levels_from_front(&behind(json!({}), |_| ())), [1, 0, 0]);
    // Its back is not drawn, so from behind it is not there.
    assert_eq!(behind(json!({}), |_| ()).levels_from(DVec3::NEG_X, 10_000), [0, 1, 0]);
    let double_sided = behind(json!({ "doubleSided": true }), |_| ());
    assert_eq!(double_sided.levels_from(DVec3::NEG_X, 10_000), [1, 1, 0]);
}

#[test]
fn glass_is_seen_and_hides_nothing() {
    for glass in [
        json!({ "alphaMode": "BLEND" }),
        json!({ "extensions": { "KHR_materials_transmission": { "transmissionFactor": 0.9 } } }),
    ] {
        assert_eq!(levels_from_front(&behind(glass, |_| ())), [1, 1, 0]);
    }
}

/// A fence of 8 x 8 pixels: `passes` tells where it is.
fn fence(builder: &mut Builder, passes: impl Fn(u32, u32) -> bool) {
    let image = image::RgbaImage::from_fn(8, 8, |x, y| {
        image::Rgba([255, 255, 255, if passes(x, y) { 255 } else { 0 }])
    });
    let mut png = Cursor::new(Vec::new());
    image.write_to(&mut png, image::ImageFormat::Png).expect("a PNG");
    let text = base64::engine::general_purpose::STANDARD.encode(png.into_inner());
    builder.push("images", json!({ "uri": format!("data:image/png;base64,{text}") }));
    builder.push("textures", json!({ "source": 0 }));
}

fn masked() -> Value {
    json!({ "alphaMode": "MASK", "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } })
}

#[test]
fn fences_hide_except_through_their_holes() {
    // The box is behind the pixels 2 to 5.
    let in_front_of_box = |x: u32, y: u32| (2..6).contains(&x) && (2..6).contains(&y);
    let closed_there = behind(masked(), |b| fence(b, in_front_of_box));
    assert_eq!(levels_from_front(&closed_there), [1, 0, 0]);
    let open_there = behind(masked(), |b| fence(b, |x, y| !in_front_of_box(x, y)));
    assert_eq!(levels_from_front(&open_there), [1, 1, 0]);
    let one_hole = behind(masked(), |b| fence(b, |x, y| (x, y) != (3, 4)));
    assert_eq!(levels_from_front(&one_hole), [1, 1, 0]);
    let hole_elsewhere = behind(masked(), |b| fence(b, |x, y| (x, y) != (0, 4)));
    assert_eq!(levels_from_front(&hole_elsewhere), [1, 0, 0]);
    // Cut away altogether: not an object of the tree at all.
    let nothing = behind(masked(), |b| fence(b, |_, _| false));
    assert_eq!(levels_from_front(&nothing), [1, 0]);
}

#[test]
fn bakes_say_the_same() {
    let front = |mut doc: svs::gltf::Document| {
        let (trees, _) = bake(&mut doc, &options(1 << 20));
        let bin = trees[0].direction_set().nearest_f64(DVec3::X);
        rows(&trees[0]).iter().map(|row| row[bin]).collect::<Vec<u8>>()
    };
    // A pane much larger than the box would be needed to hide it from the whole bin; the small box is hidden by the
    // large one always.
    assert_eq!(front(behind_document(json!({ "alphaMode": "BLEND" }), |_| ())), [1, 1, 0]);
    assert_eq!(front(behind_document(masked(), |b| fence(b, |x, y| (x, y) != (3, 4)))), [1, 1, 0]);
}
