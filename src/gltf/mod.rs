//! The lossless glTF 2.0 container layer.
//!
//! The JSON stays a [`serde_json::Value`] that is patched, never rebuilt from types: unknown extensions, extras,
//! unused objects, key order and the text of numbers survive. Buffers stay bytes. What this tool adds to a file is
//! put in by [`payload::attach`] and taken out again, exactly, by [`payload::strip`].
//!
//! What does *not* survive: white space of the JSON beyond its indentation, escapes that JSON does not need, the
//! spelling of exponents (`1E5` becomes `1e+5`), the 0 to 3 padding bytes of GLB chunks, and bytes after the length
//! that a GLB's header declares.
//!
//! Every input is hostile: lengths are checked before anything is allocated, offsets before anything is read, and
//! URIs may not leave the folder of the file that names them.

mod accessor;
mod buffers;
pub(crate) mod compressed;
#[cfg(feature = "bake")]
mod convert;
mod decode;
mod document;
mod error;
mod glb;
pub(crate) mod json;
mod kinds;
#[cfg(feature = "bake")]
mod meshopt;
#[cfg(feature = "bake")]
pub mod payload;
#[cfg(feature = "bake")]
mod release;
#[cfg(feature = "bake")]
mod resources;
mod style;
mod tables;
mod uri;
#[cfg(feature = "bake")]
mod write;

#[cfg(all(test, feature = "bake"))]
mod property_tests;
#[cfg(all(test, feature = "bake"))]
mod scene_tests;
#[cfg(all(test, feature = "bake"))]
mod write_tests;

pub use accessor::Accessor;
pub use buffers::BufferStorage;
pub use document::{Container, Document};
pub(crate) use error::undecodable;
pub use error::{AccessorError, AttachError, ReadError, UriError, WriteError};
pub use kinds::{AccessorKind, ComponentType};
#[cfg(feature = "bake")]
pub use release::{Released, append_indices, release};
pub use tables::{DocumentTables, TableError};
#[cfg(feature = "bake")]
pub use write::WriteSummary;
