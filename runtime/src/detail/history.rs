//! What was drawn in the last frame: it counts more, so that nothing flickers.

use super::forms::{Before, Source};
use super::frame::{COVERED, Content, Frame, NodeState};
use super::view::nodes;
use crate::within::is_still;

/// The frame before, and how much more counts what was drawn there.
#[derive(Clone, Copy)]
pub(crate) struct History<'a> {
    pub(crate) frame: &'a Frame,
    /// At least 1.
    pub(crate) factor: f64,
}

impl History<'_> {
    /// What a form of this value is worth, if one of the value `known` was drawn: as much of it as there was counts more.
    pub(crate) fn worth(&self, value: f64, known: f64) -> f64 {
        self.factor * value.min(known) + (value - known).max(0.0)
    }

    pub(crate) fn of_proxy(&self, source: &Source<'_>, entry: u32, node: u32) -> Before {
        let entry = &source.layout.entries[entry as usize];
        let center = || nodes(source.scene.placed, entry)[node as usize].center.as_dvec3();
        match self.frame.node_state(entry.placed, node) {
            Some(state) if is_still(entry.local.eye() - center(), entry.way) => match state {
                NodeState::Drawn => Before::Proxy,
                NodeState::Refined => Before::Parts,
                NodeState::Covered => Before::Nothing,
            },
            _ => Before::Nothing,
        }
    }

    /// Level at which an object was drawn.
    pub(crate) fn of_slot(&self, source: &Source<'_>, entry: u32, slot: u32) -> Option<u8> {
        let (entry, slot) = (&source.layout.entries[entry as usize], source.layout.slots[slot as usize]);
        let Content::Object(candidate) = slot.content() else { return None };
        let still = source.scene.candidates[candidate as usize].still;
        let state = self.frame.slot_state(entry.placed, slot.position)?;
        (still && state < COVERED).then_some(state)
    }
}
