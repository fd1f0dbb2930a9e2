//! What can go wrong with a container: each error says what, where (JSON pointer or byte offset) and what to do.

use std::path::PathBuf;
use thiserror::Error;

/// Why a file could not be read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file system refused.
    #[error("cannot read {}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the file system said.
        source: std::io::Error,
    },
    /// Neither GLB nor glTF JSON.
    #[error("this is not a glTF file: {found}; export the scene as glTF 2.0 (.glb or .gltf) first")]
    NotGltf {
        /// What was found instead.
        found: String,
    },
    /// A glTF file of another major version.
    #[error("glTF version {version} is not supported, only 2.x is; convert the file to glTF 2.0 first")]
    Version {
        /// Version as written in the file.
        version: String,
    },
    /// The binary container contradicts itself.
    #[error(
        "broken GLB at byte {offset}: {problem}; the file is probably truncated, fetch or export it again"
    )]
    Glb {
        /// Byte offset from the start of the file.
        offset: usize,
        /// What is wrong there.
        problem: String,
    },
    /// The JSON text cannot be parsed (syntax, not UTF-8, or nested deeper than 127 levels).
    #[error("the glTF JSON cannot be parsed: {source}")]
    Json {
        /// Position and reason.
        #[from]
        source: serde_json::Error,
    },
    /// A property has the wrong type or value.
    #[error("{pointer}: expected {expected}; repair or export the file again")]
    Malformed {
        /// JSON pointer of the property.
        pointer: String,
        /// What belongs there.
        expected: &'static str,
    },
    /// A buffer's source has fewer bytes than its `byteLength`.
    #[error(
        "{pointer}: byteLength is {needed} but only {available} bytes are there; the data is probably truncated"
    )]
    BufferTooShort {
        /// JSON pointer of the buffer.
        pointer: String,
        /// Bytes declared.
        needed: u64,
        /// Bytes there.
        available: u64,
    },
    /// Many buffers name one file, and together they would take far more memory than the file has bytes.
    #[error(
        "{pointer}: the same file is loaded again and again by several buffers; merge those buffers first"
    )]
    RepeatedBuffer {
        /// JSON pointer of the buffer that went too far.
        pointer: String,
    },
    /// A URI cannot be followed.
    #[error("{pointer}: {problem}")]
    Uri {
        /// JSON pointer of the URI.
        pointer: String,
        /// Why.
        problem: UriError,
    },
}

/// Why a URI cannot be followed.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum UriError {
    /// `http:`, `file:` and the like.
    #[error("{uri:?} is not a relative path; download the file beside the scene and name it relatively")]
    Remote {
        /// The URI, shortened.
        uri: String,
    },
    /// An absolute path, or one that climbs out of the folder.
    #[error("{uri:?} lies outside the scene's folder, which is not allowed; move the file beside the scene")]
    Outside {
        /// The URI, shortened.
        uri: String,
    },
    /// Percent escapes that do not give UTF-8, or an empty URI.
    #[error("{uri:?} is not a valid relative URI")]
    Invalid {
        /// The URI, shortened.
        uri: String,
    },
    /// A `data:` URI that cannot be decoded.
    #[error("the data URI cannot be decoded: {problem}")]
    Data {
        /// What is wrong.
        problem: String,
    },
    /// A relative URI, but the document came from memory and has no folder.
    #[error("{uri:?} is relative, but the document was not read from a folder; read it with its path")]
    NoFolder {
        /// The URI, shortened.
        uri: String,
    },
    /// The file holds more bytes than the caller accepts.
    #[error("{uri:?} holds {bytes} bytes, more than the {limit} that are accepted")]
    TooLarge {
        /// The URI, shortened.
        uri: String,
        /// Bytes there.
        bytes: u64,
        /// Bytes accepted.
        limit: u64,
    },
}

/// Why a document could not be written. The target is then as it was before.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The file system refused.
    #[error("cannot write {}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the file system said.
        source: std::io::Error,
    },
    /// A GLB counts its bytes in 32 bits.
    #[error(
        "the GLB would take {bytes} bytes, more than the format's 4 GiB; write a .gltf with a .bin instead"
    )]
    TooLarge {
        /// Bytes needed.
        bytes: u64,
    },
    /// The JSON value cannot be written.
    #[error("the glTF JSON cannot be written: {source}")]
    Json {
        /// Reason.
        #[from]
        source: serde_json::Error,
    },
    /// The output would replace a file that the document itself refers to.
    #[error("{} is used by the scene itself ({uri:?}); choose another output name", path.display())]
    OwnResource {
        /// The output path.
        path: PathBuf,
        /// The URI that names the same file.
        uri: String,
    },
    /// The document's JSON and buffers contradict each other; only code that edits [`super::Document`] can cause it.
    #[error("{pointer}: {problem}")]
    Inconsistent {
        /// JSON pointer of the place.
        pointer: String,
        /// What is wrong there.
        problem: String,
    },
}

/// Why an accessor cannot be read.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum AccessorError {
    /// An index names nothing.
    #[error("{pointer}: there is no such object")]
    Missing {
        /// JSON pointer of what is missing.
        pointer: String,
    },
    /// A property has the wrong type or value.
    #[error("{pointer}: expected {expected}")]
    Malformed {
        /// JSON pointer of the property.
        pointer: String,
        /// What belongs there.
        expected: &'static str,
    },
    /// Data would be read beyond its end.
    #[error("{pointer}: needs {needed} bytes but only {available} are there")]
    OutOfBounds {
        /// JSON pointer of the accessor or buffer view.
        pointer: String,
        /// Bytes needed.
        needed: u64,
        /// Bytes there.
        available: u64,
    },
    /// The buffer exists, but the file has no bytes for it.
    #[error("{pointer}: the buffer has no data (the file may be compressed, or made for another loader)")]
    NoData {
        /// JSON pointer of the buffer.
        pointer: String,
    },
    /// The only copy of the data is compressed, and this build has no decoder.
    #[error("{pointer}: {}", undecodable(extension))]
    Compressed {
        /// JSON pointer of the buffer view.
        pointer: String,
        /// The compression extension.
        extension: &'static str,
    },
    /// Compressed data are broken, or would be larger than is plausible.
    #[error("{pointer}: with {extension}: {problem}")]
    Stream {
        /// JSON pointer of the buffer view.
        pointer: String,
        /// The compression extension.
        extension: &'static str,
        /// What is wrong.
        problem: String,
    },
    /// More all-zero elements than is plausible for the size of the file.
    #[error("{pointer}: {count} elements without a buffer view, more than the file's size makes plausible")]
    TooManyZeros {
        /// JSON pointer of the accessor.
        pointer: String,
        /// Elements declared.
        count: usize,
    },
    /// The accessor is sound, but not of the kind that was asked for.
    #[error("{pointer}: is {found}, expected {expected}")]
    WrongKind {
        /// JSON pointer of the accessor.
        pointer: String,
        /// Kind and component type found.
        found: String,
        /// Kind asked for.
        expected: &'static str,
    },
}

/// What to do about data that cannot be decompressed here.
pub(crate) fn undecodable(extension: &str) -> String {
    let remedy = if extension.ends_with("meshopt_compression") {
        " (or build its proxies with `--proxy-format quantized`)"
    } else {
        ""
    };
    format!(
        "the geometry is compressed with {extension}, which cannot be decoded here; decompress the file first, for example \
         with `gltf-transform copy in.glb out.glb`{remedy}"
    )
}

/// Why the payload could not be attached. The document is then as it was before.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[non_exhaustive]
pub enum AttachError {
    /// The document already has the extension: call [`super::payload::strip`] first.
    #[error("/extensions/EXT_spherical_visibility: the file already has a bake; strip it first")]
    AlreadyAttached,
    /// A property has the wrong type.
    #[error("{pointer}: expected {expected}")]
    Malformed {
        /// JSON pointer of the property.
        pointer: String,
        /// What belongs there.
        expected: &'static str,
    },
    /// A table's bytes, count and types do not fit together.
    #[error("table {table}: {problem}")]
    Table {
        /// Index of the table.
        table: usize,
        /// What is wrong.
        problem: String,
    },
}
