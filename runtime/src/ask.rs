//! Asks a usable node which of the objects below it are seen.

use crate::estimate::is_around;
use crate::frustum::Frustum;
use crate::hits::{Hit, Hits, Small};
use crate::query::Query;
use crate::traverse::{CullStatistics, Pass};
use crate::tree::{Node, ObjectRow};
use glam::DVec3;
use std::ops::Range;

/// Nodes of fewer objects are not looked at for [`Pass::scan`]: asking each object is as fast.
const LEAST_OBJECTS: u32 = 12;

/// The settings in the form the inner loop wants them.
pub(crate) struct Thresholds {
    nearest: f64,
    triangle: Option<f64>,
    ring: Option<f64>,
    /// Some threshold is above 0, so sizes must be estimated.
    sizes: bool,
    pub(crate) pixels_squared: f64,
}

impl Thresholds {
    /// The same stages, for objects of any size.
    pub(crate) fn without_sizes(&self) -> Self {
        let any = |stage: Option<f64>| stage.map(|_| 0.0);
        Self { nearest: 0.0, triangle: any(self.triangle), ring: any(self.ring), sizes: false, ..*self }
    }
}

/// What a usable sphere says of an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Answer {
    NotSeen,
    /// Seen, but of fewer pixels than the smallest that are always drawn: of so many.
    Small(f64),
    Seen,
}

/// The bins a sphere query asks, the same for all objects below a node.
pub(crate) enum SphereBins {
    Weighted([(usize, f64); 3]),
    Any([usize; 3]),
    All,
}

impl Pass<'_> {
    pub(crate) fn thresholds(&self) -> Thresholds {
        let tau = &self.settings.tau;
        let stage = |t: f32| (t < f32::INFINITY).then(|| f64::from(t.max(tau.nearest)));
        let (triangle, ring) = (stage(tau.triangle), stage(tau.ring));
        let sizes = tau.nearest > 0.0 || [triangle, ring].iter().flatten().any(|&t| t > 0.0);
        let pixels = self.camera.pixels_per_radian();
        Thresholds { nearest: f64::from(tau.nearest), triangle, ring, sizes, pixels_squared: pixels * pixels }
    }

    /// Asks a usable node for all objects below it. Where each object has its own direction, nodes below it are looked at
    /// too: seen from afar, all objects of such a node share a bin.
    pub(crate) fn scan<T: Hit>(
        &self,
        index: usize,
        frustum: &mut Frustum<'_>,
        thresholds: &Thresholds,
        out: &mut Hits<T>,
        statistics: &mut CullStatistics,
    ) {
        let nodes = self.tree.nodes();
        let node = &nodes[index];
        statistics.objects_tested += node.object_count as usize;
        let bins = self.sphere_bins(node);
        let inside = frustum.is_inside(node.objects().end);
        let by_bin = thresholds.triangle.is_none() || self.tree.directions.is_acute();
        if bins.is_some() || inside && !by_bin {
            self.ask_each(node, node.objects(), frustum, bins.as_ref(), thresholds, out);
            return;
        }
        // Objects up to here are dealt with.
        let mut place = node.first_object;
        let end = index + node.subtree as usize;
        let mut at = index;
        while at < end {
            let inner = &nodes[at];
            let objects = inner.objects();
            let skip = at + inner.subtree as usize;
            if inner.object_count < LEAST_OBJECTS {
                // Asked with what follows.
                at = skip;
                continue;
            }
            self.ask_each(node, place..objects.start, frustum, None, thresholds, out);
            place = objects.start;
            if !frustum.enter(&self.boxes.nodes[at], objects.end) {
                (place, at) = (objects.end, skip);
                continue;
            }
            match self.common_bin(at).filter(|_| by_bin && frustum.is_inside(objects.end)) {
                Some(bin) => {
                    self.ask_bin(node, objects.clone(), bin, thresholds, out);
                    (place, at) = (objects.end, skip);
                }
                None => at += 1,
            }
        }
        self.ask_each(node, place..node.objects().end, frustum, None, thresholds, out);
    }

    /// The bin in which all objects below a node see the eye, if there is one for sure and the eye is around none of them.
    fn common_bin(&self, node: usize) -> Option<usize> {
        let bounds = &self.boxes.nodes[node];
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let middle = (min + max) * 0.5;
        let to_eye = self.camera.eye() - middle;
        let distance = to_eye.length();
        let radius = (max - min).length() * 0.5;
        // Far above what rounding can move an object's middle or its direction.
        let coordinates = self.camera.eye().abs().max_element() + middle.abs().max_element();
        let margin = radius * 1e-6 + distance * 1e-9 + coordinates * 1e-12;
        // An object's box is in the node's: its middle is at most `radius` away, and so are its corners from that.
        if distance <= 2.0 * (radius + margin) || !distance.is_finite() {
            return None;
        }
        self.tree.directions.bin_around(to_eye, radius + margin)
    }

    /// Asks for objects below `node`, in the frustum, that all have this bin and are not around the eye.
    ///
    /// The triangle around a direction is one of those at its bin, so that what neither the bin nor a neighbour sees needs no
    /// closer look.
    fn ask_bin<T: Hit>(
        &self,
        node: &Node,
        places: Range<u32>,
        bin: usize,
        thresholds: &Thresholds,
        out: &mut Hits<T>,
    ) {
        let (triangle, ring) = (thresholds.triangle.is_some(), thresholds.ring.is_some());
        let neighbours = if triangle || ring { self.tree.directions.ring(bin) } else { &[] };
        let mut length = out.list.len();
        // Room for all: writing each and keeping it or not needs no branch that goes now this way, now that.
        out.list.resize(length + places.len(), T::default());
        for place in places {
            let object = &self.tree.objects[place as usize];
            let height = object.depth - node.depth;
            let sees = |bin: usize| u32::from(self.tree.row_level(object, bin)) >= height;
            let reaches = u32::from(object.max_level) >= height;
            let in_bin = reaches && sees(bin);
            let near = || neighbours.iter().any(|&bin| sees(usize::from(bin)));
            let seen = if thresholds.sizes {
                reaches && (in_bin || near()) && self.draws(place, height, None, thresholds, length, out)
            } else {
                let mut closer = || ring || self.draws(place, height, None, thresholds, length, out);
                in_bin || reaches && near() && closer()
            };
            out.list[length] = T::new(place, height);
            length += usize::from(seen);
        }
        out.list.truncate(length);
    }

    /// Asks for each of the objects, which are below `node`.
    fn ask_each<T: Hit>(
        &self,
        node: &Node,
        places: Range<u32>,
        frustum: &mut Frustum<'_>,
        bins: Option<&SphereBins>,
        thresholds: &Thresholds,
        out: &mut Hits<T>,
    ) {
        self.in_frustum(places, frustum, |place| {
            let object = &self.tree.objects[place as usize];
            let height = object.depth - node.depth;
            if u32::from(object.max_level) < height {
                return;
            }
            let at = out.list.len();
            if self.draws(place, height, bins, thresholds, at, out) {
                out.list.push(T::new(place, height));
            }
        });
    }

    /// Asks for one object, which some bin sees at this height and which would be hit number `at`: whether it is one, be it a
    /// small one.
    #[inline]
    fn draws<T: Hit>(
        &self,
        place: u32,
        height: u32,
        bins: Option<&SphereBins>,
        thresholds: &Thresholds,
        at: usize,
        out: &mut Hits<T>,
    ) -> bool {
        let object = &self.tree.objects[place as usize];
        let bounds = &self.boxes.objects[place as usize];
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let to_eye = self.camera.eye() - (min + max) * 0.5;
        let distance_squared = to_eye.length_squared();
        if is_around(bounds, distance_squared) {
            return true;
        }
        match self.answer(object, height, to_eye, distance_squared, bins, thresholds) {
            Answer::Seen => true,
            Answer::Small(pixels) => {
                out.small.push(Small { at: at as u32, pixels: pixels as f32 });
                true
            }
            Answer::NotSeen if T::MEASURED && thresholds.sizes => {
                let any_size = thresholds.without_sizes();
                if self.answer(object, height, to_eye, distance_squared, bins, &any_size) == Answer::Seen {
                    out.too_small +=
                        self.tree.area(object, height) * thresholds.pixels_squared / distance_squared;
                }
                false
            }
            Answer::NotSeen => false,
        }
    }

    #[inline]
    pub(crate) fn answer(
        &self,
        object: &ObjectRow,
        height: u32,
        to_eye: DVec3,
        distance_squared: f64,
        bins: Option<&SphereBins>,
        thresholds: &Thresholds,
    ) -> Answer {
        let pixels = if thresholds.sizes {
            self.tree.area(object, height) * thresholds.pixels_squared / distance_squared
        } else {
            f64::INFINITY
        };
        let by_size = |pixels: f64| {
            if pixels < thresholds.nearest { Answer::Small(pixels) } else { Answer::Seen }
        };
        // A row's levels fit a byte, and heights beyond the highest level were sorted out.
        let sees = |bin: usize| u32::from(self.tree.row_level(object, bin)) >= height;
        match bins {
            Some(SphereBins::Any(bins)) if bins.iter().any(|&bin| sees(bin)) => by_size(pixels),
            Some(SphereBins::All) => by_size(pixels),
            Some(SphereBins::Weighted(bins)) => {
                let weight: f64 = bins.iter().filter(|(bin, _)| sees(*bin)).map(|(_, w)| w).sum();
                if weight > 0.0 { by_size(pixels * weight) } else { Answer::NotSeen }
            }
            Some(SphereBins::Any(_)) => Answer::NotSeen,
            None => {
                let directions = self.tree.directions;
                let nearest = directions.nearest_f64(to_eye);
                let large = |stage: Option<f64>| stage.is_some_and(|least| pixels >= least);
                let any = |bins: &[u16]| bins.iter().any(|&bin| sees(usize::from(bin)));
                if sees(nearest) {
                    by_size(pixels)
                } else if large(thresholds.triangle) && any(&directions.weights_f64(to_eye).0)
                    || large(thresholds.ring) && any(directions.ring(nearest))
                {
                    Answer::Seen
                } else {
                    Answer::NotSeen
                }
            }
        }
    }

    /// Bins that can make [`Self::answer`] draw an object, for explaining; for [`SphereBins::All`] all of them.
    pub(crate) fn bins_asked(&self, to_eye: DVec3, bins: Option<&SphereBins>) -> Vec<usize> {
        let directions = self.tree.directions;
        match bins {
            Some(SphereBins::Any(bins)) => bins.to_vec(),
            Some(SphereBins::Weighted(bins)) => bins.map(|(bin, _)| bin).to_vec(),
            Some(SphereBins::All) => (0..directions.len()).collect(),
            None => {
                let thresholds = self.thresholds();
                let nearest = directions.nearest_f64(to_eye);
                let mut asked = vec![nearest];
                if thresholds.triangle.is_some() {
                    asked.extend(directions.weights_f64(to_eye).0.map(usize::from));
                }
                if thresholds.ring.is_some() {
                    asked.extend(directions.ring(nearest).iter().map(|&bin| usize::from(bin)));
                }
                asked
            }
        }
    }

    /// `None` if each object uses its own direction.
    pub(crate) fn sphere_bins(&self, node: &Node) -> Option<SphereBins> {
        let directions = self.tree.directions;
        let to_eye = self.camera.eye() - node.center.as_dvec3();
        Some(match self.settings.query {
            Query::Object => return None,
            Query::SphereNearest => SphereBins::Any([directions.nearest_f64(to_eye); 3]),
            Query::SphereMax3 => SphereBins::Any(directions.weights_f64(to_eye).0.map(usize::from)),
            Query::SphereWeighted3 => {
                let (triangle, weights) = directions.weights_f64(to_eye);
                SphereBins::Weighted([0, 1, 2].map(|k| (usize::from(triangle[k]), f64::from(weights[k]))))
            }
            Query::SphereMaxAll => SphereBins::All,
        })
    }
}
