//! Drops what no camera can ever see: `svs build --remove-hidden`.
//!
//! A camera is either **outside**, anywhere beyond the scene's box, or **inside** at a point around which a sphere of
//! the clearance's radius holds no opaque surface. Inside points need not be connected with each other or with the
//! outside: a closed room is as good as an open one. A gap too narrow for the sphere holds no camera, and what can be
//! seen from there only is hidden.
//!
//! What is visible is found by rays, in three steps:
//! - parallel rays from all directions outside and rays in all directions from inside points ([`sample`]), in
//!   batches, until a batch finds next to nothing new or [`RAYS_PER_TRIANGLE`] are cast;
//! - from the surfaces that no ray has seen, rays outwards: one that leaves the scene, or passes a camera point before
//!   it meets an occluder, shows that the surface is visible ([`surface`]). Small and deep parts are found like this;
//! - batches again; and one more after the decision, which measures how much is missed, and puts that right.
//!
//! The doubt is always in favour of staying. What is not judged stays: objects that move, deform or may be hidden or
//! exchanged at run time, those with alpha-tested surfaces, lines or points, those smaller than the rays can tell
//! apart, and those that another scene draws too. Alpha-tested, blended, moving and exchangeable surfaces hide
//! nothing, and neither does a surface closer than [`MARGIN`]. With [`RemoveMode::Triangles`] one ring of neighbours
//! of every visible triangle stays too.
//!
//! What is dropped is dropped in the smallest way ([`apply`]): a node loses its `mesh`, a primitive gets other
//! `indices`. Nothing is renumbered. The data that nobody refers to any more leaves the buffers
//! ([`crate::gltf::release`]).
//!
//! ```no_run
//! use svs::bake::Silent;
//! use svs::gltf::Document;
//! use svs::hidden::{self, HiddenOptions};
//!
//! let mut document = Document::read("engine.glb".as_ref())?;
//! let report = hidden::remove(&mut document, &HiddenOptions::default(), &Silent)?;
//! println!("{} of {} objects removed", report.objects_removed, report.objects);
//! document.write("engine.visible.glb".as_ref())?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod apply;
mod decide;
mod options;
mod regions;
mod report;
mod sample;
mod subject;
mod surface;
mod view;

pub use options::{DEFAULT_CLEARANCE, DEFAULT_RAYS, HiddenOptions, RAYS_PER_TRIANGLE, RemoveMode};
pub use report::{HiddenReport, RemovedObject};

use crate::bake::Progress;
use crate::bake::rays::RayScene;
use crate::gltf::{Document, payload};
use crate::scene::{MaskMode, ReadOptions, SceneError, read_scene};
use regions::Regions;
use sample::Seen;
use std::time::Instant;
use subject::Subject;

/// Why nothing was removed. The document is unchanged then, except that a bake may be gone from it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum HiddenError {
    /// The scene cannot be read.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The clearance is no length.
    #[error("a clearance of {metres} m is no radius; it must be a finite number above 0")]
    Clearance {
        /// What was asked for.
        metres: f64,
    },
}

/// Removes from a document what no camera can see. A bake in it is removed first: it would be of another scene.
///
/// The result depends neither on the number of threads nor on the machine.
///
/// # Errors
/// See [`HiddenError`].
pub fn remove(
    doc: &mut Document,
    options: &HiddenOptions,
    progress: &dyn Progress,
) -> Result<HiddenReport, HiddenError> {
    if let Some(metres) = options.clearance
        && !(metres.is_finite() && metres > 0.0)
    {
        return Err(HiddenError::Clearance { metres });
    }
    let start = Instant::now();
    progress.stage("read", None);
    payload::strip(doc);
    let scene = read_scene(
        doc,
        &ReadOptions { scene: options.scene, mask: MaskMode::Transparent, ..ReadOptions::default() },
    )?;
    let subject = Subject::new(doc, &scene);
    let rays = RayScene::with_triangles(&scene.meshes, &subject.parts);
    let clearance = options.clearance.map_or(DEFAULT_CLEARANCE, |metres| metres / rays.radius());
    let regions = Regions::new(&rays, clearance);
    let seen = Seen::new(&scene, &subject, options.mode);
    let mut sampled = sample::run(&rays, &regions, &scene, &subject, &seen, options, progress);

    let decide = |seen: &Seen| decide::decide(&scene, &subject, seen, rays.radius(), options.mode);
    let mut hidden = decide(&seen);
    if hidden.is_anything() {
        sample::check(&rays, &regions, &scene, &hidden, &seen, &mut sampled, progress);
        hidden = decide(&seen);
    }
    progress.stage("remove hidden", None);
    let mut report = HiddenReport::new(doc, &scene, &hidden, options.mode, clearance * rays.radius());
    drop(rays);
    let outcome = apply::apply(doc, &scene, &hidden);
    report.finish(doc, &scene, &hidden, &outcome, &sampled);
    report.seconds = start.elapsed().as_secs_f64();
    Ok(report)
}

/// Surfaces that are closer together than this, in the scene's radii, do not hide each other: renderers cannot tell
/// which is in front either.
pub const MARGIN: f32 = 1.0 / 32_768.0;
