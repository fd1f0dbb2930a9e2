//! Pictures and items against each other and against arithmetic.

mod common;
#[path = "common/light.rs"]
mod light;

use common::*;
use glam::{DAffine3, DVec3};
use svs_render::{
    AlphaMode, DrawStatistics, Frame, GpuScene, Line, Material, Mesh, NO_ITEM, Offscreen, Primitive,
    RenderError, SceneData, View,
};

/// 60 balls, a fifth of them mirrored, turned every way.
fn balls() -> SceneData {
    let objects = (0..60).map(|i| {
        let t = f64::from(i);
        let place = DVec3::new((t * 0.7).sin() * 6.0, (t * 1.3).cos() * 3.0, (t * 0.37).sin() * 6.0);
        let mirror = if i % 5 == 0 { -0.8 } else { 0.8 };
        object(
            0,
            DAffine3::from_translation(place)
                * DAffine3::from_rotation_z(t)
                * scaled(mirror, 0.6, 1.0, DVec3::ZERO),
        )
    });
    SceneData {
        meshes: vec![mesh(sphere(24, 12), 0)],
        materials: vec![material([0.6, 0.5, 0.4, 1.0])],
        objects: objects.collect(),
        images: Vec::new(),
    }
}

/// The same with a mesh of its own for every object: all merged.
fn merged(mut data: SceneData) -> SceneData {
    let meshes = std::mem::take(&mut data.meshes);
    for (i, object) in data.objects.iter_mut().enumerate() {
        data.meshes.push(meshes[object.mesh as usize].clone());
        object.mesh = i as u32;
    }
    data
}

fn aim() -> View {
    view([5.0, 4.0, 14.0], [0.0, 0.0, 0.0])
}

#[test]
fn merged_and_instanced_objects_show_the_same() {
    let (mut one, mut other) = (Studio::new(&balls(), 320, 180), Studio::new(&merged(balls()), 320, 180));
    let (a, b) = (one.items(aim()), other.items(aim()));
    let seen: std::collections::HashSet<u32> =
        a.nearest.iter().copied().filter(|&id| id != NO_ITEM).collect();
    assert!(seen.len() > 50, "{}", seen.len());
    let differ = a.nearest.iter().zip(&b.nearest).filter(|(a, b)| a != b).count();
    assert!(differ * 2000 < a.nearest.len(), "{differ} of {} pixels", a.nearest.len());
    assert!(a.transparent.iter().all(|&id| id == NO_ITEM));
    let (a, b) = (one.image(aim(), &[]), other.image(aim(), &[]));
    let differ = a.rgba.iter().zip(&b.rgba).filter(|(a, b)| a.abs_diff(**b) > 3).count();
    assert!(differ * 500 < a.rgba.len(), "{differ} of {} bytes", a.rgba.len());
}

#[test]
fn the_order_of_the_list_and_repetitions_do_not_matter() {
    for data in [balls(), merged(balls())] {
        let mut studio = Studio::new(&data, 320, 180);
        let (image, items) = (studio.image(aim(), &[]), studio.items(aim()));
        // 37 and 60 have no common divisor.
        studio.objects = (0..90).map(|i| i * 37 % 60).chain([60, u32::MAX]).collect();
        assert_eq!(studio.image(aim(), &[]), image);
        assert_eq!(studio.items(aim()), items);
    }
}

fn statistics(data: &SceneData, objects: &[u32]) -> DrawStatistics {
    let mut studio = Studio::new(data, 16, 16);
    let mut renderer = Offscreen::renderer(gpu());
    let frame = Frame { view: aim(), objects, lines: &[] };
    studio.offscreen.time(gpu(), &mut renderer, &studio.scene, &frame).expect("a time").statistics
}

#[test]
fn neighbours_and_instances_share_draw_calls() {
    let all: Vec<u32> = (0..60).collect();
    let triangles = u64::from(24u32 * 12 * 2);
    let expected =
        |objects, draw_calls| DrawStatistics { objects, triangles: triangles * objects as u64, draw_calls };
    // Three runs of 16,384 triangles at most, cut between objects.
    assert_eq!(statistics(&merged(balls()), &all), expected(60, 3));
    assert_eq!(statistics(&merged(balls()), &[3, 4, 5, 9, 8, 20]), expected(6, 3));
    // The mirrored ones are drawn by a call of their own.
    assert_eq!(statistics(&balls(), &all), expected(60, 2));
    assert_eq!(statistics(&balls(), &[]), DrawStatistics::default());
}

#[test]
fn items_tell_opaque_from_blended_ones_and_look_through_masks() {
    let mut holes = quad();
    holes.uvs.iter_mut().for_each(|uv| uv[1] = 0.5);
    // The left half of the texture is a hole.
    let image = svs_render::Image { width: 2, height: 1, rgba: vec![255, 255, 255, 0, 255, 255, 255, 255] };
    let nearest = svs_render::Sampler {
        wrap_u: svs_render::Wrap::Clamp,
        magnify: svs_render::Filter::Nearest,
        minify: svs_render::Filter::Nearest,
        ..Default::default()
    };
    let masked = Material {
        alpha: AlphaMode::Mask(0.5),
        base_color_texture: Some(svs_render::TextureRef { image: 0, sampler: nearest }),
        ..material([1.0; 4])
    };
    let glass = Material { alpha: AlphaMode::Blend, ..material([1.0, 1.0, 1.0, 0.3]) };
    let data = SceneData {
        meshes: vec![mesh(quad(), 0), mesh(holes, 1), mesh(quad(), 2), mesh(quad(), 2), mesh(quad(), 2)],
        materials: vec![material([1.0; 4]), masked, glass],
        objects: vec![
            object(0, scaled(5.0, 5.0, 1.0, DVec3::new(0.0, 0.0, -2.0))),
            object(1, at(0.0, 0.0, 0.0)),
            object(2, scaled(1.0, 0.2, 1.0, DVec3::new(0.0, 0.5, 1.0))),
            object(3, scaled(1.0, 0.2, 1.0, DVec3::new(0.0, 0.5, 0.5))),
            object(4, at(0.0, 0.0, -3.0)),
        ],
        images: vec![image],
    };
    let mut studio = Studio::new(&data, 100, 100);
    let items = studio.items(view([0.0, 0.0, 5.0], [0.0, 0.0, 0.0]));
    let at = |x: usize, y: usize| (items.nearest[y * 100 + x], items.transparent[y * 100 + x]);
    assert_eq!(at(42, 60), (0, NO_ITEM), "through the hole");
    assert_eq!(at(58, 60), (1, NO_ITEM), "on the mask");
    // The nearer of two, whatever their order; the third is behind the wall.
    assert_eq!(at(42, 38), (0, 2));
    assert_eq!(at(58, 38), (1, 2));
}

#[test]
fn shading_agrees_with_its_twin() {
    let base = [0.6, 0.35, 0.15];
    for (metallic, roughness) in [(0.0, 0.6), (1.0, 0.4), (0.5, 0.2)] {
        let surface = Material {
            base_color: [base[0], base[1], base[2], 1.0],
            metallic,
            roughness,
            ..Material::default()
        };
        let data = SceneData {
            meshes: vec![mesh(sphere(256, 128), 0)],
            materials: vec![surface],
            objects: vec![object(0, DAffine3::IDENTITY)],
            images: Vec::new(),
        };
        let view = view([1.5, 1.0, 2.0], [0.0, 0.0, 0.0]);
        let image = Studio::new(&data, 64, 64).image(view, &[]);
        let tangent = (view.vertical_fov * 0.5).tan();
        let (mut compared, mut worst) = (0, 0.0f64);
        for (pixel, rgba) in image.rgba.chunks_exact(4).enumerate() {
            let x = ((pixel % 64) as f64 + 0.5) / 32.0 - 1.0;
            let y = 1.0 - ((pixel / 64) as f64 + 0.5) / 32.0;
            let ray = (view.forward + (view.right() * x + view.up * y) * tangent).normalize();
            let along = -view.eye.dot(ray);
            let below = 1.0 - (view.eye + ray * along).length_squared();
            // Away from the edge, where the polygons are not the ball.
            if below < 0.05 {
                continue;
            }
            let normal = view.eye + ray * (along - below.sqrt());
            let color = DVec3::from(base.map(f64::from));
            let expected = light::shade(color, f64::from(metallic), f64::from(roughness), normal, -ray);
            for (channel, expected) in expected.to_array().into_iter().enumerate() {
                worst = worst.max((f64::from(rgba[channel]) - light::srgb(expected)).abs());
            }
            compared += 1;
        }
        assert!(compared > 1000, "{compared}");
        assert!(worst < 4.0, "metallic {metallic}, roughness {roughness}: {worst} of 255");
    }
}

#[test]
fn empty_scenes_and_nothing_to_draw_show_the_sky() {
    let empty = SceneData::default();
    let bare = SceneData {
        meshes: vec![Mesh::default(), mesh(Primitive::default(), 0)],
        materials: vec![Material::default()],
        objects: vec![
            object(0, DAffine3::IDENTITY),
            object(1, DAffine3::IDENTITY),
            object(1, DAffine3::IDENTITY),
        ],
        images: Vec::new(),
    };
    let sky = Studio::new(&empty, 32, 32).image(aim(), &[]);
    assert_eq!(Studio::new(&bare, 32, 32).image(aim(), &[]), sky);
    let mut studio = Studio::new(&balls(), 32, 32);
    studio.objects.clear();
    assert_eq!(studio.image(aim(), &[]), sky);
    assert!(studio.items(aim()).nearest.iter().all(|&id| id == NO_ITEM));
}

#[test]
fn cameras_and_lines_that_are_no_numbers_do_no_harm() {
    let mut studio = Studio::new(&balls(), 32, 32);
    let nan = DVec3::splat(f64::NAN);
    let line = Line { from: nan, to: DVec3::splat(1e300), color: [255; 4] };
    studio.image(View { eye: nan, ..aim() }, &[line]);
    studio.items(View { eye: nan, vertical_fov: 0.0, ..aim() });
    studio.items(View { eye: DVec3::splat(1e300), near: 0.0, ..aim() });
}

fn refused(change: impl FnOnce(&mut SceneData)) -> String {
    let mut data = balls();
    change(&mut data);
    match GpuScene::upload(gpu(), &data, &[]) {
        Err(error @ RenderError::Data { .. }) => error.to_string(),
        Err(error) => panic!("another error: {error}"),
        Ok(_) => panic!("a broken scene was taken"),
    }
}

#[test]
fn broken_scenes_are_refused() {
    let primitive =
        |data: &mut SceneData, change: fn(&mut Primitive)| change(&mut data.meshes[0].primitives[0]);
    assert!(refused(|data| primitive(data, |p| p.indices[7] = 1_000_000)).contains("index is out of range"));
    assert!(refused(|data| primitive(data, |p| p.indices.truncate(100))).contains("multiple of three"));
    assert!(refused(|data| primitive(data, |p| p.positions[3][1] = f32::NAN)).contains("mesh 0: a position"));
    assert!(refused(|data| primitive(data, |p| p.normals[3][1] = f32::INFINITY)).contains("not finite"));
    assert!(refused(|data| primitive(data, |p| p.uvs[3][1] = f32::NAN)).contains("texture coordinate"));
    assert!(refused(|data| primitive(data, |p| p.normals.truncate(100))).contains("another length"));
    assert!(refused(|data| primitive(data, |p| p.material = 1)).contains("material does not exist"));
    assert!(refused(|data| data.objects[4].mesh = 9).contains("object 4: its mesh"));
    assert!(
        refused(|data| data.objects[4].to_world.translation.x = f64::NAN).contains("object 4: its transform")
    );
    assert!(refused(|data| data.materials[0].roughness = f32::NAN).contains("material 0"));
    assert!(
        refused(|data| data.materials[0].base_color_texture = texture_of(3)).contains("image does not exist")
    );
    let image = svs_render::Image { width: 3, height: 3, rgba: vec![0; 35] };
    assert!(refused(|data| data.images.push(image)).contains("image 0"));
    let order = GpuScene::upload(gpu(), &balls(), &[1, 60]).map(drop);
    assert!(matches!(order, Err(RenderError::Data { what: "order", index: 1, .. })), "{order:?}");
}

fn texture_of(image: u32) -> Option<svs_render::TextureRef> {
    Some(svs_render::TextureRef { image, sampler: Default::default() })
}

#[test]
fn pictures_without_pixels_or_larger_than_the_gpu_takes_are_refused() {
    assert!(matches!(Offscreen::new(gpu(), 0, 10), Err(RenderError::Data { .. })));
    assert!(matches!(Offscreen::new(gpu(), 1_000_000, 10), Err(RenderError::TooLarge { .. })));
}
