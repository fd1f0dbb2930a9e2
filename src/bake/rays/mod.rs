//! Rays against a placed scene: one bounding volume hierarchy per distinct mesh, one over their instances.
//!
//! Everything here lives in a **unit frame**: tree space moved and scaled so that the scene's box has its centre
//! at the origin and a half diagonal of 1. Results therefore do not depend on where the scene is or how large it
//! is, beyond rounding; ray parameters `t` are in units of that half diagonal.

mod blas;
pub(crate) mod build;
mod scene;
mod triangle;

pub use scene::{Hit, LineHit, RayScene};
