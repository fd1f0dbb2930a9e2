//! What makes a document unreadable as a scene.

use crate::gltf::AccessorError;

/// A document that cannot be read as a scene. Every variant names the place by its JSON pointer (RFC 6901).
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The scene asked for does not exist.
    #[error("there is no scene {index}: the file has {count} scene(s)")]
    NoSuchScene {
        /// Index that was asked for.
        index: usize,
        /// Scenes in the file.
        count: usize,
    },
    /// A property refers to something the file does not have.
    #[error("{pointer}: index {index} is out of range, the file has {count} of {array}")]
    IndexOutOfRange {
        /// Where the index stands.
        pointer: String,
        /// The index.
        index: usize,
        /// The top-level array it indexes.
        array: &'static str,
        /// Length of that array.
        count: usize,
    },
    /// A property has the wrong JSON type or shape.
    #[error("{pointer}: expected {expected}")]
    Malformed {
        /// Where.
        pointer: String,
        /// What glTF 2.0 asks for there.
        expected: &'static str,
    },
    /// A node is its own ancestor.
    #[error("{pointer}: node {node} is its own ancestor")]
    Cycle {
        /// Where the cycle closes.
        pointer: String,
        /// The node met again.
        node: usize,
    },
    /// A node is reached on two paths; glTF 2.0 (3.5.2) asks for a strict tree.
    #[error("{pointer}: node {node} is listed a second time, a node may have one parent only")]
    TwoParents {
        /// Where it is listed the second time.
        pointer: String,
        /// The node.
        node: usize,
    },
    /// An index buffer refers to a vertex that does not exist.
    #[error("{pointer}: vertex index {index} is out of range, the primitive has {vertices} vertices")]
    VertexIndexOutOfRange {
        /// The `indices` property.
        pointer: String,
        /// The index.
        index: u32,
        /// Vertices of the primitive.
        vertices: usize,
    },
    /// An accessor cannot be decoded.
    #[error("{pointer}: {source}")]
    Accessor {
        /// The property that names the accessor.
        pointer: String,
        /// What is wrong with it.
        #[source]
        source: AccessorError,
    },
    /// Geometry that only exists in a compressed form this reader does not decode.
    #[error("{pointer}: {}", crate::gltf::undecodable(extension))]
    Compressed {
        /// The property that needs the data.
        pointer: String,
        /// The compression extension.
        extension: &'static str,
    },
    /// Attributes that must have one entry per vertex or per instance differ in length.
    #[error("{pointer}: has {count} entries, its sibling attributes have {expected}")]
    CountMismatch {
        /// The attribute.
        pointer: String,
        /// Entries found.
        count: usize,
        /// Entries needed.
        expected: usize,
    },
    /// The file asks for far more than its own size can explain: many uses of the same data.
    #[error("{pointer}: too many {what}: more than {limit} for a file of this size")]
    TooLarge {
        /// Where the limit was passed.
        pointer: String,
        /// What there is too much of.
        what: &'static str,
        /// The limit.
        limit: u64,
    },
}
