//! `svs render`: one picture, without a window.

use super::args::Common;
use super::detail::{DetailArgs, Switch};
use super::error::Failure;
use super::{file, output};
use clap::Args;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::time::Instant;
use svs::camera_path::{CameraPath, near_plane};
use svs::stage::{ColourMode, Kind, Method, Stage, object_colour, visible_objects};
use svs_render::{Frame, FrameTime, Gpu, GpuScene, Image, NO_ITEM, Offscreen, RenderError, View};
use svs_runtime::{Budget, Settings};

/// Draw a picture of a scene, without a window
///
/// Works without a display, and without a GPU if a software Vulkan driver is installed. Files without baked visibility are
/// drawn too, culled by the frustum.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  svs render plant.svs.glb -o plant.png                                 from outside, what the bake says is seen
  svs render plant.svs.glb --camera inside --frame 40 -o inside.png     standing in the scene
  svs render plant.svs.glb --camera camera.json --size 1920x1080 --method exact -o exact.png
  svs render plant.svs.glb --colour importance --json -o importance.png
  svs render plant.svs.glb --budget 20000 --metric linear -o coarse.png  within a budget, with proxies where the file has them
  svs render plant.svs.glb --detail 4 --colour proxies -o proxies.png    what is a proxy

Camera files: {\"version\": 1, \"vertical_fov\": 60, \"poses\": [{\"eye\": [9, 2, 0], \"forward\": [-1, 0, 0]}]}
with lengths in metres, angles in degrees and +y up; several poses are a path, and --frame counts along it.")]
pub(crate) struct Render {
    /// Scene to draw: .glb or .gltf, baked or not
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,
    /// Picture to write: .png
    #[arg(short, long, value_name = "OUT.png")]
    pub(crate) output: PathBuf,
    /// Camera: `outside` and `inside` are made for the scene, anything else is a camera or camera path file
    #[arg(long, value_name = "FILE|outside|inside", default_value = "outside")]
    pub(crate) camera: String,
    /// Which picture of the path, from 0
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) frame: usize,
    /// Pictures along the path, in equal steps [default: one for each of its poses]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) frames: Option<u32>,
    /// Pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = size)]
    pub(crate) size: (u32, u32),
    /// What is drawn: `nothing` culled, what the `frustum` touches, what the baked `visibility` says is seen, or `exact`ly
    /// what is seen
    #[arg(long, value_name = "METHOD", default_value = "visibility",
          value_parser = clap::builder::PossibleValuesParser::new(Method::ALL.map(Method::name)))]
    pub(crate) method: String,
    /// Fewest triangles (0) to fewest missing pixels (1) [default: what the file recommends]
    #[arg(long, value_name = "Q", value_parser = super::args::share)]
    pub(crate) quality: Option<f64>,
    /// Use a sphere only where it is seen under at most this half-angle, in degrees [default: by quality]
    #[arg(long, value_name = "DEG", value_parser = angle)]
    pub(crate) max_angle: Option<f64>,
    /// Draw at most this many triangles
    #[arg(long, value_name = "TRIANGLES")]
    pub(crate) budget: Option<u64>,
    #[command(flatten)]
    pub(crate) detail: DetailArgs,
    /// Draw proxies and simplified objects where the file has them
    #[arg(long, value_enum, value_name = "on|off", default_value = "on")]
    pub(crate) proxies: Switch,
    /// Colour objects by something else than their materials
    #[arg(long, value_name = "BY", conflicts_with = "items",
          value_parser = clap::builder::PossibleValuesParser::new(ColourMode::ALL.map(ColourMode::name)))]
    pub(crate) colour: Option<String>,
    /// Draw which object each pixel shows: flat colours, one for each object
    #[arg(long)]
    pub(crate) items: bool,
}

pub(crate) fn run(args: &Render, common: &Common) -> Result<(), Failure> {
    if !args.output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
        let output = args.output.display();
        return Err(Failure::Usage(format!("the output {output} must end in .png: that is what is written")));
    }
    file::check_folder(&args.output)?;
    let method: Method = parsed(&args.method)?;
    let colour: Option<ColourMode> = args.colour.as_deref().map(parsed).transpose()?;

    let document = file::read(&args.file)?;
    let mut stage = Stage::open(&document).map_err(|error| Failure::doing("draw", &args.file, &error))?;
    let view = view(args, &stage)?;
    let drawn = Painter::new(args, &stage)
        .and_then(|mut painter| painter.draw(args, &mut stage, &view, method, colour));
    let drawn = drawn.map_err(|error| Failure::doing("draw", &args.file, error.as_ref()))?;
    file::write_png(&drawn.image, &args.output)?;
    report(args, common, &stage, &drawn)
}

/// The camera asked for.
fn view(args: &Render, stage: &Stage) -> Result<View, Failure> {
    let path = match args.camera.as_str() {
        "outside" => CameraPath::outside(&stage.surroundings()),
        "inside" => CameraPath::inside(&stage.surroundings()),
        name => {
            let file = Path::new(name);
            let path = CameraPath::read(file);
            path.map_err(|error| Failure::doing("read", file, &error))?.near_or(near_plane(stage.radius()))
        }
    };
    let frames = args.frames.map_or(path.poses.len(), |frames| frames as usize);
    path.frames(frames).get(args.frame).copied().ok_or_else(|| {
        let (frame, last) = (args.frame, frames.saturating_sub(1));
        Failure::Usage(format!(
            "--frame {frame} is past the end of the path: use 0 to {last}, or more --frames"
        ))
    })
}

type Error = Box<dyn std::error::Error>;

/// The GPU with the scene on it.
struct Painter {
    gpu: Gpu,
    scene: GpuScene,
    offscreen: Offscreen,
    renderer: svs_render::Renderer,
}

/// A picture and how it came about.
struct Drawn {
    image: Image,
    adapter: String,
    cull_us: f64,
    time: FrameTime,
    proxies: usize,
    levels: usize,
    nodes: usize,
}

impl Painter {
    fn new(args: &Render, stage: &Stage) -> Result<Self, Error> {
        let gpu = Gpu::headless()?;
        let scene = GpuScene::upload(&gpu, &stage.data, stage.upload_order())?;
        let (width, height) = args.size;
        let offscreen = Offscreen::new(&gpu, width, height)?;
        let renderer = Offscreen::renderer(&gpu);
        Ok(Self { gpu, scene, offscreen, renderer })
    }

    fn draw(
        &mut self,
        args: &Render,
        stage: &mut Stage,
        view: &View,
        method: Method,
        colour: Option<ColourMode>,
    ) -> Result<Drawn, Error> {
        let mut settings = stage.recommended();
        if let Some(quality) = args.quality {
            settings = Settings::from_quality(quality as f32);
        }
        if let Some(angle) = args.max_angle {
            settings.max_half_angle = angle.to_radians() as f32;
        }
        let budget = args.budget.map_or(Budget::Unlimited, Budget::Triangles);
        let (width, height) = args.size;
        let start = Instant::now();
        let mut objects = if args.proxies == Switch::On {
            let detail = args.detail.detail();
            stage.select(view, width, height, method, &settings, &detail, &budget).to_vec()
        } else {
            stage.cull(view, width, height, method, &settings, &budget).to_vec()
        };
        let cull_us = start.elapsed().as_secs_f64() * 1e6;
        if method == Method::Exact {
            objects = visible_objects(&self.items(view, &objects)?);
        }
        let frame = Frame { view: *view, objects: &objects, lines: &[] };
        let Self { gpu, scene, offscreen, renderer } = self;
        if let Some(mode) = colour {
            scene.set_tints(gpu, Some(&stage.tints(mode)));
        }
        // The first frame also sets up what later ones reuse.
        offscreen.time(gpu, renderer, scene, &frame)?;
        let time = offscreen.time(gpu, renderer, scene, &frame)?;
        let image = if args.items {
            item_colours(&self.items(view, &objects)?)
        } else {
            offscreen.image(gpu, renderer, scene, &frame)?
        };
        Ok(Drawn {
            image,
            adapter: self.gpu.description(),
            cull_us,
            time,
            proxies: stage.count(&objects, Kind::Proxy),
            levels: stage.count(&objects, Kind::Level),
            nodes: stage.nodes_shown(&objects),
        })
    }

    fn items(&mut self, view: &View, objects: &[u32]) -> Result<svs_render::ItemBuffer, RenderError> {
        let frame = Frame { view: *view, objects, lines: &[] };
        self.offscreen.items(&self.gpu, &mut self.renderer, &self.scene, &frame)
    }
}

/// A flat colour for each object; what is seen through counts, nothing is black.
fn item_colours(items: &svs_render::ItemBuffer) -> Image {
    let pixels = items.nearest.iter().zip(&items.transparent);
    let rgba = pixels.flat_map(|(&nearest, &transparent)| {
        let object = if transparent == NO_ITEM { nearest } else { transparent };
        let [r, g, b] = if object == NO_ITEM { [0; 3] } else { object_colour(object) };
        [r, g, b, 255]
    });
    Image { width: items.width, height: items.height, rgba: rgba.collect() }
}

fn report(args: &Render, common: &Common, stage: &Stage, drawn: &Drawn) -> Result<(), Failure> {
    let (output, time) = (args.output.display().to_string(), &drawn.time);
    let statistics = &time.statistics;
    let notes: Vec<Value> = (stage.notes.iter())
        .map(|note| json!({"code": note.code, "count": note.count, "message": note.message, "pointer": note.pointer}))
        .collect();
    let json = json!({
        "output": output,
        "size": [args.size.0, args.size.1],
        "method": args.method,
        "baked": stage.is_baked(),
        "notice": stage.notice(),
        "adapter": drawn.adapter,
        "scene_objects": stage.scene.objects.len(),
        "objects": statistics.objects - drawn.proxies,
        "simplified_objects": drawn.levels,
        "proxies": drawn.proxies,
        "hlod_nodes": drawn.nodes,
        "triangles": statistics.triangles,
        "draw_calls": statistics.draw_calls,
        "cull_us": drawn.cull_us,
        "frame_ms": time.wall_ms,
        "cpu_ms": time.cpu_ms,
        "gpu_ms": time.gpu_ms,
        "notes": notes,
    });
    let objects = output::count((statistics.objects - drawn.proxies) as u64);
    let all = output::count(stage.scene.objects.len() as u64);
    let mut rows = vec![
        ("drawn by", drawn.adapter.clone()),
        ("objects", format!("{objects} of {all}")),
        ("simplified", output::count(drawn.levels as u64)),
        (
            "proxies",
            format!("{} ({} nodes)", output::count(drawn.proxies as u64), output::count(drawn.nodes as u64)),
        ),
        ("triangles", output::count(statistics.triangles)),
        ("draw calls", output::count(statistics.draw_calls as u64)),
        ("culled in", format!("{} us", output::number(drawn.cull_us))),
        ("frame", format!("{} ms", output::number(time.wall_ms))),
    ];
    if !stage.has_proxies() {
        rows.retain(|(name, _)| !["simplified", "proxies"].contains(name));
    }
    rows.extend(stage.notice().map(|notice| ("note", notice.to_owned())));
    rows.extend(
        stage
            .notes
            .iter()
            .map(|note| ("note", format!("{} {}", output::count(note.count as u64), note.message))),
    );
    output::print(common, &json, &format!("{output} written\n{}", output::fields(&rows)))
}

/// A name that clap has accepted.
fn parsed<T: std::str::FromStr<Err: std::fmt::Display>>(name: &str) -> Result<T, Failure> {
    name.parse().map_err(|error: T::Err| Failure::Usage(error.to_string()))
}

/// `1280x720`.
pub(super) fn size(text: &str) -> Result<(u32, u32), String> {
    let side = |text: &str| text.parse::<u32>().ok().filter(|side| (1..=16_384).contains(side));
    let size = text.split_once(['x', 'X']).and_then(|(width, height)| Some((side(width)?, side(height)?)));
    size.ok_or_else(|| "width and height in pixels are needed, such as 1280x720, each up to 16384".to_owned())
}

/// A half-angle, 0 to 90 degrees.
fn angle(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=90.0).contains(&value) => Ok(value),
        _ => Err("an angle from 0 to 90 degrees is needed".to_owned()),
    }
}
