//! svs-runtime for JavaScript: the module of the npm package `@svs/runtime`.
//!
//! JavaScript reads the glTF, for it has a JSON parser already, and describes the scene in arrays of numbers ([`Description`],
//! [`Bake`]). [`Scene`] finds the objects of the visibility trees in it and answers, per camera, which of them to draw. All
//! of that is plain Rust; the bindings are in one module of their own.

#![forbid(unsafe_code)]

mod bake;
mod bindings;
mod cull;
mod describe;
mod error;
mod extras;
mod moves;
mod places;
mod scene;

pub use bake::{Accessor, Bake, MeshLevelsTable, TreeNumbers};
pub use cull::{Limit, Statistics};
pub use describe::Description;
pub use error::SceneError;
pub use extras::Extra;
pub use scene::Scene;

/// Tables are allocated when a file is opened, and nothing per frame: a small allocator is as good as the standard library's.
#[cfg(target_arch = "wasm32")]
#[global_allocator]
static ALLOCATOR: rlsf::SmallGlobalTlsf = rlsf::SmallGlobalTlsf::new();
