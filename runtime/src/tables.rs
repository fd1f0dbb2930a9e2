//! From raw tables to a checked [`Tree`].
//!
//! Everything a query relies on is checked here, in time linear in the tables (the order values are sorted), with no
//! recursion. Nothing is allocated by a count that a table's real length does not back.

use crate::directions::DirectionSet;
use crate::encode::{importance_area, row_stride, unpack_level};
use crate::error::TreeError;
use crate::tree::{Fingerprint, Nested, Node, ObjectRow, Placement, Tree};
use glam::Vec3;
use std::collections::BTreeMap;

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
        let nested = sorted_nested(tables.nested, tables.object_count)?;
        let mut nested_counts = BTreeMap::new();
        nested.iter().for_each(|n| *nested_counts.entry(n.tree).or_insert(0) += 1);
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
            nested,
            nested_counts,
            recommended_quality: tables.recommended_quality,
            fingerprint: tables.fingerprint,
        })
    }
}

fn expect_length(table: &'static str, found: usize, expected: u64) -> Result<(), TreeError> {
    if found as u64 == expected { Ok(()) } else { Err(TreeError::TableLength { table, found, expected }) }
}

fn check_order(tables: &TreeTables) -> Result<(), TreeError> {
    let Some(order) = &tables.object_order else { return Ok(()) };
    expect_length("OBJECT_ORDER", order.len(), u64::from(tables.object_count))?;
    let mut sorted = order.clone();
    sorted.sort_unstable();
    match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(TreeError::Order { value: pair[0] }),
        None => Ok(()),
    }
}

/// Nodes whose subtrees and object ranges nest in depth-first order.
fn nodes(tables: &TreeTables) -> Result<Vec<Node>, TreeError> {
    /// An ancestor of the node being looked at.
    struct Open {
        /// One past its last node and its last object.
        end: u32,
        objects_end: u32,
        /// Where the objects of its next child must begin; for its first child, at or after.
        next_object: u32,
        has_child: bool,
        node: usize,
    }
    let count = tables.node_sphere.len();
    expect_length("NODE_SUBTREE", tables.node_subtree.len(), count as u64)?;
    expect_length("NODE_FIRST_OBJECT", tables.node_first_object.len(), count as u64)?;
    expect_length("NODE_OBJECT_COUNT", tables.node_object_count.len(), count as u64)?;
    let Ok(end) = u32::try_from(count) else { return Err(TreeError::Subtree { node: 0 }) };
    // Objects of no node may lie between roots, so the outermost level is as if it had no child yet.
    let mut open =
        vec![Open { end, objects_end: tables.object_count, next_object: 0, has_child: false, node: count }];
    // Children must use up their parent's objects.
    let close = |done: &Open| {
        if done.has_child && done.next_object != done.objects_end {
            Err(TreeError::ObjectRange { node: done.node })
        } else {
            Ok(())
        }
    };
    let mut nodes = Vec::with_capacity(count);
    for node in 0..count {
        while open.len() > 1 && open[open.len() - 1].end == node as u32 {
            if let Some(done) = open.pop() {
                close(&done)?;
            }
        }
        let depth = open.len() as u32 - 1;
        let Some(parent) = open.last_mut() else { return Err(TreeError::Subtree { node }) };
        let [x, y, z, radius] = tables.node_sphere[node];
        let center = Vec3::new(x, y, z);
        if !(center.is_finite() && radius.is_finite() && radius >= 0.0) {
            return Err(TreeError::Sphere { node });
        }
        let subtree = tables.node_subtree[node];
        let node_end = (node as u32).checked_add(subtree).filter(|&e| subtree > 0 && e <= parent.end);
        let node_end = node_end.ok_or(TreeError::Subtree { node })?;
        let (first_object, object_count) = (tables.node_first_object[node], tables.node_object_count[node]);
        let objects_end = first_object.checked_add(object_count).filter(|&e| e <= parent.objects_end);
        let objects_end = objects_end.ok_or(TreeError::ObjectRange { node })?;
        let in_order = if parent.has_child {
            first_object == parent.next_object
        } else {
            first_object >= parent.next_object
        };
        if !in_order {
            return Err(TreeError::ObjectRange { node });
        }
        parent.has_child = depth > 0;
        parent.next_object = objects_end;
        nodes.push(Node { center, radius, subtree, first_object, object_count, depth });
        open.push(Open { end: node_end, objects_end, next_object: first_object, has_child: false, node });
    }
    open.iter().try_for_each(close)?;
    Ok(nodes)
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

fn sorted_nested(mut nested: Vec<Nested>, object_count: u32) -> Result<Vec<Nested>, TreeError> {
    if let Some(entry) = nested.iter().position(|n| n.object >= object_count) {
        return Err(TreeError::Nested { entry, problem: "there is no such object" });
    }
    nested.sort_by_key(|n| n.object);
    match nested.windows(2).position(|pair| pair[0].object == pair[1].object) {
        Some(entry) => Err(TreeError::Nested { entry, problem: "the object stands for two anchors" }),
        None => Ok(nested),
    }
}
