//! Bakes direction-dependent visibility into glTF scenes.

#![forbid(unsafe_code)]

pub mod bake;
pub mod generate;
pub mod gltf;
pub mod scene;
pub mod validate;
pub mod verify;
