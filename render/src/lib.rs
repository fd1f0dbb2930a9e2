#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

#[cfg(feature = "gpu")]
mod batch;
#[cfg(feature = "gpu")]
mod check;
#[cfg(feature = "gpu")]
mod chunk;
#[cfg(feature = "gpu")]
mod class;
mod data;
#[cfg(feature = "gpu")]
mod error;
#[cfg(feature = "gpu")]
mod extent;
#[cfg(feature = "gpu")]
mod frame;
#[cfg(feature = "gpu")]
mod geometry;
#[cfg(feature = "gpu")]
mod gpu;
#[cfg(feature = "gpu")]
mod layout;
mod line;
#[cfg(feature = "gpu")]
mod mipmap;
#[cfg(all(feature = "gpu", not(target_arch = "wasm32")))]
mod offscreen;
#[cfg(feature = "gpu")]
mod pipeline;
#[cfg(feature = "gpu")]
mod renderer;
#[cfg(feature = "gpu")]
mod scene;
#[cfg(feature = "gpu")]
mod shader;
#[cfg(feature = "gpu")]
mod textures;
#[cfg(feature = "gpu")]
mod vertex;
mod view;

#[cfg(feature = "gpu")]
pub use batch::DrawStatistics;
pub use data::{
    AlphaMode, Filter, Image, Material, Mesh, Object, Primitive, Sampler, SceneData, TextureRef, Wrap,
};
#[cfg(feature = "gpu")]
pub use error::RenderError;
#[cfg(feature = "gpu")]
pub use frame::Frame;
#[cfg(feature = "gpu")]
pub use gpu::{Gpu, GpuError};
pub use line::Line;
#[cfg(all(feature = "gpu", not(target_arch = "wasm32")))]
pub use offscreen::{FrameTime, ItemBuffer, Offscreen};
#[cfg(feature = "gpu")]
pub use pipeline::{DEPTH_FORMAT, ITEM_FORMAT, NO_ITEM};
#[cfg(feature = "gpu")]
pub use renderer::{ItemTarget, Renderer, Target};
#[cfg(feature = "gpu")]
pub use scene::GpuScene;
pub use view::View;
#[cfg(feature = "gpu")]
pub use wgpu;
