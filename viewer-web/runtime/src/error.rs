//! What can be wrong.

use svs_runtime::{BoundsError, DecodeError};
use thiserror::Error;

/// Why the baked visibility of a file cannot be used. The file itself is fine: draw it as if it had none.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The extension or its tables are broken.
    #[error("{0}")]
    Decode(#[from] DecodeError),
    /// A number of the extension is missing or not what it must be.
    #[error("trees/{tree}/{property} must be {expected}")]
    Number {
        /// Index of the tree.
        tree: usize,
        /// Its property.
        property: &'static str,
        /// What belongs there.
        expected: &'static str,
    },
    /// The scene has changed since it was baked.
    #[error("tree {tree} was baked from another state of the scene: run `svs build` again")]
    Stale {
        /// Index of the tree.
        tree: usize,
    },
    /// The runtime refuses the objects' boxes or triangle counts.
    #[error("the objects do not fit the baked visibility: {0}")]
    Bounds(#[from] BoundsError),
    /// Arrays of the description contradict each other.
    #[error("the description of the scene is inconsistent: {0}")]
    Description(&'static str),
}
