//! Pictures of small scenes against stored ones. `UPDATE_GOLDEN=1` writes them anew.

mod common;

use common::*;
use glam::{DAffine3, DVec3};
use svs_render::{Image, Line, Material, Mesh, SceneData};

const WIDTH: u32 = 160;
const HEIGHT: u32 = 90;

/// A channel may differ by this much, 255ths…
const CHANNEL: u8 = 3;
/// …in all but this share of the pixels: drivers round edges differently.
const SHARE: f64 = 0.001;

/// The share of pixels that differ.
fn difference(a: &Image, b: &Image) -> f64 {
    assert_eq!((a.width, a.height), (b.width, b.height));
    let pairs = a.rgba.chunks_exact(4).zip(b.rgba.chunks_exact(4));
    let differ = |(a, b): &(&[u8], &[u8])| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > CHANNEL);
    pairs.filter(differ).count() as f64 / f64::from(a.width * a.height)
}

fn check(name: &str, image: &Image) {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/golden/{name}.png"));
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        let color = image::ColorType::Rgba8;
        image::save_buffer(&path, &image.rgba, image.width, image.height, color).expect("the picture is written");
        return;
    }
    let stored = image::open(&path).expect("a stored picture; UPDATE_GOLDEN=1 writes it").to_rgba8();
    let stored = Image { width: stored.width(), height: stored.height(), rgba: stored.into_raw() };
    let share = difference(image, &stored);
    if share > SHARE {
        let actual = std::env::temp_dir().join(format!("{name}.actual.png"));
        let color = image::ColorType::Rgba8;
        image::save_buffer(&actual, &image.rgba, image.width, image.height, color).expect("the picture is written");
        panic!("{name}: {:.2} % of the pixels differ, see {}", share * 100.0, actual.display());
    }
}

/// Flat, smooth, metal and emission, on a floor.
fn opaque(origin: DVec3) -> SceneData {
    let mut flat = sphere(12, 8);
    flat.normals.clear();
    let materials = vec![
        material([0.45, 0.45, 0.42, 1.0]),
        material([0.7, 0.1, 0.08, 1.0]),
        Material { metallic: 1.0, roughness: 0.3, ..material([0.9, 0.7, 0.3, 1.0]) },
        Material { emissive: [0.0, 0.6, 2.0], ..material([0.02, 0.02, 0.02, 1.0]) },
        Material { unlit: true, ..material([0.1, 0.5, 0.2, 1.0]) },
    ];
    let meshes =
        vec![mesh(cube(), 0), mesh(flat, 1), mesh(sphere(32, 16), 2), mesh(sphere(24, 12), 3), mesh(cube(), 4)];
    let objects = vec![
        object(0, scaled(8.0, 0.1, 8.0, origin + DVec3::new(0.0, -1.1, 0.0))),
        object(1, scaled(1.0, 1.0, 1.0, origin + DVec3::new(-2.4, 0.0, 0.0))),
        object(2, scaled(1.0, 1.0, 1.0, origin)),
        object(3, scaled(0.5, 0.5, 0.5, origin + DVec3::new(1.6, -0.5, 1.0))),
        object(4, DAffine3::from_translation(origin + DVec3::new(3.0, 0.0, -0.5)) * DAffine3::from_rotation_y(0.6)),
    ];
    SceneData { meshes, materials, objects, images: Vec::new() }
}

#[test]
fn opaque_flat_smooth_metal_emissive_unlit() {
    let mut studio = Studio::new(&opaque(DVec3::ZERO), WIDTH, HEIGHT);
    check("opaque", &studio.image(view([1.0, 2.5, 7.0], [0.0, -0.2, 0.0]), &[]));
}
