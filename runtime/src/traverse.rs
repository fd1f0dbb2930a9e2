//! One pass over a tree for one camera: the hot path.
//!
//! Nodes are walked in depth-first order with skip pointers, without a stack. A node whose sphere can be used answers for
//! all objects below it; what hangs below no such node is drawn if it is in the frustum.

use crate::bounds::Bounds;
use crate::camera::{Camera, Containment};
use crate::estimate::is_around;
use crate::query::{Query, Settings};
use crate::tree::{Node, ObjectRow, Tree};
use glam::DVec3;
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

/// An object to draw, as a pass reports it: its place alone, or with what an estimate of its size needs.
pub(crate) trait Hit: Copy {
    /// Sizes are wanted: what is dropped for its size is added up.
    const MEASURED: bool;
    /// `height` is that of the sphere that answered, above the object; 0 if the frustum alone decided.
    fn new(place: u32, height: u32) -> Self;
    /// Place in tree order.
    fn place(self) -> u32;
}

impl Hit for u32 {
    const MEASURED: bool = false;
    #[inline]
    fn new(place: u32, _: u32) -> Self {
        place
    }
    #[inline]
    fn place(self) -> u32 {
        self
    }
}

/// An object and the height of the sphere that answered for it, 0 without.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Measured {
    pub(crate) place: u32,
    pub(crate) height: u32,
}

impl Hit for Measured {
    const MEASURED: bool = true;
    #[inline]
    fn new(place: u32, height: u32) -> Self {
        Self { place, height }
    }
    #[inline]
    fn place(self) -> u32 {
        self.place
    }
}

/// What passes report.
#[derive(Clone, Debug, Default)]
pub(crate) struct Hits<T> {
    pub(crate) list: Vec<T>,
    /// Estimated visible pixels of what was dropped only for its size, if that is measured.
    pub(crate) too_small: f64,
}

/// Boxes of a tree's objects and nodes.
#[derive(Debug)]
pub(crate) struct Boxes {
    pub(crate) objects: Vec<Bounds>,
    /// Union of the objects' boxes: always right, and mostly tighter than the sphere.
    pub(crate) nodes: Vec<Bounds>,
}

/// Objects hidden at run time, and per node how many disturbances there are below it.
#[derive(Clone, Debug)]
pub(crate) struct Hidden {
    pub(crate) objects: Vec<bool>,
    pub(crate) below: Vec<u32>,
}

/// Everything a pass reads.
pub(crate) struct Pass<'a> {
    pub(crate) tree: &'a Tree,
    pub(crate) boxes: &'a Boxes,
    pub(crate) hidden: Option<&'a Hidden>,
    pub(crate) camera: &'a Camera,
    pub(crate) settings: &'a Settings,
}

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

/// The bins a sphere query asks, the same for all objects below a node.
pub(crate) enum SphereBins {
    Weighted([(usize, f64); 3]),
    Any([usize; 3]),
    All,
}

impl Pass<'_> {
    /// Appends the places of the objects to draw, ascending.
    pub(crate) fn run<T: Hit>(&self, out: &mut Hits<T>) -> CullStatistics {
        let thresholds = self.thresholds();
        let max_sine = self.max_sine();
        let mut statistics = CullStatistics::default();
        let before = out.list.len();
        let nodes = self.tree.nodes();
        // Objects up to here are dealt with, and objects up to there are known to be in the frustum.
        let (mut place, mut inside_end) = (0, if self.settings.frustum { 0 } else { u32::MAX });
        let mut index = 0;
        while index < nodes.len() {
            let node = &nodes[index];
            let objects = node.objects();
            // What lies between hangs on an ancestor (or on nothing), and no sphere above it could be used.
            self.draw_in_frustum(place..objects.start, inside_end, out, &mut statistics);
            place = objects.start;
            let skip = index + node.subtree as usize;
            if objects.is_empty() {
                index = skip;
                continue;
            }
            if objects.end > inside_end {
                match self.camera.contains(&self.boxes.nodes[index]) {
                    Containment::Outside => {
                        (place, index) = (objects.end, skip);
                        continue;
                    }
                    Containment::Inside => inside_end = objects.end,
                    Containment::Intersects => {}
                }
            }
            statistics.spheres_tested += 1;
            if self.is_usable(index, node, max_sine) {
                statistics.spheres_used += 1;
                self.scan(node, objects.end <= inside_end, &thresholds, out, &mut statistics);
                (place, index) = (objects.end, skip);
            } else {
                index += 1;
            }
        }
        self.draw_in_frustum(place..self.tree.object_count, inside_end, out, &mut statistics);
        statistics.drawn = out.list.len() - before;
        statistics
    }

    /// Sine of the largest half-angle at which spheres are used.
    pub(crate) fn max_sine(&self) -> f64 {
        match self.settings.max_half_angle {
            t if t < FRAC_PI_2 => f64::from(t.max(0.0)).sin(),
            _ => 1.0,
        }
    }

    pub(crate) fn thresholds(&self) -> Thresholds {
        let tau = &self.settings.tau;
        let stage = |t: f32| (t < f32::INFINITY).then(|| f64::from(t.max(tau.nearest)));
        let (triangle, ring) = (stage(tau.triangle), stage(tau.ring));
        let sizes = tau.nearest > 0.0 || [triangle, ring].iter().flatten().any(|&t| t > 0.0);
        let pixels = self.camera.pixels_per_radian();
        Thresholds { nearest: f64::from(tau.nearest), triangle, ring, sizes, pixels_squared: pixels * pixels }
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
        inside_end: u32,
        out: &mut Hits<T>,
        statistics: &mut CullStatistics,
    ) {
        statistics.objects_tested += places.len();
        for place in places {
            let visible = place < inside_end || self.camera.sees(&self.boxes.objects[place as usize]);
            if visible && self.hidden.is_none_or(|hidden| !hidden.objects[place as usize]) {
                out.list.push(T::new(place, 0));
            }
        }
    }

    /// Asks a usable node for all objects below it.
    fn scan<T: Hit>(
        &self,
        node: &Node,
        inside: bool,
        thresholds: &Thresholds,
        out: &mut Hits<T>,
        statistics: &mut CullStatistics,
    ) {
        statistics.objects_tested += node.object_count as usize;
        let bins = self.sphere_bins(node);
        for place in node.objects() {
            let object = &self.tree.objects[place as usize];
            let height = object.depth - node.depth;
            if u32::from(object.max_level) < height {
                continue;
            }
            let bounds = &self.boxes.objects[place as usize];
            if !inside && !self.camera.sees(bounds) {
                continue;
            }
            let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
            let to_eye = self.camera.eye() - (min + max) * 0.5;
            let distance_squared = to_eye.length_squared();
            // Some bin sees it at this height.
            let around = is_around(bounds, distance_squared);
            let passes = |least: &Thresholds| {
                self.passes(object, height, to_eye, distance_squared, bins.as_ref(), least)
            };
            if around || passes(thresholds) {
                out.list.push(T::new(place, height));
            } else if T::MEASURED && thresholds.sizes && passes(&thresholds.without_sizes()) {
                out.too_small +=
                    self.tree.area(object, height) * thresholds.pixels_squared / distance_squared;
            }
        }
    }

    pub(crate) fn passes(
        &self,
        object: &ObjectRow,
        height: u32,
        to_eye: DVec3,
        distance_squared: f64,
        bins: Option<&SphereBins>,
        thresholds: &Thresholds,
    ) -> bool {
        let pixels = if thresholds.sizes {
            self.tree.area(object, height) * thresholds.pixels_squared / distance_squared
        } else {
            f64::INFINITY
        };
        if pixels < thresholds.nearest {
            return false;
        }
        // A row's levels fit a byte, and heights beyond the highest level were sorted out.
        let sees = |bin: usize| u32::from(self.tree.row_level(object, bin)) >= height;
        match bins {
            Some(SphereBins::Any(bins)) => bins.iter().any(|&bin| sees(bin)),
            Some(SphereBins::All) => true,
            Some(SphereBins::Weighted(bins)) => {
                let weight: f64 = bins.iter().filter(|(bin, _)| sees(*bin)).map(|(_, w)| w).sum();
                weight > 0.0 && pixels * weight >= thresholds.nearest
            }
            None => {
                let directions = self.tree.directions;
                let nearest = directions.nearest_f64(to_eye);
                let large = |stage: Option<f64>| stage.is_some_and(|least| pixels >= least);
                let any = |bins: &[u16]| bins.iter().any(|&bin| sees(usize::from(bin)));
                sees(nearest)
                    || large(thresholds.triangle) && any(&directions.weights_f64(to_eye).0)
                    || large(thresholds.ring) && any(directions.ring(nearest))
            }
        }
    }

    /// Bins that can make [`Self::passes`] draw an object, for explaining; for [`SphereBins::All`] all of them.
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

impl Boxes {
    /// One valid box per object; boxes of the nodes are made from them, linear in nodes plus objects.
    pub(crate) fn new(tree: &Tree, objects: &[Bounds]) -> Self {
        let mut nodes = vec![Bounds::EMPTY; tree.nodes().len()];
        let parents = parents(tree);
        // Each object goes to its innermost node; then children, which come later, are added to their parents.
        for (place, node) in innermost(tree).into_iter().enumerate() {
            if let Some(node) = node {
                nodes[node as usize].extend(&objects[place]);
            }
        }
        for node in (0..nodes.len()).rev() {
            if let Some(parent) = parents[node] {
                let child = nodes[node];
                nodes[parent as usize].extend(&child);
            }
        }
        Self { objects: objects.to_vec(), nodes }
    }
}

/// Parent of each node.
pub(crate) fn parents(tree: &Tree) -> Vec<Option<u32>> {
    let mut open: Vec<u32> = Vec::new();
    let nodes = tree.nodes();
    (0..nodes.len() as u32)
        .map(|index| {
            open.truncate(nodes[index as usize].depth as usize);
            let parent = open.last().copied();
            open.push(index);
            parent
        })
        .collect()
}

/// Innermost node above each object; empty without nodes.
pub(crate) fn innermost(tree: &Tree) -> Vec<Option<u32>> {
    let nodes = tree.nodes();
    let mut result = vec![None; tree.objects.len()];
    for (index, node) in nodes.iter().enumerate() {
        // A node's own objects come first: they end where its first child's begin.
        let first_child = nodes.get(index + 1).filter(|_| node.subtree > 1);
        let end = first_child.map_or(node.objects().end, |child| child.first_object);
        for place in node.first_object..end {
            result[place as usize] = Some(index as u32);
        }
    }
    result
}
