#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

mod bounds;
mod budget;
mod camera;
mod cost;
mod cull;
mod decode;
pub mod directions;
pub mod encode;
mod error;
mod estimate;
mod explain;
pub mod format;
mod loose;
mod query;
mod scene;
mod select;
pub mod sharing;
mod tables;
mod traverse;
mod tree;
mod within;

pub use bounds::{Bounds, BoundsError};
pub use budget::{Budget, Selection};
pub use camera::Camera;
pub use cost::CostModel;
pub use cull::Culler;
pub use decode::{AccessorSource, AccessorView, Visibility};
pub use directions::DirectionSet;
pub use error::{DecodeError, TreeError};
pub use explain::{Reason, SphereInUse};
pub use query::{DEFAULT_QUALITY, Query, Settings, Tau};
pub use scene::{Draw, LOOSE, SceneCuller};
pub use tables::TreeTables;
pub use traverse::CullStatistics;
pub use tree::{Fingerprint, Nested, Node, Placement, Tree};
