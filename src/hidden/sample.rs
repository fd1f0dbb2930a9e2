//! Rays of cameras outside and inside, until they find next to nothing new.

use super::decide::{Hidden, key_of};
use super::options::{HiddenOptions, RemoveMode};
use super::regions::Regions;
use super::subject::Subject;
use super::{surface, view};
use crate::bake::Progress;
use crate::bake::rays::{Crossing, RayScene};
use crate::bake::sample::lines::Batch;
use crate::bake::sample::random::{Random, half_sphere};
use crate::scene::Scene;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU8, Ordering};

/// Start of all random numbers of this module.
const SEED: u64 = 0x4849_4444_454E;
/// Rays from outside in a batch: a sixteenth of all rays within these bounds.
const OUTSIDE_RAYS: [u64; 2] = [1 << 14, 1 << 20];
/// Directions that they come from, in pairs of opposite ones.
const OUTSIDE_DIRECTIONS: usize = 128;
/// Rays from each inside camera point, in opposite pairs. As many as from outside if all points tried are such.
const RAYS_PER_POINT: usize = 256;

/// What has been seen, and how often up to 2: enough to know what one ray alone has found.
#[derive(Debug)]
pub(super) struct Seen {
    objects: Vec<AtomicU8>,
    /// All meshes' triangles; empty unless triangles are to be removed.
    triangles: Vec<AtomicU8>,
    /// First triangle of each mesh in `triangles`.
    first: Vec<usize>,
    /// Mesh of each object.
    mesh: Vec<u32>,
    judged: Vec<bool>,
    judged_meshes: Vec<bool>,
}

impl Seen {
    pub(super) fn new(scene: &Scene, subject: &Subject, mode: RemoveMode) -> Self {
        let mut total = 0;
        let first = scene.meshes.iter().map(|mesh| {
            let first = total;
            total += mesh.triangles.len();
            first
        });
        let first = first.collect();
        let counters = |count| (0..count).map(|_| AtomicU8::new(0)).collect();
        Self {
            objects: counters(scene.objects.len()),
            triangles: if mode == RemoveMode::Triangles { counters(total) } else { Vec::new() },
            first,
            mesh: scene.objects.iter().map(|object| object.mesh).collect(),
            judged: subject.judged.clone(),
            judged_meshes: subject.judged_meshes.clone(),
        }
    }

    pub(super) fn object(&self, object: u32) -> bool {
        self.objects[object as usize].load(Ordering::Relaxed) > 0
    }

    /// Whether a triangle of a mesh was seen in any object; `true` if triangles are not asked about.
    pub(super) fn triangle(&self, mesh: u32, triangle: u32) -> bool {
        let place = self.first[mesh as usize] + triangle as usize;
        self.triangles.get(place).is_none_or(|count| count.load(Ordering::Relaxed) > 0)
    }

    fn mark(&self, hit: &Crossing) {
        raise(&self.objects[hit.member as usize]);
        let mesh = self.mesh[hit.member as usize] as usize;
        if let Some(counter) = self.triangles.get(self.first[mesh] + hit.triangle as usize) {
            raise(counter);
        }
    }

    /// Seen, and by other means than a chance ray: not to be counted as found once.
    pub(super) fn mark_object(&self, object: u32) {
        self.objects[object as usize].store(2, Ordering::Relaxed);
    }

    /// See [`Self::mark_object`]; the object that shows it is marked too.
    pub(super) fn mark_triangle(&self, object: u32, triangle: u32) {
        self.mark_object(object);
        let place = self.first[self.mesh[object as usize] as usize] + triangle as usize;
        if let Some(counter) = self.triangles.get(place) {
            counter.store(2, Ordering::Relaxed);
        }
    }

    /// Objects and triangles that may be removed and have been seen exactly once.
    fn once(&self) -> u64 {
        let is_one = |counter: &AtomicU8| counter.load(Ordering::Relaxed) == 1;
        let objects =
            self.objects.iter().zip(&self.judged).filter(|(count, judged)| **judged && is_one(count));
        let mut once = objects.count();
        if !self.triangles.is_empty() {
            for (mesh, &first) in self.first.iter().enumerate().filter(|(mesh, _)| self.judged_meshes[*mesh])
            {
                let end = self.first.get(mesh + 1).copied().unwrap_or(self.triangles.len());
                once += self.triangles[first..end].iter().filter(|count| is_one(count)).count();
            }
        }
        once as u64
    }

    /// What is unseen now, and may be removed.
    fn unseen(&self) -> Unseen {
        let is_zero = |counter: &AtomicU8| counter.load(Ordering::Relaxed) == 0;
        let objects = self.objects.iter().zip(&self.judged);
        let objects = objects.map(|(count, judged)| *judged && is_zero(count)).collect();
        Unseen { objects, triangles: self.triangles.iter().map(is_zero).collect() }
    }
}

fn raise(counter: &AtomicU8) {
    // Mostly 2 already: reading is cheaper than writing.
    if counter.load(Ordering::Relaxed) < 2 {
        let _ = counter.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |n| (n < 2).then_some(n + 1));
    }
}

/// What a batch tests: what would be removed if it were not for the batch.
struct Unseen {
    objects: Vec<bool>,
    triangles: Vec<bool>,
}

impl Unseen {
    /// What has been decided, neighbours and all.
    fn decided(scene: &Scene, hidden: &Hidden) -> Self {
        let meshes = scene.meshes.par_iter().zip(&hidden.triangles);
        let triangles = meshes.flat_map_iter(|(mesh, hidden)| {
            (0..mesh.triangles.len() as u32)
                .map(move |triangle| !hidden.is_empty() && hidden.contains(&key_of(mesh, triangle)))
        });
        Self { objects: hidden.objects.clone(), triangles: triangles.collect() }
    }

    fn holds(&self, seen: &Seen, hit: &Crossing) -> bool {
        let mesh = seen.mesh[hit.member as usize] as usize;
        self.objects[hit.member as usize]
            || (seen.judged_meshes[mesh]
                && self.triangles.get(seen.first[mesh] + hit.triangle as usize) == Some(&true))
    }
}

/// What was done, and what is still to be feared.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sampled {
    /// Rays from outside in each batch.
    batch_rays: u64,
    /// Most rays to cast from cameras before the decision.
    pub(super) ray_limit: u64,
    /// Rays cast from cameras.
    pub(super) rays: u64,
    /// Inside camera points.
    pub(super) points: u64,
    /// Batches of rays.
    pub(super) batches: u64,
    /// Rays of the last batch that met something, and those that saw what would have been removed before it.
    pub(super) last_seen: u64,
    pub(super) last_missed: u64,
    /// Rays cast after the decision that met something, and those that saw what was to be removed.
    pub(super) held_out_seen: u64,
    pub(super) held_out_missed: u64,
    /// Good-Turing estimate: share of rays that would see something not seen yet, per million.
    pub(super) unseen_ppm: f64,
    /// Rays cast from surfaces, and objects and triangles they found.
    pub(super) surface_rays: u64,
    pub(super) surface_found: u64,
}

#[derive(Clone, Copy, Debug, Default)]
struct Found {
    rays: u64,
    points: u64,
    seen: u64,
    missed: u64,
}

impl Found {
    fn plus(self, other: Found) -> Found {
        Found {
            rays: self.rays + other.rays,
            points: self.points + other.points,
            seen: self.seen + other.seen,
            missed: self.missed + other.missed,
        }
    }

    fn missed_ppm(&self) -> f64 {
        self.missed as f64 / self.seen.max(1) as f64 * 1e6
    }
}

/// Samples until little is found or the rays are used up.
pub(super) fn run(
    rays: &RayScene<'_>,
    regions: &Regions<'_>,
    scene: &Scene,
    subject: &Subject,
    seen: &Seen,
    options: &HiddenOptions,
    progress: &dyn Progress,
) -> Sampled {
    let triangles =
        scene.objects.iter().map(|object| u64::from(scene.meshes[object.mesh as usize].drawn_triangles));
    let ray_limit = options.ray_limit(triangles.sum());
    let mut sampled = Sampled {
        batch_rays: (ray_limit / 16).clamp(OUTSIDE_RAYS[0], OUTSIDE_RAYS[1]),
        ray_limit,
        ..Sampled::default()
    };
    if !subject.judged.contains(&true) {
        return sampled;
    }
    let mut total_seen = 0;
    // Half of the rays before those from surfaces, which are the fewer the more is known, and half after them.
    for (limit, target) in
        [(ray_limit / 2, options.max_missing_ppm * 4.0), (ray_limit, options.max_missing_ppm)]
    {
        progress.stage("find hidden", Some(limit.saturating_sub(sampled.rays)));
        loop {
            let found = batch(rays, regions, seen, &seen.unseen(), &sampled, progress);
            sampled.add(&found);
            (sampled.last_seen, sampled.last_missed) = (found.seen, found.missed);
            total_seen += found.seen;
            // A ray or two prove nothing.
            if found.missed_ppm() <= target || sampled.rays >= limit {
                break;
            }
        }
        if sampled.surface_rays == 0 {
            let found = surface::run(rays, regions, scene, subject, seen, SEED, progress);
            (sampled.surface_rays, sampled.surface_found) = found;
        }
    }
    sampled.unseen_ppm = seen.once() as f64 / total_seen.max(1) as f64 * 1e6;
    sampled
}

impl Sampled {
    fn add(&mut self, found: &Found) {
        self.batches += 1;
        self.rays += found.rays;
        self.points += found.points;
    }
}

/// One more batch, on what has been decided: what it sees is marked, so that it stays if decided again.
pub(super) fn check(
    rays: &RayScene<'_>,
    regions: &Regions<'_>,
    scene: &Scene,
    hidden: &Hidden,
    seen: &Seen,
    sampled: &mut Sampled,
    progress: &dyn Progress,
) {
    progress.stage("check hidden", None);
    let found = batch(rays, regions, seen, &Unseen::decided(scene, hidden), sampled, progress);
    sampled.add(&found);
    (sampled.held_out_seen, sampled.held_out_missed) = (found.seen, found.missed);
}

fn batch(
    rays: &RayScene<'_>,
    regions: &Regions<'_>,
    seen: &Seen,
    unseen: &Unseen,
    so_far: &Sampled,
    progress: &dyn Progress,
) -> Found {
    let (index, batch_rays) = (so_far.batches, so_far.batch_rays);
    let candidates = batch_rays / RAYS_PER_POINT as u64;
    let ray = |origin, direction, hits: &mut Vec<Crossing>, found: &mut Found| {
        view::look(rays, origin, direction, hits);
        found.rays += 1;
        found.seen += u64::from(!hits.is_empty());
        found.missed += u64::from(hits.iter().any(|hit| unseen.holds(seen, hit)));
        hits.iter().for_each(|hit| seen.mark(hit));
    };
    let outside = Batch::new(rays.half_size(), OUTSIDE_DIRECTIONS, batch_rays, SEED, index);
    let outside = outside.grids.par_iter().map_init(Vec::new, |hits, grid| {
        let mut found = Found::default();
        for point in grid.points() {
            // From outside the unit ball that holds the scene.
            for direction in [grid.direction, -grid.direction] {
                let origin = point - direction * (point.dot(direction) + 1.01);
                ray(origin, direction, hits, &mut found);
            }
        }
        progress.advance(found.rays);
        found
    });
    let outside = outside.reduce(Found::default, Found::plus);
    let inside = (index * candidates..(index + 1) * candidates).into_par_iter().map_init(
        Vec::new,
        |hits, candidate| {
            let mut found = Found::default();
            let origin = regions.candidate(candidate);
            if regions.is_clear(origin) {
                found.points = 1;
                let mut random = Random::new(SEED ^ 1, candidate);
                for direction in half_sphere(RAYS_PER_POINT / 2, &mut random) {
                    ray(origin, direction, hits, &mut found);
                    ray(origin, -direction, hits, &mut found);
                }
                progress.advance(found.rays);
            }
            found
        },
    );
    outside.plus(inside.reduce(Found::default, Found::plus))
}
