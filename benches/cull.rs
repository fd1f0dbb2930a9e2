//! Time per frame on the generated plant, of the largest tree alone: outside and inside, for each query and for the
//! frustum alone.

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
use svs_runtime::{Bounds, Camera, Culler, Settings, Tree, Visibility};

/// Frames of one run round the scene or through it; a sample is the mean over all.
const FRAMES: usize = 64;

fn main() {
    divan::main();
}

/// A baked plant: its largest tree and the boxes of the objects in it.
struct Plant {
    tree: Arc<Tree>,
    bounds: Vec<Bounds>,
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
        let bounds = (0..tree.object_count()).map(|place| {
            // Every object of the plant is static and opaque, so members are counted as the document counts.
            let bounds = subject.members[tree.document_index(place) as usize].bounds;
            Bounds { min: bounds.min.as_vec3(), max: bounds.max.as_vec3() }
        });
        Self { tree: Arc::clone(tree), bounds: bounds.collect() }
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

    /// Cameras on a circle: 1.5 radii from the middle, or at a tenth of the size and at eye height.
    fn cameras(&self, outside: bool) -> Vec<Camera> {
        let min = self.bounds.iter().fold(DVec3::INFINITY, |min, b| min.min(b.min.as_dvec3()));
        let max = self.bounds.iter().fold(DVec3::NEG_INFINITY, |max, b| max.max(b.max.as_dvec3()));
        let (middle, radius) = ((min + max) * 0.5, (max - min).length() * 0.5);
        let camera = |frame: usize| {
            let (sine, cosine) = (frame as f64 / FRAMES as f64 * std::f64::consts::TAU).sin_cos();
            let (eye, target) = if outside {
                (middle + DVec3::new(cosine, 0.4, sine).normalize() * radius * 1.5, middle)
            } else {
                let eye = DVec3::new(middle.x, min.y + 1.7, middle.z)
                    + DVec3::new(cosine, 0.0, sine) * radius * 0.2;
                (eye, eye + DVec3::new(-sine, -0.1, cosine))
            };
            let view = glam::dcamera::rh::view::look_at_mat4(eye, target, DVec3::Y);
            Camera::perspective(view, 60_f64.to_radians(), 1280.0, 720.0, 0.1)
        };
        (0..FRAMES).map(camera).collect()
    }
}

/// Measured; the number of objects grows linearly with the scale.
const OBJECTS_AT_SCALE_1: f64 = 4_200.0;

/// Spheres that nothing is far enough from: what is left is the frustum.
const FRUSTUM: Settings = Settings { max_half_angle: 0.0, ..Settings::NEAREST_O };

fn frames(bencher: Bencher, objects: usize, outside: bool, settings: Settings) {
    let plant = Plant::with(objects);
    let cameras = plant.cameras(outside);
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
                frames(bencher, objects, $outside, FRUSTUM);
            }
        }
    };
}

queries!(outside, true);
queries!(inside, false);
