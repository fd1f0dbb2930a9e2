//! One pass over a tree for one camera: the hot path.
//!
//! Nodes are walked in depth-first order with skip pointers, without a stack. A node whose sphere can be used answers for
//! all objects below it; what hangs below no such node is drawn if it is in the frustum.

use crate::boxes::{Boxes, CHUNK};
use crate::camera::Camera;
use crate::frustum::Frustum;
use crate::hits::{Hit, Hits};
use crate::query::Settings;
use crate::tree::{Node, Tree};
use std::f32::consts::FRAC_PI_2;
use std::ops::Range;

/// What one call of a culler did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CullStatistics {
    /// Nodes whose sphere was compared with the eye (those outside the frustum are not).
    pub spheres_tested: usize,
    /// Spheres that answered for the objects below them.
    pub spheres_used: usize,
    /// Objects looked at one by one.
    pub objects_tested: usize,
    /// Objects to draw.
    pub drawn: usize,
}

impl std::ops::AddAssign for CullStatistics {
    fn add_assign(&mut self, other: Self) {
        self.spheres_tested += other.spheres_tested;
        self.spheres_used += other.spheres_used;
        self.objects_tested += other.objects_tested;
        self.drawn += other.drawn;
    }
}

/// Objects hidden at run time, and per node and per proxy how many disturbances there are below it.
#[derive(Clone, Debug)]
pub(crate) struct Hidden {
    pub(crate) objects: Vec<bool>,
    pub(crate) below: Vec<u32>,
    /// The same per proxy.
    pub(crate) below_proxies: Vec<u32>,
}

/// Everything a pass reads.
pub(crate) struct Pass<'a> {
    pub(crate) tree: &'a Tree,
    pub(crate) boxes: &'a Boxes,
    pub(crate) hidden: Option<&'a Hidden>,
    pub(crate) camera: &'a Camera,
    pub(crate) settings: &'a Settings,
}

impl Pass<'_> {
    /// Appends the places of the objects to draw, ascending.
    pub(crate) fn run<T: Hit>(&self, out: &mut Hits<T>) -> CullStatistics {
        let thresholds = self.thresholds();
        let max_sine = self.max_sine();
        let mut statistics = CullStatistics::default();
        let before = out.list.len();
        let nodes = self.tree.nodes();
        let mut frustum = Frustum::new(self.camera, self.settings.frustum);
        // Objects up to here are dealt with.
        let mut place = 0;
        let mut index = 0;
        while index < nodes.len() {
            let node = &nodes[index];
            let objects = node.objects();
            // What lies between hangs on an ancestor (or on nothing), and no sphere above it could be used.
            self.draw_in_frustum(place..objects.start, &mut frustum, out, &mut statistics);
            place = objects.start;
            let skip = index + node.subtree as usize;
            if objects.is_empty() {
                index = skip;
            } else if !frustum.enter(&self.boxes.nodes[index], objects.end) {
                (place, index) = (objects.end, skip);
            } else if max_sine <= 0.0 {
                // No sphere is used: what is wholly inside needs no look at its nodes.
                index = if frustum.is_inside(objects.end) { skip } else { index + 1 };
            } else {
                statistics.spheres_tested += 1;
                if self.is_usable(index, node, max_sine) {
                    statistics.spheres_used += 1;
                    self.scan(index, &mut frustum, &thresholds, out, &mut statistics);
                    (place, index) = (objects.end, skip);
                } else {
                    index += 1;
                }
            }
        }
        self.draw_in_frustum(place..self.tree.object_count, &mut frustum, out, &mut statistics);
        statistics.drawn = out.list.len() - before;
        statistics
    }

    /// Sine of the largest half-angle at which spheres are used.
    pub(crate) fn max_sine(&self) -> f64 {
        match self.settings.max_half_angle {
            t if t < FRAC_PI_2 => sine(f64::from(t.max(0.0))),
            _ => 1.0,
        }
    }

    /// The eye is outside the sphere, the sphere is not too near, and nothing below it has been disturbed.
    pub(crate) fn is_usable(&self, index: usize, node: &Node, max_sine: f64) -> bool {
        let distance_squared = (self.camera.eye() - node.center.as_dvec3()).length_squared();
        let radius = f64::from(node.radius);
        let limit = distance_squared * max_sine * max_sine;
        // Written so that an eye that is not a number is outside of nothing. At half-angle 0 not even points are used.
        distance_squared > radius * radius
            && max_sine > 0.0
            && radius * radius <= limit
            && self.hidden.is_none_or(|hidden| hidden.below[index] == 0)
    }

    fn draw_in_frustum<T: Hit>(
        &self,
        places: Range<u32>,
        frustum: &mut Frustum<'_>,
        out: &mut Hits<T>,
        statistics: &mut CullStatistics,
    ) {
        statistics.objects_tested += places.len();
        match self.hidden {
            None if frustum.is_inside(places.end) => out.list.extend(places.map(|place| T::new(place, 0))),
            None => self.in_frustum(places, frustum, |place| out.list.push(T::new(place, 0))),
            Some(hidden) => self.in_frustum(places, frustum, |place| {
                if !hidden.objects[place as usize] {
                    out.list.push(T::new(place, 0));
                }
            }),
        }
    }

    /// Hands on the places of what is in the frustum.
    #[inline]
    pub(crate) fn in_frustum(
        &self,
        places: Range<u32>,
        frustum: &mut Frustum<'_>,
        mut each: impl FnMut(u32),
    ) {
        if frustum.is_inside(places.end) {
            places.for_each(each);
            return;
        }
        let mut place = places.start;
        while place < places.end {
            let end = if place.is_multiple_of(CHUNK) && places.end - place >= CHUNK {
                let end = place + CHUNK;
                if !frustum.enter(&self.boxes.chunks[(place / CHUNK) as usize], end) {
                    place = end;
                    continue;
                }
                end
            } else {
                places.end.min((place / CHUNK + 1).saturating_mul(CHUNK))
            };
            for place in place..end {
                if frustum.sees(&self.boxes.objects[place as usize], place) {
                    each(place);
                }
            }
            place = end;
        }
    }
}

/// Of an angle from 0 to π/2, by its series: in WebAssembly the general function is 6 kB, and it differs from machine to machine.
fn sine(angle: f64) -> f64 {
    let (mut sum, mut term) = (angle, angle);
    // The next term would be below 2e-18.
    for k in 1..11 {
        term *= -angle * angle / f64::from(2 * k * (2 * k + 1));
        sum += term;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_series_is_the_sine() {
        for step in 0..=1000 {
            let angle = f64::from(step) / 1000.0 * f64::from(FRAC_PI_2);
            assert!((sine(angle) - angle.sin()).abs() < 1e-15, "{angle}");
        }
        assert_eq!(sine(0.0), 0.0);
    }
}
