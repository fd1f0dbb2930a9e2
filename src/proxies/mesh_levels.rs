//! Simplified versions of single meshes: of large ones, and of small ones that are drawn often. Where the camera is among
//! the objects no proxy can be drawn, and they are all that stands between an object and nothing.

use super::ProxyTree;
use super::geometry::{LevelOptions, MeshLevel, simplify_mesh_levels};
use crate::gltf::Document;
use crate::scene::Scene;
use rayon::prelude::*;
use svs_render::Mesh;

/// Meshes with fewer triangles are not simplified, however often they are drawn.
const LEAST_TRIANGLES: u64 = 64;

/// Nor are those of which fewer are drawn, all together.
const LEAST_DRAWN: u64 = 192;

/// A mesh and its simplified versions.
#[derive(Clone, Debug)]
pub(super) struct Simplified {
    /// Index into the scene's meshes.
    pub(super) mesh: u32,
    /// Its triangles.
    pub(super) triangles: u64,
    /// Objects that have it.
    pub(super) uses: u64,
    /// The simplified versions, rising errors.
    pub(super) levels: Vec<MeshLevel>,
}

/// Simplifies meshes that the trees' objects draw many triangles of.
pub(super) fn simplify(scene: &Scene, trees: &[ProxyTree<'_>], meshes: &[Mesh]) -> Vec<Simplified> {
    let mut uses = vec![0u64; scene.meshes.len()];
    for tree in trees {
        for (part, &object) in tree.subject.parts.iter().zip(&tree.subject.objects) {
            uses[part.mesh as usize] += u64::from(!scene.objects[object as usize].hidden);
        }
    }
    let wanted = |mesh: usize| {
        let own = u64::from(scene.meshes[mesh].drawn_triangles);
        own >= LEAST_TRIANGLES && own * uses[mesh] >= LEAST_DRAWN
    };
    let chosen: Vec<usize> = (0..scene.meshes.len()).filter(|&mesh| wanted(mesh)).collect();
    chosen
        .into_par_iter()
        .map(|mesh| Simplified {
            mesh: mesh as u32,
            triangles: u64::from(scene.meshes[mesh].drawn_triangles),
            uses: uses[mesh],
            levels: simplify_mesh_levels(&meshes[mesh], &LevelOptions::default()),
        })
        .filter(|simplified| !simplified.levels.is_empty())
        .collect()
}

impl Simplified {
    /// The mesh in the file: that of the first object that has it.
    pub(super) fn gltf_mesh(&self, document: &Document, scene: &Scene) -> u32 {
        let object = scene.objects.iter().find(|object| object.mesh == self.mesh);
        let node = object.and_then(|object| document.json.get("nodes")?.get(object.node));
        let mesh = node.and_then(|node| node.get("mesh")?.as_f64());
        mesh.map_or(0, |mesh| mesh as u32)
    }
}
