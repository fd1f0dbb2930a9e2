//! Draws many-object scenes with wgpu.
#![forbid(unsafe_code)]

mod batch;
mod check;
mod class;
mod data;
mod error;
mod frame;
mod geometry;
mod gpu;
mod layout;
mod mipmap;
mod offscreen;
mod pipeline;
mod renderer;
mod scene;
mod shader;
mod textures;
mod vertex;
mod view;

pub use batch::DrawStatistics;
pub use data::{AlphaMode, Filter, Image, Material, Mesh, Object, Primitive, Sampler, SceneData, TextureRef, Wrap};
pub use error::RenderError;
pub use frame::{Frame, Line};
pub use gpu::{Gpu, GpuError};
pub use offscreen::{FrameTime, ItemBuffer, NO_ITEM, Offscreen};
pub use pipeline::{DEPTH_FORMAT, ITEM_FORMAT};
pub use renderer::{ItemTarget, Renderer, Target};
pub use scene::GpuScene;
pub use view::View;
pub use wgpu;
