//! Pictures: each method's beside the reference, frame by frame.

use super::bench::{Bench, Shot};
use super::error::EvaluateError;
use super::method::EvaluationMethod;
use super::metrics::{Compared, MAX_PSNR, Seen, hole_mask, largest_region, psnr, ssim};
use super::options::EvaluateOptions;
use super::result::{MissingObject, QualityResult, Simplified, WorstFrame};
use crate::bake::Progress;
use crate::stage::{Kind, Stage};
use svs_render::{Image, View};

/// Missing objects that a report names.
const NAMED: usize = 5;

/// The reference of one frame.
struct Reference {
    view: View,
    frame: usize,
    /// What was drawn for the picture, ascending.
    sorted: Vec<u32>,
    image: Image,
    /// What the picture with frustum culling shows.
    seen: Seen,
}

type Result<T> = std::result::Result<T, EvaluateError>;

/// Per method, per frame.
type Results = Vec<Vec<(QualityResult, Simplified)>>;

/// Compares all frames with all methods. `lists[method][frame]` is what the method has drawn, where it cannot be asked again.
/// The results are in the same order; with them, per method whose pictures differ, the frame that differs most.
pub(super) fn compare(
    bench: &mut Bench,
    shots: &[Shot],
    options: &EvaluateOptions,
    lists: &[Vec<Option<Vec<u32>>>],
    progress: &dyn Progress,
) -> Result<(Results, Vec<WorstFrame>)> {
    let methods = &options.methods;
    let known = |method: EvaluationMethod, frame: usize| {
        let place = methods.iter().position(|&other| other == method)?;
        lists.get(place).and_then(|frames| frames.get(frame)).and_then(Option::as_deref)
    };
    let mut results: Results = methods.iter().map(|_| Vec::with_capacity(shots.len())).collect();
    let mut worst: Vec<Option<WorstFrame>> = methods.iter().map(|_| None).collect();
    for (frame, shot) in shots.iter().enumerate() {
        let in_frustum = sorted(bench.cullers.cull(shot, EvaluationMethod::Frustum));
        let seen = Seen::new(bench.items(shot.view, &in_frustum)?);
        let sorted = match known(options.reference, frame) {
            Some(drawn) => sorted(drawn),
            None => sorted(bench.cullers.cull(shot, options.reference)),
        };
        let image = bench.image(shot.view, &sorted)?;
        let reference = Reference { view: shot.view, frame, sorted, image, seen };
        for (place, &method) in methods.iter().enumerate() {
            let drawn = match known(method, frame) {
                Some(objects) => objects.to_vec(),
                None => bench.cullers.cull(shot, method).to_vec(),
            };
            results[place].push(one(bench, &reference, method, &drawn, &mut worst[place])?);
        }
        progress.advance(1);
    }
    let named = |mut frame: WorstFrame| {
        for missing in &mut frame.largest {
            missing.name = bench.cullers.stage.names.get(missing.object as usize).cloned().flatten();
        }
        frame
    };
    Ok((results, worst.into_iter().flatten().map(named).collect()))
}

fn one(
    bench: &mut Bench,
    reference: &Reference,
    method: EvaluationMethod,
    drawn: &[u32],
    worst: &mut Option<WorstFrame>,
) -> Result<(QualityResult, Simplified)> {
    let stage = &bench.cullers.stage;
    let simplified = simplified(stage, drawn);
    let compared = reference.seen.compare(&stage.objects_shown(drawn));
    let missing = reference.seen.mask(&objects_missing(&compared));
    let overdrawn_objects = overdrawn(stage, drawn, &reference.seen);
    let width = reference.image.width as usize;
    let pixels = f64::from(reference.image.width) * f64::from(reference.image.height);
    let mut result = QualityResult {
        visible_objects: reference.seen.objects.len(),
        missing_objects: compared.missing.len(),
        missing_ppm: compared.pixels as f64 / pixels * 1e6,
        overdrawn_objects,
        largest_hole: 0,
        largest_missing: largest_region(&missing, width),
        ssim: 1.0,
        psnr_y: MAX_PSNR,
        psnr_cb: MAX_PSNR,
        psnr_cr: MAX_PSNR,
    };
    // If everything seen is drawn as it is, it is seen again.
    if !compared.missing.is_empty() || simplified.proxies + simplified.levels > 0 {
        let items = bench.items(reference.view, drawn)?;
        result.largest_hole = largest_region(&hole_mask(reference.seen.items(), &items), width);
    }
    // The same list gives the same picture.
    if sorted(drawn) == reference.sorted {
        return Ok((result, simplified));
    }
    let image = bench.image(reference.view, drawn)?;
    let ratios = psnr(&reference.image, &image)?;
    result.ssim = ssim(&reference.image, &image)?;
    (result.psnr_y, result.psnr_cb, result.psnr_cr) = (ratios.y, ratios.cb, ratios.cr);
    let differs = compared.pixels > 0 || image.rgba != reference.image.rgba;
    if differs && worst.as_ref().is_none_or(|worst| is_worse(&result, &worst.quality)) {
        *worst = Some(worst_frame(reference, method, &compared, missing, result, image));
    }
    Ok((result, simplified))
}

fn simplified(stage: &Stage, drawn: &[u32]) -> Simplified {
    Simplified {
        proxies: stage.count(drawn, Kind::Proxy),
        levels: stage.count(drawn, Kind::Level),
        nodes: stage.nodes_shown(drawn),
    }
}

/// How much of what is drawn no pixel of the reference shows.
fn overdrawn(stage: &Stage, drawn: &[u32], seen: &Seen) -> usize {
    let is_seen = |object: &u32| seen.objects.binary_search(object).is_ok();
    let is_overdrawn = |id: &u32| match stage.kind_of(*id) {
        Kind::Object => !is_seen(id),
        Kind::Level | Kind::Proxy => !stage.objects_of(*id).iter().any(is_seen),
    };
    drawn.iter().filter(|&id| is_overdrawn(id)).count()
}

/// Ascending.
fn objects_missing(compared: &Compared) -> Vec<u32> {
    sorted(&compared.missing.iter().map(|&(object, _)| object).collect::<Vec<_>>())
}

/// By similarity, then by missing pixels, then by brightness.
fn is_worse(a: &QualityResult, b: &QualityResult) -> bool {
    let order = a.ssim.total_cmp(&b.ssim);
    let order = order.then(b.missing_ppm.total_cmp(&a.missing_ppm)).then(a.psnr_y.total_cmp(&b.psnr_y));
    order.is_lt()
}

fn worst_frame(
    reference: &Reference,
    method: EvaluationMethod,
    compared: &Compared,
    missing: Vec<bool>,
    quality: QualityResult,
    picture: Image,
) -> WorstFrame {
    let largest = compared.missing.iter().take(NAMED);
    WorstFrame {
        method,
        frame: reference.frame,
        quality,
        reference: reference.image.clone(),
        picture,
        missing,
        largest: largest.map(|&(object, pixels)| MissingObject { object, name: None, pixels }).collect(),
    }
}

fn sorted(objects: &[u32]) -> Vec<u32> {
    let mut sorted = objects.to_vec();
    sorted.sort_unstable();
    sorted
}
