//! Visible projected areas, counted in rays: what importance is made of.

use super::walk::Ancestry;
use std::sync::atomic::{AtomicU32, Ordering};

/// Rays by (member, level, direction): how many saw the member at exactly that level.
#[derive(Debug)]
pub(crate) struct Areas {
    directions: usize,
    /// First row of each member; a member has one row per ancestor.
    offsets: Vec<u32>,
    counts: Vec<AtomicU32>,
    /// Lines per unit area, summed over the grids of each direction bin.
    density: Vec<f64>,
}

impl Areas {
    pub(crate) fn new(ancestry: &Ancestry, directions: usize) -> Self {
        let mut offsets = Vec::with_capacity(ancestry.members() + 1);
        let mut rows = 0u32;
        for member in 0..ancestry.members() as u32 {
            offsets.push(rows);
            rows += u32::from(ancestry.depth(member));
        }
        offsets.push(rows);
        let mut counts = Vec::new();
        counts.resize_with(rows as usize * directions, AtomicU32::default);
        Self { directions, offsets, counts, density: vec![0.0; directions] }
    }

    #[inline(always)]
    pub(crate) fn count(&self, member: u32, level: u8, direction: usize) {
        if level > 0 {
            let row = self.offsets[member as usize] as usize + usize::from(level) - 1;
            self.counts[row * self.directions + direction].fetch_add(1, Ordering::Relaxed);
        }
    }

    /// Adds a finished grid's lines to a bin. Called in order of the grids, so sums are repeatable.
    pub(crate) fn add_density(&mut self, direction: usize, density: f64) {
        self.density[direction] += density;
    }

    /// Largest mean visible area over all directions (unit frame squared), for heights 1 to the member's depth:
    /// the area seen from outside the ancestor at that height. Never grows with height.
    pub(crate) fn largest(&self, member: u32) -> Vec<f64> {
        let rows = self.offsets[member as usize] as usize..self.offsets[member as usize + 1] as usize;
        let mut areas = vec![0.0; rows.len()];
        for direction in 0..self.directions {
            if self.density[direction] == 0.0 {
                continue;
            }
            // Seen at height h: all rays with that level or a higher one.
            let mut seen = 0u64;
            for (height, row) in rows.clone().enumerate().rev() {
                seen += u64::from(self.counts[row * self.directions + direction].load(Ordering::Relaxed));
                let area = seen as f64 / self.density[direction];
                if area > areas[height] {
                    areas[height] = area;
                }
            }
        }
        areas
    }
}
