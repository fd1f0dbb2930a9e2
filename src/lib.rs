//! Bakes direction-dependent visibility into glTF scenes.

pub mod bake;
pub mod gltf;
pub mod scene;
