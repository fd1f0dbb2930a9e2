//! Sampling whole direction bins: lines in many directions, each counted for the bin of its own direction.
//!
//! A bin's level is the maximum over its whole spherical cell, so what is stored can be trusted for every
//! direction of the bin, not only for its centre. Every line is a ray from both of its ends.

mod areas;
mod levels;
pub(crate) mod lines;
mod parallel;
pub(crate) mod random;
mod walk;

#[cfg(test)]
mod oracle;
#[cfg(test)]
mod tests;

pub(crate) use areas::Areas;
pub use levels::Levels;
pub use parallel::levels_from;
pub use walk::{Ancestry, MAX_DEPTH};

use crate::bake::rays::{LineHit, RayScene};
use levels::SharedLevels;
use lines::{Batch, Grid};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use svs_runtime::directions::DirectionSet;
use walk::{End, Walker};

/// Most sub-directions per bin in one batch: more would only make grids small and rays incoherent.
const SUB_DIRECTIONS: usize = 16;

/// Lines of one direction, as far as that leaves two sub-directions per bin and batch. Neighbouring lines meet
/// the same triangles while these are still in the processor's cache: with grids of 80 x 80 lines a line costs
/// two to three times as much.
const LINES_PER_DIRECTION: u64 = 1 << 15;

/// A hierarchy being sampled.
#[derive(Clone, Debug)]
pub struct Target {
    /// Its parents.
    pub ancestry: Ancestry,
    /// What has been seen so far.
    pub levels: Levels,
}

/// What a batch found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Found {
    /// Rays traced (two per line).
    pub rays: u64,
    /// Surfaces crossed by them, which is what they cost.
    pub crossings: u64,
    /// Rays that saw an object from outside everything.
    pub seen: u64,
    /// Those whose object the table did not yet list for their bin: an estimate of what the table, as it was
    /// before this batch, misses in a parallel view.
    pub missed: u64,
}

impl Found {
    /// Missing pixels per million covered ones, of the table before the batch.
    pub fn missing_ppm(&self) -> f64 {
        if self.seen == 0 { 0.0 } else { self.missed as f64 / self.seen as f64 * 1e6 }
    }
}

impl Target {
    /// Nothing seen yet.
    pub fn new(ancestry: Ancestry, directions: usize) -> Self {
        let levels = Levels::new(ancestry.members(), directions);
        Self { ancestry, levels }
    }
}

/// Which members any line has met, seen or not. What none has met may be too small for the lines, and is not to be
/// taken for hidden.
#[derive(Debug)]
pub(crate) struct Met(Vec<AtomicBool>);

impl Met {
    pub(crate) fn new(members: usize) -> Self {
        Self((0..members).map(|_| AtomicBool::new(false)).collect())
    }

    #[inline(always)]
    fn mark(&self, member: u32) {
        let flag = &self.0[member as usize];
        if !flag.load(Ordering::Relaxed) {
            flag.store(true, Ordering::Relaxed);
        }
    }

    pub(crate) fn get(&self, member: u32) -> bool {
        self.0[member as usize].load(Ordering::Relaxed)
    }
}

/// What a batch tells besides levels.
pub(crate) struct Observer<'a> {
    /// Collects visible areas for the first target.
    pub areas: Option<&'a mut Areas>,
    /// Members met by any line.
    pub met: &'a Met,
    /// Called with numbers of rays done, from several threads.
    pub advance: &'a (dyn Fn(u64) + Sync),
}

/// Traces one batch of about `rays` rays and raises the levels of all targets by what they see. The same batch
/// `index` always traces the same rays.
pub(crate) fn sample_batch(
    scene: &RayScene<'_>,
    directions: &DirectionSet,
    targets: &mut [Target],
    observer: Observer<'_>,
    rays: u64,
    index: u64,
) -> Vec<Found> {
    let Observer { mut areas, met, advance } = observer;
    let batch = batch(scene, directions, rays, index);
    let shared: Vec<SharedLevels> = targets.iter().map(|t| SharedLevels::from_levels(&t.levels)).collect();
    let bins = |grid: &Grid| {
        [directions.nearest((-grid.direction).as_vec3()), directions.nearest(grid.direction.as_vec3())]
    };
    if let Some(areas) = areas.as_deref_mut() {
        for grid in &batch.grids {
            for bin in bins(grid) {
                areas.add_density(bin, grid.density());
            }
        }
    }
    let areas = areas.as_deref();

    let found = batch
        .grids
        .par_iter()
        .map_init(
            || (Vec::new(), targets.iter().map(|t| Walker::new(&t.ancestry)).collect::<Vec<_>>()),
            |(hits, walkers), grid| {
                let mut found = vec![Found::default(); targets.len()];
                let [from_start, from_finish] = bins(grid);
                let (mut rays, mut crossings) = (0, 0);
                for point in grid.points() {
                    rays += 2;
                    scene.line(point, grid.direction, hits);
                    crossings += hits.len() as u64;
                    for hit in hits.iter() {
                        met.mark(hit.member);
                    }
                    if hits.is_empty() {
                        continue;
                    }
                    for (end, bin) in [(End::Start, from_start), (End::Finish, from_finish)] {
                        sort_away_from(end, hits);
                        for (index, target) in targets.iter().enumerate() {
                            let record = Record {
                                target,
                                shared: &shared[index],
                                areas: areas.filter(|_| index == 0),
                                bin,
                            };
                            record.ray(&mut walkers[index], hits, end, &mut found[index]);
                        }
                    }
                }
                advance(rays);
                found[0].crossings = crossings;
                found
            },
        )
        .reduce(
            || vec![Found::default(); targets.len()],
            |a, b| a.iter().zip(&b).map(|(a, b)| a.plus(b)).collect(),
        );
    for (target, shared) in targets.iter_mut().zip(shared) {
        target.levels = shared.into_levels();
    }
    let crossings = found.first().map_or(0, |f| f.crossings);
    found.into_iter().map(|f| Found { rays: batch.rays, crossings, ..f }).collect()
}

/// The lines of batch `index`.
fn batch(scene: &RayScene<'_>, directions: &DirectionSet, rays: u64, index: u64) -> Batch {
    const SEED: u64 = 0x5356_5300;
    // Each line counts for two bins.
    let lines = usize::try_from(rays / 2 / LINES_PER_DIRECTION).unwrap_or(usize::MAX);
    let lines = lines.clamp(directions.len(), directions.len() * SUB_DIRECTIONS / 2);
    Batch::new(scene.half_size(), lines, rays, SEED, index)
}

/// Where the observations of a ray go.
struct Record<'a> {
    target: &'a Target,
    shared: &'a SharedLevels,
    areas: Option<&'a Areas>,
    bin: usize,
}

impl Record<'_> {
    #[inline(always)]
    fn ray(&self, walker: &mut Walker, hits: &[LineHit], end: End, found: &mut Found) {
        let ancestry = &self.target.ancestry;
        walker.walk(ancestry, hits, end, |member, level| {
            if level == ancestry.depth(member) {
                found.seen += 1;
                // Against the table from before the batch: these rays test it, then improve it.
                found.missed += u64::from(self.target.levels.get(member, self.bin) < level);
            }
            self.shared.raise(member, self.bin, level);
            if let Some(areas) = self.areas {
                areas.count(member, level, self.bin);
            }
        });
    }
}

impl Found {
    fn plus(&self, other: &Self) -> Self {
        Self {
            rays: self.rays + other.rays,
            crossings: self.crossings + other.crossings,
            seen: self.seen + other.seen,
            missed: self.missed + other.missed,
        }
    }
}

/// Orders hits away from the viewer; ties by member, so that results do not depend on the traversal.
fn sort_away_from(end: End, hits: &mut [LineHit]) {
    match end {
        End::Start => hits.sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then(a.member.cmp(&b.member))),
        End::Finish => hits.reverse(),
    }
}
