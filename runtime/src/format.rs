//! The JSON of `EXT_spherical_visibility`, as the baker writes it and the decoder reads it (with the feature `json`).
//!
//! These types only mirror the text; nothing in them has been checked. [`crate::Visibility::decode`] does that.
//! Unknown properties are ignored.

#[cfg(feature = "json")]
use serde::{Deserialize, Serialize};

/// Name of the extension, in `extensionsUsed` and in the document's `extensions`.
pub const EXTENSION_NAME: &str = "EXT_spherical_visibility";

/// Version this crate reads and writes. The decoder accepts every `1.x`.
pub const VERSION: &str = "1.0";

/// The extension object on the document's root.
#[cfg(feature = "json")]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Extension {
    /// `major.minor` of the specification.
    pub version: String,
    /// Tool that baked it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub generator: Option<String>,
    /// One entry per visibility tree.
    pub trees: Vec<TreeJson>,
    /// Simplified versions of meshes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mesh_levels: Vec<MeshLevelsJson>,
    /// Application data.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extras: Option<serde_json::Value>,
}

/// One visibility tree.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "json", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "json", serde(rename_all = "camelCase"))]
pub struct TreeJson {
    /// glTF scene at whose root the tree is anchored: tree space is world space. Excludes `anchors`.
    #[cfg_attr(feature = "json", serde(default, skip_serializing_if = "Option::is_none"))]
    pub scene: Option<u32>,
    /// glTF nodes in whose local space the tree lives; all of them share its data. Excludes `scene`.
    #[cfg_attr(feature = "json", serde(default, skip_serializing_if = "Vec::is_empty"))]
    pub anchors: Vec<u32>,
    /// Name of the direction set, one of [`crate::directions::DIRECTION_SETS`].
    pub directions: String,
    /// Objects in the tree.
    pub object_count: u32,
    /// Bits per visible level: 1, 2, 4 or 8.
    pub level_bits: u8,
    /// Area in m² that importance code 0 stands for.
    pub importance_area: f64,
    /// Accessors of the tables.
    #[cfg_attr(feature = "json", serde(default))]
    pub tables: Tables,
    /// Meshes that stand for groups of objects.
    #[cfg_attr(feature = "json", serde(default, skip_serializing_if = "Option::is_none"))]
    pub proxies: Option<ProxiesJson>,
    /// Objects that stand for an anchor of another tree.
    #[cfg_attr(feature = "json", serde(default, skip_serializing_if = "Vec::is_empty"))]
    pub nested: Vec<NestedJson>,
    /// Settings the baker found best.
    #[cfg_attr(feature = "json", serde(default, skip_serializing_if = "Option::is_none"))]
    pub recommended: Option<RecommendedJson>,
    /// What the tree was baked from, to detect that the scene has changed since.
    #[cfg_attr(feature = "json", serde(default, skip_serializing_if = "Option::is_none"))]
    pub fingerprint: Option<FingerprintJson>,
}

/// Accessor indices by table. The node tables and [`Self::level_row`] are absent if the tree has no nodes, and
/// [`Self::importance`] if it would be empty (an accessor cannot have no elements).
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "json", derive(Serialize, Deserialize))]
pub struct Tables {
    /// VEC4 FLOAT: sphere centre x, y, z and radius per node, in metres of tree space.
    #[cfg_attr(
        feature = "json",
        serde(rename = "NODE_SPHERE", default, skip_serializing_if = "Option::is_none")
    )]
    pub node_sphere: Option<u32>,
    /// SCALAR unsigned integer: nodes in the subtree, the node itself included.
    #[cfg_attr(
        feature = "json",
        serde(rename = "NODE_SUBTREE", default, skip_serializing_if = "Option::is_none")
    )]
    pub node_subtree: Option<u32>,
    /// SCALAR unsigned integer: first object (place in tree order) below the node.
    #[cfg_attr(
        feature = "json",
        serde(rename = "NODE_FIRST_OBJECT", default, skip_serializing_if = "Option::is_none")
    )]
    pub node_first_object: Option<u32>,
    /// SCALAR unsigned integer: objects below the node, contiguous in tree order.
    #[cfg_attr(
        feature = "json",
        serde(rename = "NODE_OBJECT_COUNT", default, skip_serializing_if = "Option::is_none")
    )]
    pub node_object_count: Option<u32>,
    /// SCALAR unsigned integer: for each place in tree order, the index of the object among the mesh-bearing
    /// nodes and instances below the anchor in depth-first document order. Absent: the same order.
    #[cfg_attr(
        feature = "json",
        serde(rename = "OBJECT_ORDER", default, skip_serializing_if = "Option::is_none")
    )]
    pub object_order: Option<u32>,
    /// SCALAR unsigned byte: distinct rows of packed visible levels, see [`crate::encode::pack_levels`].
    #[cfg_attr(
        feature = "json",
        serde(rename = "LEVEL_ROW", default, skip_serializing_if = "Option::is_none")
    )]
    pub level_row: Option<u32>,
    /// SCALAR unsigned integer: row of each object. Absent: row `k` belongs to object `k`.
    #[cfg_attr(
        feature = "json",
        serde(rename = "LEVEL_ROW_INDEX", default, skip_serializing_if = "Option::is_none")
    )]
    pub level_row_index: Option<u32>,
    /// SCALAR unsigned byte: for each object in tree order one code per height, from 1 to the highest level in
    /// its row, see [`crate::encode::importance_code`].
    #[cfg_attr(
        feature = "json",
        serde(rename = "IMPORTANCE", default, skip_serializing_if = "Option::is_none")
    )]
    pub importance: Option<u32>,
}

impl TreeJson {
    /// The accessors of all tables of the tree, those of its proxies included.
    pub fn accessors(&self) -> impl Iterator<Item = u32> + '_ {
        self.tables.accessors().chain(self.proxies.iter().flat_map(|proxies| proxies.tables.accessors()))
    }
}

impl Tables {
    /// The accessors of all tables there are.
    pub fn accessors(&self) -> impl Iterator<Item = u32> + '_ {
        let all = [
            self.node_sphere,
            self.node_subtree,
            self.node_first_object,
            self.node_object_count,
            self.object_order,
            self.level_row,
            self.level_row_index,
            self.importance,
        ];
        all.into_iter().flatten()
    }
}

/// Simplified versions of one glTF mesh, for any object that has it.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "json", derive(Serialize, Deserialize))]
pub struct MeshLevelsJson {
    /// glTF mesh of the originals.
    pub mesh: u32,
    /// Coarser and coarser.
    pub levels: Vec<MeshLevelJson>,
}

/// One simplified version of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "json", derive(Serialize, Deserialize))]
pub struct MeshLevelJson {
    /// glTF mesh that no node of a scene names.
    pub mesh: u32,
    /// Geometric error, metres of mesh space.
    pub error: f64,
    /// Mean and root mean square of the distance, metres of mesh space, and the share that looks wrong. Absent: the error
    /// everywhere, and nothing wrong.
    #[cfg_attr(feature = "json", serde(default, skip_serializing_if = "Option::is_none"))]
    pub deviation: Option<[f64; 3]>,
}

/// The proxies of a tree.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "json", derive(Serialize, Deserialize))]
pub struct ProxiesJson {
    /// Proxies hold only what is visible from outside of their spheres.
    pub visible: bool,
    /// Accessors of the tables.
    pub tables: ProxyTables,
}

/// Accessor indices of the tables of proxies. All are required but [`Self::object`] and
/// [`Self::deviation`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "json", derive(Serialize, Deserialize))]
pub struct ProxyTables {
    /// VEC4 FLOAT: sphere centre x, y, z and radius per proxy, in metres of tree space.
    #[cfg_attr(feature = "json", serde(rename = "PROXY_SPHERE"))]
    pub sphere: u32,
    /// SCALAR unsigned integer: proxies in the subtree, itself included.
    #[cfg_attr(feature = "json", serde(rename = "PROXY_SUBTREE"))]
    pub subtree: u32,
    /// SCALAR unsigned integer: first object, in proxy order, that it stands for.
    #[cfg_attr(feature = "json", serde(rename = "PROXY_FIRST_OBJECT"))]
    pub first_object: u32,
    /// SCALAR unsigned integer: objects it stands for, contiguous in proxy order.
    #[cfg_attr(feature = "json", serde(rename = "PROXY_OBJECT_COUNT"))]
    pub object_count: u32,
    /// SCALAR unsigned integer: for each place in proxy order the place in tree order. Absent: the same order.
    #[cfg_attr(
        feature = "json",
        serde(rename = "PROXY_OBJECT", default, skip_serializing_if = "Option::is_none")
    )]
    pub object: Option<u32>,
    /// SCALAR FLOAT: geometric error, metres of tree space.
    #[cfg_attr(feature = "json", serde(rename = "PROXY_ERROR"))]
    pub error: u32,
    /// VEC3 FLOAT: mean and root mean square of the distance, metres of tree space, and the share that looks wrong. Absent:
    /// the error everywhere, and nothing wrong.
    #[cfg_attr(
        feature = "json",
        serde(rename = "PROXY_DEVIATION", default, skip_serializing_if = "Option::is_none")
    )]
    pub deviation: Option<u32>,
    /// SCALAR unsigned integer: glTF mesh.
    #[cfg_attr(feature = "json", serde(rename = "PROXY_MESH"))]
    pub mesh: u32,
    /// VEC3 FLOAT: added to the mesh's positions, metres of tree space.
    #[cfg_attr(feature = "json", serde(rename = "PROXY_ORIGIN"))]
    pub origin: u32,
}

impl ProxyTables {
    /// The accessors of all tables there are.
    pub fn accessors(&self) -> impl Iterator<Item = u32> + '_ {
        let all = [self.sphere, self.subtree, self.first_object, self.object_count];
        let rest = [self.error, self.mesh, self.origin];
        all.into_iter().chain(self.object).chain(rest).chain(self.deviation)
    }
}

/// An object of this tree that stands for a whole other tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "json", derive(Serialize, Deserialize))]
pub struct NestedJson {
    /// Place in this tree's order.
    pub object: u32,
    /// Index of the other tree.
    pub tree: u32,
    /// Index into the other tree's anchors.
    pub anchor: u32,
}

/// Settings the baker found best for a tree.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "json", derive(Serialize, Deserialize))]
pub struct RecommendedJson {
    /// Quality, 0 to 1, see [`crate::Settings::from_quality`].
    pub quality: f64,
}

/// What a tree was baked from.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "json", derive(Serialize, Deserialize))]
pub struct FingerprintJson {
    /// Sum of the objects' triangle counts.
    pub triangles: u64,
    /// Sixteen hexadecimal digits of [`crate::encode::fingerprint`].
    pub hash: String,
}
