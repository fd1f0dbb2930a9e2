//! What a selection made of one object.

use super::frame::{COVERED, Content, DROPPED, NodeState};
use super::view::{Scene, nodes};
use crate::scene::{Draw, LOOSE, SceneCuller};

/// What the last [`SceneCuller::select`] did with an object. Why culling found it visible or not says
/// [`SceneCuller::explain`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Outcome {
    /// Culling did not answer it, or there is no such object.
    NotVisible,
    /// Drawn as it is.
    Object,
    /// Drawn simplified.
    Level {
        /// Which of its levels, from 1.
        level: u8,
        /// Visible error, pixels.
        error: f64,
    },
    /// A proxy stands for it.
    Proxy {
        /// Tree, anchor and, as `object`, the index in [`crate::Proxies::nodes`].
        proxy: Draw,
        /// Objects that it stands for, visible or not; a nested tree is one of them.
        objects: u32,
        /// Visible error, pixels.
        error: f64,
    },
    /// The budget left no room for it.
    LeftOut,
}

impl SceneCuller {
    /// What the last [`Self::select`] did with an object; `None` if nothing was selected since the last
    /// [`Self::cull`], or something has changed. Linear in the proxies around the object.
    pub fn outcome(&self, object: Draw) -> Option<Outcome> {
        let state = &self.detail;
        let asked = state.asked.as_ref()?;
        let scene = Scene {
            placed: &self.placed,
            loose: &self.loose,
            tables: &state.tables,
            candidates: &self.within.candidates,
            detail: asked.detail,
            clip: asked.settings.frustum,
        };
        let (layout, states) = (&state.frame.layout, &state.frame.states);
        // Of a loose object no entry of the list, and its place.
        let (placed, place) = if object.tree == LOOSE {
            (u32::MAX, self.loose.place(object.object).filter(|_| object.anchor == 0))
        } else {
            let found = self.find(object.tree, object.anchor).map(|index| index as u32);
            (found.unwrap_or(u32::MAX), found.map(|_| object.object as usize))
        };
        let Some(mut position) = place.map(|place| place as u32) else { return Some(Outcome::NotVisible) };
        let mut entry = match layout.find(placed) {
            Some(entry) => entry,
            None => return Some(Outcome::NotVisible),
        };
        if object.tree != LOOSE {
            let tree = &self.placed[placed as usize].instance.tree;
            if position as usize >= tree.object_count() {
                return Some(Outcome::NotVisible);
            }
            position =
                tree.proxies().filter(|p| !p.nodes().is_empty()).map_or(position, |p| p.position(position));
        }
        let Some(slot) = layout.slot_at(entry, position) else { return Some(Outcome::NotVisible) };
        match states.slots[slot] {
            COVERED => {}
            DROPPED => return Some(Outcome::LeftOut),
            level => {
                let Content::Object(candidate) = layout.slots[slot].content() else {
                    return Some(Outcome::NotVisible);
                };
                let error = scene.level_error(&scene.object(entry, candidate), level);
                return Some(if level == 0 { Outcome::Object } else { Outcome::Level { level, error } });
            }
        }
        // A proxy of its tree, or of one around that, stands for it.
        loop {
            let proxies = nodes(&self.placed, entry);
            let mut node = 0;
            while let Some(proxy) = proxies.get(node) {
                if !proxy.objects().contains(&position) {
                    node += proxy.subtree as usize;
                    continue;
                }
                if states.nodes[entry.nodes as usize + node] == NodeState::Drawn {
                    let slots = layout.slots_of(entry, proxy.objects());
                    let error = scene.view(layout, entry, node as u32, slots)?.error;
                    let placed = &self.placed[entry.placed as usize];
                    let proxy_draw = Draw { tree: placed.tree, anchor: placed.anchor, object: node as u32 };
                    let objects = proxy.object_count;
                    return Some(Outcome::Proxy { proxy: proxy_draw, objects, error });
                }
                node += 1;
            }
            let Some((host, at)) = self.placed.get(entry.placed as usize).and_then(|placed| placed.host)
            else {
                return Some(Outcome::LeftOut);
            };
            entry = layout.find(host as u32)?;
            let proxies = self.placed[host].instance.tree.proxies().filter(|p| !p.nodes().is_empty());
            position = proxies.map_or(at, |p| p.position(at));
        }
    }
}
