//! The bake pipeline, one module per stage.

pub mod hierarchy;
pub mod spheres;
pub mod tree;
