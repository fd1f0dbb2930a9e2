//! The bake pipeline, one module per stage.

pub mod hierarchy;
pub mod progress;
pub mod rays;
pub mod spheres;
pub mod subject;
pub mod tree;
