//! Pictures: each method's beside the reference, frame by frame.

use super::bench::{Bench, Shot};
use super::error::EvaluateError;
use super::metrics::{Compared, MAX_PSNR, Seen, psnr, ssim};
use super::options::EvaluationMethod;
use super::result::{MissingObject, QualityResult, WorstFrame};
use crate::bake::Progress;
use svs_render::{Image, View};

/// Missing objects that a report names.
const NAMED: usize = 5;

/// The reference of one frame.
struct Reference {
    view: View,
    frame: usize,
    /// What frustum culling draws, ascending.
    sorted: Vec<u32>,
    image: Image,
    seen: Seen,
}

/// Compares all frames with all methods. `lists[method][frame]` is what the method has drawn, where it cannot be asked again.
/// The results are in the same order; with them, per method whose pictures differ, the frame that differs most.
pub(super) fn compare(
    bench: &mut Bench,
    shots: &[Shot],
    methods: &[EvaluationMethod],
    lists: &[Vec<Option<Vec<u32>>>],
    progress: &dyn Progress,
) -> Result<(Vec<Vec<QualityResult>>, Vec<WorstFrame>), EvaluateError> {
    let mut results: Vec<Vec<QualityResult>> =
        methods.iter().map(|_| Vec::with_capacity(shots.len())).collect();
    let mut worst: Vec<Option<WorstFrame>> = methods.iter().map(|_| None).collect();
    for (frame, shot) in shots.iter().enumerate() {
        let sorted = sorted(bench.cullers.cull(shot, EvaluationMethod::Frustum));
        let image = bench.image(shot.view, &sorted)?;
        let seen = Seen::new(bench.items(shot.view, &sorted)?);
        let reference = Reference { view: shot.view, frame, sorted, image, seen };
        for (place, &method) in methods.iter().enumerate() {
            let known = lists.get(place).and_then(|frames| frames.get(frame)).and_then(Option::as_deref);
            let drawn = match known {
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
) -> Result<QualityResult, EvaluateError> {
    let compared = reference.seen.compare(drawn);
    let pixels = f64::from(reference.image.width) * f64::from(reference.image.height);
    let mut result = QualityResult {
        visible_objects: reference.seen.objects.len(),
        missing_objects: compared.missing.len(),
        missing_ppm: compared.pixels as f64 / pixels * 1e6,
        overdrawn_objects: compared.overdrawn,
        ssim: 1.0,
        psnr_y: MAX_PSNR,
        psnr_cb: MAX_PSNR,
        psnr_cr: MAX_PSNR,
    };
    // The same list gives the same picture.
    if sorted(drawn) == reference.sorted {
        return Ok(result);
    }
    let image = bench.image(reference.view, drawn)?;
    let ratios = psnr(&reference.image, &image)?;
    result.ssim = ssim(&reference.image, &image)?;
    (result.psnr_y, result.psnr_cb, result.psnr_cr) = (ratios.y, ratios.cb, ratios.cr);
    let differs = compared.pixels > 0 || image.rgba != reference.image.rgba;
    if differs && worst.as_ref().is_none_or(|worst| is_worse(&result, &worst.quality)) {
        *worst = Some(worst_frame(reference, method, &compared, result, image));
    }
    Ok(result)
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
    quality: QualityResult,
    picture: Image,
) -> WorstFrame {
    let objects = sorted(&compared.missing.iter().map(|&(object, _)| object).collect::<Vec<_>>());
    let largest = compared.missing.iter().take(NAMED);
    WorstFrame {
        method,
        frame: reference.frame,
        quality,
        reference: reference.image.clone(),
        picture,
        missing: reference.seen.mask(&objects),
        largest: largest.map(|&(object, pixels)| MissingObject { object, name: None, pixels }).collect(),
    }
}

fn sorted(objects: &[u32]) -> Vec<u32> {
    let mut sorted = objects.to_vec();
    sorted.sort_unstable();
    sorted
}
