//! From the extension's JSON and the accessors' bytes to checked trees.

use crate::deviation::Deviation;
use crate::encode::parse_hash;
use crate::error::{DecodeError, TreeError};
#[cfg(feature = "json")]
use crate::format::Extension;
use crate::format::{MeshLevelsJson, ProxiesJson, TreeJson};
use crate::mesh_levels::{self, MeshLevels};
use crate::proxies::ProxyTables;
use crate::sharing::first_excess;
use crate::tables::TreeTables;
use crate::tree::{Fingerprint, Nested, Placement, Tree};
#[cfg(feature = "json")]
use serde::Deserialize;
use std::sync::Arc;

/// Where the bytes of accessors come from: the loader's glTF library.
pub trait AccessorSource {
    /// The elements of accessor `index`, or `None` if there is none or it cannot be read.
    fn accessor(&self, index: usize) -> Option<AccessorView<'_>>;
}

/// The elements of one accessor.
#[derive(Clone, Copy, Debug)]
pub struct AccessorView<'a> {
    /// Little-endian elements, tightly packed (sparse values and strides resolved).
    pub bytes: &'a [u8],
    /// glTF component type: 5121 unsigned byte, 5123 unsigned short, 5125 unsigned int, 5126 float.
    pub component_type: u32,
    /// Components per element: 1 for SCALAR, 4 for VEC4.
    pub components: u32,
    /// Number of elements.
    pub count: usize,
}

/// All visibility trees of a document.
#[derive(Clone, Debug)]
pub struct Visibility {
    trees: Vec<Arc<Tree>>,
    mesh_levels: Vec<MeshLevels>,
}

impl Visibility {
    /// Decodes `extensions.EXT_spherical_visibility` of a document's root.
    ///
    /// # Errors
    /// Anything that is not as the specification says, and trees that together need far more memory than the file has, see
    /// [`crate::sharing::first_excess`]. Draw the scene with frustum culling alone then.
    #[cfg(feature = "json")]
    pub fn decode(extension: &serde_json::Value, source: &dyn AccessorSource) -> Result<Self, DecodeError> {
        let extension = Extension::deserialize(extension)?;
        Self::from_extension(extension, source)
    }

    /// [`Self::decode`] from JSON text.
    ///
    /// # Errors
    /// As [`Self::decode`], and for text that is not JSON.
    #[cfg(feature = "json")]
    pub fn decode_json(extension: &str, source: &dyn AccessorSource) -> Result<Self, DecodeError> {
        Self::from_extension(serde_json::from_str(extension)?, source)
    }

    #[cfg(feature = "json")]
    fn from_extension(extension: Extension, source: &dyn AccessorSource) -> Result<Self, DecodeError> {
        Self::from_parsed(&extension.version, extension.trees, &extension.mesh_levels, source)
    }

    /// [`Self::decode`] of JSON that another parser has read: the extension's `version`, `trees` and `meshLevels`.
    ///
    /// # Errors
    /// As [`Self::decode`].
    pub fn from_parsed(
        version: &str,
        trees: Vec<TreeJson>,
        mesh_levels: &[MeshLevelsJson],
        source: &dyn AccessorSource,
    ) -> Result<Self, DecodeError> {
        if version != "1" && !version.starts_with("1.") {
            return Err(DecodeError::Version { found: version.to_owned() });
        }
        let (mut named, mut views) = (Vec::new(), Vec::new());
        for (tree, json) in trees.iter().enumerate() {
            json.accessors().for_each(|index| {
                // Accessors that cannot be read are reported by the tree that needs them.
                if let Some(view) = source.accessor(index as usize) {
                    named.push(tree);
                    views.push(view);
                }
            });
        }
        if let Some(excess) = first_excess(views) {
            return Err(DecodeError::TablesTooLarge { tree: named[excess] });
        }
        let mut decoded = Vec::with_capacity(trees.len());
        for (tree, json) in trees.into_iter().enumerate() {
            let checked = read_tables(json, source).and_then(Tree::new);
            decoded.push(checked.map_err(|source| DecodeError::Tree { tree, source })?);
        }
        let mut visibility = Self::new(decoded)?;
        visibility.mesh_levels = mesh_levels::read(mesh_levels)?;
        Ok(visibility)
    }

    /// Puts trees together and checks that their `nested` entries fit.
    ///
    /// # Errors
    /// [`TreeError::Nested`] if an entry names a tree or an anchor that does not exist, if two name the same anchor,
    /// or if trees contain each other.
    pub fn new(trees: Vec<Tree>) -> Result<Self, DecodeError> {
        check_nested(&trees)?;
        Ok(Self { trees: trees.into_iter().map(Arc::new).collect(), mesh_levels: Vec::new() })
    }

    /// The trees, in the order of the file.
    pub fn trees(&self) -> &[Arc<Tree>] {
        &self.trees
    }

    /// Simplified versions of meshes, in the order of the file; each mesh appears once.
    pub fn mesh_levels(&self) -> &[MeshLevels] {
        &self.mesh_levels
    }
}

/// Every nested anchor exists and hangs on one object only, and no tree contains itself.
fn check_nested(trees: &[Tree]) -> Result<(), DecodeError> {
    let problem =
        |tree, entry, problem| Err(DecodeError::Tree { tree, source: TreeError::Nested { entry, problem } });
    let mut taken: Vec<Vec<bool>> = trees.iter().map(|tree| vec![false; tree.placement.count()]).collect();
    for (host, tree) in trees.iter().enumerate() {
        for (entry, nested) in tree.nested.iter().enumerate() {
            let Some(guest) = trees.get(nested.tree as usize) else {
                return problem(host, entry, "there is no such tree");
            };
            if matches!(guest.placement, Placement::Scene(_)) {
                return problem(host, entry, "that tree has no anchors");
            }
            for anchor in 0..tree.placement.count() {
                match taken[nested.tree as usize].get_mut(tree.nested_anchor(nested, anchor)) {
                    None => return problem(host, entry, "there is no such anchor"),
                    Some(true) => return problem(host, entry, "the anchor hangs on another object already"),
                    Some(free) => *free = true,
                }
            }
        }
    }
    // Kahn's algorithm: take away trees that no remaining tree contains; a cycle is what stays.
    let mut hosts = vec![0_usize; trees.len()];
    trees.iter().flat_map(|t| &t.nested).for_each(|n| hosts[n.tree as usize] += 1);
    let mut free: Vec<usize> = (0..trees.len()).filter(|&t| hosts[t] == 0).collect();
    while let Some(tree) = free.pop() {
        for nested in &trees[tree].nested {
            hosts[nested.tree as usize] -= 1;
            if hosts[nested.tree as usize] == 0 {
                free.push(nested.tree as usize);
            }
        }
    }
    for (host, tree) in trees.iter().enumerate() {
        if let Some(entry) = tree.nested.iter().position(|n| hosts[n.tree as usize] > 0)
            && hosts[host] > 0
        {
            return problem(host, entry, "the trees contain each other");
        }
    }
    Ok(())
}

fn read_tables(json: TreeJson, source: &dyn AccessorSource) -> Result<TreeTables, TreeError> {
    let placement = match (json.scene, json.anchors) {
        (Some(scene), anchors) if anchors.is_empty() => Placement::Scene(scene),
        (None, anchors) if !anchors.is_empty() => Placement::Anchors(anchors),
        _ => return Err(TreeError::Placement),
    };
    let fingerprint = match json.fingerprint {
        Some(f) => Some(Fingerprint {
            triangles: f.triangles,
            hash: parse_hash(&f.hash).ok_or(TreeError::Fingerprint)?,
        }),
        None => None,
    };
    let mut reader = Reader { source, error: None };
    let tables = &json.tables;
    let node_sphere = reader.floats("NODE_SPHERE", tables.node_sphere);
    let has_nodes = !node_sphere.is_empty();
    let mut node_table = |table, accessor: Option<u32>| {
        if accessor.is_none() && has_nodes {
            reader.fail(TreeError::TableMissing { table });
        }
        reader.integers(table, accessor)
    };
    let result = TreeTables {
        placement,
        directions: json.directions,
        object_count: json.object_count,
        node_subtree: node_table("NODE_SUBTREE", tables.node_subtree),
        node_first_object: node_table("NODE_FIRST_OBJECT", tables.node_first_object),
        node_object_count: node_table("NODE_OBJECT_COUNT", tables.node_object_count),
        node_sphere,
        object_order: reader.optional_integers("OBJECT_ORDER", tables.object_order),
        level_bits: json.level_bits,
        level_row: {
            if tables.level_row.is_none() && has_nodes {
                reader.fail(TreeError::TableMissing { table: "LEVEL_ROW" });
            }
            reader.bytes("LEVEL_ROW", tables.level_row)
        },
        level_row_index: reader.optional_integers("LEVEL_ROW_INDEX", tables.level_row_index),
        importance_area: json.importance_area,
        importance: reader.bytes("IMPORTANCE", tables.importance),
        proxies: json.proxies.as_ref().map(|proxies| read_proxies(proxies, &mut reader)),
        nested: json
            .nested
            .iter()
            .map(|n| Nested { object: n.object, tree: n.tree, anchor: n.anchor })
            .collect(),
        recommended_quality: json.recommended.map(|r| r.quality as f32),
        fingerprint,
    };
    reader.error.map_or(Ok(result), Err)
}

fn read_proxies(json: &ProxiesJson, reader: &mut Reader<'_>) -> ProxyTables {
    let tables = &json.tables;
    ProxyTables {
        visible: json.visible,
        sphere: reader.floats("PROXY_SPHERE", Some(tables.sphere)),
        subtree: reader.integers("PROXY_SUBTREE", Some(tables.subtree)),
        first_object: reader.integers("PROXY_FIRST_OBJECT", Some(tables.first_object)),
        object_count: reader.integers("PROXY_OBJECT_COUNT", Some(tables.object_count)),
        object: reader.optional_integers("PROXY_OBJECT", tables.object),
        error: reader.floats::<1>("PROXY_ERROR", Some(tables.error)).into_iter().flatten().collect(),
        deviation: tables.deviation.map(|index| {
            let rows = reader.floats("PROXY_DEVIATION", Some(index));
            rows.into_iter().map(|[mean, rms, wrong]| Deviation { mean, rms, wrong }).collect()
        }),
        mesh: reader.integers("PROXY_MESH", Some(tables.mesh)),
        origin: reader.floats("PROXY_ORIGIN", Some(tables.origin)),
    }
}

/// Reads tables; allocates only what the accessors' bytes hold. What cannot be read comes out empty, and the first error is
/// kept: leaving at each of them would cost 3 kB of WebAssembly, for all that is then to be freed.
struct Reader<'a> {
    source: &'a dyn AccessorSource,
    error: Option<TreeError>,
}

const UNSIGNED_BYTE: u32 = 5121;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;

impl<'a> Reader<'a> {
    fn fail(&mut self, error: TreeError) {
        self.error.get_or_insert(error);
    }

    /// The bytes of a table whose elements are of these types, and how many bytes one number has. No bytes if there is no
    /// accessor.
    fn view(
        &mut self,
        table: &'static str,
        accessor: Option<u32>,
        types: &[u32],
        components: u32,
    ) -> (&'a [u8], usize) {
        const NOTHING: (&[u8], usize) = (&[], 1);
        let Some(accessor) = accessor else { return NOTHING };
        let Some(view) = self.source.accessor(accessor as usize) else {
            self.fail(TreeError::Accessor { table, accessor });
            return NOTHING;
        };
        let size = match view.component_type {
            UNSIGNED_BYTE => 1,
            UNSIGNED_SHORT => 2,
            _ => 4,
        };
        let length = view.count.checked_mul(size * components as usize);
        let fits = view.components == components && length == Some(view.bytes.len());
        if fits && types.contains(&view.component_type) {
            return (view.bytes, size);
        }
        self.fail(TreeError::AccessorType { table, accessor });
        NOTHING
    }

    fn floats<const N: usize>(&mut self, table: &'static str, accessor: Option<u32>) -> Vec<[f32; N]> {
        let (bytes, _) = self.view(table, accessor, &[FLOAT], N as u32);
        let (floats, _) = bytes.as_chunks::<4>();
        let element = |e: &[[u8; 4]; N]| e.map(f32::from_le_bytes);
        floats.as_chunks::<N>().0.iter().map(element).collect()
    }

    fn integers(&mut self, table: &'static str, accessor: Option<u32>) -> Vec<u32> {
        let (bytes, size) = self.view(table, accessor, &[UNSIGNED_BYTE, UNSIGNED_SHORT, UNSIGNED_INT], 1);
        let value = |b: &[u8]| b.iter().rev().fold(0_u32, |value, &byte| value << 8 | u32::from(byte));
        bytes.chunks_exact(size).map(value).collect()
    }

    fn optional_integers(&mut self, table: &'static str, accessor: Option<u32>) -> Option<Vec<u32>> {
        accessor.map(|_| self.integers(table, accessor))
    }

    fn bytes(&mut self, table: &'static str, accessor: Option<u32>) -> Vec<u8> {
        self.view(table, accessor, &[UNSIGNED_BYTE], 1).0.to_vec()
    }
}
