//! What can be wrong with baked data.

use thiserror::Error;

/// Why an extension could not be decoded. Whatever it is, the scene itself is untouched: draw it with frustum
/// culling alone.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum DecodeError {
    /// The JSON does not have the form of the extension.
    #[cfg(feature = "json")]
    #[error("not a valid EXT_spherical_visibility object: {0}")]
    Json(#[from] serde_json::Error),
    /// Baked for another major version.
    #[error("version \"{found}\" is not supported, only 1.x is; bake again with a matching tool")]
    Version {
        /// Version text of the file.
        found: String,
    },
    /// Trees name the same tables again and again, see [`crate::sharing::first_excess`].
    #[error("trees/{tree}: the trees share tables so often that decoding them would take too much memory")]
    TablesTooLarge {
        /// Index of the first tree that is too much.
        tree: usize,
    },
    /// An entry of `meshLevels` is empty, too long, repeats a mesh, or has errors that are not finite or fall.
    #[error("meshLevels/{entry}: {problem}")]
    MeshLevels {
        /// Index of the entry.
        entry: usize,
        /// What is wrong.
        problem: &'static str,
    },
    /// One of the trees is wrong.
    #[error("trees/{tree}: {source}")]
    Tree {
        /// Index of the tree.
        tree: usize,
        /// What is wrong with it.
        source: TreeError,
    },
}

/// What is wrong with one visibility tree.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum TreeError {
    /// Neither or both of `scene` and `anchors` are there.
    #[error("exactly one of `scene` and `anchors` must be given")]
    Placement,
    /// No direction set has this name.
    #[error("unknown direction set \"{name}\"")]
    Directions {
        /// Name in the file.
        name: String,
    },
    /// Not 1, 2, 4 or 8.
    #[error("levelBits is {found}, must be 1, 2, 4 or 8")]
    LevelBits {
        /// Value in the file.
        found: u8,
    },
    /// Negative, infinite or not a number.
    #[error("importanceArea must be a finite number of square metres, not negative")]
    ImportanceArea,
    /// A table the others call for is absent.
    #[error("tables/{table} is missing")]
    TableMissing {
        /// Name of the table.
        table: &'static str,
    },
    /// A table names an accessor that is not there or cannot be read.
    #[error("tables/{table}: accessor {accessor} cannot be read")]
    Accessor {
        /// Name of the table.
        table: &'static str,
        /// Accessor index in the file.
        accessor: u32,
    },
    /// An accessor has the wrong component type or number of components, or too few or too many bytes.
    #[error("tables/{table}: accessor {accessor} has the wrong type or length of data")]
    AccessorType {
        /// Name of the table.
        table: &'static str,
        /// Accessor index in the file.
        accessor: u32,
    },
    /// A table has too few or too many elements.
    #[error("tables/{table} has {found} elements, must have {expected}")]
    TableLength {
        /// Name of the table.
        table: &'static str,
        /// Elements there are.
        found: usize,
        /// Elements there should be.
        expected: u64,
    },
    /// A subtree is empty or reaches beyond its parent's.
    #[error("node {node}: its subtree is empty or does not nest in its parent's")]
    Subtree {
        /// Index of the node.
        node: usize,
    },
    /// Objects of a node are not inside its parent's, or not in depth-first order (its own before its children's).
    #[error("node {node}: its objects are not in depth-first order inside its parent's")]
    ObjectRange {
        /// Index of the node.
        node: usize,
    },
    /// A sphere is not finite or has a negative radius.
    #[error("node {node}: its sphere is not finite or has a negative radius")]
    Sphere {
        /// Index of the node.
        node: usize,
    },
    /// Two objects of the tree are the same object.
    #[error("tables/OBJECT_ORDER: {value} appears twice")]
    Order {
        /// The value that repeats.
        value: u32,
    },
    /// An object names a row that is not there.
    #[error("object {object}: row {row} does not exist")]
    Row {
        /// Place of the object.
        object: usize,
        /// Row it names.
        row: u32,
    },
    /// An object has a level above the number of its ancestors.
    #[error("object {object}: level {level} but only {depth} ancestors")]
    Level {
        /// Place of the object.
        object: usize,
        /// Highest level in its row.
        level: u8,
        /// Ancestors it has.
        depth: u32,
    },
    /// An entry of `nested` names something that is not there, repeats an object or an anchor, or closes a cycle.
    #[error("nested/{entry}: {problem}")]
    Nested {
        /// Index of the entry.
        entry: usize,
        /// What is wrong.
        problem: &'static str,
    },
    /// Something is wrong with the proxies; nodes are proxies then.
    #[error("proxies: {0}")]
    Proxies(Box<TreeError>),
    /// A geometric error is negative, not finite or larger than the parent's.
    #[error("node {node}: its error is negative, not finite or larger than its parent's")]
    ProxyError {
        /// Index of the proxy.
        node: usize,
    },
    /// A deviation is not one: see [`crate::Deviation`].
    #[error(
        "node {node}: its deviation is negative, not finite, of a mean above the rms or an rms above the error"
    )]
    ProxyDeviation {
        /// Index of the proxy.
        node: usize,
    },
    /// An origin is not finite.
    #[error("node {node}: its origin is not finite")]
    ProxyOrigin {
        /// Index of the proxy.
        node: usize,
    },
    /// `PROXY_OBJECT` is not a permutation of the tree's objects.
    #[error("tables/PROXY_OBJECT: {value} appears twice or is no object")]
    ProxyOrder {
        /// The value.
        value: u32,
    },
    /// The quality is not between 0 and 1.
    #[error("recommended/quality must be between 0 and 1")]
    Quality,
    /// The hash is not sixteen hexadecimal digits.
    #[error("fingerprint/hash must be sixteen hexadecimal digits")]
    Fingerprint,
}
