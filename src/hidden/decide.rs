//! From what was seen to what goes.

use super::MARGIN;
use super::options::RemoveMode;
use super::sample::Seen;
use super::subject::Subject;
use crate::bake::subject::box_in_tree;
use crate::scene::{Mesh, Scene};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::HashSet;

/// A triangle by its corners' bits, relative to its mesh's origin: what tells it apart in the file, too.
pub(super) type Key = [[u32; 3]; 3];

/// What goes.
#[derive(Debug)]
pub(super) struct Hidden {
    /// By object: it goes.
    pub(super) objects: Vec<bool>,
    /// By mesh of the scene: the triangles that go.
    pub(super) triangles: Vec<HashSet<Key>>,
    /// By mesh of the scene: its index in the document.
    pub(super) mesh_indices: Vec<usize>,
    /// Objects that stay because they are not judged.
    pub(super) not_judged: usize,
    /// Objects that stay because they are too small to be judged.
    pub(super) tiny: usize,
}

impl Hidden {
    /// Whether anything goes.
    pub(super) fn is_anything(&self) -> bool {
        self.objects.contains(&true) || self.triangles.iter().any(|triangles| !triangles.is_empty())
    }
}

/// Objects less than this across, in the scene's radii, are not judged.
const TINY: f64 = 4.0 * MARGIN as f64;

/// `radius`: the scene's, metres.
pub(super) fn decide(scene: &Scene, subject: &Subject, seen: &Seen, radius: f64, mode: RemoveMode) -> Hidden {
    let mut judged_meshes = subject.judged_meshes.clone();
    let mut tiny = 0;
    let mut objects = vec![false; scene.objects.len()];
    for (index, object) in scene.objects.iter().enumerate() {
        if !subject.judged[index] || seen.object(index as u32) {
            continue;
        }
        let bounds = box_in_tree(&scene.meshes[object.mesh as usize], &object.to_world);
        // Written so that NaN is tiny.
        if (bounds.max - bounds.min).length() >= TINY * radius {
            objects[index] = true;
        } else {
            tiny += 1;
            judged_meshes[object.mesh as usize] = false;
        }
    }
    // A node draws all of its instances or none.
    let mut start = 0;
    while start < objects.len() {
        let node = scene.objects[start].node;
        let end = start + scene.objects[start..].iter().take_while(|object| object.node == node).count();
        if !objects[start..end].iter().all(|&hidden| hidden) {
            objects[start..end].fill(false);
        }
        start = end;
    }
    let triangles = scene
        .meshes
        .par_iter()
        .enumerate()
        .map(|(index, mesh)| match mode {
            RemoveMode::Triangles if judged_meshes[index] => {
                hidden_triangles(mesh, |triangle| seen.triangle(index as u32, triangle))
            }
            _ => HashSet::new(),
        })
        .collect();
    Hidden {
        objects,
        triangles,
        mesh_indices: subject.mesh_indices.clone(),
        not_judged: subject.judged.iter().filter(|judged| !**judged).count(),
        tiny,
    }
}

/// Triangles that were not seen and touch none that was.
fn hidden_triangles(mesh: &Mesh, seen: impl Fn(u32) -> bool) -> HashSet<Key> {
    let all = 0..mesh.triangles.len() as u32;
    let visible = all.clone().filter(|&triangle| seen(triangle));
    let touched: HashSet<[u32; 3]> = visible.flat_map(|triangle| key_of(mesh, triangle)).collect();
    all.map(|triangle| key_of(mesh, triangle))
        .filter(|key| !key.iter().any(|corner| touched.contains(corner)))
        .collect()
}

/// The key of a mesh's triangle.
pub(super) fn key_of(mesh: &Mesh, triangle: u32) -> Key {
    mesh.triangles[triangle as usize].map(|v| mesh.positions[v as usize].to_array().map(f32::to_bits))
}

/// The key of a triangle of the file, as its mesh has it.
pub(super) fn key(mesh: &Mesh, corners: [DVec3; 3]) -> Key {
    corners.map(|corner| (corner - mesh.origin).as_vec3().to_array().map(f32::to_bits))
}
