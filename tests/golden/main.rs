//! Scenes whose visible sets are known exactly.

mod baking;
mod chain;
mod copies;
mod cubes;
mod document;
mod materials;
mod negative_zero;
mod proxies;
mod repeatable;
mod shells;
