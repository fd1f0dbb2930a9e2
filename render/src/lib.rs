#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod batch;
mod check;
mod chunk;
mod class;
mod data;
mod error;
mod extent;
mod frame;
mod geometry;
mod gpu;
mod layout;
mod mipmap;
#[cfg(not(target_arch = "wasm32"))]
mod offscreen;
mod pipeline;
mod renderer;
mod scene;
mod shader;
mod textures;
mod vertex;
mod view;

pub use batch::DrawStatistics;
pub use data::{
    AlphaMode, Filter, Image, Material, Mesh, Object, Primitive, Sampler, SceneData, TextureRef, Wrap,
};
pub use error::RenderError;
pub use frame::{Frame, Line};
pub use gpu::{Gpu, GpuError};
#[cfg(not(target_arch = "wasm32"))]
pub use offscreen::{FrameTime, ItemBuffer, Offscreen};
pub use pipeline::{DEPTH_FORMAT, ITEM_FORMAT, NO_ITEM};
pub use renderer::{ItemTarget, Renderer, Target};
pub use scene::GpuScene;
pub use view::View;
pub use wgpu;
