//! Draws many-object scenes with wgpu.
#![forbid(unsafe_code)]

mod data;
mod view;

pub use data::{
    AlphaMode, Filter, Image, Material, Mesh, Object, Primitive, Sampler, SceneData, TextureRef, Wrap,
};
pub use view::View;
pub use wgpu;
