//! Time per frame on the generated plant, of the largest tree alone: outside and inside, for each query and for the
//! frustum alone; then for a budget of a tenth of the triangles, and for a million objects.

#[path = "cull/grid.rs"]
mod grid;

use divan::Bencher;
use glam::DVec3;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};
use svs::bake::hierarchy::HierarchyKind;
use svs::bake::subject::subjects;
use svs::bake::{BakeOptions, HierarchyChoice, Silent, build};
use svs::generate::{SampleKind, SampleOptions, generate};
use svs::gltf::{Document, DocumentTables};
use svs::scene::{ReadOptions, read_scene};
use svs_runtime::format::Extension;
use svs_runtime::{Bounds, Budget, Camera, Culler, Detail, SceneCuller, Settings, Tree, Visibility};

/// Frames of one run round the scene or through it; a sample is the mean over all.
const FRAMES: usize = 64;

fn main() {
    divan::main();
}

/// A baked plant: its largest tree, and the boxes and triangle counts of the objects in it.
struct Plant {
    tree: Arc<Tree>,
    bounds: Vec<Bounds>,
    triangles: Vec<u32>,
}

impl Plant {
    /// Few rays are enough here: the tree has its full size, only some objects are missed. Pruning keeps all nodes
    /// that cull anything, which is the most work.
    fn bake(scale: f64) -> Self {
        let sample = generate(&SampleOptions { scale, ..SampleOptions::new(SampleKind::Plant) });
        let mut doc = Document::from_parts(sample.json, Some(sample.bin)).expect("a readable sample");
        let options = BakeOptions {
            rays: Some(1 << 22),
            hierarchy: HierarchyChoice::Kind(HierarchyKind::Scene),
            prune: Some(0.0),
            verify: false,
            ..BakeOptions::default()
        };
        build(&mut doc, &options, &Silent).expect("a sample that can be baked");
        let json = doc.json.pointer("/extensions/EXT_spherical_visibility").expect("a bake");
        let extension: Extension = serde_json::from_value(json.clone()).expect("a valid bake");
        let visibility =
            Visibility::decode(json, &DocumentTables::of_extension(&doc, &extension)).expect("a valid bake");
        let scene = read_scene(&doc, &ReadOptions::default()).expect("a readable scene");
        let pairs = visibility.trees().iter().zip(subjects(&scene));
        let (tree, subject) = pairs.max_by_key(|(tree, _)| tree.object_count()).expect("a plant has a tree");
        // Every object of the plant is static and opaque, so members are counted as the document counts.
        let members = (0..tree.object_count()).map(|k| &subject.members[tree.document_index(k) as usize]);
        let bounds = members
            .clone()
            .map(|member| Bounds { min: member.bounds.min.as_vec3(), max: member.bounds.max.as_vec3() });
        let triangles = members.clone().map(|member| member.triangles);
        Self { tree: Arc::clone(tree), bounds: bounds.collect(), triangles: triangles.collect() }
    }

    /// The plant with about that many objects; baked once.
    fn with(objects: usize) -> Arc<Plant> {
        static PLANTS: Mutex<BTreeMap<usize, Arc<Plant>>> = Mutex::new(BTreeMap::new());
        let mut plants = PLANTS.lock().unwrap_or_else(PoisonError::into_inner);
        let plant = plants.entry(objects).or_insert_with(|| {
            let plant = Self::bake(objects as f64 / OBJECTS_AT_SCALE_1);
            eprintln!("plant: {} objects, {} nodes", plant.tree.object_count(), plant.tree.nodes().len());
            Arc::new(plant)
        });
        Arc::clone(plant)
    }
}

/// Cameras on a circle round the boxes: 1.5 radii from the middle, or at a fifth of the size and at eye height.
fn cameras(bounds: &[Bounds], outside: bool) -> Vec<Camera> {
    let min = bounds.iter().fold(DVec3::INFINITY, |min, b| min.min(b.min.as_dvec3()));
    let max = bounds.iter().fold(DVec3::NEG_INFINITY, |max, b| max.max(b.max.as_dvec3()));
    let (middle, radius) = ((min + max) * 0.5, (max - min).length() * 0.5);
    let camera = |frame: usize| {
        let (sine, cosine) = (frame as f64 / FRAMES as f64 * std::f64::consts::TAU).sin_cos();
        let (eye, target) = if outside {
            (middle + DVec3::new(cosine, 0.4, sine).normalize() * radius * 1.5, middle)
        } else {
            let eye =
                DVec3::new(middle.x, min.y + 1.7, middle.z) + DVec3::new(cosine, 0.0, sine) * radius * 0.2;
            (eye, eye + DVec3::new(-sine, -0.1, cosine))
        };
        let view = glam::dcamera::rh::view::look_at_mat4(eye, target, DVec3::Y);
        Camera::perspective(view, 60_f64.to_radians(), 1280.0, 720.0, 0.1)
    };
    (0..FRAMES).map(camera).collect()
}

/// Measured; the number of objects grows linearly with the scale.
const OBJECTS_AT_SCALE_1: f64 = 4_200.0;

fn frames(bencher: Bencher, objects: usize, outside: bool, settings: Settings) {
    let plant = Plant::with(objects);
    let cameras = cameras(&plant.bounds, outside);
    let mut culler = Culler::new(&plant.tree, &plant.bounds).expect("a box for each object");
    let mut frame = 0;
    bencher.bench_local(|| {
        frame = (frame + 1) % FRAMES;
        culler.cull(&cameras[frame], &settings).len()
    });
}

macro_rules! queries {
    ($module:ident, $outside:literal) => {
        mod $module {
            use super::*;

            #[divan::bench(args = [10_000, 100_000])]
            fn nearest_o(bencher: Bencher, objects: usize) {
                frames(bencher, objects, $outside, Settings::NEAREST_O);
            }

            #[divan::bench(args = [10_000, 100_000])]
            fn max3_o(bencher: Bencher, objects: usize) {
                frames(bencher, objects, $outside, Settings::MAX3_O);
            }

            #[divan::bench(args = [10_000, 100_000])]
            fn ring_o(bencher: Bencher, objects: usize) {
                frames(bencher, objects, $outside, Settings::RING_O);
            }

            #[divan::bench(args = [10_000, 100_000])]
            fn frustum(bencher: Bencher, objects: usize) {
                frames(bencher, objects, $outside, Settings::FRUSTUM);
            }
        }
    };
}

queries!(outside, true);
queries!(inside, false);

/// Choosing a tenth of the triangles that culling answers in the mean, culling included.
#[divan::bench(args = ["nearest_o", "frustum"])]
fn budget_of_a_tenth(bencher: Bencher, query: &str) {
    let settings = if query == "frustum" { Settings::FRUSTUM } else { Settings::NEAREST_O };
    let plant = Plant::with(100_000);
    let trees = vec![grid::rebuilt(&plant.tree, svs_runtime::Placement::Scene(0), None)];
    let visibility = Visibility::new(trees).expect("a valid tree");
    let mut culler = SceneCuller::new(&visibility, &[&plant.bounds]).expect("a box for each object");
    culler.set_triangles(0, &plant.triangles).expect("a count for each object");
    let cameras = cameras(&plant.bounds, true);
    let mut sum = 0;
    for camera in &cameras {
        culler.cull(camera, &settings);
        sum += culler.selection().chosen_triangles;
    }
    scene_frames(bencher, culler, &cameras, settings, Budget::Triangles(sum / FRAMES as u64 / 10));
}

fn scene_frames(
    bencher: Bencher,
    mut culler: SceneCuller,
    cameras: &[Camera],
    settings: Settings,
    budget: Budget<'_>,
) {
    let mut frame = 0;
    bencher.bench_local(|| {
        frame = (frame + 1) % cameras.len();
        culler.cull_within(&cameras[frame], &settings, &budget).len()
    });
}

/// Choosing proxies and originals, with a proxy for each node of the tree: culling included, without a budget and with one
/// of a tenth of the triangles that culling answers in the mean.
mod select {
    use super::*;

    fn frames(bencher: Bencher, objects: usize, outside: bool, settings: Settings, tau: f32, tenth: bool) {
        let plant = Plant::with(objects);
        let (proxies, triangles) = grid::proxies(&plant.tree, &plant.bounds, &plant.triangles);
        let trees = vec![grid::rebuilt(&plant.tree, svs_runtime::Placement::Scene(0), Some(proxies))];
        let visibility = Visibility::new(trees).expect("a valid tree");
        let mut culler = SceneCuller::new(&visibility, &[&plant.bounds]).expect("a box for each object");
        culler.set_triangles(0, &plant.triangles).expect("a count for each object");
        culler.set_proxy_triangles(0, &triangles).expect("a count for each proxy");
        let cameras = cameras(&plant.bounds, outside);
        let detail = Detail { tau, ..Detail::default() };
        let mut sum = 0;
        for camera in &cameras {
            culler.cull(camera, &settings);
            sum += culler.selection().chosen_triangles;
        }
        let budget = Budget::Triangles(sum / FRAMES as u64 / 10);
        let budget = if tenth { budget } else { Budget::Unlimited };
        let mut frame = 0;
        bencher.bench_local(|| {
            frame = (frame + 1) % FRAMES;
            culler.select(&cameras[frame], &settings, &detail, &budget).len()
        });
    }

    macro_rules! select {
        ($name:ident, $outside:literal, $settings:expr, $tau:literal, $tenth:literal) => {
            #[divan::bench(args = [10_000, 100_000])]
            fn $name(bencher: Bencher, objects: usize) {
                frames(bencher, objects, $outside, $settings, $tau, $tenth);
            }
        };
    }

    select!(outside_one_pixel, true, Settings::NEAREST_O, 1.0, false);
    select!(outside_sixteen_pixels, true, Settings::NEAREST_O, 16.0, false);
    select!(outside_tenth, true, Settings::NEAREST_O, 1.0, true);
    select!(outside_frustum_tenth, true, Settings::FRUSTUM, 1.0, true);
    select!(inside_one_pixel, false, Settings::NEAREST_O, 1.0, false);
    select!(inside_tenth, false, Settings::NEAREST_O, 1.0, true);
}

/// A hundred plants of 10,000 objects, see [`grid`].
mod million {
    use super::*;

    fn frames(bencher: Bencher, outside: bool, settings: Settings) {
        let (culler, cells) = grid::culler(&Plant::with(10_000));
        scene_frames(bencher, culler, &cameras(&cells, outside), settings, Budget::Unlimited);
    }

    #[divan::bench]
    fn outside_nearest_o(bencher: Bencher) {
        frames(bencher, true, Settings::NEAREST_O);
    }

    #[divan::bench]
    fn outside_frustum(bencher: Bencher) {
        frames(bencher, true, Settings::FRUSTUM);
    }

    #[divan::bench]
    fn inside_nearest_o(bencher: Bencher) {
        frames(bencher, false, Settings::NEAREST_O);
    }

    #[divan::bench]
    fn inside_frustum(bencher: Bencher) {
        frames(bencher, false, Settings::FRUSTUM);
    }
}
