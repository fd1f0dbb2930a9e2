//! Proxies and levels as a camera sees them, and the parts of a tree.

use super::frame::{Entry, Layout};
use super::metric::visible_error;
use super::mu::{Shape, distance};
use super::{Detail, Tables};
use crate::loose::Loose;
use crate::proxies::ProxyNode;
use crate::scene::{LOOSE, Placed};
use crate::within::Candidate;
use std::ops::Range;

/// Everything a cut reads beside the frame.
pub(crate) struct Scene<'a> {
    pub(crate) placed: &'a [Placed],
    pub(crate) loose: &'a Loose,
    pub(crate) tables: &'a Tables,
    pub(crate) candidates: &'a [Candidate],
    pub(crate) detail: Detail,
    /// Candidates were tested against the frustum.
    pub(crate) clip: bool,
}

/// A proxy as the camera sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct View {
    /// Estimated visible pixels of what it stands for, in sum.
    #[cfg(test)]
    pub(crate) pixels: f64,
    /// As many of them as there can be: what it stands for hides each other.
    pub(crate) shown: f64,
    pub(crate) triangles: u32,
    /// P(mu).
    pub(crate) ratio: f64,
    /// Visible error in pixels: P(mu) times the screen-space error.
    pub(crate) error: f64,
    /// Share of its visible pixels that it shows wrong.
    pub(crate) loss: f64,
}

/// A level of an object as the camera sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ObjectView {
    pub(crate) pixels: f64,
    /// P(mu).
    pub(crate) ratio: f64,
    pixels_per_radian: f64,
    /// From the eye to the nearest point of its box, metres.
    pub(crate) distance: f64,
    /// From the eye to the centre of its box, metres.
    to_center: f64,
    /// Index of its first level in its tree's list, and levels that have fewer triangles than the original.
    levels: (u32, u8),
    tree: u32,
    original: u32,
}

/// A part of a tree: a proxy with the slots it stands for, or slots on no proxy below the one asked for.
#[derive(Clone, Debug)]
pub(crate) enum Part {
    Proxy(u32, Range<usize>),
    Slots(Range<usize>),
}

/// The proxies of an entry, or none.
pub(crate) fn nodes<'a>(placed: &'a [Placed], entry: &Entry) -> &'a [ProxyNode] {
    let proxies = placed.get(entry.placed as usize).and_then(|placed| placed.instance.tree.proxies());
    proxies.map_or(&[], |proxies| proxies.nodes())
}

/// Hands the parts of an entry to `take`, in order: all of them, or those below one proxy. What `take` accepts of the proxies
/// is not looked into.
pub(crate) fn parts(
    layout: &Layout,
    entry: &Entry,
    nodes: &[ProxyNode],
    below: Option<u32>,
    mut take: impl FnMut(Part) -> bool,
) {
    if nodes.is_empty() {
        take(Part::Slots(entry.slots()));
        return;
    }
    let (mut index, end, all) = match below {
        Some(node) => {
            let parent = &nodes[node as usize];
            (node + 1, node + parent.subtree, layout.slots_of(entry, parent.objects()))
        }
        None => (0, nodes.len() as u32, entry.slots()),
    };
    // Slots up to here are dealt with.
    let mut slot = all.start;
    while index < end {
        let node = &nodes[index as usize];
        let slots = layout.slots_of(entry, node.objects());
        if slots.is_empty() {
            index += node.subtree;
            continue;
        }
        if slot < slots.start {
            take(Part::Slots(slot..slots.start));
        }
        slot = slots.start;
        if take(Part::Proxy(index, slots.clone())) {
            (slot, index) = (slots.end, index + node.subtree);
        } else {
            index += 1;
        }
    }
    if slot < all.end {
        take(Part::Slots(slot..all.end));
    }
}

impl Scene<'_> {
    /// A proxy that could be drawn: the eye is outside of its sphere, nothing it stands for is hidden, and it has fewer
    /// triangles than what is visible of that.
    pub(crate) fn view(
        &self,
        layout: &Layout,
        entry: &Entry,
        node: u32,
        slots: Range<usize>,
    ) -> Option<View> {
        let placed = self.placed.get(entry.placed as usize)?;
        let (pixels, visible_triangles) = layout.sums(slots);
        let triangles = self.tables.proxy_triangles(placed.tree, node);
        let proxy = &placed.instance.tree.proxies()?.nodes()[node as usize];
        let to_eye = entry.local.eye() - proxy.center.as_dvec3();
        let distance = to_eye.length() - f64::from(proxy.radius);
        // An eye that is not a number is outside of nothing.
        let outside = distance > 0.0 && distance < f64::INFINITY;
        if !outside || u64::from(triangles) >= visible_triangles || placed.instance.is_proxy_disturbed(node) {
            return None;
        }
        let (mu, shown) = placed.instance.boxes.proxy(node).mu_and_shown(pixels, &entry.local, self.clip);
        let ratio = self.detail.metric.ratio(mu);
        let error = visible_error(ratio, proxy.error, entry.local.pixels_per_radian(), distance);
        let loss = proxy.deviation.loss(entry.local.pixels_per_radian() / to_eye.length());
        Some(View {
            #[cfg(test)]
            pixels,
            shown,
            triangles,
            ratio,
            error,
            loss,
        })
    }

    /// The visible error is so small that nothing finer is wanted.
    pub(crate) fn is_fine(&self, error: f64) -> bool {
        self.detail.tau > 0.0 && error <= f64::from(self.detail.tau)
    }

    pub(crate) fn object(&self, entry: &Entry, candidate: u32) -> ObjectView {
        let candidate = &self.candidates[candidate as usize];
        let pixels = f64::from(candidate.estimate.expected);
        let place = candidate.draw.object;
        let (bounds, shape, levels) = match self.placed.get(entry.placed as usize) {
            Some(placed) => {
                let bounds = &placed.instance.boxes.objects[place as usize];
                let shape = Shape::of_object(&placed.instance.tree, bounds, place);
                (bounds, shape, self.tables.levels(placed.tree, place, candidate.triangles))
            }
            None => {
                let bounds = self.loose.bounds(candidate.key.1 as usize);
                (bounds, Shape::of_box(bounds), self.tables.levels(LOOSE, place, candidate.triangles))
            }
        };
        let ratio = self.detail.metric.ratio(shape.mu(pixels, &entry.local, false));
        let distance = distance(bounds, entry.local.eye());
        let usable = distance > 0.0 && distance < f64::INFINITY;
        ObjectView {
            pixels,
            ratio,
            pixels_per_radian: entry.local.pixels_per_radian(),
            distance,
            to_center: (entry.local.eye() - (bounds.min.as_dvec3() + bounds.max.as_dvec3()) * 0.5).length(),
            levels: if usable { levels } else { (0, 0) },
            tree: candidate.draw.tree,
            original: candidate.triangles,
        }
    }

    /// Visible error in pixels of a level, 0 for the original.
    pub(crate) fn level_error(&self, object: &ObjectView, level: u8) -> f64 {
        if level == 0 {
            return 0.0;
        }
        let error = self.tables.level(object.tree, object.levels.0, level).error;
        visible_error(object.ratio, error, object.pixels_per_radian, object.distance)
    }

    /// Share of its visible pixels that a level shows wrong.
    pub(crate) fn level_loss(&self, object: &ObjectView, level: u8) -> f64 {
        if level == 0 {
            return 0.0;
        }
        let deviation = self.tables.level(object.tree, object.levels.0, level).deviation;
        deviation.loss(object.pixels_per_radian / object.to_center)
    }

    pub(crate) fn level_triangles(&self, object: &ObjectView, level: u8) -> u32 {
        match level {
            0 => object.original,
            _ => self.tables.level(object.tree, object.levels.0, level).triangles,
        }
    }

    /// The next finer level that has fewer triangles than the original, else the original.
    pub(crate) fn finer(&self, object: &ObjectView, level: u8) -> u8 {
        let finer = level.saturating_sub(1);
        if finer > 0 && self.level_triangles(object, finer) < object.original { finer } else { 0 }
    }

    /// The coarsest level there is, 0 without.
    pub(crate) fn coarsest(&self, object: &ObjectView) -> u8 {
        object.levels.1
    }

    /// The coarsest level that is fine enough.
    pub(crate) fn fine_level(&self, object: &ObjectView) -> u8 {
        let mut level = self.coarsest(object);
        while level > 0 && !self.is_fine(self.level_error(object, level)) {
            level = self.finer(object, level);
        }
        level
    }
}
