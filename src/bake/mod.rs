//! The bake pipeline, one module per stage.

pub mod rays;
pub mod tree;
