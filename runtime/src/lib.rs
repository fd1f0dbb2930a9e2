#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod bounds;
mod camera;
mod cull;
mod decode;
pub mod directions;
pub mod encode;
mod error;
pub mod format;
mod query;
mod scene;
pub mod sharing;
mod tables;
mod traverse;
mod tree;

pub use bounds::{Bounds, BoundsError};
pub use camera::Camera;
pub use cull::Culler;
pub use decode::{AccessorSource, AccessorView, Visibility};
pub use directions::DirectionSet;
pub use error::{DecodeError, TreeError};
pub use query::{DEFAULT_QUALITY, Query, Settings, Tau};
pub use scene::{Draw, SceneCuller};
pub use tables::TreeTables;
pub use traverse::CullStatistics;
pub use tree::{Fingerprint, Nested, Node, Placement, Tree};
