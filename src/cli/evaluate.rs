//! `svs evaluate`: flies camera paths with each method and writes a report.

use super::args::Common;
use super::detail::{DetailArgs, Switch};
use super::error::Failure;
use super::output::{count, number};
use super::progress::Bars;
use super::{file, interrupt, output};
use clap::{Args, ValueEnum};
use std::path::{Path, PathBuf};
use svs::camera_path::CameraPath;
use svs::evaluate::{
    EvaluateError, EvaluateOptions, Evaluation, EvaluationMethod, FrameBudget, MethodSummary, REPORT_FILES,
    Tour,
};

/// Measure what culling gains on camera paths, and what it costs in the picture: writes a report
///
/// Flies each path in fixed steps with each method, offscreen, on any GPU or a software driver, and writes report.html
/// (plots, tables, worst frames), frames.csv (every frame) and summary.json.
#[derive(Debug, Args)]
#[command(after_help = "\
Methods:
  nothing       everything is drawn
  frustum       hierarchical frustum culling: the reference of all pictures
  visibility    spherical visibility
  exact         what the reference's pixels show, at no cost of finding it
  budget        visibility within --budget
  first-misfit  the same budget by the published rule: stop at the first object that does not fit
  proxies       visibility, and what is far or hardly visible simplified or through proxies: --detail, --metric, --budget
  proxies-sse, proxies-linear, proxies-frustum
                the same with --metric sse, with --metric linear, and by the screen-space error without visibility

Examples:
  svs evaluate plant.svs.glb -o report
  svs evaluate plant.svs.glb --budget 10% -o report         budget and first-misfit come in addition
  svs evaluate plant.svs.glb --path tour.json --methods frustum,visibility --passes 5 -o report
  svs evaluate plant.svs.glb --proxies on --detail 2 --metric linear -o report
  svs evaluate plant.svs.glb --methods proxies-sse,proxies --reference proxies-sse -o report
  svs evaluate plant.svs.glb --size 640x360 --frames 12 --tour inside -o report --json")]
pub(crate) struct Evaluate {
    /// Scene to measure, baked or not
    #[arg(value_name = "FILE")]
    pub(crate) file: PathBuf,
    /// Folder of the report; created if it is not there
    #[arg(short, long, value_name = "FOLDER")]
    pub(crate) output: PathBuf,
    /// Recorded camera path; more than one may be given [default: generated ones]
    #[arg(long, value_name = "FILE.json", conflicts_with = "tour")]
    pub(crate) path: Vec<PathBuf>,
    /// Generated paths to fly
    #[arg(long, value_enum, value_name = "TOUR", default_value_t)]
    pub(crate) tour: TourName,
    /// Methods to compare, separated by commas [default: frustum,visibility,exact]
    #[arg(long, value_name = "LIST")]
    pub(crate) methods: Option<String>,
    /// Quality of the visibility query, 0 to 1 [default: as the file recommends]
    #[arg(long, value_name = "Q", value_parser = super::args::share)]
    pub(crate) quality: Option<f64>,
    /// Most that a frame may draw: triangles (200000), a share of the triangles of visibility (10%), or time (8ms)
    #[arg(long, value_name = "BUDGET")]
    pub(crate) budget: Option<String>,
    #[command(flatten)]
    pub(crate) detail: DetailArgs,
    /// Measure method `proxies` in addition [default: on with --detail or --metric]
    #[arg(long, value_enum, value_name = "on|off")]
    pub(crate) proxies: Option<Switch>,
    /// Method whose pictures the others are compared with [default: frustum]
    #[arg(long, value_name = "METHOD")]
    pub(crate) reference: Option<String>,
    /// Frames of each path
    #[arg(long, value_name = "N", default_value_t = 48)]
    pub(crate) frames: usize,
    /// How often each frame is timed with each method
    #[arg(long, value_name = "N", default_value_t = 3)]
    pub(crate) passes: usize,
    /// Size of the pictures, pixels
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = super::render::size)]
    pub(crate) size: (u32, u32),
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum TourName {
    /// A round trip about the scene
    Outside,
    /// A walk through it
    Inside,
    /// Outside and inside, one after the other
    #[default]
    Both,
    /// Turns about it, from overview to close-up and back
    Inspection,
}

impl From<TourName> for Tour {
    fn from(name: TourName) -> Self {
        match name {
            TourName::Outside => Self::Outside,
            TourName::Inside => Self::Inside,
            TourName::Both => Self::Both,
            TourName::Inspection => Self::Inspection,
        }
    }
}

pub(crate) fn run(args: &Evaluate, common: &Common) -> Result<(), Failure> {
    let mut options = options(args)?;
    check_folder(&args.output)?;
    options.paths = args.path.iter().map(|path| read_path(path)).collect::<Result<_, _>>()?;
    let document = file::read(&args.file)?;
    let scene = args.file.file_name().unwrap_or(args.file.as_os_str()).to_string_lossy();
    let bars = Bars::new(common.quiet);
    let mut evaluation =
        svs::evaluate::evaluate(&document, &scene, &options, &bars).map_err(|error| match error {
            EvaluateError::Options(error) => Failure::Usage(error.to_string()),
            error => Failure::doing("evaluate", &args.file, &error),
        })?;
    bars.clear();
    evaluation.file_bytes = std::fs::metadata(&args.file).ok().map(|data| data.len());
    interrupt::protect(|| evaluation.write(&args.output))
        .map_err(|error| Failure::doing("write", &args.output, &error))?;
    if let Some(notice) = evaluation.notice.as_ref().filter(|_| !common.quiet) {
        eprintln!("note: {notice}");
    }
    output::print(common, &evaluation.summary(), &to_text(&evaluation, &args.output))
}

fn options(args: &Evaluate) -> Result<EvaluateOptions, Failure> {
    let usage = |error: svs::evaluate::OptionError| Failure::Usage(error.to_string());
    let mut options = EvaluateOptions {
        tour: args.tour.into(),
        quality: args.quality.map(|quality| quality as f32),
        budget: args.budget.as_deref().map(str::parse).transpose().map_err(usage)?,
        detail: args.detail.detail(),
        frames: args.frames,
        passes: args.passes,
        width: args.size.0,
        height: args.size.1,
        ..EvaluateOptions::default()
    };
    if let Some(methods) = &args.methods {
        options.methods =
            methods.split(',').map(|name| name.trim().parse()).collect::<Result<_, _>>().map_err(usage)?;
    }
    let budgeted: &[EvaluationMethod] = match options.budget {
        // The published rule knows no milliseconds.
        Some(FrameBudget::Milliseconds(_)) => &[EvaluationMethod::Budget],
        Some(_) => &[EvaluationMethod::Budget, EvaluationMethod::FirstMisfit],
        None => &[],
    };
    // Not where the methods asked for keep within the budget already.
    if !options.methods.iter().any(|&method| options.limits(method)) {
        options.methods.extend(budgeted);
    }
    let wants_proxies = args.proxies.map_or(args.detail.is_given(), |switch| switch == Switch::On);
    if wants_proxies && !options.methods.iter().any(|method| method.draws_proxies().is_some()) {
        options.methods.push(EvaluationMethod::Proxies);
    }
    if let Some(reference) = &args.reference {
        options.reference = reference.parse().map_err(usage)?;
    }
    options.check().map_err(usage)?;
    Ok(options)
}

/// A recorded path; one without a name is called by its file.
fn read_path(path: &Path) -> Result<CameraPath, Failure> {
    let mut read = CameraPath::read(path).map_err(|error| Failure::doing("read", path, &error))?;
    if read.name.is_empty() {
        read.name = path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    }
    Ok(read)
}

/// Refuses, before any work is done, a folder that could not be written at its end.
fn check_folder(folder: &Path) -> Result<(), Failure> {
    let inside = if folder.is_dir() {
        folder
    } else {
        if folder.exists() {
            return Err(Failure::Input(format!(
                "cannot write {}: it is a file, not a folder",
                folder.display()
            )));
        }
        file::check_folder(folder)?;
        folder.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
    };
    tempfile::Builder::new()
        .prefix(".svs-report-")
        .tempfile_in(inside)
        .map(drop)
        .map_err(|error| Failure::doing("write", folder, &error))
}

fn to_text(evaluation: &Evaluation, folder: &Path) -> String {
    let mut text = String::new();
    for path in &evaluation.paths {
        text += &format!("{}\n{}\n", path.name, table(&path.methods));
    }
    text += &format!(
        "medians; frame time by {}\n{}\n",
        evaluation.settings.time_source.text(),
        evaluation.machine.adapter
    );
    if let Some(cost) = &evaluation.cost_model {
        text += &format!(
            "cost model: median error {}, {} of the frames above {} ms\n",
            output::percent(cost.relative_error),
            output::percent(cost.share_over_budget),
            cost.budget_ms
        );
    }
    text + &format!("{} written\n", folder.join(REPORT_FILES[0]).display())
}

fn table(methods: &[MethodSummary]) -> String {
    let head = [
        "method",
        "frame ms",
        "p95",
        "x frustum",
        "cull us",
        "objects",
        "triangles",
        "missing ppm",
        "worst",
        "worst SSIM",
        "proxies",
        "nodes",
        "worst hole px",
    ];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for method in methods {
        rows.push(vec![
            method.method.clone(),
            number(method.frame_ms.median),
            number(method.frame_ms.p95),
            method.speedup_over_frustum.map_or_else(|| "-".to_owned(), number),
            number(method.cull_us.median),
            count(method.draws.median as u64),
            count(method.triangles.median as u64),
            number(method.missing_ppm.median),
            number(method.missing_ppm.worst),
            format!("{:.6}", method.ssim.worst),
            count(method.proxies.median as u64),
            count(method.nodes.median as u64),
            count(method.largest_hole.worst as u64),
        ]);
    }
    output::table(&rows)
}
