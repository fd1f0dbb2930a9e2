//! Held-out verification: what a baked file draws and misses on cameras that its bake has not seen.
//!
//! For each camera an item buffer ([`visible_set`]) gives the exact visible set (EVS): the objects that at least one
//! pixel shows. Methods are compared with it: the runtime at its default settings (or those the file recommends), at a
//! sweep of its quality slider, the **published method** ([`PublishedBake`]) and plain frustum culling. The runtime
//! crate itself answers, so what is measured is what users run. See [`VerifyReport`] for the figures.
//!
//! Proxies and simplified meshes are held against their stated errors: [`CalibrationReport`].

mod calibrate;
mod cameras;
mod item_buffer;
mod methods;
mod published;
mod published_bake;
pub(crate) mod random;
mod report;
mod score;
mod slider;
mod statistics;
mod target;
#[cfg(test)]
mod tests;
mod view;

pub use crate::baked::BakedError as VerifyError;
pub use calibrate::CalibrationReport;
pub use cameras::{CAMERA_GROUPS, CameraGroup, CameraOptions, Surroundings, camera};
pub use item_buffer::{VisibleSet, visible_set};
pub use published_bake::{PIXEL_LIMIT, PublishedBake, RESOLUTION, Sampling};
pub use report::{GroupReport, PublishedReport, TriangleRatios, VerifyReport};
pub use score::{Frame, Score};
pub use statistics::{Distribution, interpolate_log, median, nearest_rank, ratio};
pub use target::Target;
pub use view::{Frustum, View};

use crate::bake::Progress;
use crate::bake::rays::RayScene;
use crate::baked::Baked;
use crate::gltf::Document;
use methods::Measure;
use slider::RuntimeSlider;

/// What to measure.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct VerifyOptions {
    /// Cameras in each of the five groups ([`CAMERA_GROUPS`]).
    pub cameras: usize,
    /// Seed of the cameras.
    pub seed: u64,
    /// Compare with the published method, too.
    pub published: bool,
    /// Pixels per row, at least 1.
    pub width: u32,
    /// Rows, at least 1.
    pub height: u32,
}

impl Default for VerifyOptions {
    /// 24 cameras per group at 1280x720, with the published method.
    fn default() -> Self {
        Self { cameras: 24, seed: 1, published: true, width: 1280, height: 720 }
    }
}

/// Measures the baked visibility of `doc` on held-out cameras. The report does not depend on the number of threads.
///
/// Objects in no visibility tree (skinned, morphed, …) are ignored in all figures, as occluders too. Trees that move are
/// measured where the file puts them at rest.
///
/// # Errors
/// See [`VerifyError`].
pub fn verify(
    doc: &Document,
    options: &VerifyOptions,
    progress: &dyn Progress,
) -> Result<VerifyReport, VerifyError> {
    measure(doc, options, true, progress)
}

/// A quick look for the end of a bake: four cameras per group at 640x360, groups `outside` and `inside`, the default
/// settings and frustum culling alone.
///
/// # Errors
/// See [`VerifyError`].
pub fn short(doc: &Document, progress: &dyn Progress) -> Result<VerifyReport, VerifyError> {
    let options =
        VerifyOptions { cameras: 4, published: false, width: 640, height: 360, ..VerifyOptions::default() };
    measure(doc, &options, false, progress)
}

fn measure(
    doc: &Document,
    options: &VerifyOptions,
    full: bool,
    progress: &dyn Progress,
) -> Result<VerifyReport, VerifyError> {
    let (scene, baked) = Baked::read(doc, false)?;
    let target = Target::new(&scene, &baked.covered(&scene));
    let rays = RayScene::new(&scene.meshes, &target.parts);
    let mut report = VerifyReport {
        objects: target.members.len(),
        triangles: target.members.iter().map(|member| u64::from(member.triangles)).sum(),
        cameras_per_group: options.cameras,
        seed: options.seed,
        width: options.width.max(1),
        height: options.height.max(1),
        ..VerifyReport::default()
    };
    if full {
        progress.stage("measuring proxies", None);
        let broken = baked.broken_proxies().map(ToString::to_string);
        match calibrate::calibrate(doc, &scene, &baked, options.seed) {
            Ok(calibration) => (report.calibration, report.broken_proxies) = (calibration, broken),
            Err(error) => report.broken_proxies = Some(error.to_string()),
        }
    }
    if target.is_empty() || options.cameras == 0 {
        return Ok(report);
    }
    let published = options.published.then(|| {
        let size = (RESOLUTION, PIXEL_LIMIT);
        PublishedBake::new(&target, &scene.meshes, &rays, size, progress)
    });
    report.published = published.as_ref().map(|bake| PublishedReport {
        nodes: bake.hierarchy.nodes.len(),
        directions: bake.directions.len(),
        sampling: bake.sampling,
        resolution: RESOLUTION,
        entries: bake.vectors.iter().map(Vec::len).sum(),
    });

    let image = CameraOptions { seed: options.seed, width: report.width, height: report.height };
    progress.stage("rendering held-out cameras", Some((CAMERA_GROUPS.len() * options.cameras) as u64));
    let surroundings = target.surroundings();
    let mut frames = Vec::new();
    for group in 0..CAMERA_GROUPS.len() {
        for index in 0..options.cameras {
            let view = camera(group, index, &surroundings, &image);
            frames.push((group, Frame::render(&target, &rays, view)));
            progress.advance(1);
        }
    }
    progress.stage("comparing methods", None);
    let slider = RuntimeSlider { baked: &baked, target: &target, culler: baked.culler(&scene)? };
    let published = published.as_ref();
    let measure =
        Measure { target: &target, frames: &frames, slider, published, recommended: baked.recommended() };
    report.groups = measure.rows(full);
    Ok(report)
}
