//! Files opened for drawing, on the GPU: needs a Vulkan driver, software is enough (package mesa-vulkan-drivers).
#![cfg(feature = "render")]

#[path = "../../fuzz/common/mod.rs"]
mod fuzz;
mod hostile;
mod item_buffers;
