//! Why a camera path cannot be read or written.

use std::io;
use std::path::PathBuf;

/// A file that is no camera path, or that cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CameraPathError {
    /// The file cannot be read.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        #[source]
        source: io::Error,
    },
    /// The file cannot be written.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        #[source]
        source: io::Error,
    },
    /// The file is larger than any camera path.
    #[error("this is no camera path: it has {bytes} bytes, more than {limit}")]
    TooLarge {
        /// Bytes of the file.
        bytes: u64,
        /// Bytes accepted.
        limit: u64,
    },
    /// The text is not JSON.
    #[error("this is not JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// Something in the JSON is not as it has to be.
    #[error("{pointer}: expected {expected}")]
    Malformed {
        /// JSON pointer (RFC 6901) of the place; empty for the whole file.
        pointer: String,
        /// What has to be there.
        expected: String,
    },
}
