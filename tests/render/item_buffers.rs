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
use svs_render::{Frame, Gpu, GpuScene, ItemBuffer, NO_ITEM, Offscreen, View};

const WIDTH: u32 = 640;
const HEIGHT: u32 = 360;

/// Cameras on each of the two generated paths.
const CAMERAS: usize = 6;

/// An object of up to this many pixels may differ for any of the reasons above; of a larger one it must be shown that it
/// shares its place with another, or is behind a transparent one.
const FEW_PIXELS: u32 = 4;

/// Surfaces this far apart, in half diagonals of the scene, are in the same place.
const SAME_PLACE: f32 = 2e-6;

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
    /// Those of them with more than a few pixels that share their place with others, or are behind transparent ones.
    explained: usize,
    /// Pixels of the others.
    pixels: u64,
    /// Most pixels that one of the others has.
    largest: u32,
    /// Pixels of all images.
    all_pixels: u64,
}

impl Agreement {
    fn add(&mut self, rays: &RayScene<'_>, view: &verify::View, items: &ItemBuffer) {
        let cpu: Pixels = visible_set(rays, view).into_iter().collect();
        let gpu = pixels(items);
        self.seen += cpu.len();
        self.all_pixels += u64::from(WIDTH) * u64::from(HEIGHT);
        let only = |a: &Pixels, b: &Pixels| -> Pixels {
            a.iter()
                .filter(|(object, _)| !b.contains_key(object))
                .map(|(&object, &pixels)| (object, pixels))
                .collect()
        };
        for (object, pixels) in only(&cpu, &gpu).into_iter().chain(only(&gpu, &cpu)) {
            self.differing += 1;
            if pixels > FEW_PIXELS && is_explained(rays, view, items, object) {
                self.explained += 1;
            } else {
                self.pixels += u64::from(pixels);
                self.largest = self.largest.max(pixels);
            }
        }
    }

    fn share(&self) -> f64 {
        self.differing as f64 / self.seen.max(1) as f64
    }

    fn pixel_share(&self) -> f64 {
        self.pixels as f64 / self.all_pixels as f64
    }

    /// As measured on these scenes, with room for other drivers: up to 0.4 % of the objects, 3 pixels per million, and
    /// 1.1 % of the objects where they are seen through two panes of glass.
    #[track_caller]
    fn is_good(&self) {
        let rest = (self.differing - self.explained) as f64 / self.seen as f64;
        assert!(
            self.seen >= 20 && rest <= 0.01 && self.pixel_share() <= 20e-6 && self.share() <= 0.03,
            "{self:?}"
        );
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
            agreement.add(&rays, &ray_view, &scene.items(&stage, view));
        }
        println!(
            "{}, {}: {} of {} objects differ ({:.3} %); {} share their place with others or are seen through them, the rest have {:.1} pixels per \
             million, the largest {} pixels",
            file.file_name().map(|name| name.to_string_lossy()).unwrap_or_default(),
            path.name,
            agreement.differing,
            agreement.seen,
            100.0 * agreement.share(),
            agreement.explained,
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

    fn items(&mut self, stage: &Stage, view: &View) -> ItemBuffer {
        let frame = Frame { view: *view, objects: stage.order(), lines: &[] };
        self.offscreen.items(gpu(), &mut self.renderer, &self.scene, &frame).expect("items")
    }
}

/// Objects, and how many pixels show each.
type Pixels = BTreeMap<u32, u32>;

fn pixels(items: &ItemBuffer) -> Pixels {
    let mut pixels = Pixels::new();
    for &object in items.nearest.iter().chain(&items.transparent).filter(|&&object| object != NO_ITEM) {
        *pixels.entry(object).or_default() += 1;
    }
    pixels
}

/// In (nearly) all pixels in which one of both sees `object`, and the other does not, it is behind a transparent object
/// that the item buffer keeps instead, or a ray through the pixel meets another surface in the same place.
fn is_explained(rays: &RayScene<'_>, view: &verify::View, items: &ItemBuffer, object: u32) -> bool {
    let eye = (view.eye - rays.center()) / rays.radius();
    let (mut shown, mut explained) = (0, 0);
    let (mut hits, mut transparent) = (Vec::new(), Vec::new());
    for pixel in 0..WIDTH * HEIGHT {
        let ray = view.ray(pixel % WIDTH, pixel / WIDTH);
        let nearest = rays.view(eye, ray, &mut transparent);
        let seen_by_cpu = nearest.iter().chain(&transparent).any(|hit| hit.member == object);
        let front = items.transparent[pixel as usize];
        if seen_by_cpu == (items.nearest[pixel as usize] == object || front == object) {
            continue;
        }
        shown += 1;
        let is_transparent = |member: u32| transparent.iter().any(|hit| hit.member == member);
        if is_transparent(object) && is_transparent(front) {
            explained += 1;
            continue;
        }
        rays.line(eye, ray, &mut hits);
        hits.retain(|hit| hit.t > 0.0 && hit.seen_from_start);
        let own = hits.iter().filter(|hit| hit.member == object).map(|hit| hit.t).reduce(f32::min);
        let in_place =
            |own: f32| hits.iter().any(|hit| hit.member != object && (hit.t - own).abs() <= SAME_PLACE);
        explained += u32::from(own.is_some_and(in_place));
    }
    shown > 0 && explained * 100 >= shown * 95
}

#[test]
fn rays_and_rasteriser_see_the_same_objects_of_the_plant() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/plant.glb");
    for agreement in agreement(&file) {
        agreement.is_good();
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
            agreement.is_good();
        }
    }
}
