//! What an evaluation has found.

use super::figures::{Figures, Likeness, median_of};
use super::machine::Machine;
use super::method::EvaluationMethod;
use super::options::EvaluateOptions;
use serde::{Serialize, Serializer};
use svs_render::Image;

/// What an evaluation has found: serialised, `summary.json`.
#[derive(Clone, Debug, Serialize)]
pub struct Evaluation {
    /// Name of the file, or whatever the caller calls the scene.
    pub scene: String,
    /// Over all frames of all paths.
    pub methods: Vec<MethodSummary>,
    /// Path by path.
    pub paths: Vec<PathEvaluation>,
    /// Objects of the scene.
    pub objects: usize,
    /// Triangles of the scene, each instance counted.
    pub triangles: u64,
    /// Bytes of the file, if it is one.
    pub file_bytes: Option<u64>,
    /// Bytes of geometry and textures on the GPU.
    pub gpu_bytes: u64,
    /// Baked visibility is there and used.
    pub baked: bool,
    /// Why it is not, where that needs saying.
    pub notice: Option<String>,
    /// How it was measured.
    pub settings: Settings,
    /// On what.
    pub machine: Machine,
    /// The runtime's cost model at the end, with a budget in milliseconds.
    pub cost_model: Option<CostReport>,
}

/// How an evaluation was made.
#[derive(Clone, Debug, Serialize)]
pub struct Settings {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Frames of each path.
    pub frames: usize,
    /// Times each frame was timed with each method.
    pub passes: usize,
    /// Quality of the query, 0 to 1, if it was chosen; else the file's recommendation or the runtime's default.
    pub quality: Option<f32>,
    /// The query, in the runtime's terms.
    pub query: String,
    /// The budget, in words.
    pub budget: Option<String>,
    /// Largest error of what is drawn simplified, pixels, where it is in full view.
    pub detail_px: f32,
    /// How much of the error counts, as on the command line.
    pub metric: String,
    /// The method whose pictures the others are compared with.
    pub reference: String,
    /// Where `frame_ms` comes from.
    pub time_source: TimeSource,
}

/// Which clock says when a frame is done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TimeSource {
    /// Timestamps that the GPU takes: frame time is culling, the CPU's part of drawing, and the GPU's.
    GpuTimestamps,
    /// The wall clock, until the GPU has finished: frame time is culling and that.
    WallClock,
}

impl TimeSource {
    /// In words.
    pub fn text(self) -> &'static str {
        match self {
            Self::GpuTimestamps => "GPU timestamps",
            Self::WallClock => "wall clock until the GPU has finished",
        }
    }
}

impl Serialize for TimeSource {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.text())
    }
}

/// The runtime's cost model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CostReport {
    /// Milliseconds asked for.
    pub budget_ms: f64,
    /// Frames it has learnt from.
    pub frames_learnt: usize,
    /// Median relative error of its latest predictions, each made before its frame was seen.
    pub relative_error: f64,
    /// Share of the frames whose time (median over the passes) was above the budget.
    pub share_over_budget: f64,
}

/// One camera path.
#[derive(Clone, Debug, Serialize)]
pub struct PathEvaluation {
    /// Its name: `outside`, `inside`, or the file's.
    pub name: String,
    /// Over its frames.
    pub methods: Vec<MethodSummary>,
    /// Frame by frame, all methods of a frame together. In `frames.csv`.
    #[serde(skip)]
    pub frames: Vec<FrameResult>,
    /// Per method whose pictures differ from the reference, the frame that differs most.
    #[serde(skip)]
    pub worst: Vec<WorstFrame>,
}

impl PathEvaluation {
    /// Frames of one method, in order.
    pub fn frames_of(&self, method: EvaluationMethod) -> impl Iterator<Item = &FrameResult> {
        self.frames.iter().filter(move |frame| frame.method == method)
    }
}

/// One frame with one method.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameResult {
    /// Place on the path.
    pub frame: usize,
    /// The method.
    pub method: EvaluationMethod,
    /// Times.
    pub time: TimeResult,
    /// Objects drawn.
    pub draws: usize,
    /// Draw calls after merging.
    pub draw_calls: usize,
    /// Triangles drawn.
    pub triangles: u64,
    /// What of it is simplified.
    pub simplified: Simplified,
    /// Most triangles allowed, for a method with a budget in triangles.
    pub triangle_budget: Option<u64>,
    /// The picture beside the reference.
    pub quality: QualityResult,
}

/// What of a draw list stands for something finer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Simplified {
    /// Proxies.
    pub proxies: usize,
    /// Objects at a simplified level.
    pub levels: usize,
    /// HLOD nodes: the proxies, and the innermost proxy nodes of which objects are drawn themselves.
    pub nodes: usize,
}

/// Times of a frame: each the median over the passes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TimeResult {
    /// Culling, microseconds; 0 for [`EvaluationMethod::Exact`].
    pub cull_us: f64,
    /// The whole frame, milliseconds, see [`TimeSource`].
    pub frame_ms: f64,
    /// Shortest pass, milliseconds.
    pub frame_ms_least: f64,
    /// Longest pass, milliseconds.
    pub frame_ms_most: f64,
    /// Batching, encoding and submitting on the CPU, milliseconds.
    pub cpu_ms: f64,
    /// On the GPU by its timestamps, milliseconds.
    pub gpu_ms: Option<f64>,
    /// From the beginning of batching until the GPU has finished, milliseconds.
    pub wall_ms: f64,
}

/// A picture beside the reference.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct QualityResult {
    /// Objects that at least one pixel of the reference shows.
    pub visible_objects: usize,
    /// Those that are not drawn.
    pub missing_objects: usize,
    /// Pixels that show one of them, per million pixels of the picture.
    pub missing_ppm: f64,
    /// Objects drawn that no pixel of the reference shows; a proxy counts if no pixel shows any object it stands for.
    pub overdrawn_objects: usize,
    /// Pixels of the largest region (neighbours share an edge) where the reference shows an object and the picture shows
    /// nothing at all.
    pub largest_hole: usize,
    /// Pixels of the largest region that shows missing objects in the reference.
    pub largest_missing: usize,
    /// Structural similarity.
    pub ssim: f64,
    /// Peak signal-to-noise ratio of luma, decibels.
    pub psnr_y: f64,
    /// Of blue.
    pub psnr_cb: f64,
    /// Of red.
    pub psnr_cr: f64,
}

/// A method over the frames of one path, or of all.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MethodSummary {
    /// Name of the method.
    pub method: String,
    /// Frame time, milliseconds.
    pub frame_ms: Figures,
    /// Culling, microseconds.
    pub cull_us: Figures,
    /// Objects drawn.
    pub draws: Figures,
    /// Triangles drawn.
    pub triangles: Figures,
    /// Pixels per million that show a missing object.
    pub missing_ppm: Figures,
    /// Structural similarity.
    pub ssim: Likeness,
    /// Peak signal-to-noise ratio of luma, decibels; equal pictures count as [`super::metrics::MAX_PSNR`].
    pub psnr_y: Likeness,
    /// Of blue.
    pub psnr_cb: Likeness,
    /// Of red.
    pub psnr_cr: Likeness,
    /// Draw calls after merging.
    pub draw_calls: Figures,
    /// Objects missing.
    pub missing_objects: Figures,
    /// Objects drawn that are not seen.
    pub overdrawn_objects: Figures,
    /// Pixels of the largest region that shows nothing where the reference shows something.
    pub largest_hole: Figures,
    /// Pixels of the largest region of missing objects.
    pub largest_missing: Figures,
    /// Proxies drawn.
    pub proxies: Figures,
    /// Objects drawn at a simplified level.
    pub levels: Figures,
    /// HLOD nodes drawn, see [`Simplified::nodes`].
    pub nodes: Figures,
    /// CPU's part of drawing, milliseconds.
    pub cpu_ms: Figures,
    /// GPU time by timestamps, milliseconds, if every frame has it.
    pub gpu_ms: Option<Figures>,
    /// Wall clock of drawing, milliseconds.
    pub wall_ms: Figures,
    /// (longest - shortest pass) / median pass, per frame.
    pub frame_ms_spread: Figures,
    /// Median frame time of frustum culling / that of this method, over the same frames.
    pub speedup_over_frustum: Option<f64>,
}

impl MethodSummary {
    /// Of the frames of one method; `frustum_ms` is the median frame time of frustum culling.
    pub fn of(method: EvaluationMethod, frames: &[&FrameResult], frustum_ms: Option<f64>) -> Self {
        let figures = |of: &dyn Fn(&FrameResult) -> f64| Figures::of(frames.iter().map(|frame| of(frame)));
        let likeness = |of: &dyn Fn(&FrameResult) -> f64| Likeness::of(frames.iter().map(|frame| of(frame)));
        let gpu: Option<Vec<f64>> = frames.iter().map(|frame| frame.time.gpu_ms).collect();
        let frame_ms = figures(&|f| f.time.frame_ms);
        let speedup = frustum_ms.map(|frustum| frustum / frame_ms.median).filter(|ratio| ratio.is_finite());
        Self {
            method: method.name().to_owned(),
            frame_ms,
            cull_us: figures(&|f| f.time.cull_us),
            draws: figures(&|f| f.draws as f64),
            triangles: figures(&|f| f.triangles as f64),
            missing_ppm: figures(&|f| f.quality.missing_ppm),
            ssim: likeness(&|f| f.quality.ssim),
            psnr_y: likeness(&|f| f.quality.psnr_y),
            psnr_cb: likeness(&|f| f.quality.psnr_cb),
            psnr_cr: likeness(&|f| f.quality.psnr_cr),
            draw_calls: figures(&|f| f.draw_calls as f64),
            missing_objects: figures(&|f| f.quality.missing_objects as f64),
            overdrawn_objects: figures(&|f| f.quality.overdrawn_objects as f64),
            largest_hole: figures(&|f| f.quality.largest_hole as f64),
            largest_missing: figures(&|f| f.quality.largest_missing as f64),
            proxies: figures(&|f| f.simplified.proxies as f64),
            levels: figures(&|f| f.simplified.levels as f64),
            nodes: figures(&|f| f.simplified.nodes as f64),
            cpu_ms: figures(&|f| f.time.cpu_ms),
            gpu_ms: gpu.map(Figures::of),
            wall_ms: figures(&|f| f.time.wall_ms),
            frame_ms_spread: figures(&|f| f.time.spread()),
            speedup_over_frustum: speedup,
        }
    }

    /// One per method, of frames of all of them.
    pub fn all(options: &EvaluateOptions, frames: &[&FrameResult]) -> Vec<Self> {
        let of = |method| -> Vec<&FrameResult> {
            frames.iter().copied().filter(|frame| frame.method == method).collect()
        };
        let frustum = of(EvaluationMethod::Frustum);
        let frustum_ms =
            (!frustum.is_empty()).then(|| median_of(frustum.iter().map(|frame| frame.time.frame_ms)));
        options.methods.iter().map(|&method| Self::of(method, &of(method), frustum_ms)).collect()
    }
}

impl TimeResult {
    /// (longest - shortest pass) / median pass.
    pub fn spread(&self) -> f64 {
        let spread = (self.frame_ms_most - self.frame_ms_least) / self.frame_ms;
        if spread.is_finite() { spread } else { 0.0 }
    }
}

/// The frame of a path in which a method's picture differs most: least similarity, then most missing pixels.
#[derive(Clone, Debug)]
pub struct WorstFrame {
    /// The method.
    pub method: EvaluationMethod,
    /// Place on the path.
    pub frame: usize,
    /// How far it is off.
    pub quality: QualityResult,
    /// What it should look like.
    pub reference: Image,
    /// What it looks like.
    pub picture: Image,
    /// Per pixel: the reference shows a missing object there.
    pub missing: Vec<bool>,
    /// The missing objects with most pixels, and how many pixels each has.
    pub largest: Vec<MissingObject>,
}

/// An object that is missing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MissingObject {
    /// Its index.
    pub object: u32,
    /// Name of its node.
    pub name: Option<String>,
    /// Pixels that show it in the reference.
    pub pixels: u32,
}
