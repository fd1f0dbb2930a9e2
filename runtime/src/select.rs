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
    /// Value per weight.
    worth: f32,
    value: f32,
    triangles: u32,
    /// Place in the list of candidates.
    index: u32,
}

/// Memory of the selection, kept from frame to frame.
#[derive(Clone, Debug, Default)]
pub(crate) struct Selector {
    items: Vec<Item>,
    /// Per candidate: bit 0 for the greedy set, bit 1 for the set with a forced first choice.
    taken: Vec<u8>,
    winner: u8,
}

/// The second set is tried if the first is worth less than this share of the bound.
const GOOD_ENOUGH: f64 = 0.99;

/// Prefixes that are looked for by selection before the rest is sorted.
const ROUNDS: usize = 12;

const GREEDY: u8 = 1;
const FORCED: u8 = 2;

impl Selector {
    pub(crate) fn clear(&mut self) {
        self.items.clear();
    }

    /// The next candidate: its value (at least 0) and its triangles.
    pub(crate) fn push(&mut self, value: f64, triangles: u32, capacity: &Capacity<'_>) {
        let value = if value > 0.0 { value.min(f64::from(f32::MAX)) } else { 0.0 };
        let weight = capacity.weight(triangles);
        // What costs nothing is worth most, whatever it shows.
        let worth =
            if weight > 0.0 { (value / weight).min(f64::from(f32::MAX)) as f32 } else { f32::INFINITY };
        let index = self.items.len() as u32;
        self.items.push(Item { worth, value: value as f32, triangles, index });
    }

    /// Chooses among the candidates.
    pub(crate) fn choose(&mut self, capacity: &Capacity<'_>) {
        self.start();
        let whole = load(&self.items, Load::default());
        if capacity.fits(whole) {
            self.taken.fill(GREEDY);
            return;
        }
        if !capacity.fits(Load::default()) {
            return;
        }
        let taken = &mut self.taken;
        let take = |item: &Item| taken[item.index as usize] |= GREEDY;
        let greedy = fill(&mut self.items, capacity, Load::default(), true, take);
        if greedy.value >= greedy.bound * GOOD_ENOUGH {
            return;
        }
        let left_out = |item: &&Item| self.taken[item.index as usize] == 0;
        let fits_alone = |item: &&Item| capacity.fits(Load::default().plus(item.triangles));
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
        let load = Load::default().plus(first.triangles);
        let forced = fill(&mut self.items[1..], capacity, load, true, take);
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
            fill(&mut self.items, capacity, Load::default(), false, take);
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

/// Takes items in order of worth, each if it still fits after those before it; or, if not `past_misfits`, up to the first
/// that does not.
fn fill(
    mut items: &mut [Item],
    capacity: &Capacity<'_>,
    mut spent: Load,
    past_misfits: bool,
    mut take: impl FnMut(&Item),
) -> Filled {
    let mut value = 0.0;
    let mut bound = None;
    for round in 0.. {
        if round == ROUNDS {
            // Rare: sizes so mixed that each prefix is short.
            items.sort_unstable_by(by_worth);
            for item in items.iter() {
                let with = spent.plus(item.triangles);
                if capacity.fits(with) {
                    spent = with;
                    value += f64::from(item.value);
                    take(item);
                }
            }
            break;
        }
        let end = prefix(items, capacity, &mut spent);
        let (taken, rest) = items.split_at_mut(end);
        for item in taken.iter() {
            value += f64::from(item.value);
            take(item);
        }
        if round == 0 {
            let part = rest.first().map_or(0.0, |misfit| f64::from(misfit.worth) * capacity.left(spent));
            bound = Some(value + part);
        }
        let kept = keep(rest, |item| capacity.fits(spent.plus(item.triangles)));
        if kept == 0 || !past_misfits {
            break;
        }
        items = &mut rest[..kept];
    }
    Filled { value, bound: bound.unwrap_or(value) }
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
    let triangles: u64 = items.iter().map(|item| u64::from(item.triangles)).sum();
    Load { triangles: before.triangles + triangles, draws: before.draws + items.len() as u64 }
}

/// The worthiest first; of equal ones the largest, for small ones fill gaps.
fn by_worth(a: &Item, b: &Item) -> Ordering {
    let worth = b.worth.total_cmp(&a.worth);
    worth.then(b.triangles.cmp(&a.triangles)).then(a.index.cmp(&b.index))
}
