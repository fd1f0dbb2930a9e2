//! What can go wrong.

/// Why a scene cannot be uploaded or a picture not be taken.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// An index or a number in the scene cannot be drawn.
    #[error("{what} {index}: {problem}")]
    Data {
        /// Which list of the scene: "object", "mesh", "material", "image", "order".
        what: &'static str,
        /// Index in it.
        index: usize,
        /// What is wrong there.
        problem: &'static str,
    },
    /// The scene needs more of something than the GPU or its driver has.
    #[error("{what}: {needed} needed, this GPU allows {available}; {advice}")]
    TooLarge {
        /// What there is too much of.
        what: &'static str,
        /// How much the scene needs.
        needed: u64,
        /// The limit.
        available: u64,
        /// What the user can do.
        advice: &'static str,
    },
    /// The driver ran out of memory.
    #[error("out of GPU memory: {0}; close other programs or draw a smaller scene")]
    OutOfMemory(String),
    /// The driver refused something. A fault of this crate or of the driver.
    #[error("the GPU driver refused a command: {0}; please report this with the output of the program")]
    Driver(String),
    /// The GPU did not answer.
    #[error("the GPU does not answer: {0}")]
    Lost(String),
}

impl RenderError {
    /// Sorts a wgpu error.
    pub(crate) fn from_wgpu(error: &wgpu::Error) -> Self {
        match error {
            wgpu::Error::OutOfMemory { source } => Self::OutOfMemory(source.to_string()),
            other => Self::Driver(other.to_string()),
        }
    }
}
