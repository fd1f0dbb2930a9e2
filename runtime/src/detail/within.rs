//! The cut within a budget: what shows most of what is visible.
//!
//! What a cut shows is the sum over what is visible of its pixels, less the share of them that is shown wrong. Two cuts are
//! made, the best at a price ([`super::hull`]) and the best without proxies ([`crate::select`]), and the better one is drawn.

use super::forms::{Forms, Source, Target};
use super::frame::{DROPPED, NodeState, States};
use super::hull::{Hull, NOT, Searching, Totals};
use crate::budget::{Capacity, Load};
use crate::select::Selector;

/// Memory of the search, kept from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct Search {
    forms: Forms,
    hull: Hull,
    /// Forms that are tried together.
    tried: Vec<u32>,
}

impl Search {
    /// Memory for a list of entries.
    pub(crate) fn pending(&mut self) -> &mut Vec<u32> {
        self.forms.pending()
    }
}

/// One search.
pub(crate) struct Within<'a> {
    pub(crate) source: Source<'a>,
    pub(crate) states: &'a mut States,
    pub(crate) capacity: Capacity<'a>,
}

impl Within<'_> {
    /// Sets the states of what is drawn. Returns how many proxies were looked at.
    pub(crate) fn run(&mut self, search: &mut Search, selector: &mut Selector) -> usize {
        let visited = search.forms.gather(&self.source, self.states);
        let Search { forms, hull, tried } = search;
        let searching = Searching { forms, history: self.source.history, capacity: self.capacity };
        let mut totals = searching.run(hull);
        hull.cover(forms);
        self.fill(forms, hull, tried, selector, &mut totals);
        let plain = self.plain(forms, tried, selector);
        if plain.worth > totals.worth {
            totals = plain;
            hull.picks.fill(NOT);
            hull.covered.fill(false);
            for (_, &index) in tried.iter().enumerate().filter(|&(at, _)| selector.is_chosen(at)) {
                hull.picks[index as usize] = forms.choices(&forms.list[index as usize]).len() as u8 - 1;
            }
            self.fill(forms, hull, tried, selector, &mut totals);
        }
        self.write(forms, hull);
        visited
    }

    /// Draws of what is dropped what still fits, in its coarsest form.
    fn fill(
        &self,
        forms: &Forms,
        hull: &mut Hull,
        tried: &mut Vec<u32>,
        selector: &mut Selector,
        totals: &mut Totals,
    ) {
        selector.clear(false);
        tried.clear();
        for (index, form) in forms.list.iter().enumerate() {
            if form.is_object() && hull.picks[index] == NOT && !hull.covered[index] {
                let choice = &forms.choices(form)[0];
                tried.push(index as u32);
                selector.push(choice.worth, choice.triangles, choice.worth > choice.value, &self.capacity);
            }
        }
        selector.choose_after(totals.load, &self.capacity);
        for (at, &index) in tried.iter().enumerate() {
            if selector.is_chosen(at) {
                hull.picks[index as usize] = 0;
                totals.draw(&forms.choices(&forms.list[index as usize])[0]);
            }
        }
    }

    /// Chooses as if there were no proxies and no levels but those that are fine; returns what the choice shows.
    fn plain(&self, forms: &Forms, tried: &mut Vec<u32>, selector: &mut Selector) -> Totals {
        selector.clear(false);
        tried.clear();
        for (index, form) in forms.list.iter().enumerate().filter(|(_, form)| form.is_object()) {
            let Some(choice) = forms.choices(form).last() else { continue };
            tried.push(index as u32);
            selector.push(choice.worth, choice.triangles, choice.worth > choice.value, &self.capacity);
        }
        selector.choose_after(Load::default(), &self.capacity);
        let mut totals = Totals::default();
        for (_, &index) in tried.iter().enumerate().filter(|&(at, _)| selector.is_chosen(at)) {
            if let Some(choice) = forms.choices(&forms.list[index as usize]).last() {
                totals.draw(choice);
            }
        }
        totals
    }

    fn write(&mut self, forms: &Forms, hull: &Hull) {
        for (index, form) in forms.list.iter().enumerate().filter(|&(index, _)| !hull.covered[index]) {
            let pick = hull.picks[index];
            let entry = &self.source.layout.entries[form.entry as usize];
            match form.target {
                Target::Proxy(node) => {
                    let state = if pick == NOT { NodeState::Refined } else { NodeState::Drawn };
                    self.states.nodes[(entry.nodes + node) as usize] = state;
                }
                Target::Slot(slot) => {
                    self.states.slots[slot as usize] = match pick {
                        NOT => DROPPED,
                        pick => forms.choices(form)[usize::from(pick)].level,
                    };
                }
            }
        }
        for &(entry, parent) in &forms.entries {
            self.states.open[entry as usize] = match hull.covered.get(parent as usize) {
                Some(covered) => !covered && hull.picks[parent as usize] == NOT,
                None => true,
            };
        }
    }
}
