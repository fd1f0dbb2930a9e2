//! Reads `EXT_spherical_visibility` and answers, per camera, what to draw.

pub mod directions;
pub mod encode;
pub mod format;

pub use directions::DirectionSet;
