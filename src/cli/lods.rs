//! `MSFT_lod` in a file, counted.

use super::output::{count, counted};
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeSet;
use svs::gltf::Document;

/// `MSFT_lod` on nodes, of our own or of others.
#[derive(Debug, Default, Serialize)]
pub(crate) struct Lods {
    /// Nodes that have it.
    nodes: u64,
    /// Meshes that these show.
    meshes: u64,
    /// Versions that they name, in sum.
    versions: u64,
}

impl Lods {
    pub(crate) fn of(document: &Document) -> Self {
        let nodes = document.json.get("nodes").and_then(Value::as_array).into_iter().flatten();
        let mut lods = Self::default();
        let mut meshes = BTreeSet::new();
        for node in nodes {
            let Some(lod) = node.pointer("/extensions/MSFT_lod") else { continue };
            lods.nodes += 1;
            lods.versions += lod.get("ids").and_then(Value::as_array).map_or(0, |ids| ids.len() as u64);
            meshes.extend(node.get("mesh").and_then(Value::as_u64));
        }
        lods.meshes = meshes.len() as u64;
        lods
    }

    /// A line, if there are any.
    pub(crate) fn to_text(&self) -> String {
        if self.nodes == 0 {
            return String::new();
        }
        let shown =
            if self.meshes == 1 { "1 mesh".to_owned() } else { format!("{} meshes", count(self.meshes)) };
        format!(
            "MSFT_lod: {} with {shown}, {}\n",
            counted(self.nodes, "node"),
            counted(self.versions, "version")
        )
    }
}
