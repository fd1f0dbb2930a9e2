//! Everything that a cut within a budget decides on, in one list: groups with a usable proxy, and visible objects.

use super::cut::gives_way;
use super::frame::{Content, Layout, NodeState, States};
use super::history::History;
use super::view::{ObjectView, Scene, View, nodes};

/// No form above.
pub(crate) const NONE: u32 = u32::MAX;

/// What a form is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Target {
    /// A proxy of an entry.
    Proxy(u32),
    /// An object.
    Slot(u32),
}

/// What was drawn in the last frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Before {
    /// Nothing that counts.
    Nothing,
    /// The proxy.
    Proxy,
    /// Something below it.
    Parts,
}

/// A group that is drawn as its proxy or by its parts, or an object that is drawn at one of its levels or not at all.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Form {
    /// The innermost group around it: an earlier form, or [`NONE`].
    pub(crate) parent: u32,
    pub(crate) entry: u32,
    pub(crate) target: Target,
    /// A proxy is fine enough: its parts are drawn only where they cost less.
    pub(crate) fine: bool,
    /// Of a group with parts.
    pub(crate) before: Before,
    /// First of its choices, and how many there are: coarse to fine, one for a proxy.
    first: u32,
    count: u32,
}

impl Form {
    pub(crate) fn is_object(&self) -> bool {
        matches!(self.target, Target::Slot(_))
    }
}

/// A way to draw something.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Choice {
    pub(crate) triangles: u32,
    /// Of an object.
    pub(crate) level: u8,
    /// Visible pixels, as far as they are shown right.
    pub(crate) value: f64,
    /// The same; what was drawn in the last frame counts more.
    pub(crate) worth: f64,
}

/// The forms of a frame: parents come before what is in them.
#[derive(Debug, Default)]
pub(crate) struct Forms {
    pub(crate) list: Vec<Form>,
    choices: Vec<Choice>,
    /// Groups around the place that is looked at: form, end of its proxies, end of its slots.
    around: Vec<(u32, u32, usize)>,
    /// All entries, with the group around each.
    pub(crate) entries: Vec<(u32, u32)>,
    /// Those that are still to be looked at.
    guests: Vec<(u32, u32)>,
    pending: Vec<u32>,
}

/// What forms are made of.
pub(crate) struct Source<'a> {
    pub(crate) scene: &'a Scene<'a>,
    pub(crate) layout: &'a Layout,
    pub(crate) history: History<'a>,
}

impl Forms {
    pub(crate) fn choices(&self, form: &Form) -> &[Choice] {
        &self.choices[form.first as usize..(form.first + form.count) as usize]
    }

    /// Memory for a list of entries.
    pub(crate) fn pending(&mut self) -> &mut Vec<u32> {
        &mut self.pending
    }

    /// Makes the list; groups without a usable proxy are refined. Returns how many proxies were looked at.
    pub(crate) fn gather(&mut self, source: &Source<'_>, states: &mut States) -> usize {
        self.list.clear();
        self.choices.clear();
        self.entries.clear();
        self.guests.clear();
        let roots = source.layout.entries.iter().enumerate().filter(|(_, entry)| entry.is_root());
        self.guests.extend(roots.map(|(index, _)| (index as u32, NONE)).rev());
        let mut visited = 0;
        while let Some((entry, parent)) = self.guests.pop() {
            self.entries.push((entry, parent));
            visited += self.entry(source, states, entry, parent);
        }
        visited
    }

    fn entry(&mut self, source: &Source<'_>, states: &mut States, index: u32, parent: u32) -> usize {
        let (scene, layout) = (source.scene, source.layout);
        let entry = &layout.entries[index as usize];
        let nodes = nodes(scene.placed, entry);
        let mut slot = entry.slots().start;
        let mut visited = 0;
        let mut node = 0;
        self.around.clear();
        while (node as usize) < nodes.len() {
            while let Some(&(_, end, slots_end)) = self.around.last()
                && end <= node
            {
                self.slots(source, index, slot..slots_end, parent);
                slot = slots_end;
                self.around.pop();
            }
            let proxy = &nodes[node as usize];
            let slots = layout.slots_of(entry, proxy.objects());
            if slots.is_empty() {
                node += proxy.subtree;
                continue;
            }
            self.slots(source, index, slot..slots.start, parent);
            slot = slots.start;
            visited += 1;
            let Some(view) = scene.view(layout, entry, node, slots.clone()) else {
                states.nodes[(entry.nodes + node) as usize] = NodeState::Refined;
                // Its own slots end before what follows it.
                self.around.push((self.above(parent), node + proxy.subtree, slots.end));
                node += 1;
                continue;
            };
            let fine =
                scene.is_fine(view.error) && !gives_way(scene, layout, index, node, &view, &mut self.pending);
            let form = self.proxy(source, index, node, &view, fine, parent);
            self.around.push((form, node + proxy.subtree, slots.end));
            node += 1;
        }
        while let Some(&(_, _, slots_end)) = self.around.last() {
            self.slots(source, index, slot..slots_end, parent);
            slot = slots_end;
            self.around.pop();
        }
        self.slots(source, index, slot..entry.slots().end, parent);
        visited
    }

    /// The innermost group around what comes next.
    fn above(&self, parent: u32) -> u32 {
        self.around.last().map_or(parent, |&(form, ..)| form)
    }

    fn proxy(
        &mut self,
        source: &Source<'_>,
        entry: u32,
        node: u32,
        view: &View,
        fine: bool,
        parent: u32,
    ) -> u32 {
        let value = view.shown * (1.0 - view.loss);
        let before = source.history.of_proxy(source, entry, node);
        let worth = if before == Before::Proxy { value * source.history.factor } else { value };
        let first = self.choices.len() as u32;
        self.choices.push(Choice { triangles: view.triangles, level: 0, value, worth });
        let form = self.list.len() as u32;
        let (parent, target) = (self.above(parent), Target::Proxy(node));
        self.list.push(Form { parent, entry, target, fine, before, first, count: 1 });
        form
    }

    fn slots(&mut self, source: &Source<'_>, index: u32, slots: std::ops::Range<usize>, parent: u32) {
        let parent = self.above(parent);
        let entry = &source.layout.entries[index as usize];
        for slot in slots {
            match source.layout.slots[slot].content() {
                Content::Guest(guest) => self.guests.push((guest, parent)),
                Content::Object(candidate) => {
                    let object = source.scene.object(entry, candidate);
                    let before = source.history.of_slot(source, index, slot as u32);
                    self.object(source, index, slot as u32, &object, before, parent);
                }
            }
        }
    }

    fn object(
        &mut self,
        source: &Source<'_>,
        entry: u32,
        slot: u32,
        object: &ObjectView,
        before: Option<u8>,
        parent: u32,
    ) {
        let scene = source.scene;
        let value = |level| object.pixels * (1.0 - scene.level_loss(object, level));
        let known = before.map(value);
        let first = self.choices.len() as u32;
        let mut level = scene.coarsest(object);
        loop {
            let value = value(level);
            let worth = known.map_or(value, |known| source.history.worth(value, known));
            self.choices.push(Choice {
                triangles: scene.level_triangles(object, level),
                level,
                value,
                worth,
            });
            if level == 0 || scene.is_fine(scene.level_error(object, level)) {
                break;
            }
            level = scene.finer(object, level);
        }
        let count = self.choices.len() as u32 - first;
        let (target, before) = (Target::Slot(slot), Before::Nothing);
        self.list.push(Form { parent, entry, target, fine: false, before, first, count });
    }
}
