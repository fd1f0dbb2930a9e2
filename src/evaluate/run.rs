//! The whole evaluation.

use super::bench::{Bench, Shot};
use super::error::EvaluateError;
use super::flight::{Flight, flights};
use super::machine::Machine;
use super::method::EvaluationMethod;
use super::options::{EvaluateOptions, FrameBudget};
use super::quality;
use super::result::{
    CostReport, Evaluation, FrameResult, MethodSummary, PathEvaluation, Settings, TimeSource,
};
use super::timing::{self, Timed};
use crate::bake::Progress;
use crate::gltf::Document;
use crate::stage::{metric_name, visible_objects};

/// Flies camera paths through the scene of `doc` with each method. `scene` is what the report calls it.
///
/// A file without usable baked visibility is measured too: its visibility is frustum culling, and the evaluation says so.
///
/// # Errors
/// [`EvaluateError`], with what to do about it.
pub fn evaluate(
    doc: &Document,
    scene: &str,
    options: &EvaluateOptions,
    progress: &dyn Progress,
) -> Result<Evaluation, EvaluateError> {
    options.check()?;
    progress.stage("opening the scene", None);
    let mut bench = Bench::new(doc, options)?;
    let mut source = None;
    let mut paths = Vec::new();
    for flight in flights(&bench.cullers.stage, options) {
        let flown = fly(&mut bench, &flight, options, source, progress)?;
        source = Some(flown.1);
        paths.push(flown.0);
    }
    let source = source.unwrap_or(TimeSource::WallClock);
    let all: Vec<&FrameResult> = paths.iter().flat_map(|path| &path.frames).collect();
    let stage = &bench.cullers.stage;
    Ok(Evaluation {
        scene: scene.to_owned(),
        methods: MethodSummary::all(options, &all),
        cost_model: cost_report(&bench, options, &all),
        objects: stage.order().len(),
        triangles: stage.triangles().iter().map(|&count| u64::from(count)).sum(),
        file_bytes: None,
        gpu_bytes: bench.scene.bytes(),
        baked: stage.is_baked(),
        notice: notice(&bench, options),
        settings: Settings {
            width: options.width,
            height: options.height,
            frames: options.frames,
            passes: options.passes,
            quality: options.quality,
            query: query(&bench.cullers.settings),
            budget: options.budget.map(|budget| budget.to_string()),
            detail_px: options.detail.tau,
            metric: metric_name(&options.detail.metric),
            reference: options.reference.to_string(),
            time_source: source,
        },
        machine: Machine::this(bench.gpu.adapter.get_info()),
        paths,
    })
}

/// One path: what may be drawn in each frame, then the times, then the pictures. Times come first because a budget in
/// milliseconds depends on them: pictures are compared of what was timed.
fn fly(
    bench: &mut Bench,
    flight: &Flight,
    options: &EvaluateOptions,
    source: Option<TimeSource>,
    progress: &dyn Progress,
) -> Result<(PathEvaluation, TimeSource), EvaluateError> {
    let name = &flight.name;
    progress.stage(&format!("{name}: visible objects"), Some(flight.views.len() as u64));
    let mut shots = Vec::with_capacity(flight.views.len());
    for &view in &flight.views {
        shots.push(prepare(bench, Shot { view, exact: Vec::new(), triangles: None }, options)?);
        progress.advance(1);
    }
    progress.stage(&format!("{name}: warming up"), None);
    let found = timing::warm_up(bench, &shots, options)?;
    let known = source.is_some();
    // One clock for all paths.
    let source = source.unwrap_or(found);
    if matches!(options.budget, Some(FrameBudget::Milliseconds(_))) && !known {
        timing::teach(bench, &shots, source)?;
    }
    let frames = shots.len() * options.methods.len();
    progress.stage(&format!("{name}: timing"), Some((frames * options.passes) as u64));
    let mut timed = timing::measure(bench, &shots, options, source, progress)?;

    progress.stage(&format!("{name}: comparing pictures"), Some(shots.len() as u64));
    let lists: Vec<Vec<Option<Vec<u32>>>> = timed
        .iter_mut()
        .map(|frames| frames.iter_mut().map(|frame| frame.objects.take()).collect())
        .collect();
    let (quality, worst) = quality::compare(bench, &shots, options, &lists, progress)?;

    let mut frames = Vec::with_capacity(frames);
    for (frame, shot) in shots.iter().enumerate() {
        for (place, &method) in options.methods.iter().enumerate() {
            let Timed { time, draws, draw_calls, triangles, .. } = timed[place][frame];
            let triangle_budget = shot.triangles.filter(|_| options.limits(method));
            let (quality, simplified) = quality[place][frame];
            frames.push(FrameResult {
                frame,
                method,
                time,
                draws,
                draw_calls,
                triangles,
                simplified,
                triangle_budget,
                quality,
            });
        }
    }
    let all: Vec<&FrameResult> = frames.iter().collect();
    let methods = MethodSummary::all(options, &all);
    Ok((PathEvaluation { name: name.clone(), methods, frames, worst }, source))
}

/// Finds out what the methods need to know of a frame.
fn prepare(bench: &mut Bench, mut shot: Shot, options: &EvaluateOptions) -> Result<Shot, EvaluateError> {
    if options.methods.contains(&EvaluationMethod::Exact) {
        let reference = bench.cullers.cull(&shot, EvaluationMethod::Frustum).to_vec();
        let items = bench.items(shot.view, &reference)?;
        shot.exact = visible_objects(&items);
    }
    shot.triangles = match options.budget {
        Some(FrameBudget::Triangles(most)) => Some(most),
        Some(FrameBudget::Share(share)) => {
            let visible = bench.cullers.cull(&shot, EvaluationMethod::Visibility).to_vec();
            Some((bench.cullers.triangles_of(&visible) as f64 * share) as u64)
        }
        Some(FrameBudget::Milliseconds(_)) | None => None,
    };
    Ok(shot)
}

fn cost_report(bench: &Bench, options: &EvaluateOptions, frames: &[&FrameResult]) -> Option<CostReport> {
    let Some(FrameBudget::Milliseconds(budget_ms)) = options.budget else { return None };
    let budgeted = || frames.iter().filter(|frame| frame.method == EvaluationMethod::Budget);
    let over = budgeted().filter(|frame| frame.time.frame_ms > budget_ms).count();
    Some(CostReport {
        budget_ms,
        frames_learnt: bench.cullers.cost.frames(),
        relative_error: bench.cullers.cost.error(),
        share_over_budget: over as f64 / budgeted().count().max(1) as f64,
    })
}

/// What has to be said of the file.
fn notice(bench: &Bench, options: &EvaluateOptions) -> Option<String> {
    let stage = &bench.cullers.stage;
    let by_visibility =
        [EvaluationMethod::Visibility, EvaluationMethod::Budget, EvaluationMethod::FirstMisfit];
    let matters = options.methods.iter().any(|method| by_visibility.contains(method));
    let wants_proxies = options.methods.iter().any(|method| method.draws_proxies().is_some());
    match stage.notice() {
        Some(notice) => Some(notice.to_owned()),
        None if matters && !stage.is_baked() => Some(
            "The file holds no baked visibility: method visibility is frustum culling here. Run `svs build` on it first."
                .to_owned(),
        ),
        None if wants_proxies && !stage.has_proxies() => Some(
            "The file holds no proxies: the methods with proxies draw the objects themselves. Run `svs build --proxies auto` \
             on it."
                .to_owned(),
        ),
        None => None,
    }
}

/// The query in words.
fn query(settings: &svs_runtime::Settings) -> String {
    let tau = &settings.tau;
    let stage = |pixels: f32| if pixels.is_finite() { format!("{pixels} px") } else { "off".to_owned() };
    format!(
        "{:?}: own bin {}, triangle {}, ring {}; spheres up to {:.0} degrees",
        settings.query,
        stage(tau.nearest),
        stage(tau.triangle),
        stage(tau.ring),
        settings.max_half_angle.to_degrees()
    )
}
