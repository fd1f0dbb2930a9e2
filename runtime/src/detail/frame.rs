//! One frame's visible objects in proxy order, with running sums, so that a proxy's share of them is two look-ups.

use crate::camera::Camera;
use crate::proxies::Proxies;
use crate::scene::Placed;
use crate::within::Candidate;
use std::ops::Range;

/// No entry, no place, nothing there.
const NONE: u32 = u32::MAX;

/// A slot's content is an entry, not a candidate.
const GUEST: u32 = 1 << 31;

/// State of a slot: nothing is drawn for it.
pub(crate) const DROPPED: u8 = u8::MAX;
/// State of a slot: a proxy stands for it.
pub(crate) const COVERED: u8 = u8::MAX - 1;

/// What becomes of a proxy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum NodeState {
    /// One above it is drawn, or nothing of it is visible.
    #[default]
    Covered,
    /// What is below it decides for itself.
    Refined,
    Drawn,
}

/// A tree at one of its anchors, or the loose objects, as the frame sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    /// Index in the list of placed trees; [`NONE`] for the loose objects.
    pub(crate) placed: u32,
    /// The camera in the space of the tree.
    pub(crate) local: Camera,
    /// Of the eye since the last frame, squared.
    pub(crate) way: f64,
    candidates: (u32, u32),
    /// Its slots; one more follows, with the sums.
    pub(crate) slots: (u32, u32),
    /// First of its ranks (one per place in proxy order, and one more), [`NONE`] without proxies.
    ranks: u32,
    /// First of its proxies' states.
    pub(crate) nodes: u32,
    /// The entry, and the object there, that stands for this one.
    host: (u32, u32),
    /// First of the entries in this one, and the next one of those that have the same host.
    first_guest: u32,
    next_guest: u32,
}

impl Entry {
    pub(crate) fn new(placed: u32, local: Camera, way: f64) -> Self {
        Self {
            placed,
            local,
            way,
            candidates: (0, 0),
            slots: (0, 0),
            ranks: NONE,
            nodes: 0,
            host: (NONE, 0),
            first_guest: NONE,
            next_guest: NONE,
        }
    }

    /// It stands in no other tree.
    pub(crate) fn is_root(&self) -> bool {
        self.host.0 == NONE
    }

    pub(crate) fn slots(&self) -> Range<usize> {
        self.slots.0 as usize..self.slots.1 as usize
    }
}

/// What is visible at one place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slot {
    /// In proxy order (without proxies: tree order).
    pub(crate) position: u32,
    what: u32,
    /// Estimated visible pixels and triangles of all slots of the entry before this one.
    pixels: f64,
    triangles: u64,
}

/// What a slot holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Content {
    /// Index of a candidate.
    Object(u32),
    /// Index of an entry.
    Guest(u32),
}

impl Slot {
    pub(crate) fn content(&self) -> Content {
        if self.what & GUEST == 0 { Content::Object(self.what) } else { Content::Guest(self.what & !GUEST) }
    }
}

/// What is visible in a frame.
#[derive(Debug, Default)]
pub(crate) struct Layout {
    /// In the order in which they are drawn.
    pub(crate) entries: Vec<Entry>,
    pub(crate) slots: Vec<Slot>,
    ranks: Vec<u32>,
    /// Per placed tree, and last for the loose objects.
    entry_of: Vec<u32>,
    /// Proxies of all entries.
    nodes: usize,
    /// Slot content by position, of the entry that is being laid out; [`NONE`] in between.
    at: Vec<u32>,
}

/// What is drawn of it.
#[derive(Debug, Default)]
pub(crate) struct States {
    pub(crate) nodes: Vec<NodeState>,
    /// Level drawn per slot, 0 for the original, or [`DROPPED`] or [`COVERED`].
    pub(crate) slots: Vec<u8>,
    /// Per entry: no proxy stands for it.
    pub(crate) open: Vec<bool>,
}

impl States {
    /// Nothing is drawn of anything; entries in others wait for those.
    pub(crate) fn reset(&mut self, layout: &Layout) {
        self.nodes.clear();
        self.nodes.resize(layout.nodes, NodeState::Covered);
        self.slots.clear();
        self.slots.resize(layout.slots.len(), COVERED);
        self.open.clear();
        self.open.extend(layout.entries.iter().map(Entry::is_root));
    }
}

/// A frame, kept for the next one.
#[derive(Debug, Default)]
pub(crate) struct Frame {
    pub(crate) layout: Layout,
    pub(crate) states: States,
}

impl Layout {
    /// Forgets everything.
    pub(crate) fn clear(&mut self) {
        self.entries.clear();
        self.slots.clear();
        self.ranks.clear();
        self.entry_of.clear();
        self.nodes = 0;
    }

    /// Sorts the candidates of a frame, which come entry by entry in the order of the entries and ascending in place.
    pub(crate) fn lay_out(&mut self, placed: &[Placed], candidates: &[Candidate], camera: &Camera, way: f64) {
        self.entry_of.resize(placed.len() + 1, NONE);
        let mut next = 0;
        for index in 0..self.entries.len() {
            let entry = &mut self.entries[index];
            let place = &placed[entry.placed as usize];
            let first = next;
            while candidates.get(next).is_some_and(|c| c.key.0 == place.rank) {
                next += 1;
            }
            entry.candidates = (first as u32, next as u32);
            self.entry_of[entry.placed as usize] = index as u32;
            if let Some((host, object)) = place.host {
                // A host is walked before its guests.
                let host = self.entry_of[host];
                let others = std::mem::replace(&mut self.entries[host as usize].first_guest, index as u32);
                let entry = &mut self.entries[index];
                (entry.host, entry.next_guest) = ((host, object), others);
            }
        }
        if next < candidates.len() {
            self.entry_of[placed.len()] = self.entries.len() as u32;
            let mut entry = Entry::new(NONE, *camera, way);
            entry.candidates = (next as u32, candidates.len() as u32);
            self.entries.push(entry);
        }
        // Guests first: a host counts what is in them.
        for index in (0..self.entries.len()).rev() {
            self.lay_out_entry(index, placed, candidates);
        }
    }

    fn lay_out_entry(&mut self, index: usize, placed: &[Placed], candidates: &[Candidate]) {
        let entry = self.entries[index];
        let tree = placed.get(entry.placed as usize).map(|placed| &placed.instance.tree);
        let proxies = tree.and_then(|tree| tree.proxies()).filter(|proxies| !proxies.nodes().is_empty());
        let first_slot = self.slots.len() as u32;
        let (mut pixels, mut triangles) = (0.0, 0);
        let range = entry.candidates.0..entry.candidates.1;
        let mut push = |slots: &mut Vec<Slot>, position, what, more: (f64, u64)| {
            slots.push(Slot { position, what, pixels, triangles });
            pixels += more.0;
            triangles += more.1;
        };
        let worth =
            |candidate: &Candidate| (f64::from(candidate.estimate.expected), u64::from(candidate.triangles));
        if proxies.is_none() && entry.first_guest == NONE {
            for index in range {
                let candidate = &candidates[index as usize];
                push(&mut self.slots, candidate.key.1, index, worth(candidate));
            }
        } else {
            let count = tree.map_or(0, |tree| tree.object_count());
            if self.at.len() < count {
                self.at.resize(count, NONE);
            }
            let position =
                |place| proxies.map_or(place, |proxies: &Proxies| proxies.position(place)) as usize;
            for index in range {
                self.at[position(candidates[index as usize].draw.object)] = index;
            }
            let mut guest = entry.first_guest;
            while guest != NONE {
                let guest_entry = &self.entries[guest as usize];
                self.at[position(guest_entry.host.1)] = guest | GUEST;
                guest = guest_entry.next_guest;
            }
            if proxies.is_some() {
                self.entries[index].ranks = self.ranks.len() as u32;
            }
            for position in 0..count {
                if proxies.is_some() {
                    self.ranks.push(self.slots.len() as u32);
                }
                let what = std::mem::replace(&mut self.at[position], NONE);
                if what == NONE {
                    continue;
                }
                let more = if what & GUEST == 0 {
                    worth(&candidates[what as usize])
                } else {
                    let guest = &self.entries[(what & !GUEST) as usize];
                    if guest.slots.0 == guest.slots.1 {
                        // Nothing of it is visible.
                        continue;
                    }
                    self.sums(guest.slots())
                };
                push(&mut self.slots, position as u32, what, more);
            }
            if proxies.is_some() {
                self.ranks.push(self.slots.len() as u32);
            }
        }
        self.entries[index].slots = (first_slot, self.slots.len() as u32);
        self.slots.push(Slot { position: NONE, what: NONE, pixels, triangles });
        self.entries[index].nodes = self.nodes as u32;
        self.nodes += proxies.map_or(0, |proxies| proxies.nodes().len());
    }

    /// Slots of an entry with proxies, of a range of the proxy order.
    pub(crate) fn slots_of(&self, entry: &Entry, positions: Range<u32>) -> Range<usize> {
        let rank = |position: u32| self.ranks[(entry.ranks + position) as usize] as usize;
        rank(positions.start)..rank(positions.end)
    }

    /// Estimated visible pixels and triangles of a range of one entry's slots.
    pub(crate) fn sums(&self, slots: Range<usize>) -> (f64, u64) {
        let (first, end) = (&self.slots[slots.start], &self.slots[slots.end]);
        // A difference of running sums may come out below 0 by rounding.
        ((end.pixels - first.pixels).max(0.0), end.triangles - first.triangles)
    }

    /// The slot of a position; `None` if nothing is visible there.
    pub(crate) fn slot_at(&self, entry: &Entry, position: u32) -> Option<usize> {
        let slots = entry.slots();
        let at = self.slots[slots.clone()].binary_search_by_key(&position, |slot| slot.position);
        Some(slots.start + at.ok()?)
    }

    /// The entry of a placed tree, or of the loose objects for [`NONE`].
    pub(crate) fn find(&self, placed: u32) -> Option<&Entry> {
        let last = self.entry_of.len().checked_sub(1)?;
        let index = self.entry_of[(placed as usize).min(last)];
        self.entries.get(index as usize)
    }
}

impl Frame {
    /// What became of a proxy: `None` if the tree was not there.
    pub(crate) fn node_state(&self, placed: u32, node: u32) -> Option<NodeState> {
        self.layout.find(placed).map(|entry| self.states.nodes[(entry.nodes + node) as usize])
    }

    /// State of the object at a position; `None` if it was not visible.
    pub(crate) fn slot_state(&self, placed: u32, position: u32) -> Option<u8> {
        let entry = self.layout.find(placed)?;
        Some(self.states.slots[self.layout.slot_at(entry, position)?])
    }
}
