//! Hand-made scenes with exact expected answers, and one file from bake to report.

use super::methods::{Measure, Slider};
use super::*;
use crate::bake::{self, BakeOptions, Quality, Silent};
use crate::baked::Baked;
use crate::scene::{Mesh, Object, Opacity, Role, Scene, Surface};
use glam::{DAffine3, DVec3, Vec3};
use serde_json::json;
use svs_runtime::Settings;

/// Corners of the cube from -1 to 1 and its triangles, counter-clockwise from outside.
fn cube_geometry() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let corner = |i: u32| Vec3::from_array([0, 1, 2].map(|axis| if i >> axis & 1 == 0 { -1.0 } else { 1.0 }));
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    ((0..8).map(corner).collect(), triangles)
}

fn cube(opacity: Opacity) -> Mesh {
    let (positions, triangles) = cube_geometry();
    Mesh {
        positions,
        triangles,
        surfaces: vec![Surface { triangles: 0..12, double_sided: false, opacity }],
        drawn_triangles: 12,
        min: DVec3::NEG_ONE,
        max: DVec3::ONE,
        ..Mesh::default()
    }
}

/// Cubes by (centre, half side, transparent).
fn scene(cubes: &[(DVec3, f64, bool)]) -> Scene {
    let object = |&(center, half, transparent): &(DVec3, f64, bool)| Object {
        node: 0,
        instance: None,
        mesh: u32::from(transparent),
        scene_node: 0,
        to_world: DAffine3::from_scale_rotation_translation(DVec3::splat(half), Default::default(), center),
        role: Role::Static,
        hidden: false,
    };
    Scene {
        meshes: vec![cube(Opacity::Opaque), cube(Opacity::Transparent)],
        objects: cubes.iter().map(object).collect(),
        ..Scene::default()
    }
}

fn target(scene: &Scene) -> Target {
    Target::new(scene, &vec![true; scene.objects.len()])
}

/// 100x100 pixels, looking along -z; at distance d the image is d wide.
fn front_view(z: f64) -> View {
    View::new(DVec3::new(0.0, 0.0, z), DVec3::NEG_Z, 0.5, 100, 100)
}

fn seen(scene: &Scene, view: &View) -> VisibleSet {
    visible_set(&RayScene::new(&scene.meshes, &target(scene).parts), view)
}

#[test]
fn a_box_hides_the_smaller_one_behind_it() {
    // Faces at distances 10 and 20: 20 pixels wide and, were it not hidden, 10.
    let scene = scene(&[(DVec3::new(0.0, 0.0, -11.0), 1.0, false), (DVec3::new(0.0, 0.0, -1.0), 1.0, false)]);
    assert_eq!(seen(&scene, &front_view(10.0)), [(1, 400)]);
}

#[test]
fn a_larger_box_is_seen_around_the_one_before_it() {
    let scene = scene(&[(DVec3::new(0.0, 0.0, -1.0), 1.0, false), (DVec3::new(0.0, 0.0, -14.0), 4.0, false)]);
    assert_eq!(seen(&scene, &front_view(10.0)), [(0, 400), (1, 1200)]);
}

#[test]
fn a_transparent_box_is_seen_and_hides_nothing() {
    let scene = scene(&[(DVec3::new(0.0, 0.0, -1.0), 1.0, true), (DVec3::new(0.0, 0.0, -14.0), 4.0, false)]);
    assert_eq!(seen(&scene, &front_view(10.0)), [(0, 400), (1, 1600)]);
    // Behind the opaque one it is not seen.
    assert_eq!(seen(&scene, &View::new(DVec3::new(0.0, 0.0, -28.0), DVec3::Z, 0.5, 100, 100)), [(1, 6400)]);
}

#[test]
fn culled_back_faces_show_nothing() {
    let scene = scene(&[(DVec3::ZERO, 5.0, false), (DVec3::new(0.0, 0.0, -14.0), 4.0, false)]);
    // From within the first box one looks through its wall.
    assert_eq!(seen(&scene, &front_view(0.0)), [(1, 6400)]);
}

#[test]
fn distance_and_place_cost_no_precision() {
    let near = scene(&[(DVec3::ZERO, 1.0, false), (DVec3::new(0.3, 0.0, -1.00001), 1.0, false)]);
    let shift = DVec3::new(1e7, -1e7, 1e7);
    let far = scene(&[(shift, 1.0, false), (shift + DVec3::new(0.3, 0.0, -1.00001), 1.0, false)]);
    let view = front_view(60.0);
    let moved = View { eye: view.eye + shift, ..view.clone() };
    assert_eq!(seen(&near, &view), seen(&far, &moved));
}

#[test]
fn frames_count_what_is_missing() {
    let scene = scene(&[(DVec3::new(0.0, 0.0, -1.0), 1.0, false), (DVec3::new(0.0, 0.0, -14.0), 4.0, false)]);
    let target = target(&scene);
    let rays = RayScene::new(&scene.meshes, &target.parts);
    let frame = Frame::render(&target, &rays, front_view(10.0));
    assert_eq!((frame.visible_triangles, frame.frustum_triangles), (24, 24));
    let score = frame.score(&target, &mut vec![0, 0]);
    assert_eq!(
        score,
        Score { missing_objects: 1, missing_pixels: 1200, drawn_objects: 1, drawn_triangles: 12 }
    );
    assert_eq!(frame.missing_ppm(&score), 120_000.0);
}

fn published(scene: &Scene, target: &Target, pixel_limit: u64) -> PublishedBake {
    let rays = RayScene::new(&scene.meshes, &target.parts);
    PublishedBake::new(target, &scene.meshes, &rays, (64, pixel_limit), &Silent)
}

#[test]
fn published_bake_of_a_box_in_a_box() {
    let scene = scene(&[(DVec3::ZERO, 1.0, false), (DVec3::ZERO, 2.0, false)]);
    let target = target(&scene);
    let bake = published(&scene, &target, u64::MAX);
    assert_eq!(bake.sampling, Sampling::PerSphere);
    assert_eq!((bake.hierarchy.nodes.len(), bake.directions.len()), (1, 20));
    assert!((bake.spheres[0].radius - 12f64.sqrt()).abs() < 1e-5);
    for direction in 0..20 {
        let [(member, pixels)] = *bake.vector(0, direction) else { panic!("only the outer box is visible") };
        assert_eq!(member, 1);
        // Projected area of a cube of side 4, in pixels of an image 2 r wide.
        let d = bake.directions.direction_f64(direction).abs();
        let expected = 16.0 * (d.x + d.y + d.z) * (64.0 / (2.0 * bake.spheres[0].radius)).powi(2);
        assert!((f64::from(pixels) / expected - 1.0).abs() < 0.05, "{pixels} {expected}");
    }
    let mut drawn = Vec::new();
    bake.draw(&target, &front_view(10.0), &mut drawn);
    assert_eq!(drawn, [1]);
    // Inside the sphere its objects are drawn as they are, if the frustum touches them.
    bake.draw(&target, &front_view(3.0), &mut drawn);
    drawn.sort_unstable();
    assert_eq!(drawn, [0, 1]);
    bake.draw(&target, &View::new(DVec3::new(0.0, 0.0, 3.0), DVec3::Z, 0.5, 100, 100), &mut drawn);
    assert!(drawn.is_empty());
}

/// Two far clusters of nine cubes, each behind the walls of a closed box.
fn two_clusters() -> Scene {
    let mut cubes = Vec::new();
    for side in [-1.0, 1.0] {
        let center = DVec3::new(side * 20.0, 0.0, 0.0);
        cubes.push((center, 4.0, false));
        for i in 0..9 {
            let offset = DVec3::new(f64::from(i % 3), f64::from(i / 3), 0.0) - 1.0;
            cubes.push((center + offset * 2.0, 0.5, false));
        }
    }
    scene(&cubes)
}

#[test]
fn one_grid_for_all_spheres_sees_what_each_sphere_sees() {
    let scene = two_clusters();
    let target = target(&scene);
    let grid = published(&scene, &target, 0);
    let images = published(&scene, &target, u64::MAX);
    assert_eq!((grid.sampling, images.sampling), (Sampling::RootGrid, Sampling::PerSphere));
    let nodes = grid.hierarchy.nodes.len();
    assert!(nodes >= 3, "{nodes} nodes");
    for node in 0..nodes {
        for direction in 0..20 {
            if node == 0 {
                assert_eq!(grid.vector(0, direction), images.vector(0, direction));
            }
            let members = |bake: &PublishedBake| -> Vec<u32> {
                bake.vector(node, direction).iter().map(|&(member, _)| member).collect()
            };
            // The coarser grid may miss slivers, but sees nothing that is not there; housings hide the rest.
            let fine = members(&images);
            assert!(members(&grid).iter().all(|m| fine.contains(m)), "node {node}, direction {direction}");
        }
    }
    assert!(grid.vectors.iter().take(20).flatten().all(|&(member, _)| member % 10 == 0));
}

#[test]
fn published_bake_is_the_same_for_any_number_of_threads() {
    let scene = two_clusters();
    let target = target(&scene);
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| published(&scene, &target, 0).vectors)
    };
    assert_eq!(with(1), with(3));
}

/// Draws the first members: more, the higher the settings' quality.
struct Prefix(u32);

impl Slider for Prefix {
    fn draw(&mut self, _: &View, settings: &Settings, drawn: &mut Vec<u32>) {
        let steps = (0..=512).map(|i| i as f32 / 512.0).chain((0..=20).map(|i| i as f32 / 20.0));
        let quality = steps.filter(|&q| Settings::from_quality(q) == *settings).fold(0.0, f32::max);
        drawn.extend(0..(quality * self.0 as f32).round() as u32);
    }
}

#[test]
fn published_triangles_are_bracketed_on_the_slider() {
    let scene = two_clusters();
    let target = target(&scene);
    let rays = RayScene::new(&scene.meshes, &target.parts);
    let around = target.surroundings();
    let image = CameraOptions { seed: 1, width: 64, height: 36 };
    let frames: Vec<(usize, Frame)> = (0..CAMERA_GROUPS.len())
        .map(|group| (group, Frame::render(&target, &rays, camera(group, 0, &around, &image))))
        .collect();
    let bake = published(&scene, &target, 0);
    let measure = Measure {
        target: &target,
        frames: &frames,
        slider: Prefix(20),
        published: Some(&bake),
        recommended: Some(0.25),
    };
    let rows = measure.rows(true);
    let find = |group: &str, method: &str| rows.iter().find(|r| r.group == group && r.method == method);
    for group in ["outside", "inside", "outside 1.05r", "outside 1.5r", "outside 3r", "outside 10r"] {
        let frustum = find(group, "frustum").unwrap();
        assert_eq!(frustum.triangles.over_frustum, 1.0);
        assert_eq!(frustum.missing_ppm.worst, 0.0);
        assert_eq!(find(group, "default").unwrap().quality, Some(0.25));
        assert!(find(group, "quality 0.55").is_some());
        let published = find(group, "published").unwrap();
        let equal = find(group, "at published triangles").unwrap();
        assert!(equal.note.is_some() || equal.triangles == published.triangles);
    }
    assert_eq!(find("outside", "default").unwrap().cameras, 4);
}

/// A glTF of cubes: a closed shell with `inner` cubes in it and one cube beside it.
fn document(inner: u32) -> Document {
    let (positions, triangles) = cube_geometry();
    let mut bin: Vec<u8> = positions.iter().flat_map(|p| p.to_array()).flat_map(f32::to_le_bytes).collect();
    bin.extend(triangles.iter().flatten().flat_map(|&i| (i as u16).to_le_bytes()));
    let mut nodes = vec![
        json!({"mesh": 0, "scale": [10.0, 10.0, 10.0]}),
        json!({"mesh": 0, "translation": [30.0, 0.0, 0.0], "scale": [3.0, 3.0, 3.0]}),
    ];
    nodes.extend((0..inner).map(
        |i| json!({"mesh": 0, "translation": [f64::from(i) - 4.0, 3.0, 0.0], "scale": [0.4, 0.4, 0.4]}),
    ));
    let json = json!({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": (0..nodes.len()).collect::<Vec<_>>()}],
        "nodes": nodes,
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3", "min": [-1.0, -1.0, -1.0], "max": [1.0, 1.0, 1.0]},
            {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 96},
            {"buffer": 0, "byteOffset": 96, "byteLength": 72},
        ],
        "buffers": [{"byteLength": bin.len()}],
    });
    Document::from_parts(json, Some(bin)).unwrap()
}

fn baked_document() -> Document {
    let mut doc = document(8);
    let options =
        BakeOptions { quality: Quality::Draft, verify: false, rays: Some(200_000), ..BakeOptions::default() };
    bake::build(&mut doc, &options, &Silent).unwrap();
    doc
}

const SMALL: VerifyOptions = VerifyOptions { cameras: 3, seed: 5, published: false, width: 96, height: 54 };

#[test]
fn a_baked_file_is_measured() {
    let doc = baked_document();
    let report = verify(&doc, &SMALL, &Silent).unwrap();
    assert_eq!((report.objects, report.triangles), (10, 120));
    let outside = report.find("outside", "default").unwrap();
    assert_eq!(outside.cameras, 12);
    assert_eq!(outside.missing_ppm.worst, 0.0, "two boxes side by side hide nothing that matters");
    // The shell's content is not drawn from outside, and frustum culling cannot know.
    let frustum = report.find("outside", "frustum").unwrap();
    assert!(outside.triangles.over_evs <= 1.5 && frustum.triangles.over_evs > 2.0);
    assert!(report.find("inside", "quality 1").is_some() && report.find("outside 10r", "default").is_some());
    assert!(report.find("outside", "published").is_none() && report.published.is_none());
    let json = serde_json::to_value(&report).unwrap();
    assert!(json["groups"][0]["missing_ppm"]["p95"].is_number());

    let short = short(&doc, &Silent).unwrap();
    assert_eq!(short.groups.len(), 4);
    assert!(short.find("inside", "default").is_some());
}

#[test]
fn trees_that_move_are_measured_where_they_rest() {
    let mut doc = document(8);
    // Everything hangs on an animated node that is turned, mirrored and scaled; the cube beside it stays.
    let children: Vec<usize> = (0..10).filter(|&node| node != 1).collect();
    let group = json!({"children": children, "translation": [0.0, 40.0, 0.0], "rotation": [0.0, 0.6, 0.0, 0.8], "scale": [-2.0, 2.0, 2.0]});
    doc.json["nodes"].as_array_mut().unwrap().push(group);
    let still = json!({"mesh": 0, "translation": [30.0, 8.0, 0.0], "scale": [3.0, 3.0, 3.0]});
    doc.json["nodes"].as_array_mut().unwrap().push(still);
    doc.json["scenes"][0]["nodes"] = json!([1, 10, 11]);
    let key = json!({"bufferView": 0, "componentType": 5126, "count": 1, "type": "SCALAR", "min": [-1.0], "max": [-1.0]});
    let value = json!({"bufferView": 0, "componentType": 5126, "count": 1, "type": "VEC3"});
    doc.json["accessors"].as_array_mut().unwrap().extend([key, value]);
    doc.json["animations"] = json!([{
        "samplers": [{"input": 2, "output": 3}],
        "channels": [{"sampler": 0, "target": {"node": 10, "path": "translation"}}],
    }]);
    let options =
        BakeOptions { quality: Quality::Draft, verify: false, rays: Some(200_000), ..BakeOptions::default() };
    bake::build(&mut doc, &options, &Silent).unwrap();
    let trees = &doc.json["extensions"]["EXT_spherical_visibility"]["trees"];
    assert_eq!((&trees[0]["scene"], &trees[1]["anchors"]), (&json!(0), &json!([10])));

    let report = verify(&doc, &SMALL, &Silent).unwrap();
    assert_eq!(report.objects, 11);
    let outside = report.find("outside", "default").unwrap();
    assert_eq!(outside.missing_ppm.worst, 0.0);
    let frustum = report.find("outside", "frustum").unwrap();
    assert!(outside.triangles.over_evs < 2.0 && frustum.triangles.over_evs > 2.5, "{report}");
}

#[test]
fn reports_do_not_depend_on_threads() {
    let doc = baked_document();
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| verify(&doc, &SMALL, &Silent).unwrap())
    };
    assert_eq!(with(1), with(2));
}

#[test]
fn a_file_that_is_not_baked_says_what_to_do() {
    let error = verify(&document(3), &SMALL, &Silent).unwrap_err();
    assert!(matches!(error, VerifyError::NotBaked));
    assert!(error.to_string().contains("svs build"));
}

#[test]
fn a_changed_scene_is_refused() {
    let mut doc = baked_document();
    doc.json["scenes"][0]["nodes"] = json!([0, 1]);
    assert!(matches!(verify(&doc, &SMALL, &Silent), Err(VerifyError::Stale { tree: 0 })));
    assert!(Baked::read(&baked_document(), false).is_ok());
}

#[test]
fn no_cameras_give_no_rows() {
    let options = VerifyOptions { cameras: 0, ..SMALL };
    assert!(verify(&baked_document(), &options, &Silent).unwrap().groups.is_empty());
}
