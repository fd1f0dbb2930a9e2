//! Which objects to draw within a budget: a 0-1 knapsack, whose value is what may be seen and whose weight is what it
//! costs.
//!
//! Objects are taken in order of value per weight, as published (Eikel, *Spherical Visibility Sampling*, 2013), but an
//! object that does not fit does not end the search: smaller ones after it still go in. Where the result is clearly below
//! the bound of the relaxed problem, the most valuable object left out is tried as a first choice, and the better of
//! the two sets wins. The winner is worth at least half of the best possible set (the classic bound of the greedy set or
//! the best single object), and in practice nearly all of it: see the tests.
//!
//! There is no full sort: the prefix that fits is found by bisection with a linear-time selection, and so is the next one
//! among what still fits. Ties are broken by weight and place, so that the result does not depend on the method.

use crate::budget::{Capacity, Load};
use std::cmp::Ordering;

/// One object to choose or not.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Item {
    /// What items are taken by, the lowest first: the bits of the value per weight, then the triangles, all inverted. So of
    /// equally worthy items the largest comes first, for small ones fill gaps.
    rank: u64,
    value: f32,
    /// Place in the list of candidates.
    index: u32,
    /// It was drawn in the last frame.
    again: bool,
}

/// Memory of the selection, kept from frame to frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct Selector {
    items: Vec<Item>,
    /// Per candidate: bit 0 for the greedy set, bit 1 for the set with a forced first choice.
    taken: Vec<u8>,
    winner: u8,
    /// Part of the budget that is not filled up with what was not drawn in the last frame.
    reserve: f64,
}

/// The second set is tried if the first is worth less than this share of the bound.
const GOOD_ENOUGH: f64 = 0.99;

/// See [`Selector::reserve`]: room for the sizes of objects to change a little without pushing others out.
const RESERVE: f64 = 1.0 / 64.0;

/// Prefixes that are looked for by selection before the rest is sorted.
const ROUNDS: usize = 12;

const GREEDY: u8 = 1;
const FORCED: u8 = 2;

impl Item {
    /// Value per weight.
    fn worth(&self) -> f32 {
        f32::from_bits((!self.rank >> 32) as u32)
    }

    fn triangles(&self) -> u32 {
        !self.rank as u32
    }
}

impl Selector {
    /// Forgets all candidates. `steady`: what was drawn in the last frame is to stay.
    pub(crate) fn clear(&mut self, steady: bool) {
        self.items.clear();
        self.reserve = if steady { RESERVE } else { 0.0 };
    }

    /// The next candidate: its value (at least 0), its triangles, and whether it was drawn in the last frame.
    pub(crate) fn push(&mut self, value: f64, triangles: u32, again: bool, capacity: &Capacity<'_>) {
        let value = if value > 0.0 { value.min(f64::from(f32::MAX)) } else { 0.0 };
        let weight = capacity.weight(triangles);
        // What costs nothing is worth most, whatever it shows.
        let worth =
            if weight > 0.0 { (value / weight).min(f64::from(f32::MAX)) as f32 } else { f32::INFINITY };
        let index = self.items.len() as u32;
        // The bits of numbers that are not negative are in the numbers' order.
        let rank = !(u64::from(worth.to_bits()) << 32 | u64::from(triangles));
        self.items.push(Item { rank, value: value as f32, index, again });
    }

    /// Chooses among the candidates.
    pub(crate) fn choose(&mut self, capacity: &Capacity<'_>) {
        self.choose_after(Load::default(), capacity);
    }

    /// Chooses among the candidates where so much is drawn already.
    pub(crate) fn choose_after(&mut self, spent: Load, capacity: &Capacity<'_>) {
        self.start();
        let whole = load(&self.items, spent);
        if capacity.fits(whole) {
            self.taken.fill(GREEDY);
            return;
        }
        if !capacity.fits(spent) {
            return;
        }
        let taken = &mut self.taken;
        let take = |item: &Item| taken[item.index as usize] |= GREEDY;
        let greedy = fill(&mut self.items, capacity, spent, Some(self.reserve), take);
        if greedy.value >= greedy.bound * GOOD_ENOUGH {
            return;
        }
        let left_out = |item: &&Item| self.taken[item.index as usize] == 0;
        let fits_alone = |item: &&Item| capacity.fits(spent.plus(item.triangles()));
        let Some(first) = self
            .items
            .iter()
            .filter(left_out)
            .filter(fits_alone)
            .copied()
            .max_by(|a, b| a.value.total_cmp(&b.value).then(by_worth(b, a)))
        else {
            return;
        };
        let Some(at) = self.items.iter().position(|item| item.index == first.index) else { return };
        self.items.swap(0, at);
        let taken = &mut self.taken;
        taken[first.index as usize] |= FORCED;
        let take = |item: &Item| taken[item.index as usize] |= FORCED;
        let load = spent.plus(first.triangles());
        let forced = fill(&mut self.items[1..], capacity, load, Some(self.reserve), take);
        if f64::from(first.value) + forced.value > greedy.value {
            self.winner = FORCED;
        }
    }

    /// Chooses as published: up to the first object that does not fit.
    pub(crate) fn choose_until_misfit(&mut self, capacity: &Capacity<'_>) {
        self.start();
        if capacity.fits(Load::default()) {
            let taken = &mut self.taken;
            let take = |item: &Item| taken[item.index as usize] |= GREEDY;
            fill(&mut self.items, capacity, Load::default(), None, take);
        }
    }

    /// Whether candidate `index` was chosen.
    pub(crate) fn is_chosen(&self, index: usize) -> bool {
        self.taken[index] & self.winner != 0
    }

    fn start(&mut self) {
        self.winner = GREEDY;
        self.taken.clear();
        self.taken.resize(self.items.len(), 0);
    }
}

/// What [`fill`] has taken.
struct Filled {
    value: f64,
    /// No set is worth more.
    bound: f64,
}

/// Takes items in order of worth as long as they fit and then, if there is a `reserve`, what still fits: first of what was
/// drawn in the last frame, then of the rest as long as the reserve is left.
fn fill(
    items: &mut [Item],
    capacity: &Capacity<'_>,
    mut spent: Load,
    reserve: Option<f64>,
    mut take: impl FnMut(&Item),
) -> Filled {
    let end = prefix(items, capacity, &mut spent);
    let (taken, rest) = items.split_at_mut(end);
    let mut value: f64 = taken.iter().map(|item| f64::from(item.value)).sum();
    taken.iter().for_each(&mut take);
    let bound = value + rest.first().map_or(0.0, |misfit| f64::from(misfit.worth()) * capacity.left(spent));
    if let Some(reserve) = reserve {
        let again = keep(rest, |item| item.again);
        let (again, newcomers) = rest.split_at_mut(again);
        for (items, capacity) in [(again, *capacity), (newcomers, capacity.less(reserve))] {
            value += fill_up(items, &capacity, &mut spent, &mut take);
        }
    }
    Filled { value, bound }
}

/// Takes items in order of worth, each if it still fits after those before it, and returns their value.
fn fill_up(
    mut items: &mut [Item],
    capacity: &Capacity<'_>,
    spent: &mut Load,
    mut take: impl FnMut(&Item),
) -> f64 {
    let mut value = 0.0;
    for _ in 0..ROUNDS {
        let kept = keep(items, |item| capacity.fits(spent.plus(item.triangles())));
        let end = prefix(&mut items[..kept], capacity, spent);
        let (taken, rest) = items[..kept].split_at_mut(end);
        value += taken.iter().map(|item| f64::from(item.value)).sum::<f64>();
        taken.iter().for_each(&mut take);
        if rest.is_empty() {
            return value;
        }
        items = rest;
    }
    // Rare: sizes so mixed that each run is short.
    items.sort_unstable_by(by_worth);
    for item in items.iter() {
        let with = spent.plus(item.triangles());
        if capacity.fits(with) {
            *spent = with;
            value += f64::from(item.value);
            take(item);
        }
    }
    value
}

/// Brings the longest run of the worthiest items that fits to the front, the first misfit behind it, and returns its
/// length; `spent` then includes the run. Linear: half of what is left is looked at each time.
fn prefix(items: &mut [Item], capacity: &Capacity<'_>, spent: &mut Load) -> usize {
    let (mut low, mut high) = (0, items.len());
    while low < high {
        let middle = low + (high - low) / 2;
        items[low..high].select_nth_unstable_by(middle - low, by_worth);
        let with = load(&items[low..=middle], *spent);
        if capacity.fits(with) {
            (*spent, low) = (with, middle + 1);
        } else {
            high = middle;
        }
    }
    low
}

/// Moves the items that pass to the front and returns how many there are.
fn keep(items: &mut [Item], passes: impl Fn(&Item) -> bool) -> usize {
    let mut kept = 0;
    for at in 0..items.len() {
        if passes(&items[at]) {
            items.swap(kept, at);
            kept += 1;
        }
    }
    kept
}

/// `before` and all the items.
fn load(items: &[Item], before: Load) -> Load {
    let triangles: u64 = items.iter().map(|item| u64::from(item.triangles())).sum();
    Load { triangles: before.triangles + triangles, draws: before.draws + items.len() as u64 }
}

/// The worthiest first.
fn by_worth(a: &Item, b: &Item) -> Ordering {
    (a.rank, a.index).cmp(&(b.rank, b.index))
}

#[cfg(test)]
mod tests;
