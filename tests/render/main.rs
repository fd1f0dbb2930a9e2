//! Files opened for drawing, on the GPU: needs a Vulkan driver, software is enough (package mesa-vulkan-drivers).
#![cfg(feature = "render")]

#[path = "../../fuzz/common/mod.rs"]
mod fuzz;
#[path = "../common/handmade.rs"]
mod handmade;
mod hostile;
mod item_buffers;
mod proxies;
