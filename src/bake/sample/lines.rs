//! Where the lines of a batch run: parallel, jittered grids over the scene's box, one per direction.

use super::random::{Random, half_sphere};
use glam::DVec3;

/// One direction's lines: a grid over the shadow of the scene's box.
#[derive(Clone, Debug)]
pub(crate) struct Grid {
    /// Unit vector along the lines.
    pub direction: DVec3,
    axes: [DVec3; 2],
    half_extent: [f64; 2],
    cells: [usize; 2],
    stream: u64,
    seed: u64,
}

/// The grids of one batch.
#[derive(Clone, Debug)]
pub(crate) struct Batch {
    pub grids: Vec<Grid>,
    /// Rays: every line counts twice, once from each end.
    pub rays: u64,
}

impl Batch {
    /// `directions` grids with about `rays` rays in all, at one density (rays per area) for all directions.
    /// `half_size` is half the size of the scene's box in the unit frame.
    pub(crate) fn new(half_size: DVec3, directions: usize, rays: u64, seed: u64, index: u64) -> Self {
        let mut random = Random::new(seed, index);
        let mut grids: Vec<Grid> = half_sphere(directions.max(1), &mut random)
            .into_iter()
            .enumerate()
            .map(|(i, direction)| Grid::over_box(direction, half_size, seed, index << 32 | i as u64))
            .collect();
        let area: f64 = grids.iter().map(Grid::area).sum();
        let density = rays as f64 / 2.0 / area.max(f64::MIN_POSITIVE);
        for grid in &mut grids {
            grid.subdivide(density);
        }
        let rays = grids.iter().map(|g| 2 * (g.cells[0] * g.cells[1]) as u64).sum();
        Self { grids, rays }
    }
}

impl Grid {
    fn over_box(direction: DVec3, half_size: DVec3, seed: u64, stream: u64) -> Self {
        // A side of the box as seen along the direction makes a tight rectangle; take the best of the three.
        let mut best: Option<(f64, [DVec3; 2], [f64; 2])> = None;
        for axis in DVec3::AXES {
            let across = axis - direction * direction.dot(axis);
            if across.length_squared() < 1e-6 {
                continue;
            }
            let u = across / across.length();
            let v = direction.cross(u);
            let extent = [(u.abs()).dot(half_size), (v.abs()).dot(half_size)];
            let area = extent[0] * extent[1];
            if best.as_ref().is_none_or(|(smallest, ..)| area < *smallest) {
                best = Some((area, [u, v], extent));
            }
        }
        // A unit vector is nearly parallel to one axis at most.
        let (_, axes, half_extent) = best.unwrap_or((1.0, [DVec3::X, DVec3::Y], [1.0, 1.0]));
        Self { direction, axes, half_extent: half_extent.map(|e| e.max(1e-9)), cells: [1, 1], stream, seed }
    }

    fn area(&self) -> f64 {
        4.0 * self.half_extent[0] * self.half_extent[1]
    }

    fn subdivide(&mut self, density: f64) {
        // Keep the number of cells right for very flat rectangles, too.
        let wanted = (self.area() * density).max(1.0);
        let columns = (2.0 * self.half_extent[0] * density.sqrt()).clamp(1.0, wanted).ceil();
        let rows = (wanted / columns).clamp(1.0, wanted).ceil();
        self.cells = [columns as usize, rows as usize];
    }

    /// Lines per unit of area, in the unit frame.
    pub(crate) fn density(&self) -> f64 {
        (self.cells[0] * self.cells[1]) as f64 / self.area()
    }

    /// A point of every line, near the scene's centre: one at random in each cell, row by row so that
    /// neighbours in time are neighbours in space.
    pub(crate) fn points(&self) -> impl Iterator<Item = DVec3> + '_ {
        let [columns, rows] = self.cells;
        let mut random = Random::new(self.seed, self.stream);
        let step = [2.0 * self.half_extent[0] / columns as f64, 2.0 * self.half_extent[1] / rows as f64];
        (0..rows).flat_map(move |row| (0..columns).map(move |column| (column, row))).map(move |(column, row)| {
            let (x, y) = random.pair();
            let u = (column as f64 + x) * step[0] - self.half_extent[0];
            let v = (row as f64 + y) * step[1] - self.half_extent[1];
            self.axes[0] * u + self.axes[1] * v
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_batch_has_about_the_rays_asked_for() {
        for half_size in [DVec3::splat(0.577), DVec3::new(0.9, 0.05, 0.4), DVec3::new(1.0, 0.0, 0.0)] {
            let batch = Batch::new(half_size, 100, 1_000_000, 3, 0);
            let ratio = batch.rays as f64 / 1e6;
            assert!((0.95..1.3).contains(&ratio), "{half_size}: {ratio}");
        }
    }

    #[test]
    fn grids_cover_every_corner_of_the_box() {
        let half_size = DVec3::new(0.8, 0.2, 0.56);
        for grid in Batch::new(half_size, 50, 10_000, 9, 1).grids {
            for corner in 0..8 {
                let sign = |bit: usize| if corner & bit == 0 { -1.0 } else { 1.0 };
                let corner = half_size * DVec3::new(sign(1), sign(2), sign(4));
                assert!(corner.dot(grid.axes[0]).abs() <= grid.half_extent[0] + 1e-12);
                assert!(corner.dot(grid.axes[1]).abs() <= grid.half_extent[1] + 1e-12);
            }
            let points: Vec<DVec3> = grid.points().collect();
            assert_eq!(points.len(), grid.cells[0] * grid.cells[1]);
            assert!(points.iter().all(|p| p.dot(grid.direction).abs() < 1e-12));
        }
    }
}
