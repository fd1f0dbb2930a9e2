//! What became of the proxies, in figures.

use super::LodReport;
use serde::Serialize;

/// Figures of all proxies of a bake.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ProxyReport {
    /// Proxies stored: nodes, and levels of nodes.
    pub nodes: usize,
    /// Meshes they share.
    pub meshes: usize,
    /// Triangles of those meshes.
    pub triangles: u64,
    /// Meshes of the scene that got simplified versions.
    pub simplified_meshes: usize,
    /// Their simplified versions.
    pub mesh_levels: usize,
    /// Triangles of those.
    pub mesh_level_triangles: u64,
    /// Bytes added for all of this, JSON counted.
    pub bytes: u64,
    /// Those as a share of the scene's geometry.
    pub share: f64,
    /// Meshes that were made and left out to save bytes, or because they save too little.
    pub dropped: usize,
    /// Proxies by their depth, all trees together.
    pub levels: Vec<ProxyLevelReport>,
    /// What became of `MSFT_lod`, if it was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub msft_lod: Option<LodReport>,
    /// Trees without proxies, and why.
    pub without: Vec<String>,
    /// Wall-clock seconds.
    pub seconds: f64,
}

/// Figures of the proxies of one depth.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ProxyLevelReport {
    /// Proxies above.
    pub depth: u32,
    /// Proxies.
    pub nodes: usize,
    /// Triangles they draw, copies counted.
    pub triangles: u64,
    /// Smallest geometric error, metres.
    pub least_error: f32,
    /// Largest.
    pub largest_error: f32,
}
