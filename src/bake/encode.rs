//! A baked tree as the tables of the extension.

use super::pipeline::BakedTree;
use super::subject::Subject;
use svs_runtime::directions::DirectionSet;
use svs_runtime::encode::{fingerprint, format_hash, index_bytes, level_bits_for, palette};
use svs_runtime::format::FingerprintJson;

/// One accessor's worth of data.
#[derive(Clone, Debug, PartialEq)]
pub struct EncodedTable {
    /// Name in the extension's `tables`.
    pub semantic: &'static str,
    /// Little-endian components, tightly packed.
    pub bytes: Vec<u8>,
    /// glTF component type.
    pub component_type: u32,
    /// glTF accessor type.
    pub kind: &'static str,
    /// Elements.
    pub count: usize,
}

/// A tree's tables and the figures that go into JSON beside them.
#[derive(Clone, Debug, PartialEq)]
pub struct EncodedTree {
    /// The tables, in the order in which they are stored.
    pub tables: Vec<EncodedTable>,
    /// Bits per level.
    pub level_bits: u8,
    /// m² of importance code 0.
    pub importance_area: f64,
    /// What was baked.
    pub fingerprint: FingerprintJson,
}

impl EncodedTree {
    /// Bytes of all tables.
    pub fn bytes(&self) -> usize {
        self.tables.iter().map(|t| t.bytes.len()).sum()
    }
}

/// Encodes a baked tree; see the extension's specification for the meaning of every table.
pub fn encode_tree(tree: &BakedTree, subject: &Subject, directions: &DirectionSet) -> EncodedTree {
    let order = &tree.hierarchy.order;
    let nodes = &tree.hierarchy.nodes;
    let mut tables = Vec::new();

    if !nodes.is_empty() {
        let spheres = tree
            .spheres
            .iter()
            .flat_map(|s| [s.center.x, s.center.y, s.center.z, s.radius])
            .flat_map(|v| (v as f32).to_le_bytes())
            .collect();
        tables.push(EncodedTable {
            semantic: "NODE_SPHERE",
            bytes: spheres,
            component_type: 5126,
            kind: "VEC4",
            count: nodes.len(),
        });
        tables.push(integers("NODE_SUBTREE", nodes.iter().map(|n| n.subtree)));
        tables.push(integers("NODE_FIRST_OBJECT", nodes.iter().map(|n| n.members.start)));
        tables.push(integers("NODE_OBJECT_COUNT", nodes.iter().map(|n| n.members.end - n.members.start)));
    }

    let order_values: Vec<u32> = order.iter().map(|&m| subject.order_values[m as usize]).collect();
    if !order_values.iter().enumerate().all(|(k, &v)| k as u32 == v) {
        tables.push(integers("OBJECT_ORDER", order_values.iter().copied()));
    }

    let rows: Vec<u8> = order.iter().flat_map(|&m| tree.levels.row(m)).copied().collect();
    let level_bits = level_bits_for(rows.iter().copied().max().unwrap_or(0));
    let importance_area = tree.importance_area();
    // Without spheres there are no levels: every object is always a candidate.
    if !nodes.is_empty() {
        let packed = palette(&rows, directions.len(), level_bits);
        tables.push(bytes("LEVEL_ROW", packed.rows));
        if let Some(index) = packed.index {
            tables.push(integers("LEVEL_ROW_INDEX", index.into_iter()));
        }
        let importance: Vec<u8> = order.iter().flat_map(|&m| tree.importance(m, importance_area)).collect();
        if !importance.is_empty() {
            tables.push(bytes("IMPORTANCE", importance));
        }
    }

    EncodedTree {
        tables,
        level_bits,
        importance_area,
        fingerprint: FingerprintJson {
            triangles: subject.members.iter().map(|m| u64::from(m.triangles)).sum(),
            hash: format_hash(fingerprint(
                subject.order_values.iter().zip(&subject.members).map(|(&value, m)| (value, m.triangles)),
            )),
        },
    }
}

fn bytes(semantic: &'static str, bytes: Vec<u8>) -> EncodedTable {
    EncodedTable { semantic, component_type: 5121, kind: "SCALAR", count: bytes.len(), bytes }
}

/// Floats; `kind` says how many make an element.
pub(crate) fn floats(
    semantic: &'static str,
    kind: &'static str,
    values: impl Iterator<Item = f32>,
) -> EncodedTable {
    let bytes: Vec<u8> = values.flat_map(f32::to_le_bytes).collect();
    let components = match kind {
        "VEC4" => 4,
        "VEC3" => 3,
        "VEC2" => 2,
        _ => 1,
    };
    EncodedTable { semantic, component_type: 5126, kind, count: bytes.len() / 4 / components, bytes }
}

/// Unsigned integers in the smallest component type that holds them all.
pub(crate) fn integers(semantic: &'static str, values: impl Iterator<Item = u32> + Clone) -> EncodedTable {
    let count = values.clone().count();
    let width = index_bytes(values.clone().max().unwrap_or(0));
    let bytes = values.flat_map(|v| v.to_le_bytes().into_iter().take(width)).collect();
    let component_type = match width {
        1 => 5121,
        2 => 5123,
        _ => 5125,
    };
    EncodedTable { semantic, bytes, component_type, kind: "SCALAR", count }
}
