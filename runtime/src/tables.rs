//! From raw tables to a checked [`Tree`].
//!
//! Everything a query relies on is checked here, in time linear in the tables (the order values are sorted), with no
//! recursion. Nothing is allocated by a count that a table's real length does not back.

use crate::directions::DirectionSet;
use crate::encode::{importance_area, row_stride, unpack_level};
use crate::error::TreeError;
use crate::nesting::{self, Names, expect_length};
use crate::proxies::{Proxies, ProxyTables};
use crate::sorting::{repeated, sorted};
use crate::tree::{Fingerprint, Nested, Node, ObjectRow, Placement, Tree};
use glam::Vec3;

/// The tables of one tree, unchecked. A baker can turn its result into a [`Tree`] without writing a file.
#[derive(Clone, Debug, PartialEq)]
pub struct TreeTables {
    /// Where the tree is.
    pub placement: Placement,
    /// Name of the direction set.
    pub directions: String,
    /// Number of objects.
    pub object_count: u32,
    /// Centre x, y, z and radius per node, metres.
    pub node_sphere: Vec<[f32; 4]>,
    /// Nodes in each subtree, itself included.
    pub node_subtree: Vec<u32>,
    /// First object below each node.
    pub node_first_object: Vec<u32>,
    /// Objects below each node.
    pub node_object_count: Vec<u32>,
    /// Document index per object; `None`: the same order.
    pub object_order: Option<Vec<u32>>,
    /// Bits per level: 1, 2, 4 or 8.
    pub level_bits: u8,
    /// Packed rows, see [`crate::encode::palette`]. Empty without nodes.
    pub level_row: Vec<u8>,
    /// Row per object; `None`: row `k` belongs to object `k`.
    pub level_row_index: Option<Vec<u32>>,
    /// Area in m² of importance code 0.
    pub importance_area: f64,
    /// Importance codes, for each object one per height up to its highest level.
    pub importance: Vec<u8>,
    /// Meshes that stand for groups of objects.
    pub proxies: Option<ProxyTables>,
    /// Objects that stand for other trees.
    pub nested: Vec<Nested>,
    /// Recommended quality, 0 to 1.
    pub recommended_quality: Option<f32>,
    /// What the tree was baked from.
    pub fingerprint: Option<Fingerprint>,
}

impl Tree {
    /// Checks the tables. Whether `nested` fits the other trees is checked when all are known, by
    /// [`crate::Visibility::new`].
    ///
    /// # Errors
    /// Every inconsistency, see [`TreeError`].
    pub fn new(tables: TreeTables) -> Result<Self, TreeError> {
        let directions = DirectionSet::by_name(&tables.directions)
            .ok_or_else(|| TreeError::Directions { name: tables.directions.clone() })?;
        if !matches!(tables.level_bits, 1 | 2 | 4 | 8) {
            return Err(TreeError::LevelBits { found: tables.level_bits });
        }
        if !(tables.importance_area.is_finite() && tables.importance_area >= 0.0) {
            return Err(TreeError::ImportanceArea);
        }
        if matches!(&tables.placement, Placement::Anchors(nodes) if nodes.is_empty()) {
            return Err(TreeError::Placement);
        }
        if tables.recommended_quality.is_some_and(|q| !(0.0..=1.0).contains(&q)) {
            return Err(TreeError::Quality);
        }
        check_order(&tables)?;
        let nodes = nodes(&tables)?;
        let stride = row_stride(directions.len(), tables.level_bits);
        let objects = if nodes.is_empty() {
            expect_length("LEVEL_ROW", tables.level_row.len(), 0)?;
            expect_length("LEVEL_ROW_INDEX", tables.level_row_index.as_ref().map_or(0, Vec::len), 0)?;
            expect_length("IMPORTANCE", tables.importance.len(), 0)?;
            Vec::new()
        } else {
            object_rows(&tables, &nodes, directions.len(), stride)?
        };
        let proxies = tables.proxies.map(|proxies| Proxies::new(proxies, tables.object_count)).transpose()?;
        let nested = sorted_nested(tables.nested, tables.object_count)?;
        let guests = sorted(nested.iter().map(|n| u64::from(n.tree)));
        let nested_counts = guests.chunk_by(|a, b| a == b).map(|same| (same[0] as u32, same.len())).collect();
        Ok(Self {
            placement: tables.placement,
            directions,
            object_count: tables.object_count,
            nodes,
            objects,
            order: tables.object_order,
            level_bits: tables.level_bits,
            rows: tables.level_row,
            importance: tables.importance,
            areas: (0..=255).map(|code| importance_area(code, tables.importance_area)).collect(),
            proxies,
            nested,
            nested_counts,
            recommended_quality: tables.recommended_quality,
            fingerprint: tables.fingerprint,
        })
    }
}

fn check_order(tables: &TreeTables) -> Result<(), TreeError> {
    let Some(order) = &tables.object_order else { return Ok(()) };
    expect_length("OBJECT_ORDER", order.len(), u64::from(tables.object_count))?;
    match repeated(order.iter().copied()) {
        Some(value) => Err(TreeError::Order { value }),
        None => Ok(()),
    }
}

/// Nodes whose subtrees and object ranges nest in depth-first order.
fn nodes(tables: &TreeTables) -> Result<Vec<Node>, TreeError> {
    const NAMES: Names = Names {
        subtree: "NODE_SUBTREE",
        first_object: "NODE_FIRST_OBJECT",
        object_count: "NODE_OBJECT_COUNT",
    };
    let ranges = [&*tables.node_subtree, &tables.node_first_object, &tables.node_object_count];
    let depths = nesting::depths(tables.node_sphere.len(), &NAMES, ranges, tables.object_count)?;
    let mut nodes = Vec::with_capacity(depths.len());
    for (node, depth) in depths.into_iter().enumerate() {
        let (center, radius) = sphere(tables.node_sphere[node]).ok_or(TreeError::Sphere { node })?;
        nodes.push(Node {
            center,
            radius,
            subtree: tables.node_subtree[node],
            first_object: tables.node_first_object[node],
            object_count: tables.node_object_count[node],
            depth,
        });
    }
    Ok(nodes)
}

/// Centre and radius, if they are finite and the radius is not negative.
pub(crate) fn sphere([x, y, z, radius]: [f32; 4]) -> Option<(Vec3, f32)> {
    let center = Vec3::new(x, y, z);
    (center.is_finite() && radius.is_finite() && radius >= 0.0).then_some((center, radius))
}

fn object_rows(
    tables: &TreeTables,
    nodes: &[Node],
    directions: usize,
    stride: usize,
) -> Result<Vec<ObjectRow>, TreeError> {
    let count = tables.object_count as usize;
    match &tables.level_row_index {
        Some(index) => expect_length("LEVEL_ROW_INDEX", index.len(), count as u64)?,
        None => expect_length("LEVEL_ROW", tables.level_row.len(), count as u64 * stride as u64)?,
    }
    // From here on `count` is backed by a table's length.
    let row_count = tables.level_row.len() / stride;
    expect_length("LEVEL_ROW", tables.level_row.len(), (row_count * stride) as u64)?;
    let highest: Vec<u8> = tables
        .level_row
        .chunks_exact(stride)
        .map(|row| (0..directions).map(|d| unpack_level(row, tables.level_bits, d)).max().unwrap_or(0))
        .collect();
    let depths = depths(nodes, count);
    let mut objects = Vec::with_capacity(count);
    let mut importance = 0_u64;
    for (object, &depth) in depths.iter().enumerate() {
        let row = tables.level_row_index.as_ref().map_or(object as u32, |index| index[object]);
        let max_level = *highest.get(row as usize).ok_or(TreeError::Row { object, row })?;
        if u32::from(max_level) > depth {
            return Err(TreeError::Level { object, level: max_level, depth });
        }
        let first = importance.min(u64::from(u32::MAX)) as u32;
        objects.push(ObjectRow { row: row as usize * stride, importance: first, depth, max_level });
        importance += u64::from(max_level);
    }
    expect_length("IMPORTANCE", tables.importance.len(), importance)?;
    if importance > u64::from(u32::MAX) {
        return Err(TreeError::TableLength {
            table: "IMPORTANCE",
            found: tables.importance.len(),
            expected: u64::from(u32::MAX),
        });
    }
    Ok(objects)
}

/// Ancestors per object by a running sum: linear however deep the nodes nest.
fn depths(nodes: &[Node], object_count: usize) -> Vec<u32> {
    let mut change = vec![0_i64; object_count + 1];
    for node in nodes {
        change[node.first_object as usize] += 1;
        change[node.objects().end as usize] -= 1;
    }
    let mut depth = 0;
    change[..object_count]
        .iter()
        .map(|delta| {
            depth += delta;
            depth as u32
        })
        .collect()
}

fn sorted_nested(nested: Vec<Nested>, object_count: u32) -> Result<Vec<Nested>, TreeError> {
    if let Some(entry) = nested.iter().position(|n| n.object >= object_count) {
        return Err(TreeError::Nested { entry, problem: "there is no such object" });
    }
    // Entries by object; of equal objects, of which one is too many, by place.
    let keys = nested.iter().enumerate().map(|(entry, n)| u64::from(n.object) << 32 | entry as u64);
    let nested: Vec<Nested> = sorted(keys).into_iter().map(|key| nested[key as u32 as usize]).collect();
    match nested.windows(2).position(|pair| pair[0].object == pair[1].object) {
        Some(entry) => Err(TreeError::Nested { entry, problem: "the object stands for two anchors" }),
        None => Ok(nested),
    }
}
