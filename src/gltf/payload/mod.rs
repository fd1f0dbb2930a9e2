//! The payload: what this tool adds to a file, put in by [`attach`] and taken out, exactly, by [`strip`].
//!
//! Attaching appends one buffer view with all tables, one accessor per table, the root extension and its name in
//! `extensionsUsed`; and, for a bake with proxies, their buffer views, accessors, materials, meshes and nodes ([`Additions`]), before
//! the tables. Everything is appended, so nothing of the file is renumbered. If views are compressed, a fallback buffer without
//! bytes is appended too.
//!
//! The tables' bytes go
//! - of a GLB: to the end of the BIN chunk; into a new BIN chunk if there is no buffer at all; into a new buffer with a
//!   `data:` URI if buffer 0 is not in the BIN chunk;
//! - of a .gltf: into a new buffer, in a file `<stem of the output>.svs.bin` if any buffer is in a file, else in a
//!   `data:` URI.
//!
//! Stripping a file is exact without any record of what it was before, but for a few rare cases. Those are recorded in
//! the extension's `extras.before`:
//! - `empty`: names of root properties that were there and empty (`"extensions": {}`),
//! - `declared`: the extension was named in `extensionsUsed` although absent,
//! - `byteLength`: the buffer's `byteLength` as it stood, if it was no multiple of 4 (the payload is aligned) or not
//!   written as a plain integer,
//! - `used`, `required`: names that proxies added to `extensionsUsed` and `extensionsRequired`,
//! - `nodes`, `extras`: see [`NodeLevels`], `MSFT_lod` on nodes.

mod additions;
mod attach;
pub(crate) mod lod;
mod strip;

pub use additions::{Additions, Compression, View};
pub use attach::{attach, attach_with};
pub use lod::NodeLevels;
pub use strip::strip;

/// Name of the extension.
pub const EXTENSION: &str = "EXT_spherical_visibility";

/// Root properties that the payload appends to, in the order in which they are created.
const CONTAINERS: [&str; 8] = [
    "buffers",
    "bufferViews",
    "accessors",
    "materials",
    "meshes",
    "extensionsRequired",
    "extensionsUsed",
    "extensions",
];

/// One table of the payload: an accessor's worth of tightly packed little-endian data.
#[derive(Clone, Debug)]
pub struct Table<'a> {
    /// `count` elements without gaps.
    pub bytes: &'a [u8],
    /// glTF component type: 5121 (u8), 5123 (u16), 5125 (u32) or 5126 (f32).
    pub component_type: u32,
    /// glTF accessor type: `SCALAR`, `VEC2`, `VEC3` or `VEC4`.
    pub kind: &'static str,
    /// Number of elements, at least 1.
    pub count: usize,
    /// Smallest and largest value of each component, if they are to be written.
    pub min_max: Option<(Vec<f32>, Vec<f32>)>,
}
