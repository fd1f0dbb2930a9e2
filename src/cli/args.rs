//! The command line as typed. What the values mean together is checked in [`super::options`].

use clap::builder::PossibleValue;
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;
use svs::generate::SampleKind;
use svs_runtime::directions::DIRECTION_SETS;

/// Bakes direction-dependent visibility into glTF scenes (EXT_spherical_visibility), so that a viewer can skip
/// what cannot be seen without asking the GPU.
#[derive(Debug, Parser)]
#[command(
    name = "svs",
    version,
    propagate_version = true,
    max_term_width = 110,
    after_help = "\
Examples:
  svs build plant.glb -o plant.svs.glb      bake with standard quality
  svs info plant.svs.glb                    what the file holds
  svs verify plant.svs.glb                  what it is worth, on cameras the bake has not seen
  svs render plant.svs.glb -o plant.png     a picture of it
  svs evaluate plant.svs.glb -o report      what it gains on camera paths: times and pictures
  svs help build                            all options of a command

Exit codes: 0 done; 1 bad input, failed validation or a file that cannot be written; 2 wrong usage."
)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
    #[command(flatten)]
    pub(crate) common: Common,
}

/// What every command understands.
#[derive(Clone, Debug, Args)]
pub(crate) struct Common {
    /// Print the result as JSON on standard output
    #[arg(long, global = true, display_order = 100)]
    pub(crate) json: bool,
    /// Print nothing but errors (and the JSON of --json)
    #[arg(short, long, global = true, display_order = 101)]
    pub(crate) quiet: bool,
    /// Threads to use [default: all cores]. The result does not depend on it
    #[arg(long, value_name = "N", global = true, display_order = 102, value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub(crate) threads: Option<u32>,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Build(Build),
    Info(Info),
    Validate(Validate),
    Verify(Verify),
    #[cfg(feature = "render")]
    Render(super::render::Render),
    #[cfg(feature = "render")]
    Evaluate(super::evaluate::Evaluate),
    Sample(Sample),
    Serve(super::serve::Serve),
    Strip(Strip),
    #[cfg(feature = "render")]
    View(View),
}

/// Bake a scene: adds visibility to a copy of IN
///
/// Everything else in the file stays as it is, byte for byte (but see --layout). An earlier bake is replaced.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  svs build plant.glb -o plant.svs.glb
  svs build plant.gltf -o baked/plant.gltf --quality high --report report.json
  svs build plant.glb -o plant.glb --max-missing 20       bake in place, at most 20 missing pixels per million
  svs build city.glb -o city.svs.glb --directions icosahedron-2 --hierarchy octree --json
  svs build engine.glb -o engine.svs.glb --remove-hidden=triangles     drop what no camera can see
  svs build plant.glb -o plant.svs.glb --proxies auto     simplified stand-ins for groups of objects too
  svs build plant.glb -o plant.svs.glb --proxies auto --msft-lod     its simplified meshes for other loaders too")]
pub(crate) struct Build {
    /// Scene to bake: .glb, or .gltf with external or data-URI buffers
    #[arg(value_name = "IN")]
    pub(crate) input: PathBuf,
    /// File to write: .glb or .gltf; may be IN
    #[arg(short, long, value_name = "OUT")]
    pub(crate) output: PathBuf,
    /// How few pixels may be missing [default: standard]
    #[arg(long, value_enum, value_name = "QUALITY", conflicts_with = "max_missing")]
    pub(crate) quality: Option<QualityName>,
    /// Sample until at most this many pixels per million are estimated to be missing, seen from outside
    #[arg(long, value_name = "PPM", value_parser = positive)]
    pub(crate) max_missing: Option<f64>,
    /// Set of directions that visibility is stored for
    #[arg(long, value_name = "NAME", default_value = "icosahedron-1",
          value_parser = clap::builder::PossibleValuesParser::new(DIRECTION_SETS))]
    pub(crate) directions: String,
    /// Cast at most this many rays [default: by quality]; fewer if the estimated error is small enough before
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=1_000_000_000_000))]
    pub(crate) rays: Option<u64>,
    /// How objects are grouped: the cheapest, the scene's own nodes, a loose octree or a bounding volume hierarchy
    #[arg(long, value_enum, value_name = "KIND", default_value_t)]
    pub(crate) hierarchy: HierarchyName,
    /// Bounding spheres: quick ones, or nearly the smallest
    #[arg(long, value_enum, value_name = "KIND", default_value_t)]
    pub(crate) spheres: SpheresName,
    /// Keep only spheres that cull at least this share (0 to 1) beyond what those below them do [default: chosen]
    #[arg(long, value_name = "X", value_parser = share)]
    pub(crate) prune: Option<f64>,
    #[command(flatten)]
    pub(crate) hidden: super::hidden::Hidden,
    #[command(flatten)]
    pub(crate) proxies: Proxies,
    /// Order of the data in a .glb. stream: as a viewer that loads by ranges wants it, most important first, with a
    /// compressed copy of the JSON; `byteOffset` of the file's buffer views changes with it, and nothing else does
    #[arg(long, value_enum, value_name = "LAYOUT", default_value_t)]
    pub(crate) layout: LayoutName,
    /// Write the full report to this file too
    #[arg(long, value_name = "FILE.json")]
    pub(crate) report: Option<PathBuf>,
}

/// Orders of the data.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum LayoutName {
    /// As it was, what is added last
    #[default]
    Keep,
    /// As it is wanted
    Stream,
}

/// Simplified stand-ins for groups of objects. Viewers that do not know the extension do not see them.
#[derive(Debug, Args)]
pub(crate) struct Proxies {
    /// Proxies: of what is visible from outside, of everything, or none
    #[arg(long, value_enum, value_name = "WHICH", default_value_t)]
    pub(crate) proxies: ProxiesName,
    /// Error of the finest proxies, in pixels of a screen of 1080 lines that the whole scene fills; coarser is smaller
    #[arg(long, value_name = "PX", default_value_t = svs::proxies::DEFAULT_ERROR_PIXELS, value_parser = positive)]
    pub(crate) proxy_error: f64,
    /// Bytes that proxies may add, in percent of the geometry's
    #[arg(long, value_name = "PERCENT", default_value_t = 100.0 * svs::proxies::DEFAULT_SHARE, value_parser = positive)]
    pub(crate) proxy_share: f64,
    /// How proxies are stored. Loaders that do not know the extensions that this needs refuse the whole file
    #[arg(long, value_enum, value_name = "FORMAT", default_value_t)]
    pub(crate) proxy_format: ProxyFormatName,
    /// Triangles that the smallest proxies stand for, about
    #[arg(long, value_name = "N", default_value_t = svs::proxies::DEFAULT_TRIANGLES,
          value_parser = clap::value_parser!(u32).range(16..=1_000_000))]
    pub(crate) proxy_triangles: u32,
    /// With --proxies: simplified meshes also as MSFT_lod, for loaders that know that extension instead
    #[arg(long)]
    pub(crate) msft_lod: bool,
}

/// Show what is in a baked file: trees, spheres, directions, bytes, what each level culls
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  svs info plant.svs.glb
  svs info plant.svs.glb --json")]
pub(crate) struct Info {
    /// File to look at
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,
}

/// Check the extension against its schema and against the scene; exit code 1 on errors
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  svs validate plant.svs.glb
  svs validate plant.svs.glb --json         one object per finding: code, severity, message, pointer")]
pub(crate) struct Validate {
    /// File to check
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,
}

/// Measure a baked file on cameras the bake has not seen: missing pixels, triangles drawn
///
/// Perspective cameras of 1280 x 720 pixels and 60 degrees, outside (1.05 to 10 radii) and standing inside, against
/// the exact visible sets; the default query, a sweep of the quality slider, and the published method.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  svs verify plant.svs.glb
  svs verify plant.svs.glb --cameras 64 --seed 7 --json")]
pub(crate) struct Verify {
    /// Baked file to measure
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,
    /// Cameras per group [default: chosen]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) cameras: Option<u32>,
    /// Where the cameras stand follows from this number
    #[arg(long, value_name = "S")]
    pub(crate) seed: Option<u64>,
}

/// Write a generated sample scene; the same numbers give the same bytes
///
/// `grid` generates nothing but repeats a scene of yours: for large test scenes made of real parts. Its meshes are shared,
/// so that the file stays small.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  svs sample plant -o plant.glb
  svs sample city --scale 4 --seed 7 -o city.glb
  svs sample grid --of engine.glb --copies 400 -o engines.glb")]
pub(crate) struct Sample {
    /// What to generate
    #[arg(value_enum, value_name = "KIND")]
    pub(crate) kind: SampleName,
    /// File to write: .glb or .gltf
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: PathBuf,
    /// Size of the scene: about this many times the objects of the default [default: 1]
    #[arg(long, value_name = "S", value_parser = positive)]
    pub(crate) scale: Option<f64>,
    /// Start of the random numbers [default: 7]
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u64>,
    /// Scene that `grid` repeats: .glb or .gltf, without animations and skins
    #[arg(long, value_name = "FILE", required_if_eq("kind", "grid"))]
    pub(crate) of: Option<PathBuf>,
    /// Copies in the grid, the scene itself counted [default: 100]
    #[arg(long, value_name = "N", requires = "of")]
    pub(crate) copies: Option<usize>,
    /// Distance from copy to copy, in sizes of the scene: at 1 they touch [default: 1.1]
    #[arg(long, value_name = "F", requires = "of")]
    pub(crate) spacing: Option<f64>,
}

/// A sample scene that is generated, or a grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SampleName {
    Generated(SampleKind),
    Grid,
}

impl ValueEnum for SampleName {
    fn value_variants<'a>() -> &'a [Self] {
        const ALL: [SampleName; SampleKind::ALL.len() + 1] = {
            let mut all = [SampleName::Grid; SampleKind::ALL.len() + 1];
            let mut place = 0;
            while place < SampleKind::ALL.len() {
                all[place] = SampleName::Generated(SampleKind::ALL[place]);
                place += 1;
            }
            all
        };
        &ALL
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        match self {
            Self::Generated(kind) => kind.to_possible_value(),
            Self::Grid => {
                Some(PossibleValue::new("grid").help("Copies of a scene of yours, side by side (--of)"))
            }
        }
    }
}

/// Remove the baked visibility: gives back the file as it was before `svs build`
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  svs strip plant.svs.glb -o plant.glb")]
pub(crate) struct Strip {
    /// Baked file
    #[arg(value_name = "IN")]
    pub(crate) input: PathBuf,
    /// File to write: .glb or .gltf; may be IN
    #[arg(short, long, value_name = "OUT")]
    pub(crate) output: PathBuf,
}

/// Look at a scene in a window: what is drawn, what is skipped, and why
///
/// Files without baked visibility are shown too, with frustum culling. A file dropped on the window is opened.
#[cfg(feature = "render")]
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  svs view plant.svs.glb
  svs view plant.svs.glb --method frustum --camera path.json
  svs view plant.svs.glb --size 1280x800 --screenshot window.png --after 3

F1 in the window shows all keys.")]
pub(crate) struct View {
    /// File to open; without one, the window waits for a file to be dropped
    #[arg(value_name = "FILE")]
    pub(crate) file: Option<PathBuf>,
    /// 0 (fewest triangles) to 1 (fewest missing pixels) [default: 0.5]
    #[arg(long, value_name = "Q", value_parser = quality)]
    pub(crate) quality: Option<f32>,
    /// What is drawn: nothing is culled, frustum, visibility or exact [default: visibility]
    #[arg(long, value_name = "METHOD")]
    pub(crate) method: Option<svs::stage::Method>,
    /// Where to look from at first: a camera or camera path file
    #[arg(long, value_name = "FILE.json")]
    pub(crate) camera: Option<PathBuf>,
    /// Size of the window's inside in pixels [default: 1280x800]
    #[arg(long, value_name = "WxH", value_parser = window_size)]
    pub(crate) size: Option<[u32; 2]>,
    /// Write a picture of the window and close it
    #[arg(long, value_name = "OUT.png", conflicts_with = "script")]
    pub(crate) screenshot: Option<PathBuf>,
    /// Frames to draw before the picture is taken
    #[arg(long, value_name = "N", default_value_t = 2, requires = "screenshot",
          value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) after: u32,
    /// Run the steps of this file: a JSON list that sets what the controls set
    #[arg(long, value_name = "FILE.json")]
    pub(crate) script: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum QualityName {
    Draft,
    Standard,
    High,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum HierarchyName {
    #[default]
    Auto,
    Scene,
    Octree,
    Bvh,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum ProxiesName {
    Auto,
    All,
    #[default]
    Off,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum ProxyFormatName {
    /// For every loader
    #[default]
    Float,
    /// Smaller; needs KHR_mesh_quantization
    Quantized,
    /// Compressed, about a third of the bytes; needs EXT_meshopt_compression too, as files of gltfpack -c do
    Meshopt,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum SpheresName {
    Simple,
    #[default]
    Tight,
}

/// A finite number above zero.
pub(crate) fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err("a number above 0 is needed".to_owned()),
    }
}

/// A share, 0 to 1.
pub(crate) fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=1.0).contains(&value) => Ok(value),
        _ => Err("a share from 0 to 1 is needed, such as 0.05".to_owned()),
    }
}

/// A quality, 0 to 1.
#[cfg(feature = "render")]
fn quality(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(value) if (0.0..=1.0).contains(&value) => Ok(value),
        _ => Err("a number from 0 to 1 is needed, such as 0.5".to_owned()),
    }
}

/// Width and height in pixels.
#[cfg(feature = "render")]
fn window_size(text: &str) -> Result<[u32; 2], String> {
    let side = |text: &str| text.parse::<u32>().ok().filter(|side| (16..=16_384).contains(side));
    text.split_once('x')
        .and_then(|(width, height)| Some([side(width)?, side(height)?]))
        .ok_or_else(|| "two numbers from 16 to 16384 are needed, such as 1280x800".to_owned())
}
