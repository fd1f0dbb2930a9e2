//! Bakes direction-dependent visibility into glTF scenes.

pub mod bake;
pub mod scene;
pub mod validate;
