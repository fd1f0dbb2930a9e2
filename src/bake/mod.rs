//! The bake pipeline, one module per stage.

pub mod tree;
