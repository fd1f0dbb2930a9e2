//! Why the viewer cannot run.

use super::script::ScriptError;
use std::path::PathBuf;
use svs_render::{GpuError, RenderError};

/// Why the viewer ended, or did not start.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ViewError {
    /// There is no display to open a window on.
    #[error("cannot open a window: {0}; `svs render` makes pictures without a display")]
    NoWindow(String),
    /// The window cannot be drawn on.
    #[error("cannot draw on the window: {0}")]
    Surface(String),
    /// No format of the window's surface can be used.
    #[error(
        "cannot draw on the window: {adapter} offers it no format of 8 bits per channel (it has {formats})"
    )]
    NoSurfaceFormat {
        /// Which GPU.
        adapter: String,
        /// What it has.
        formats: String,
    },
    /// There is no usable GPU.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// Drawing failed.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The script cannot be used.
    #[error(transparent)]
    Script(#[from] ScriptError),
    /// A step of a script failed.
    #[error("step {step} of the script: {message}")]
    Step {
        /// From 1.
        step: usize,
        /// What went wrong.
        message: String,
    },
    /// A screenshot or a dump cannot be written.
    #[error("cannot write {}: {message}", path.display())]
    Write {
        /// Which file.
        path: PathBuf,
        /// What went wrong.
        message: String,
    },
}
