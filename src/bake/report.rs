//! What a bake did, in figures.

use crate::proxies::ProxyReport;
use crate::verify::VerifyReport;
use serde::Serialize;

/// Figures of a whole bake. Serialises to the JSON of `svs build --json`.
#[derive(Clone, Debug, Serialize)]
pub struct BakeReport {
    /// Objects the scene draws.
    pub objects: usize,
    /// Objects that were baked into trees.
    pub baked_objects: usize,
    /// Triangles the scene draws, instances counted.
    pub triangles: u64,
    /// Bytes of vertex and index data of the meshes in use.
    pub geometry_bytes: u64,
    /// Bytes the tables take, without JSON.
    pub table_bytes: u64,
    /// Bytes added to the file: tables and JSON.
    pub bytes_added: u64,
    /// Trees, the scene's own first.
    pub trees: Vec<TreeReport>,
    /// Proxies, if they were asked for.
    pub proxies: Option<ProxyReport>,
    /// Rays traced.
    pub rays: u64,
    /// Estimated missing pixels per million covered ones from outside, default query, before perspective; of the
    /// worst tree.
    pub estimated_missing_ppm: f64,
    /// Wall-clock seconds, writing the file not included.
    pub seconds: f64,
    /// Seconds by stage.
    pub stages: Vec<StageSeconds>,
    /// What was passed over or repaired.
    pub notes: Vec<NoteReport>,
    /// Short check on held-out cameras.
    pub verification: Option<VerifyReport>,
}

/// Figures of one tree.
#[derive(Clone, Debug, Serialize)]
pub struct TreeReport {
    /// `scene`, or the index of the anchor node.
    pub anchor: String,
    /// Objects.
    pub objects: usize,
    /// Hierarchy: `scene`, `octree` or `bvh`.
    pub hierarchy: String,
    /// Nodes of the hierarchy before pruning.
    pub nodes_before: usize,
    /// Nodes, that is spheres, kept.
    pub nodes_kept: usize,
    /// Share of triangles that a kept sphere culls at least.
    pub prune: f64,
    /// Direction set.
    pub directions: String,
    /// Bits per level.
    pub level_bits: u8,
    /// Bytes by table.
    pub tables: Vec<TableReport>,
}

/// Size of one table.
#[derive(Clone, Debug, Serialize)]
pub struct TableReport {
    /// Name in the extension.
    pub semantic: String,
    /// Bytes.
    pub bytes: usize,
}

/// Time of one stage.
#[derive(Clone, Debug, Serialize)]
pub struct StageSeconds {
    /// Name of the stage.
    pub name: String,
    /// Wall-clock seconds.
    pub seconds: f64,
}

/// A note on the input.
#[derive(Clone, Debug, Serialize)]
pub struct NoteReport {
    /// Stable code.
    pub code: String,
    /// How often.
    pub count: usize,
    /// For people.
    pub message: String,
    /// JSON pointer of the first place.
    pub pointer: String,
}
