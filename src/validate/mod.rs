//! Checks `EXT_spherical_visibility` in a document: against its schema, and against the scene.

mod document;
mod report;
mod schema;

pub use report::{Issue, Severity, ValidationReport};

/// JSON pointer of the extension object.
const ROOT: &str = "/extensions/EXT_spherical_visibility";
