//! What culling gains on camera paths, and what it costs in the picture: frame by frame, method by method, measured in one
//! run with one renderer.
//!
//! ```no_run
//! use svs::bake::Silent;
//! use svs::evaluate::{EvaluateOptions, evaluate};
//! use svs::gltf::Document;
//!
//! let document = Document::read("plant.svs.glb".as_ref())?;
//! let evaluation = evaluate(&document, "plant", &EvaluateOptions::default(), &Silent)?;
//! for method in &evaluation.methods {
//!     println!("{}: {} ms, worst SSIM {}", method.method, method.frame_ms.median, method.ssim.worst);
//! }
//! evaluation.write("report".as_ref())?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! - Cameras go along the paths in fixed steps, so that every method, machine and day sees the same frames.
//! - The **reference** is the picture with frustum culling, and its item buffer: which object each pixel shows. Pictures may
//!   be compared with those of another method instead.
//! - **Pictures** are compared untimed: structural similarity over an image pyramid, signal-to-noise ratios of brightness
//!   and colour, missing objects and their pixels, objects drawn for nothing.
//! - **Times** are taken offscreen, where nothing waits for a display, in several passes. Within a pass the methods take
//!   turns frame by frame, so that a machine that gets slower gets slower for all of them. The time of a frame is the
//!   median over the passes; nothing is smoothed or left out after that.
//!
//! The flaws this avoids are those of Thann's bachelor thesis (TU Wien 2019): times locked to the display's refresh, means
//! that mix phases, outliers removed, no measure of the picture, no word on the machine.

mod bench;
mod error;
mod figures;
mod flight;
mod machine;
mod method;
pub mod metrics;
mod options;
mod quality;
mod report;
mod result;
mod run;
mod timing;

pub use error::EvaluateError;
pub use figures::{Figures, Likeness};
pub use machine::Machine;
pub use method::EvaluationMethod;
pub use options::{EvaluateOptions, FrameBudget, OptionError, Tour};
pub use report::{REPORT_FILES, ReportError};
pub use result::{
    CostReport, Evaluation, FrameResult, MethodSummary, MissingObject, PathEvaluation, QualityResult,
    Settings, Simplified, TimeResult, TimeSource, WorstFrame,
};
pub use run::evaluate;
