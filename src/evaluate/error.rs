//! Why a scene could not be evaluated.

use super::metrics::SizeMismatch;
use super::options::OptionError;
use crate::stage::StageError;
use svs_render::{GpuError, RenderError};

/// Why a scene could not be evaluated.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EvaluateError {
    /// The options make no sense.
    #[error(transparent)]
    Options(#[from] OptionError),
    /// The scene cannot be drawn.
    #[error(transparent)]
    Stage(#[from] StageError),
    /// There is no GPU, not even a software one.
    #[error(transparent)]
    Gpu(#[from] GpuError),
    /// The GPU cannot draw the scene.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The renderer gave pictures of different sizes.
    #[error(transparent)]
    Size(#[from] SizeMismatch),
}
