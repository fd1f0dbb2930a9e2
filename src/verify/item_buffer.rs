//! The item buffer: which object each pixel of an image shows, by one ray through each pixel's centre.

use super::view::View;
use crate::bake::rays::{Hit, RayScene};
use glam::DVec3;
use rayon::prelude::*;

/// Rays start on a ball of this many half diagonals, so that a far camera costs no precision.
const NEAR_SCENE: f64 = 1.01;

/// Exact visible set (EVS) of an image: every member that at least one pixel shows, ascending, and the number of
/// pixels that do.
///
/// A pixel shows the nearest opaque surface and every transparent one in front of it, so with transparent objects
/// the counts can add up to more than the image has pixels.
pub type VisibleSet = Vec<(u32, u32)>;

/// Renders the members of `scene` as `view` (world space) sees them. The result does not depend on the number of
/// threads.
pub fn visible_set(scene: &RayScene<'_>, view: &View) -> VisibleSet {
    let eye = (view.eye - scene.center()) / scene.radius();
    let rows: Vec<VisibleSet> = (0..view.height)
        .into_par_iter()
        .map_init(Row::default, |row, y| {
            row.trace(scene, view, eye, y);
            row.counts()
        })
        .collect();
    let mut all: VisibleSet = rows.into_iter().flatten().collect();
    all.sort_unstable_by_key(|&(member, _)| member);
    all.dedup_by(|next, first| {
        let same = next.0 == first.0;
        if same {
            first.1 += next.1;
        }
        same
    });
    all
}

/// Scratch space of one thread.
#[derive(Default)]
struct Row {
    seen: Vec<u32>,
    transparent: Vec<Hit>,
}

impl Row {
    fn trace(&mut self, scene: &RayScene<'_>, view: &View, eye: DVec3, y: u32) {
        self.seen.clear();
        for x in 0..view.width {
            let direction = view.ray(x, y);
            let Some(origin) = approach(eye, direction) else { continue };
            let nearest = scene.view(origin, direction, &mut self.transparent);
            self.seen.extend(nearest.iter().chain(&self.transparent).map(|hit| hit.member));
        }
    }

    fn counts(&mut self) -> VisibleSet {
        self.seen.sort_unstable();
        self.seen.chunk_by(|a, b| a == b).map(|run| (run[0], run.len() as u32)).collect()
    }
}

/// Where a ray enters the ball around the scene (the eye itself when it is in there); `None` if it misses.
fn approach(eye: DVec3, direction: DVec3) -> Option<DVec3> {
    let squared = eye.length_squared();
    if squared <= NEAR_SCENE * NEAR_SCENE {
        return Some(eye);
    }
    let along = -eye.dot(direction);
    let nearest = eye + direction * along;
    let half_chord = NEAR_SCENE * NEAR_SCENE - nearest.length_squared();
    (along > 0.0 && half_chord > 0.0).then(|| nearest - direction * half_chord.sqrt())
}
