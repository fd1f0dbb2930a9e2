//! The cut without a budget: top-down, by the visible error. And what a cut, once it is chosen, draws.

use super::frame::{COVERED, Content, DROPPED, Entry, Layout, NodeState, States};
use super::view::{ObjectView, Part, Scene, View, nodes, parts};

/// Something to draw.
pub(crate) enum Drawn<'a> {
    Proxy(u32, &'a View),
    /// Candidate and level.
    Object(u32, u8, &'a ObjectView),
}

/// A proxy that is fine gives way to its parts if these, in their coarsest forms, are fine, too, and have fewer triangles: so
/// it is where little of what it stands for is visible.
pub(crate) fn gives_way(
    scene: &Scene<'_>,
    layout: &Layout,
    index: u32,
    node: u32,
    view: &View,
    pending: &mut Vec<u32>,
) -> bool {
    let mut left = Some(u64::from(view.triangles));
    let take = |left: &mut Option<u64>, error: f64, triangles: u32| {
        let fewer = left.and_then(|left| left.checked_sub(u64::from(triangles)));
        *left = fewer.filter(|&left| left > 0 && scene.is_fine(error));
    };
    pending.clear();
    let mut at = (index, Some(node));
    loop {
        let entry = &layout.entries[at.0 as usize];
        parts(layout, entry, nodes(scene.placed, entry), at.1, |part| {
            if left.is_none() {
                return true;
            }
            match part {
                Part::Proxy(node, slots) => {
                    let view = scene.view(layout, entry, node, slots);
                    if let Some(view) = &view {
                        take(&mut left, view.error, view.triangles);
                    }
                    view.is_some()
                }
                Part::Slots(slots) => {
                    for slot in slots {
                        match layout.slots[slot].content() {
                            _ if left.is_none() => break,
                            Content::Guest(guest) => pending.push(guest),
                            Content::Object(candidate) => {
                                let object = scene.object(entry, candidate);
                                let level = scene.coarsest(&object);
                                let error = scene.level_error(&object, level);
                                take(&mut left, error, scene.level_triangles(&object, level));
                            }
                        }
                    }
                    true
                }
            }
        });
        match pending.pop().filter(|_| left.is_some()) {
            Some(guest) => at = (guest, None),
            None => return left.is_some(),
        }
    }
}

/// The cut without a budget: the first proxies from the top that are fine enough, and what is on none of them. `draw` gets
/// it in order. Returns how many proxies were looked at.
pub(crate) fn unlimited(
    scene: &Scene<'_>,
    layout: &Layout,
    states: &mut States,
    pending: &mut Vec<u32>,
    mut draw: impl FnMut(&Entry, Drawn<'_>),
) -> usize {
    let mut visited = 0;
    for (index, entry) in layout.entries.iter().enumerate() {
        if !states.open[index] {
            continue;
        }
        parts(layout, entry, nodes(scene.placed, entry), None, |part| match part {
            Part::Proxy(node, slots) => {
                visited += 1;
                let view = scene.view(layout, entry, node, slots).filter(|view| {
                    scene.is_fine(view.error) && !gives_way(scene, layout, index as u32, node, view, pending)
                });
                let state = &mut states.nodes[(entry.nodes + node) as usize];
                *state = if view.is_some() { NodeState::Drawn } else { NodeState::Refined };
                if let Some(view) = &view {
                    draw(entry, Drawn::Proxy(node, view));
                }
                view.is_some()
            }
            Part::Slots(slots) => {
                for slot in slots {
                    match layout.slots[slot].content() {
                        Content::Guest(guest) => states.open[guest as usize] = true,
                        Content::Object(candidate) => {
                            let object = scene.object(entry, candidate);
                            let level = scene.fine_level(&object);
                            states.slots[slot] = level;
                            draw(entry, Drawn::Object(candidate, level, &object));
                        }
                    }
                }
                true
            }
        });
    }
    visited
}

/// Hands what the states say to `draw`, in order.
pub(crate) fn chosen(
    scene: &Scene<'_>,
    layout: &Layout,
    states: &States,
    mut draw: impl FnMut(&Entry, Drawn<'_>),
) {
    for (index, entry) in layout.entries.iter().enumerate() {
        if !states.open[index] {
            continue;
        }
        parts(layout, entry, nodes(scene.placed, entry), None, |part| match part {
            Part::Proxy(node, slots) => {
                let drawn = states.nodes[(entry.nodes + node) as usize] == NodeState::Drawn;
                if let Some(view) = drawn.then(|| scene.view(layout, entry, node, slots)).flatten() {
                    draw(entry, Drawn::Proxy(node, &view));
                }
                drawn
            }
            Part::Slots(slots) => {
                for slot in slots {
                    if let Content::Object(candidate) = layout.slots[slot].content()
                        && states.slots[slot] < COVERED
                    {
                        draw(
                            entry,
                            Drawn::Object(candidate, states.slots[slot], &scene.object(entry, candidate)),
                        );
                    }
                }
                true
            }
        });
    }
}

/// Estimated visible pixels of what is dropped.
pub(crate) fn dropped_pixels(scene: &Scene<'_>, layout: &Layout, states: &States) -> f64 {
    let slots = layout.slots.iter().zip(&states.slots);
    let dropped = slots.filter(|(_, state)| **state == DROPPED).map(|(slot, _)| match slot.content() {
        Content::Object(candidate) => f64::from(scene.candidates[candidate as usize].estimate.expected),
        Content::Guest(_) => 0.0,
    });
    dropped.sum()
}
