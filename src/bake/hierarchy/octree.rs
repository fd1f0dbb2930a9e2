//! Loose octree with factor 2: Thatcher Ulrich, Loose Octrees, Game Programming Gems, 2000, chapter 4.11.
//!
//! A cell with more than eight items passes each item whose longest side is at most half its own to the child cell
//! that holds the item's centre; larger items stay.

use super::draft::{Child, Draft};
use crate::bake::tree::Aabb;
use glam::DVec3;
use std::ops::Range;

/// A cell with more items than this is split.
const CELL_ITEMS: usize = 8;

/// Cells are halved this often before the rest gets a root cell of its own.
const MAX_HALVINGS: u32 = 20;

/// Centres this close below a splitting plane (part of the root cell's side) count as above it, and sizes this close
/// above a limit as within it: objects on a grid sit exactly there, and would else be sorted by rounding errors.
const TOLERANCE: f64 = 1.0 / (1u64 << 28) as f64;

/// Cells to split: a range of `slots`, all items of which lie in this cell.
struct Cell {
    node: u32,
    slots: Range<usize>,
    /// How often the root cell was halved to get this one.
    halvings: u32,
    /// Side of the root cell, metres.
    root_side: f64,
}

/// An item's place in its root cell.
#[derive(Clone, Copy, Default)]
struct Place {
    /// Three bits (octant z, y, x) per halving, the first halving in the highest bits.
    path: u64,
    /// Cells of more halvings than this are too small for it.
    halvings: u32,
}

/// Splits `items`, whose boxes are usable, and returns what hangs on the root cell; the other cells are added to the
/// draft. Empty cells are not made; cells with one child are (they are removed when the draft is finished).
pub(super) fn subdivide(draft: &mut Draft, items: &[(Aabb, Child)]) -> Vec<Child> {
    let mut slots: Vec<u32> = (0..items.len() as u32).collect();
    let mut places = vec![Place::default(); items.len()];
    let mut scratch = Vec::new();
    let root = draft.add(Vec::new());
    let all = Cell { node: root, slots: 0..slots.len(), halvings: MAX_HALVINGS, root_side: f64::INFINITY };
    let mut cells = vec![all];
    while let Some(mut cell) = cells.pop() {
        if cell.slots.len() > CELL_ITEMS && cell.halvings == MAX_HALVINGS {
            let side = place(&slots[cell.slots.clone()], items, &mut places);
            // The finest cell is split on if its content is at most half as wide: this ends, because sides halve.
            let finest = cell.root_side * 0.5f64.powi(MAX_HALVINGS as i32);
            if side > 0.0 && side <= 0.5 * finest {
                cell.root_side = side;
                cell.halvings = 0;
            }
        }
        if cell.slots.len() <= CELL_ITEMS || cell.halvings == MAX_HALVINGS {
            for &slot in &slots[cell.slots] {
                draft.push(cell.node, items[slot as usize].1);
            }
            continue;
        }
        // Stable sort into what stays and the eight octants.
        let bucket = |slot: u32| {
            let place = places[slot as usize];
            let shift = 3 * (MAX_HALVINGS - 1 - cell.halvings);
            if place.halvings <= cell.halvings { 0 } else { 1 + (place.path >> shift & 7) as usize }
        };
        scratch.clear();
        scratch.extend_from_slice(&slots[cell.slots.clone()]);
        let mut ends = [0; 9];
        for &slot in &scratch {
            ends[bucket(slot)] += 1;
        }
        let mut starts = [cell.slots.start; 9];
        for i in 1..9 {
            starts[i] = starts[i - 1] + ends[i - 1];
        }
        ends = starts;
        for &slot in &scratch {
            let end = &mut ends[bucket(slot)];
            slots[*end] = slot;
            *end += 1;
        }
        for &slot in &slots[starts[0]..ends[0]] {
            draft.push(cell.node, items[slot as usize].1);
        }
        for octant in (1..9).filter(|&octant| ends[octant] > starts[octant]) {
            let node = draft.add(Vec::new());
            draft.push(cell.node, Child::Node(node));
            let slots = starts[octant]..ends[octant];
            cells.push(Cell { node, slots, halvings: cell.halvings + 1, root_side: cell.root_side });
        }
    }
    vec![Child::Node(root)]
}

/// Places the items in the smallest cube about their boxes; returns its side.
fn place(slots: &[u32], items: &[(Aabb, Child)], places: &mut [Place]) -> f64 {
    let bounds = slots.iter().fold(Aabb::EMPTY, |all, &slot| all.union(&items[slot as usize].0));
    let center = bounds.center();
    let side = (bounds.max - bounds.min).max_element();
    let cells = (1u64 << MAX_HALVINGS) as f64;
    for &slot in slots {
        let item = &items[slot as usize].0;
        let relative = (item.center() - center) / side + 0.5 + TOLERANCE;
        let cell = (relative * cells).floor().clamp(DVec3::ZERO, DVec3::splat(cells - 1.0));
        let size = (item.max - item.min).max_element() / side;
        let mut halvings = 0;
        while halvings < MAX_HALVINGS && size <= 0.5f64.powi(halvings as i32 + 1) * (1.0 + TOLERANCE) {
            halvings += 1;
        }
        let spread = |value: f64, axis: u32| {
            let value = value as u64;
            (0..MAX_HALVINGS).fold(0, |path, bit| path | (value >> bit & 1) << (3 * bit + axis))
        };
        let path = spread(cell.x, 0) | spread(cell.y, 1) | spread(cell.z, 2);
        places[slot as usize] = Place { path, halvings };
    }
    side
}
