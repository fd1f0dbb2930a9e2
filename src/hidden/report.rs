//! What was removed, for people and for programs.

use super::apply::Outcome;
use super::decide::Hidden;
use super::options::RemoveMode;
use super::sample::Sampled;
use super::subject::items;
use crate::gltf::Document;
use crate::scene::Scene;
use serde::Serialize;
use std::collections::BTreeMap;

/// Objects named in a report.
const NAMED: usize = 10;

/// What [`super::remove`] has done.
#[derive(Clone, Debug, Serialize)]
pub struct HiddenReport {
    /// `objects` or `triangles`.
    pub mode: &'static str,
    /// Radius of the sphere that inside cameras keep free of opaque surfaces, metres.
    pub clearance: f64,
    /// Objects before.
    pub objects: usize,
    /// Objects that are gone.
    pub objects_removed: usize,
    /// Objects that stay without having been judged: moving, deforming, alpha-tested, switched at run time, …
    pub not_judged: usize,
    /// Objects that stay because rays cannot judge anything so small.
    pub tiny: usize,
    /// Triangles drawn before, every object counted.
    pub triangles: u64,
    /// Triangles drawn no more, every object counted.
    pub triangles_removed: u64,
    /// Those of them that objects lost which are still there.
    pub triangles_removed_of_kept: u64,
    /// JSON and buffers before, bytes.
    pub bytes_before: u64,
    /// JSON and buffers after, bytes.
    pub bytes_after: u64,
    /// Bytes of buffers that nobody refers to any more and that are gone.
    pub bytes_released: u64,
    /// Why unused bytes stay in the file, if they do.
    pub bytes_kept_because: Option<String>,
    /// Rays of outside and inside cameras.
    pub rays: u64,
    /// Most of them before the decision; they end there, or where a batch finds next to nothing new.
    pub ray_limit: u64,
    /// Inside camera points.
    pub camera_points: u64,
    /// Batches of rays.
    pub batches: u64,
    /// Rays from surfaces that no camera ray had seen, and the objects and triangles that they found visible.
    pub surface_rays: u64,
    /// See `surface_rays`.
    pub surface_found: u64,
    /// Of a million camera rays that had no part in the decision and met something, how many saw what was to be
    /// removed (it stays, then): an upper estimate of the pixels that change. If it was none: what the true number
    /// is below with 95 % confidence, 3 in that many rays. 0 if there was nothing to remove.
    pub estimated_missing_ppm: f64,
    /// Of a million camera rays, how many would see an object or triangle that no ray had seen: Good-Turing estimate
    /// from those seen once. It does not know what surface rays and neighbours keep.
    pub good_turing_ppm: f64,
    /// Of a million rays of the last batch before the decision, how many saw something that none had seen.
    pub last_batch_ppm: f64,
    /// The largest removed objects by triangles.
    pub largest: Vec<RemovedObject>,
    /// Wall time, seconds.
    pub seconds: f64,
}

/// A node that lost its mesh.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RemovedObject {
    /// Index in `nodes`.
    pub node: usize,
    /// The node's name.
    pub name: Option<String>,
    /// Triangles it drew, instances included.
    pub triangles: u64,
}

impl HiddenReport {
    /// What is known before the document changes.
    pub(super) fn new(
        doc: &Document,
        scene: &Scene,
        hidden: &Hidden,
        mode: RemoveMode,
        clearance: f64,
    ) -> Self {
        let triangles = |mesh: u32| u64::from(scene.meshes[mesh as usize].drawn_triangles);
        let mut removed: BTreeMap<usize, u64> = BTreeMap::new();
        for (object, _) in scene.objects.iter().zip(&hidden.objects).filter(|(_, hidden)| **hidden) {
            *removed.entry(object.node).or_default() += triangles(object.mesh);
        }
        let triangles_removed = removed.values().sum();
        let mut largest: Vec<(usize, u64)> = removed.into_iter().collect();
        largest.sort_by_key(|&(node, triangles)| (std::cmp::Reverse(triangles), node));
        let nodes = items(&doc.json, "nodes");
        let largest = largest.into_iter().take(NAMED).map(|(node, triangles)| RemovedObject {
            node,
            name: nodes[node].get("name").and_then(|name| name.as_str()).map(str::to_owned),
            triangles,
        });
        Self {
            mode: match mode {
                RemoveMode::Objects => "objects",
                RemoveMode::Triangles => "triangles",
            },
            clearance,
            objects: scene.objects.len(),
            objects_removed: hidden.objects.iter().filter(|hidden| **hidden).count(),
            not_judged: hidden.not_judged,
            tiny: hidden.tiny,
            triangles: scene.objects.iter().map(|object| triangles(object.mesh)).sum(),
            triangles_removed,
            triangles_removed_of_kept: 0,
            bytes_before: doc.bytes(),
            bytes_after: 0,
            bytes_released: 0,
            bytes_kept_because: None,
            rays: 0,
            ray_limit: 0,
            camera_points: 0,
            batches: 0,
            surface_rays: 0,
            surface_found: 0,
            estimated_missing_ppm: 0.0,
            good_turing_ppm: 0.0,
            last_batch_ppm: 0.0,
            largest: largest.collect(),
            seconds: 0.0,
        }
    }

    /// What is known afterwards.
    pub(super) fn finish(
        &mut self,
        doc: &Document,
        scene: &Scene,
        hidden: &Hidden,
        outcome: &Outcome,
        sampled: &Sampled,
    ) {
        let kept = scene.objects.iter().zip(&hidden.objects).filter(|(_, hidden)| !**hidden);
        self.triangles_removed_of_kept = kept.map(|(o, _)| outcome.triangles[o.mesh as usize]).sum();
        self.triangles_removed += self.triangles_removed_of_kept;
        self.bytes_after = doc.bytes();
        self.bytes_released = outcome.released.bytes;
        self.bytes_kept_because.clone_from(&outcome.released.kept_because);
        self.rays = sampled.rays;
        self.ray_limit = sampled.ray_limit;
        self.camera_points = sampled.points;
        self.batches = sampled.batches;
        self.surface_rays = sampled.surface_rays;
        self.surface_found = sampled.surface_found;
        let missed = if sampled.held_out_missed > 0 { sampled.held_out_missed as f64 } else { 3.0 };
        if sampled.held_out_seen > 0 {
            self.estimated_missing_ppm = missed / sampled.held_out_seen as f64 * 1e6;
        }
        self.good_turing_ppm = sampled.unseen_ppm;
        self.last_batch_ppm = sampled.last_missed as f64 / sampled.last_seen.max(1) as f64 * 1e6;
    }
}
