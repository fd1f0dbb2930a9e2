//! One exact parallel view, for checking what whole-bin sampling stores.

use super::random::Random;
use super::sort_away_from;
use super::walk::{Ancestry, End, Walker};
use crate::bake::rays::RayScene;
use glam::DVec3;

/// Visible levels of all members (document order) for a viewer infinitely far away in `direction`: only lines with
/// exactly that direction are traced, about `lines` of them (at least one), one at a random place in each cell of
/// a grid over the scene's box. 0 is also the level of members that no line meets.
///
/// A bin of a baked table holds the maximum of such views over its whole cell, so it is never below the view from
/// a direction of the bin, and is above it wherever an object peeps out elsewhere in the cell.
///
/// `direction` must be finite and not zero; it need not have unit length. The same arguments give the same levels.
pub fn levels_from(scene: &RayScene<'_>, ancestry: &Ancestry, direction: DVec3, lines: usize) -> Vec<u8> {
    const SEED: u64 = 0x5041_5241;
    let along = -direction.normalize();
    // The coordinate axis most across the direction gives the grid's first axis.
    let axis = DVec3::AXES.into_iter().min_by(|a, b| a.dot(along).abs().total_cmp(&b.dot(along).abs()));
    let u = along.cross(axis.unwrap_or(DVec3::X)).normalize();
    let v = along.cross(u);
    let half = [u, v].map(|axis| axis.abs().dot(scene.half_size()).max(1e-9));
    let cells = |along: f64, across: f64| {
        let cells = (lines.max(1) as f64 * along / across).sqrt().ceil();
        (cells as usize).clamp(1, lines.max(1))
    };
    let [columns, rows] = [cells(half[0], half[1]), cells(half[1], half[0])];
    let mut random = Random::new(SEED, 0);
    let mut walker = Walker::new(ancestry);
    let mut hits = Vec::new();
    let mut levels = vec![0u8; ancestry.members()];
    for row in 0..rows {
        for column in 0..columns {
            let (x, y) = random.pair();
            let place = |cell: usize, at: f64, cells: usize, half: f64| {
                (2.0 * (cell as f64 + at) / cells as f64 - 1.0) * half
            };
            let point = u * place(column, x, columns, half[0]) + v * place(row, y, rows, half[1]);
            scene.line(point, along, &mut hits);
            sort_away_from(End::Start, &mut hits);
            walker.walk(ancestry, &hits, End::Start, |member, level| {
                let known = &mut levels[member as usize];
                *known = (*known).max(level);
            });
        }
    }
    levels
}
