//! The best cut for its cost: the one that shows most, less a price for what it costs.
//!
//! For any price, groups and objects decide for themselves, from the innermost outwards, in one pass. The price is searched
//! at which the budget is nearly used up. What does not fit at that price stays as it is, and the rest goes on (Everett,
//! *Generalized Lagrange Multiplier Method for Solving Problems of Optimum Allocation of Resources*, 1963, and for cuts of
//! trees Chou, Lookabaugh and Gray, *Optimal Pruning with Applications to Tree-Structured Source Coding and Modeling*, 1989).

use super::forms::{Before, Choice, Forms, NONE, Target};
use super::history::History;
use crate::budget::{Capacity, Load};

/// Form that is not drawn: an object is dropped, a group is drawn by its parts.
pub(crate) const NOT: u8 = u8::MAX;

/// What must stay as it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Lock {
    /// A group stays as its proxy, or never becomes it.
    group: Option<bool>,
    /// Choices of an object from here on are too costly, counted from the coarsest, plus one; 0: none is.
    from: u8,
}

/// What a cut costs and shows.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Totals {
    pub(crate) load: Load,
    /// Visible pixels, as far as they are shown right.
    pub(crate) value: f64,
    /// The same; what was drawn in the last frame counts more.
    pub(crate) worth: f64,
}

impl Totals {
    /// Adds something drawn.
    pub(crate) fn draw(&mut self, choice: &Choice) {
        self.load = self.load.plus(choice.triangles);
        self.value += choice.value;
        self.worth += choice.worth;
    }

    fn add(&mut self, other: &Totals) {
        self.load.triangles += other.load.triangles;
        self.load.draws += other.load.draws;
        self.value += other.value;
        self.worth += other.worth;
    }
}

/// Memory of the search, kept from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct Hull {
    /// By form: its choice, counted from the coarsest, or [`NOT`].
    pub(crate) picks: Vec<u8>,
    /// Of the cheapest cut known not to fit.
    above: Vec<u8>,
    trial: Vec<u8>,
    locks: Vec<Lock>,
    /// By form: the parts of a group together.
    parts: Vec<Totals>,
    /// By form: a proxy above it is drawn.
    pub(crate) covered: Vec<bool>,
}

/// Passes of one search for the price, at most.
const PASSES: usize = 48;
/// Searches at most: after each, what does not fit is held back.
const ROUNDS: usize = 4;
/// Part of the budget that is not worth another round.
const LEFT: f64 = 1.0 / 64.0;

/// A search.
pub(crate) struct Searching<'a> {
    pub(crate) forms: &'a Forms,
    pub(crate) history: History<'a>,
    pub(crate) capacity: Capacity<'a>,
}

impl Searching<'_> {
    /// Finds the cut.
    pub(crate) fn run(&self, hull: &mut Hull) -> Totals {
        let count = self.forms.list.len();
        hull.locks.clear();
        hull.locks.resize(count, Lock::default());
        hull.parts.clear();
        hull.parts.resize(count, Totals::default());
        for picks in [&mut hull.picks, &mut hull.above, &mut hull.trial] {
            picks.clear();
            picks.resize(count, NOT);
        }
        let mut best = Totals::default();
        if !self.capacity.fits(best.load) {
            return best;
        }
        let whole = self.capacity.left(Load::default());
        let mut price = 0.0;
        for _ in 0..ROUNDS {
            let mut above = self.pass(hull, price);
            while self.capacity.fits(above.load) {
                std::mem::swap(&mut hull.picks, &mut hull.trial);
                best = above;
                if price <= 0.0 {
                    return best;
                }
                price = 0.0;
                above = self.pass(hull, price);
            }
            std::mem::swap(&mut hull.above, &mut hull.trial);
            (best, price) = self.search(hull, best, (above, price));
            if self.capacity.left(best.load) < whole * LEFT || !self.hold_back(hull) {
                break;
            }
            // What is held back hardly changes the price.
            price *= 0.5;
        }
        best
    }

    fn cost(&self, load: Load) -> f64 {
        self.capacity.difference(load.triangles as i64, load.draws as i64)
    }

    /// Between a cut that fits and one that does not, and its price: the dearest that fits of those that are best at some
    /// price, and the price of the next.
    fn search(&self, hull: &mut Hull, mut below: Totals, next: (Totals, f64)) -> (Totals, f64) {
        let (mut above, mut low) = next;
        let mut high = f64::INFINITY;
        for pass in 0..PASSES {
            let (less, more) = (self.cost(below.load), self.cost(above.load));
            let secant = (above.worth - below.worth) / (more - less);
            // Every other time the middle, which cannot get stuck.
            let middle = f64::sqrt(low * high);
            let halve = pass % 2 == 1 && middle > low && middle < high;
            let price = if halve { middle } else { secant };
            let usable = price > 0.0 && price.is_finite();
            if !usable {
                break;
            }
            let found = self.pass(hull, price);
            let gain = (found.worth - price * self.cost(found.load)) - (below.worth - price * less);
            if !halve && gain <= above.worth * 1e-12 {
                break;
            }
            if self.capacity.fits(found.load) {
                (below, high) = (found, price);
                std::mem::swap(&mut hull.picks, &mut hull.trial);
            } else {
                (above, low) = (found, price);
                std::mem::swap(&mut hull.above, &mut hull.trial);
            }
        }
        (below, low)
    }

    /// The best cut at a price, into `trial`. Of equally good ones the cheapest.
    fn pass(&self, hull: &mut Hull, price: f64) -> Totals {
        let mut totals = Totals::default();
        let price_of = |load: Load| price * self.cost(load);
        for (index, form) in self.forms.list.iter().enumerate().rev() {
            let parts = std::mem::take(&mut hull.parts[index]);
            let lock = hull.locks[index];
            let mut best = Totals::default();
            let mut pick = NOT;
            match form.target {
                Target::Slot(_) => {
                    let mut most = 0.0;
                    for (at, choice) in self.forms.choices(form).iter().enumerate() {
                        if lock.from > 0 && at + 1 >= usize::from(lock.from) {
                            break;
                        }
                        let load = Load::default().plus(choice.triangles);
                        let worth = choice.worth - price_of(load);
                        if worth > most {
                            (most, pick) = (worth, at as u8);
                            best = Totals::default();
                            best.draw(choice);
                        }
                    }
                }
                Target::Proxy(_) => {
                    let choice = &self.forms.choices(form)[0];
                    let mut proxy = Totals::default();
                    proxy.draw(choice);
                    best = parts;
                    match form.before {
                        Before::Nothing => {}
                        Before::Proxy => best.worth = self.history.worth(parts.value, choice.value),
                        Before::Parts => proxy.worth = self.history.worth(choice.value, parts.value),
                    }
                    let (own, other) = (proxy.worth - price_of(proxy.load), best.worth - price_of(best.load));
                    let cheaper = self.cost(proxy.load) <= self.cost(best.load);
                    let better = own > other || cheaper && (own == other || form.fine && own > 0.0);
                    if lock.group.unwrap_or(better) {
                        (best, pick) = (proxy, 0);
                    }
                }
            }
            hull.trial[index] = pick;
            match form.parent {
                NONE => totals.add(&best),
                parent => hull.parts[parent as usize].add(&best),
            }
        }
        totals
    }

    /// The first form that is dearer in the next cut stays as it is. False if there is none.
    fn hold_back(&self, hull: &mut Hull) -> bool {
        hull.cover(self.forms);
        for (index, form) in self.forms.list.iter().enumerate() {
            let (now, next) = (hull.picks[index], hull.above[index]);
            // Parents come first: above a form that is looked at, both cuts are the same.
            if now == next || hull.covered[index] {
                continue;
            }
            let lock = &mut hull.locks[index];
            match form.target {
                Target::Proxy(_) => lock.group = Some(now != NOT),
                Target::Slot(_) if next != NOT && (now == NOT || now < next) => lock.from = next + 1,
                Target::Slot(_) => continue,
            }
            return true;
        }
        false
    }
}

impl Hull {
    /// Finds out what is covered in the cut that was found.
    pub(crate) fn cover(&mut self, forms: &Forms) {
        self.covered.clear();
        for form in &forms.list {
            let covered = match form.parent {
                NONE => false,
                parent => self.covered[parent as usize] || self.picks[parent as usize] != NOT,
            };
            self.covered.push(covered);
        }
    }
}
