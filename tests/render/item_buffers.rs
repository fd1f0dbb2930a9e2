//! Which objects are seen: by rays through pixel centres on the CPU, and by the renderer's item buffer.
//!
//! Both should name the same objects. They differ, for a few objects of few pixels, because
//!
//! - a triangle covers a pixel centre by the rasteriser's rules: coordinates in the image are rounded to 1/256 of a pixel
//!   and an edge through a centre belongs to one side, while a ray hits or misses in double precision;
//! - of surfaces in the same place the depth buffer keeps the one drawn first, or whose single-precision depth is rounded
//!   nearer, while of a ray's equal hits the one wins whose triangle comes first in the ray's tree;
//! - surfaces less than the depth buffer's resolution apart (a ten-millionth of the distance) count as in the same place;
//! - the near plane cuts off what is nearer, and of transparent surfaces the item buffer keeps the nearest only, while a
//!   ray counts every one before the first opaque surface.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use svs::bake::rays::RayScene;
use svs::camera_path::CameraPath;
use svs::gltf::Document;
use svs::scene::Role;
use svs::stage::Stage;
use svs::verify::{self, Target, visible_set};
use svs_render::{Frame, Gpu, GpuScene, NO_ITEM, Offscreen, View};

const WIDTH: u32 = 640;
const HEIGHT: u32 = 360;

/// Cameras on each of the two generated paths.
const CAMERAS: usize = 6;

fn gpu() -> &'static Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    GPU.get_or_init(|| Gpu::headless().expect("these tests need a Vulkan driver, e.g. mesa-vulkan-drivers"))
}

/// Sums over the cameras of one path.
#[derive(Debug, Default)]
struct Agreement {
    /// Objects that the CPU sees.
    seen: usize,
    /// Objects that one of both sees, but not the other.
    differing: usize,
    /// Their pixels.
    pixels: u64,
    /// Most pixels that one of them has.
    largest: u32,
    /// Pixels of all images.
    all_pixels: u64,
}

impl Agreement {
    fn add(&mut self, cpu: &BTreeMap<u32, u32>, gpu: &BTreeMap<u32, u32>) {
        self.seen += cpu.len();
        self.all_pixels += u64::from(WIDTH) * u64::from(HEIGHT);
        let only = |a: &BTreeMap<u32, u32>, b: &BTreeMap<u32, u32>| {
            a.iter().filter(|(object, _)| !b.contains_key(object)).map(|(_, &pixels)| pixels).collect()
        };
        let differing: [Vec<u32>; 2] = [only(cpu, gpu), only(gpu, cpu)];
        for pixels in differing.into_iter().flatten() {
            self.differing += 1;
            self.pixels += u64::from(pixels);
            self.largest = self.largest.max(pixels);
        }
    }

    fn share(&self) -> f64 {
        self.differing as f64 / self.seen.max(1) as f64
    }

    fn pixel_share(&self) -> f64 {
        self.pixels as f64 / self.all_pixels as f64
    }
}

/// Compares both on the generated paths of a file: outside, inside.
fn agreement(file: &Path) -> [Agreement; 2] {
    let document = Document::read(file).expect("a scene");
    let stage = Stage::open(&document).expect("a stage");
    let covered: Vec<bool> = stage.scene.objects.iter().map(|object| object.role == Role::Static).collect();
    assert!(covered.iter().all(|&covered| covered), "objects that the rays do not know");
    let target = Target::new(&stage.scene, &covered);
    let rays = RayScene::new(&stage.scene.meshes, &target.parts);
    let mut scene = GpuItems::new(&stage);
    let around = stage.surroundings();
    let paths = [CameraPath::outside(&around), CameraPath::inside(&around)];
    paths.map(|path| {
        let mut agreement = Agreement::default();
        // The round trip ends where it begins.
        for view in path.frames(CAMERAS + 1).iter().take(CAMERAS) {
            let half_height = (view.vertical_fov * 0.5).tan();
            let ray_view = verify::View::new(view.eye, view.forward, half_height, WIDTH, HEIGHT);
            let cpu: BTreeMap<u32, u32> = visible_set(&rays, &ray_view).into_iter().collect();
            agreement.add(&cpu, &scene.visible(&stage, view));
        }
        println!(
            "{}, {}: {} of {} objects differ ({:.3} %), in {:.1} pixels per million, the largest in {} pixels",
            file.file_name().map(|name| name.to_string_lossy()).unwrap_or_default(),
            path.name,
            agreement.differing,
            agreement.seen,
            100.0 * agreement.share(),
            1e6 * agreement.pixel_share(),
            agreement.largest,
        );
        agreement
    })
}

struct GpuItems {
    scene: GpuScene,
    offscreen: Offscreen,
    renderer: svs_render::Renderer,
}

impl GpuItems {
    fn new(stage: &Stage) -> Self {
        Self {
            scene: GpuScene::upload(gpu(), &stage.data, stage.order()).expect("a scene on the GPU"),
            offscreen: Offscreen::new(gpu(), WIDTH, HEIGHT).expect("an image"),
            renderer: Offscreen::renderer(gpu()),
        }
    }

    /// Objects that a pixel shows, and how many do.
    fn visible(&mut self, stage: &Stage, view: &View) -> BTreeMap<u32, u32> {
        let frame = Frame { view: *view, objects: stage.order(), lines: &[] };
        let items = self.offscreen.items(gpu(), &mut self.renderer, &self.scene, &frame).expect("items");
        let mut pixels = BTreeMap::new();
        for &object in items.nearest.iter().chain(&items.transparent).filter(|&&object| object != NO_ITEM) {
            *pixels.entry(object).or_default() += 1;
        }
        pixels
    }
}

#[test]
fn rays_and_rasteriser_see_the_same_objects_of_the_plant() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/plant.glb");
    for agreement in agreement(&file) {
        assert!(agreement.seen > 100);
        assert!(agreement.share() <= 0.01 && agreement.pixel_share() <= 50e-6, "{agreement:?}");
    }
}

#[test]
fn rays_and_rasteriser_see_the_same_objects_of_real_scenes() {
    for name in ["duplex-apartment/duplex-apartment.glb", "two-cylinder-engine/2CylinderEngine.glb"] {
        let file: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/scenes").join(name);
        if !file.is_file() {
            println!("skipped: there is no {}", file.display());
            continue;
        }
        for agreement in agreement(&file) {
            assert!(agreement.share() <= 0.01 && agreement.pixel_share() <= 50e-6, "{agreement:?}");
        }
    }
}
