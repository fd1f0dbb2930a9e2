//! Pictures of small scenes against stored ones. `UPDATE_GOLDEN=1` writes them anew.

mod common;

use common::*;
use glam::{DAffine3, DVec3};
use svs_render::{AlphaMode, Filter, Image, Line, Material, Sampler, SceneData, TextureRef, Wrap};

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
    if updating() {
        save(&path(name), image);
    } else {
        compare(name, image);
    }
}

fn updating() -> bool {
    std::env::var_os("UPDATE_GOLDEN").is_some()
}

fn path(name: &str) -> std::path::PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/golden/{name}.png"))
}

fn save(path: &std::path::Path, image: &Image) {
    let color = image::ColorType::Rgba8;
    image::save_buffer(path, &image.rgba, image.width, image.height, color).expect("the picture is written");
}

/// For pictures that another test stores.
fn compare(name: &str, image: &Image) {
    if updating() {
        // The stored one may just be written.
        return;
    }
    let stored = image::open(path(name)).expect("a stored picture; UPDATE_GOLDEN=1 writes it").to_rgba8();
    let stored = Image { width: stored.width(), height: stored.height(), rgba: stored.into_raw() };
    let share = difference(image, &stored);
    if share > SHARE {
        let actual = std::env::temp_dir().join(format!("{name}.actual.png"));
        save(&actual, image);
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
    let meshes = vec![
        mesh(cube(), 0),
        mesh(flat, 1),
        mesh(sphere(32, 16), 2),
        mesh(sphere(24, 12), 3),
        mesh(cube(), 4),
    ];
    let objects = vec![
        object(0, scaled(8.0, 0.1, 8.0, origin + DVec3::new(0.0, -1.1, 0.0))),
        object(1, scaled(1.0, 1.0, 1.0, origin + DVec3::new(-2.4, 0.0, 0.0))),
        object(2, scaled(1.0, 1.0, 1.0, origin)),
        object(3, scaled(0.5, 0.5, 0.5, origin + DVec3::new(1.6, -0.5, 1.0))),
        object(
            4,
            DAffine3::from_translation(origin + DVec3::new(3.0, 0.0, -0.5)) * DAffine3::from_rotation_y(0.6),
        ),
    ];
    SceneData { meshes, materials, objects, images: Vec::new() }
}

#[test]
fn opaque_flat_smooth_metal_emissive_unlit() {
    let mut studio = Studio::new(&opaque(DVec3::ZERO), WIDTH, HEIGHT);
    check("opaque", &studio.image(view([1.0, 2.5, 7.0], [0.0, -0.2, 0.0]), &[]));
}

#[test]
fn ten_million_metres_from_the_origin_nothing_changes() {
    let far = DVec3::new(1e7, -2e6, 1e7);
    let mut studio = Studio::new(&opaque(far), WIDTH, HEIGHT);
    let mut view = view([1.0, 2.5, 7.0], [0.0, -0.2, 0.0]);
    view.eye += far;
    compare("opaque", &studio.image(view, &[]));
}

/// Squares of two colours; every second one has no alpha.
fn checks(size: u32, a: [u8; 4], b: [u8; 4]) -> Image {
    let texel = |i: u32| if (i % size / 8 + i / size / 8).is_multiple_of(2) { a } else { b };
    Image { width: size, height: size, rgba: (0..size * size).flat_map(texel).collect() }
}

fn texture(image: u32) -> Option<TextureRef> {
    Some(TextureRef { image, sampler: Sampler::default() })
}

#[test]
fn textures_masks_and_mipmaps() {
    let images = vec![
        checks(64, [220, 60, 30, 255], [240, 230, 200, 255]),
        checks(64, [40, 160, 60, 255], [40, 160, 60, 0]),
        checks(64, [0, 30, 255, 255], [0, 230, 0, 255]),
        checks(64, [255, 120, 0, 255], [0, 0, 0, 255]),
    ];
    let white = material([1.0; 4]);
    let nearest =
        Sampler { wrap_u: Wrap::Mirror, wrap_v: Wrap::Clamp, magnify: Filter::Nearest, ..Sampler::default() };
    let materials = vec![
        Material { base_color_texture: texture(0), ..white.clone() },
        Material {
            base_color_texture: texture(1),
            alpha: AlphaMode::Mask(0.5),
            double_sided: true,
            ..white.clone()
        },
        Material {
            metallic_roughness_texture: texture(2),
            emissive_texture: texture(3),
            emissive: [0.5; 3],
            metallic: 1.0,
            ..white.clone()
        },
        Material {
            base_color_texture: Some(TextureRef { image: 0, sampler: nearest }),
            unlit: true,
            ..white
        },
    ];
    // The floor repeats its texture so often that it is grey at the horizon.
    let mut floor = cube();
    floor.uvs.iter_mut().for_each(|uv| *uv = uv.map(|x| x * 30.0));
    let mut sign = quad();
    sign.uvs.iter_mut().for_each(|uv| *uv = uv.map(|x| x * 3.0 - 1.0));
    let meshes = vec![mesh(floor, 0), mesh(sphere(32, 16), 1), mesh(sphere(32, 16), 2), mesh(sign, 3)];
    let objects = vec![
        object(0, scaled(60.0, 0.1, 60.0, DVec3::new(0.0, -1.1, -40.0))),
        object(1, at(-2.2, 0.0, 0.0)),
        object(2, at(0.0, 0.0, 0.0)),
        object(3, at(2.3, 0.0, 0.0)),
    ];
    let data = SceneData { meshes, materials, objects, images };
    check("textured", &Studio::new(&data, WIDTH, HEIGHT).image(view([0.0, 1.0, 5.5], [0.0, 0.0, 0.0]), &[]));
}

#[test]
fn blended_surfaces_lie_over_opaque_ones_from_far_to_near() {
    let glass = |color: [f32; 3]| Material {
        alpha: AlphaMode::Blend,
        double_sided: true,
        ..material([color[0], color[1], color[2], 0.5])
    };
    let materials = vec![
        material([0.8, 0.8, 0.8, 1.0]),
        glass([0.9, 0.05, 0.05]),
        glass([0.05, 0.8, 0.05]),
        glass([0.05, 0.05, 0.9]),
    ];
    let meshes = vec![mesh(cube(), 0), mesh(quad(), 1), mesh(quad(), 2), mesh(quad(), 3)];
    let objects = vec![
        object(3, at(0.8, 0.5, 1.0)),
        object(1, at(-0.6, 0.0, -2.0)),
        object(2, at(0.1, -0.3, 0.0)),
        object(0, scaled(0.4, 2.0, 0.4, DVec3::new(0.2, 0.0, -1.0))),
        object(0, scaled(5.0, 0.1, 5.0, DVec3::new(0.0, -1.6, 0.0))),
    ];
    let data = SceneData { meshes, materials, objects, images: Vec::new() };
    check("blended", &Studio::new(&data, WIDTH, HEIGHT).image(view([0.6, 0.6, 5.0], [0.0, -0.2, 0.0]), &[]));
}

/// The quads turn away one after the other: the double-sided ones stay. Below, the same mirrored, and mirrored instances.
#[test]
fn double_sided_and_mirrored() {
    let materials = vec![
        material([0.9, 0.6, 0.1, 1.0]),
        Material { double_sided: true, ..material([0.1, 0.5, 0.8, 1.0]) },
    ];
    // The last mesh has too many vertices for its uses to be merged.
    let meshes = vec![mesh(quad(), 0), mesh(quad(), 1), mesh(sphere(48, 24), 0)];
    let mut objects = Vec::new();
    for column in 0..6 {
        let turn = DAffine3::from_rotation_y(f64::from(column) * 0.7);
        for (row, mirror) in [(0, 1.0), (1, -1.0)] {
            let place = DVec3::new(f64::from(column) * 1.2 - 3.0, 1.3 - f64::from(row) * 1.2, 0.0);
            let to_world =
                DAffine3::from_translation(place) * turn * scaled(0.5 * mirror, 0.5, 0.5, DVec3::ZERO);
            objects.push(object(column % 2, to_world));
        }
        let place = DVec3::new(f64::from(column) * 1.2 - 3.0, -1.1, 0.0);
        let mirror = if column % 2 == 0 { 0.5 } else { -0.5 };
        objects.push(object(2, scaled(0.3, mirror, 0.5, place)));
    }
    let data = SceneData { meshes, materials, objects, images: Vec::new() };
    check("mirrored", &Studio::new(&data, WIDTH, HEIGHT).image(view([0.0, 0.2, 5.0], [0.0, 0.0, 0.0]), &[]));
}

#[test]
fn vertex_colours() {
    let mut ball = sphere(32, 16);
    ball.colors = ball.uvs.iter().map(|uv| [(uv[0] * 255.0) as u8, (uv[1] * 255.0) as u8, 60, 255]).collect();
    let mut square = quad();
    square.colors = vec![[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255, 255, 255, 255]];
    square.normals.clear();
    let materials = vec![material([1.0; 4]), Material { unlit: true, ..material([0.8, 0.8, 0.8, 1.0]) }];
    let meshes = vec![mesh(ball, 0), mesh(square.clone(), 0), mesh(square, 1)];
    let objects =
        vec![object(0, at(-2.4, 0.0, 0.0)), object(1, at(0.0, 0.0, 0.0)), object(2, at(2.3, 0.0, 0.0))];
    let data = SceneData { meshes, materials, objects, images: Vec::new() };
    check("colours", &Studio::new(&data, WIDTH, HEIGHT).image(view([0.0, 0.3, 4.5], [0.0, 0.0, 0.0]), &[]));
}

/// 400 cubes and 400 balls, turned and scaled.
fn grid() -> SceneData {
    let materials = vec![material([0.3, 0.5, 0.8, 1.0]), material([0.8, 0.4, 0.2, 1.0])];
    let meshes = vec![mesh(cube(), 0), mesh(sphere(16, 8), 1)];
    let mut objects = Vec::new();
    for row in 0..20 {
        for column in 0..40 {
            let (x, z) = (f64::from(column) - 19.5, f64::from(row) - 10.0);
            let turn = DAffine3::from_rotation_y(x * 0.3) * DAffine3::from_rotation_x(z * 0.2);
            let size = scaled(0.35, 0.2 + 0.1 * (x * 0.5).sin(), 0.3, DVec3::ZERO);
            objects.push(object((row + column) as u32 % 2, at(x, 0.0, z) * turn * size));
        }
    }
    SceneData { meshes, materials, objects, images: Vec::new() }
}

#[test]
fn instances_in_a_grid() {
    check(
        "instances",
        &Studio::new(&grid(), WIDTH, HEIGHT).image(view([3.0, 6.0, 16.0], [0.0, 0.0, 0.0]), &[]),
    );
}

#[test]
fn tints_and_lines() {
    let data = grid();
    let mut studio = Studio::new(&data, WIDTH, HEIGHT);
    let tints: Vec<[u8; 4]> = (0..data.objects.len())
        .map(|i| [(i % 256) as u8, 200, 40, if i % 3 == 0 { 0 } else { 230 }])
        .collect();
    studio.scene.set_tints(gpu(), Some(&tints));
    let ring = |i: u32| {
        let angle = f64::from(i) / 48.0 * std::f64::consts::TAU;
        DVec3::new(angle.cos() * 7.0, 0.1, angle.sin() * 7.0)
    };
    let lines: Vec<Line> =
        (0..48).map(|i| Line { from: ring(i), to: ring(i + 1), color: [255, 0, 255, 255] }).collect();
    let view = view([3.0, 6.0, 16.0], [0.0, 0.0, 0.0]);
    check("tints", &studio.image(view, &lines));
    studio.scene.set_tints(gpu(), None);
    compare("instances", &studio.image(view, &[]));
}
