//! What can go wrong while a file is loaded bit by bit.

use crate::gltf::{AccessorError, ReadError};
use crate::stage::StageError;

/// Why a file cannot be loaded or arranged.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StreamError {
    /// The container or its JSON is broken.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// The scene cannot be drawn.
    #[error(transparent)]
    Stage(#[from] StageError),
    /// An accessor is broken.
    #[error(transparent)]
    Accessor(#[from] AccessorError),
    /// There is no room for the file.
    #[error("{bytes} bytes are too many for the memory there is")]
    Memory {
        /// Bytes of the file.
        bytes: u64,
    },
    /// Bytes came that do not belong to the file.
    #[error("bytes {start} to {end} are not in a file of {length} bytes")]
    Outside {
        /// First byte.
        start: u64,
        /// One past the last byte.
        end: u64,
        /// Bytes of the file.
        length: u64,
    },
    /// The file cannot be arranged for streaming.
    #[error("the file cannot be arranged for streaming: {problem}")]
    Arrange {
        /// Why, and what to do.
        problem: &'static str,
    },
}
