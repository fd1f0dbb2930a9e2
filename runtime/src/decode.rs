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
        let named = trees.iter().enumerate();
        let named = named.flat_map(|(tree, json)| json.accessors().map(move |index| (tree, index)));
        // Accessors that cannot be read are reported by the tree that needs them.
        let (named, views): (Vec<usize>, Vec<AccessorView<'_>>) =
            named.filter_map(|(tree, index)| Some((tree, source.accessor(index as usize)?))).unzip();
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
    let tables = &json.tables;
    let reader = |table, accessor: Option<u32>| accessor.map(|index| Reader { source, table, index });
    let node_sphere = reader("NODE_SPHERE", tables.node_sphere).map_or(Ok(Vec::new()), |r| r.spheres())?;
    let has_nodes = !node_sphere.is_empty();
    let node_table = |table, accessor: Option<u32>| match reader(table, accessor) {
        Some(reader) => reader.integers(),
        None if has_nodes => Err(TreeError::TableMissing { table }),
        None => Ok(Vec::new()),
    };
    let fingerprint = match json.fingerprint {
        Some(f) => Some(Fingerprint {
            triangles: f.triangles,
            hash: parse_hash(&f.hash).ok_or(TreeError::Fingerprint)?,
        }),
        None => None,
    };
    Ok(TreeTables {
        placement,
        directions: json.directions,
        object_count: json.object_count,
        node_subtree: node_table("NODE_SUBTREE", tables.node_subtree)?,
        node_first_object: node_table("NODE_FIRST_OBJECT", tables.node_first_object)?,
        node_object_count: node_table("NODE_OBJECT_COUNT", tables.node_object_count)?,
        node_sphere,
        object_order: reader("OBJECT_ORDER", tables.object_order).map(|r| r.integers()).transpose()?,
        level_bits: json.level_bits,
        level_row: match reader("LEVEL_ROW", tables.level_row) {
            Some(reader) => reader.bytes()?,
            None if has_nodes => return Err(TreeError::TableMissing { table: "LEVEL_ROW" }),
            None => Vec::new(),
        },
        level_row_index: reader("LEVEL_ROW_INDEX", tables.level_row_index)
            .map(|r| r.integers())
            .transpose()?,
        importance_area: json.importance_area,
        importance: reader("IMPORTANCE", tables.importance).map_or(Ok(Vec::new()), |r| r.bytes())?,
        proxies: json.proxies.as_ref().map(|proxies| read_proxies(proxies, source)).transpose()?,
        nested: json
            .nested
            .iter()
            .map(|n| Nested { object: n.object, tree: n.tree, anchor: n.anchor })
            .collect(),
        recommended_quality: json.recommended.map(|r| r.quality as f32),
        fingerprint,
    })
}

fn read_proxies(json: &ProxiesJson, source: &dyn AccessorSource) -> Result<ProxyTables, TreeError> {
    let tables = &json.tables;
    let reader = |table, index| Reader { source, table, index };
    Ok(ProxyTables {
        visible: json.visible,
        sphere: reader("PROXY_SPHERE", tables.sphere).spheres()?,
        subtree: reader("PROXY_SUBTREE", tables.subtree).integers()?,
        first_object: reader("PROXY_FIRST_OBJECT", tables.first_object).integers()?,
        object_count: reader("PROXY_OBJECT_COUNT", tables.object_count).integers()?,
        object: tables.object.map(|index| reader("PROXY_OBJECT", index).integers()).transpose()?,
        error: reader("PROXY_ERROR", tables.error).floats::<1>()?.into_iter().flatten().collect(),
        deviation: tables
            .deviation
            .map(|index| reader("PROXY_DEVIATION", index).floats::<3>())
            .transpose()?
            .map(|rows| rows.into_iter().map(|[mean, rms, wrong]| Deviation { mean, rms, wrong }).collect()),
        mesh: reader("PROXY_MESH", tables.mesh).integers()?,
        origin: reader("PROXY_ORIGIN", tables.origin).floats::<3>()?,
    })
}

/// Reads one table; allocates only what the accessor's bytes hold.
struct Reader<'a> {
    source: &'a dyn AccessorSource,
    table: &'static str,
    index: u32,
}

impl Reader<'_> {
    fn view(&self, components: u32) -> Result<(AccessorView<'_>, usize), TreeError> {
        let view = self
            .source
            .accessor(self.index as usize)
            .ok_or(TreeError::Accessor { table: self.table, accessor: self.index })?;
        let size: usize = match view.component_type {
            5121 => 1,
            5123 => 2,
            5125 | 5126 => 4,
            _ => return Err(self.wrong_type()),
        };
        let length = view.count.checked_mul(size * components as usize);
        if view.components != components || length != Some(view.bytes.len()) {
            return Err(self.wrong_type());
        }
        Ok((view, size))
    }

    fn wrong_type(&self) -> TreeError {
        TreeError::AccessorType { table: self.table, accessor: self.index }
    }

    fn spheres(&self) -> Result<Vec<[f32; 4]>, TreeError> {
        self.floats::<4>()
    }

    fn floats<const N: usize>(&self) -> Result<Vec<[f32; N]>, TreeError> {
        let (view, _) = self.view(N as u32)?;
        if view.component_type != 5126 {
            return Err(self.wrong_type());
        }
        let float = |b: &[u8]| f32::from_le_bytes([b[0], b[1], b[2], b[3]]);
        let element = |b: &[u8]| std::array::from_fn(|k| float(&b[4 * k..]));
        Ok(view.bytes.chunks_exact(4 * N).map(element).collect())
    }

    fn integers(&self) -> Result<Vec<u32>, TreeError> {
        let (view, size) = self.view(1)?;
        if view.component_type == 5126 {
            return Err(self.wrong_type());
        }
        let value = |b: &[u8]| b.iter().rev().fold(0_u32, |value, &byte| value << 8 | u32::from(byte));
        Ok(view.bytes.chunks_exact(size).map(value).collect())
    }

    fn bytes(&self) -> Result<Vec<u8>, TreeError> {
        let (view, _) = self.view(1)?;
        if view.component_type == 5121 { Ok(view.bytes.to_vec()) } else { Err(self.wrong_type()) }
    }
}
