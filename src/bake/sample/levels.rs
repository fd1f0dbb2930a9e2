//! The table that the bake is about: objects x directions, one visible level each.

use rayon::prelude::*;
use std::sync::atomic::{AtomicU8, Ordering};

/// Visible levels of members (document order) for every direction bin.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Levels {
    directions: usize,
    table: Vec<u8>,
}

impl Levels {
    /// Nothing seen yet.
    pub fn new(members: usize, directions: usize) -> Self {
        Self { directions, table: vec![0; members * directions] }
    }

    /// Number of directions.
    pub fn directions(&self) -> usize {
        self.directions
    }

    /// Level of a member for a direction.
    pub fn get(&self, member: u32, direction: usize) -> u8 {
        self.table[member as usize * self.directions + direction]
    }

    /// Levels of a member for all directions.
    pub fn row(&self, member: u32) -> &[u8] {
        let start = member as usize * self.directions;
        &self.table[start..start + self.directions]
    }

    /// Replaces the levels of one member.
    ///
    /// # Panics
    /// If `row` does not have one level per direction.
    pub fn set_row(&mut self, member: u32, row: &[u8]) {
        let start = member as usize * self.directions;
        self.table[start..start + self.directions].copy_from_slice(row);
    }

    /// Replaces each member's levels by `map(member, level)`.
    pub fn remap(&mut self, map: impl Fn(u32, u8) -> u8 + Sync) {
        let directions = self.directions;
        self.table.par_chunks_mut(directions.max(1)).enumerate().for_each(|(member, row)| {
            for level in row {
                *level = map(member as u32, *level);
            }
        });
    }
}

/// The same table while several threads fill it. Maxima commute, so the result does not depend on their order.
#[derive(Debug)]
pub(crate) struct SharedLevels {
    directions: usize,
    table: Vec<AtomicU8>,
}

impl SharedLevels {
    pub(crate) fn from_levels(levels: &Levels) -> Self {
        Self {
            directions: levels.directions,
            table: levels.table.iter().map(|&level| AtomicU8::new(level)).collect(),
        }
    }

    #[inline(always)]
    pub(crate) fn raise(&self, member: u32, direction: usize, level: u8) {
        let cell = &self.table[member as usize * self.directions + direction];
        if cell.load(Ordering::Relaxed) < level {
            cell.fetch_max(level, Ordering::Relaxed);
        }
    }

    pub(crate) fn into_levels(self) -> Levels {
        Levels {
            directions: self.directions,
            table: self.table.into_iter().map(AtomicU8::into_inner).collect(),
        }
    }
}
