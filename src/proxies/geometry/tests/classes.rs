//! Materials, colours, normals and winding.

use super::*;
use glam::{DMat3, DVec3};
use svs_render::{Image, TextureRef};

fn made_of(material: Material, primitive: Primitive, images: &[Image]) -> ProxyGeometry {
    let mesh = mesh(vec![primitive]);
    let palette = Palette::new(&[material], images);
    simplify_node(&[placed(&mesh, DAffine3::IDENTITY)], &palette, &NodeOptions::default())
}

/// Linear colour that a plain class mesh shows.
fn shown(class: &ClassMesh) -> [f32; 3] {
    let Class::Plain(plain) = class.class else { panic!("not plain") };
    let color = class.uniform_color().expect("one colour");
    std::array::from_fn(|c| f32::from(color[c]) / 255.0 * plain.material().base_color[c])
}

#[test]
fn colors_are_kept_within_a_percent_dark_ones_too() {
    for color in [[0.9, 0.5, 0.3, 1.0], [0.1, 0.15, 0.05, 1.0], [0.01, 0.02, 0.005, 1.0]] {
        let material = Material { base_color: color, ..Material::default() };
        let made = made_of(material, cuboid([0.0; 3], 1.0), &[]);
        let shown = shown(&made.classes[0]);
        let top = color[..3].iter().fold(0.0f32, |a, &b| a.max(b));
        for (a, b) in shown.iter().zip(color) {
            assert!((a - b).abs() < 0.01 * top, "{shown:?} is not {color:?}");
        }
    }
}

#[test]
fn vertex_colors_multiply_the_base_color() {
    let material = Material { base_color: [1.0, 0.5, 1.0, 1.0], ..Material::default() };
    let mut primitive = cuboid([0.0; 3], 1.0);
    primitive.colors = vec![[128, 128, 0, 255]; primitive.positions.len()];
    let shown = shown(&made_of(material, primitive, &[]).classes[0]);
    for (a, b) in shown.iter().zip([0.5, 0.25, 0.0]) {
        assert!((a - b).abs() < 0.005, "{shown:?}");
    }
}

fn textured(rgba: Vec<u8>, width: u32) -> (Material, Primitive, Image) {
    let texture = TextureRef { image: 0, sampler: svs_render::Sampler::default() };
    let material = Material { base_color_texture: Some(texture), ..Material::default() };
    let mut primitive = cuboid([0.0; 3], 1.0);
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    primitive.uvs = corners.into_iter().cycle().take(24).collect();
    let height = rgba.len() as u32 / 4 / width;
    (material, primitive, Image { width, height, rgba })
}

#[test]
fn calm_textures_become_their_linear_mean() {
    // 188 in sRGB is half as bright as 255.
    let (material, primitive, image) = textured([188, 188, 188, 255].repeat(64), 8);
    let made = made_of(material, primitive, &[image]);
    assert!(made.classes[0].uvs.is_empty());
    let shown = shown(&made.classes[0]);
    assert!(shown.iter().all(|c| (c - 0.503).abs() < 0.005), "{shown:?}");
}

#[test]
fn lively_textures_are_kept_where_they_cover_much() {
    let checker: Vec<u8> = (0..64)
        .flat_map(|i| [if (i + i / 8) % 2 == 0 { 0 } else { 255 }; 3].into_iter().chain([255]))
        .collect();
    let (material, primitive, image) = textured(checker, 8);
    let palette = Palette::new(&[material, Material::default()], &[image]);
    let small = mesh(vec![primitive]);
    let large = mesh(vec![Primitive { material: 1, ..cuboid([20.0, 0.0, 0.0], 9.0) }]);
    let alone = [placed(&small, DAffine3::IDENTITY)];
    let made = simplify_node(&alone, &palette, &NodeOptions::default());
    assert_eq!(made.classes[0].class, Class::Kept { material: 0, flat: true });
    assert_eq!(made.classes[0].uvs.len(), made.classes[0].positions.len());
    let beside = [placed(&small, DAffine3::IDENTITY), placed(&large, DAffine3::IDENTITY)];
    let made = simplify_node(&beside, &palette, &NodeOptions::default());
    assert!(made.classes.iter().all(|mesh| matches!(mesh.class, Class::Plain(_))));
}

#[test]
fn materials_that_differ_little_share_a_class() {
    let materials = [0.5, 0.52, 0.9].map(|roughness| Material { roughness, ..Material::default() });
    let palette = Palette::new(&materials, &[]);
    let boxes = [0u32, 1, 2].map(|i| Primitive { material: i, ..cuboid([3.0 * i as f32, 0.0, 0.0], 1.0) });
    let mesh = mesh(boxes.to_vec());
    let made = simplify_node(&[placed(&mesh, DAffine3::IDENTITY)], &palette, &NodeOptions::default());
    assert_eq!(made.classes.iter().map(ClassMesh::triangles).collect::<Vec<_>>(), [24, 12]);
}

#[test]
fn mirrored_and_stretched_parts_look_outward() {
    let round = mesh(vec![sphere(16)]);
    for scale in [DVec3::new(-1.0, 1.0, 1.0), DVec3::new(-1.0, -2.0, -3.0), DVec3::new(4.0, 1.0, 0.5)] {
        let to_node = DAffine3::from_mat3(DMat3::from_diagonal(scale));
        let options = NodeOptions { target_triangles: 300, ..NodeOptions::default() };
        let made = simplify_node(&[placed(&round, to_node)], &palette(), &options);
        let class = &made.classes[0];
        assert!(volume(class) > 0.0, "{scale}");
        let mut fitting = 0;
        for (position, normal) in class.positions.iter().zip(&class.normals) {
            // The gradient of the ellipsoid.
            let p = Vec3::from_array(*position).as_dvec3();
            let outward = (p / (scale * scale)).normalize();
            let normal = Vec3::from_array(*normal).as_dvec3();
            assert!((normal.length() - 1.0).abs() < 1e-5, "{normal}");
            fitting += usize::from(normal.dot(outward) > 0.999);
        }
        // Along sharp rims a few take the normal of their triangle.
        assert!(fitting * 10 >= class.normals.len() * 9, "{scale}: {fitting} of {}", class.normals.len());
    }
}

#[test]
fn far_from_the_origin_nothing_is_lost() {
    let round = mesh(vec![sphere(32)]);
    let options = NodeOptions { target_triangles: 500, ..NodeOptions::default() };
    let near = simplify_node(&[placed(&round, DAffine3::IDENTITY)], &palette(), &options);
    let tiny = DAffine3::from_scale(DVec3::splat(1e-6));
    let small = simplify_node(&[placed(&round, tiny)], &palette(), &options);
    assert!((small.error / near.error - 1e-6).abs() < 3e-7, "{} {}", small.error, near.error);
    // Rounding may decide between two ways of simplifying that are as good.
    assert!(small.triangles.abs_diff(near.triangles) <= 5, "{} {}", small.triangles, near.triangles);
}
