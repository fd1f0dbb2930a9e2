//! The cut within a budget: the coarsest first, then refined where that shows most for what it costs.
//!
//! A greedy search over cuts, as in Funkhouser and Séquin, *Adaptive Display Algorithm for Interactive Frame Rates*, 1993. What
//! a cut loses is the sum over what is visible of its pixels times [`loss`] of its visible error, 1 where nothing is drawn.

use super::cut::gives_way;
use super::frame::{Content, DROPPED, Entry, Frame, Layout, NodeState, States};
use super::metric::loss;
use super::step::{Piece, Step, Target};
use super::view::{ObjectView, Part, Scene, View, nodes, parts};
use crate::budget::{Capacity, Load};
use crate::select::Selector;
use std::collections::BinaryHeap;

/// Memory of the search, kept from frame to frame.
#[derive(Debug, Default)]
pub(crate) struct Search {
    heap: BinaryHeap<Step>,
    pieces: Vec<Piece>,
    next: Vec<Piece>,
    /// Entries whose parts are still to be looked at.
    pending: Vec<u32>,
    pending_inner: Vec<u32>,
}

impl Search {
    /// Memory for a list of entries.
    pub(crate) fn pending(&mut self) -> &mut Vec<u32> {
        &mut self.pending
    }
}

/// One search.
pub(crate) struct Searching<'a> {
    pub(crate) scene: &'a Scene<'a>,
    pub(crate) layout: &'a Layout,
    pub(crate) states: &'a mut States,
    /// The frame before, and how much more counts what was drawn or refined there.
    pub(crate) before: Option<&'a Frame>,
    pub(crate) hysteresis: f64,
    pub(crate) capacity: Capacity<'a>,
    pub(crate) spent: Load,
    pub(crate) visited: usize,
}

impl Searching<'_> {
    /// Sets the states of what is drawn.
    pub(crate) fn run(&mut self, search: &mut Search, selector: &mut Selector) {
        search.heap.clear();
        search.pieces.clear();
        let roots = self.layout.entries.iter().enumerate().filter(|(_, entry)| entry.is_root());
        search.pending.clear();
        search.pending.extend(roots.map(|(index, _)| index as u32).rev());
        self.open(&mut search.pending, &mut search.pieces);
        while !search.pieces.is_empty() {
            self.choose(search, selector);
            std::mem::swap(&mut search.pieces, &mut search.next);
        }
        while let Some(step) = search.heap.pop() {
            self.refine(&step, search);
        }
        self.fill(search, selector);
    }

    /// The parts, in their coarsest forms, of all pending entries.
    fn open(&mut self, pending: &mut Vec<u32>, out: &mut Vec<Piece>) {
        while let Some(index) = pending.pop() {
            self.states.open[index as usize] = true;
            self.look_below(index, None, pending, out);
        }
    }

    fn look_below(&mut self, index: u32, below: Option<u32>, pending: &mut Vec<u32>, out: &mut Vec<Piece>) {
        let (scene, layout) = (self.scene, self.layout);
        let entry = &layout.entries[index as usize];
        let (states, visited) = (&mut *self.states, &mut self.visited);
        parts(layout, entry, nodes(scene.placed, entry), below, |part| match part {
            Part::Proxy(node, slots) => {
                *visited += 1;
                let usable = scene.view(layout, entry, node, slots).is_some();
                if usable {
                    out.push(Piece { entry: index, target: Target::Proxy(node) });
                } else {
                    states.nodes[(entry.nodes + node) as usize] = NodeState::Refined;
                }
                usable
            }
            Part::Slots(slots) => {
                for slot in slots {
                    match layout.slots[slot].content() {
                        Content::Guest(guest) => pending.push(guest),
                        Content::Object(_) => {
                            out.push(Piece { entry: index, target: Target::Slot(slot as u32) });
                        }
                    }
                }
                true
            }
        });
    }

    fn view(&self, entry: &Entry, node: u32) -> Option<View> {
        let range = nodes(self.scene.placed, entry)[node as usize].objects();
        self.scene.view(self.layout, entry, node, self.layout.slots_of(entry, range))
    }

    fn object(&self, entry: &Entry, slot: u32) -> Option<ObjectView> {
        match self.layout.slots[slot as usize].content() {
            Content::Object(candidate) => Some(self.scene.object(entry, candidate)),
            Content::Guest(_) => None,
        }
    }

    /// Draws of the pieces what shows most for what it costs; of proxies that do not fit, the parts come next.
    fn choose(&mut self, search: &mut Search, selector: &mut Selector) {
        selector.clear(false);
        for piece in &search.pieces {
            let entry = &self.layout.entries[piece.entry as usize];
            let (value, triangles) = match piece.target {
                Target::Proxy(node) => self
                    .view(entry, node)
                    .map_or((0.0, 0), |view| (view.pixels * (1.0 - loss(view.error)), view.triangles)),
                Target::Slot(slot) => self.object(entry, slot).map_or((0.0, 0), |object| {
                    let level = self.scene.coarsest(&object);
                    let shown = 1.0 - loss(self.scene.level_error(&object, level));
                    (object.pixels * shown, self.scene.level_triangles(&object, level))
                }),
            };
            let again = self.was_drawn(entry, piece.target);
            let factor = if again { self.hysteresis } else { 1.0 };
            selector.push(value * factor, triangles, again, &self.capacity);
        }
        selector.choose_after(self.spent, &self.capacity);
        search.next.clear();
        for at in 0..search.pieces.len() {
            let piece = search.pieces[at];
            if selector.is_chosen(at) {
                self.draw(piece, &mut search.heap, &mut search.pending_inner);
            } else {
                let entry = &self.layout.entries[piece.entry as usize];
                match piece.target {
                    Target::Proxy(node) => {
                        self.states.nodes[(entry.nodes + node) as usize] = NodeState::Split;
                        search.pending.clear();
                        self.look_below(piece.entry, Some(node), &mut search.pending, &mut search.next);
                        self.open(&mut search.pending, &mut search.next);
                    }
                    Target::Slot(slot) => self.states.slots[slot as usize] = DROPPED,
                }
            }
        }
    }

    /// Draws a piece in its coarsest form, which fits.
    fn draw(&mut self, piece: Piece, heap: &mut BinaryHeap<Step>, pending: &mut Vec<u32>) {
        let entry = &self.layout.entries[piece.entry as usize];
        let step = match piece.target {
            Target::Proxy(node) => {
                self.states.nodes[(entry.nodes + node) as usize] = NodeState::Drawn;
                let Some(view) = self.view(entry, node) else { return };
                self.spent = self.spent.plus(view.triangles);
                self.proxy_step(piece.entry, node, &view, pending)
            }
            Target::Slot(slot) => {
                let Some(object) = self.object(entry, slot) else { return };
                let level = self.scene.coarsest(&object);
                self.states.slots[slot as usize] = level;
                self.spent = self.spent.plus(self.scene.level_triangles(&object, level));
                self.level_step(piece.entry, slot, level, &object)
            }
        };
        heap.extend(step);
    }

    /// The refinement of a drawn proxy, unless it is fine enough and does not give way to its parts.
    fn proxy_step(&mut self, index: u32, node: u32, view: &View, pending: &mut Vec<u32>) -> Option<Step> {
        let (scene, layout) = (self.scene, self.layout);
        if scene.is_fine(view.error) && !gives_way(scene, layout, index, node, view, pending) {
            return None;
        }
        let (mut triangles, mut draws, mut lost) = (-i64::from(view.triangles), -1, 0.0);
        let visited = &mut self.visited;
        pending.clear();
        let mut at = (index, Some(node));
        loop {
            let entry = &layout.entries[at.0 as usize];
            parts(layout, entry, nodes(scene.placed, entry), at.1, |part| match part {
                Part::Proxy(node, slots) => {
                    *visited += 1;
                    let view = scene.view(layout, entry, node, slots);
                    if let Some(view) = &view {
                        triangles += i64::from(view.triangles);
                        draws += 1;
                        lost += view.pixels * loss(view.error);
                    }
                    view.is_some()
                }
                Part::Slots(slots) => {
                    for slot in slots {
                        match layout.slots[slot].content() {
                            Content::Guest(guest) => pending.push(guest),
                            Content::Object(candidate) => {
                                let object = scene.object(entry, candidate);
                                let level = scene.coarsest(&object);
                                triangles += i64::from(scene.level_triangles(&object, level));
                                draws += 1;
                                lost += object.pixels * loss(scene.level_error(&object, level));
                            }
                        }
                    }
                    true
                }
            });
            match pending.pop() {
                Some(guest) => at = (guest, None),
                None => break,
            }
        }
        let benefit = view.pixels * loss(view.error) - lost;
        let entry = &layout.entries[index as usize];
        let worth = self.worth(benefit, self.was_refined(entry, node), triangles, draws);
        Some(Step { worth, triangles, draws, entry: index, target: Target::Proxy(node), level: 0 })
    }

    /// The refinement of an object that shows most for what it costs, unless its level is fine enough: to any finer level up
    /// to the first that is.
    fn level_step(&self, index: u32, slot: u32, level: u8, object: &ObjectView) -> Option<Step> {
        let entry = &self.layout.entries[index as usize];
        let (error, triangles) =
            (self.scene.level_error(object, level), i64::from(self.scene.level_triangles(object, level)));
        let again = self.finest_before(entry, slot);
        let mut best: Option<Step> = None;
        let mut finer = level;
        while finer > 0 && !self.scene.is_fine(self.scene.level_error(object, finer)) {
            finer = self.scene.finer(object, finer);
            let benefit = object.pixels * (loss(error) - loss(self.scene.level_error(object, finer)));
            let triangles = i64::from(self.scene.level_triangles(object, finer)) - triangles;
            let worth = self.worth(benefit, again.is_some_and(|before| before <= finer), triangles, 0);
            // Of equally worthy ones the finest.
            if best.is_none_or(|best| worth >= best.worth) {
                let target = Target::Slot(slot);
                best = Some(Step { worth, triangles, draws: 0, entry: index, target, level: finer });
            }
        }
        best
    }

    fn worth(&self, benefit: f64, again: bool, triangles: i64, draws: i64) -> f64 {
        let factor = if again { self.hysteresis } else { 1.0 };
        // A loss (parts may show more of their errors than the whole) is made less by the factor.
        let benefit = if benefit > 0.0 { benefit * factor } else { benefit / factor };
        let weight = self.capacity.difference(triangles, draws);
        // What costs nothing comes first.
        if weight <= 0.0 { f64::INFINITY } else { (benefit / weight).max(-f64::MAX) }
    }

    /// Makes a refinement if it fits.
    fn refine(&mut self, step: &Step, search: &mut Search) {
        let load = Load {
            triangles: self.spent.triangles.saturating_add_signed(step.triangles),
            draws: self.spent.draws.saturating_add_signed(step.draws),
        };
        if !self.capacity.fits(load) {
            return;
        }
        let entry = &self.layout.entries[step.entry as usize];
        match step.target {
            Target::Slot(slot) => {
                self.spent = load;
                self.states.slots[slot as usize] = step.level;
                if let Some(object) = self.object(entry, slot) {
                    search.heap.extend(self.level_step(step.entry, slot, step.level, &object));
                }
            }
            Target::Proxy(node) => {
                self.states.nodes[(entry.nodes + node) as usize] = NodeState::Refined;
                search.pieces.clear();
                search.pending.clear();
                self.look_below(step.entry, Some(node), &mut search.pending, &mut search.pieces);
                self.open(&mut search.pending, &mut search.pieces);
                for at in 0..search.pieces.len() {
                    self.draw(search.pieces[at], &mut search.heap, &mut search.pending_inner);
                }
                // Drawing the parts has added what they cost; the proxy is gone.
                self.spent = load;
            }
        }
    }

    /// Refinements may have freed room: draws what was dropped and fits now.
    fn fill(&mut self, search: &mut Search, selector: &mut Selector) {
        search.pieces.clear();
        for (index, entry) in self.layout.entries.iter().enumerate().filter(|&(i, _)| self.states.open[i]) {
            let dropped = entry.slots().filter(|&slot| self.states.slots[slot] == DROPPED);
            let piece = |slot| Piece { entry: index as u32, target: Target::Slot(slot as u32) };
            search.pieces.extend(dropped.map(piece));
        }
        if !search.pieces.is_empty() {
            self.choose(search, selector);
        }
    }
}
