//! What was drawn and refined in the last frame: it counts more, so that nothing flickers.

use super::frame::{COVERED, Content, DROPPED, Entry, NodeState};
use super::step::Target;
use super::view::nodes;
use super::within::Searching;
use crate::within::is_still;

impl Searching<'_> {
    pub(crate) fn was_drawn(&self, entry: &Entry, target: Target) -> bool {
        let Some(before) = self.before else { return false };
        match target {
            Target::Proxy(node) => {
                let state = before.node_state(entry.placed, node);
                matches!(state, Some(NodeState::Drawn | NodeState::Refined)) && self.is_still(entry, node)
            }
            Target::Slot(slot) => {
                let position = self.layout.slots[slot as usize].position;
                let state = before.slot_state(entry.placed, position);
                state.is_some_and(|state| state != DROPPED) && self.is_slot_still(slot)
            }
        }
    }

    pub(crate) fn was_refined(&self, entry: &Entry, node: u32) -> bool {
        let Some(before) = self.before else { return false };
        before.node_state(entry.placed, node) == Some(NodeState::Refined) && self.is_still(entry, node)
    }

    /// Level at which an object was drawn in the last frame.
    pub(crate) fn finest_before(&self, entry: &Entry, slot: u32) -> Option<u8> {
        let position = self.layout.slots[slot as usize].position;
        let state = self.before?.slot_state(entry.placed, position)?;
        (state < COVERED && self.is_slot_still(slot)).then_some(state)
    }

    fn is_still(&self, entry: &Entry, node: u32) -> bool {
        let center = nodes(self.scene.placed, entry)[node as usize].center.as_dvec3();
        is_still(entry.local.eye() - center, entry.way)
    }

    fn is_slot_still(&self, slot: u32) -> bool {
        match self.layout.slots[slot as usize].content() {
            Content::Object(candidate) => self.scene.candidates[candidate as usize].still,
            Content::Guest(_) => false,
        }
    }
}
