//! The geometric error of a simplified surface, measured: how far points of one surface are from the other, both ways.
//!
//! The maximum is an estimate of the Hausdorff distance from samples and vertices (Cignoni, Rocchini, Scopigno: Metro,
//! 1998): never above it, and below it only by what lies between the samples.

use super::fidelity::{Fidelity, Place, Target};
use super::likeness::{TriangleLook, looks};
use super::sequence::{square, weights};
use super::soup::{Soup, area};
use super::tree::TriangleTree;
use glam::{DVec3, Vec3A};
use obvhs::triangle::Triangle;
use rayon::prelude::*;

/// Triangles, as far as measuring is concerned.
#[derive(Clone, Copy, Debug)]
pub struct Surface<'a> {
    /// Finite, metres.
    pub positions: &'a [[f32; 3]],
    /// Three a triangle, in range.
    pub indices: &'a [u32],
}

/// How far two surfaces are apart, metres.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviation {
    /// Largest distance of a sample of either surface from the other.
    pub max: f64,
    /// Mean distance of area samples; the larger one of the two ways.
    pub mean: f64,
}

/// Compares two surfaces by about `samples` points of each (area samples, and as many vertices). If only one of them has
/// triangles, everything is missing: the deviation is the diagonal of its box.
pub fn measure(original: Surface<'_>, simplified: Surface<'_>, samples: usize) -> Deviation {
    let [there, back] = [(original, simplified), (simplified, original)]
        .map(|(from, to)| one_way(&from.samples(samples, samples), &TriangleTree::new(&to.triangles())));
    match (there, back) {
        (Some(a), Some(b)) => Deviation { max: a.max.max(b.max), mean: a.mean.max(b.mean) },
        // One of the two is empty, or both are.
        _ => {
            let missing = original.diagonal().max(simplified.diagonal());
            Deviation { max: missing, mean: missing }
        }
    }
}

/// Sample points: as many as there are `triangles` are spread by area, the others are vertices.
#[derive(Clone, Debug, Default)]
struct Points {
    points: Vec<[f32; 3]>,
    /// Where the area samples are.
    triangles: Vec<u32>,
}

/// Distances of points from a surface; `None` if either is empty.
fn one_way(points: &Points, tree: &TriangleTree) -> Option<Deviation> {
    let nearest: Vec<(f32, u32)> = points
        .points
        .par_iter()
        .with_min_len(64)
        .map_init(Vec::new, |stack, &point| tree.nearest(Vec3A::from(point), stack))
        .collect::<Option<_>>()?;
    let max = nearest.iter().map(|&(distance, _)| distance).reduce(f32::max)?;
    let by_area = &nearest[..points.triangles.len()];
    let sum: f64 = by_area.iter().map(|&(distance, _)| f64::from(distance)).sum();
    Some(Deviation { max: f64::from(max), mean: sum / by_area.len().max(1) as f64 })
}

/// An original surface, prepared for several comparisons.
pub(super) struct Reference {
    target: Target,
    /// Spread by area.
    places: Vec<Place>,
    /// Some of them, for trials.
    few: Vec<Place>,
    /// Vertices.
    corners: Vec<Place>,
    samples: usize,
    diagonal: f64,
    /// Area, square metres.
    area: f64,
}

/// Trials are compared with this part of the samples.
const FEW: usize = 4;

impl Reference {
    pub(super) fn of_soup(soup: &Soup, samples: usize) -> Self {
        let surface = soup.surface();
        let looks = looks(soup);
        let places = places(soup, &looks, samples);
        Self {
            few: places.iter().copied().step_by(FEW).collect(),
            corners: surface.corners_of(samples),
            places,
            target: Target::new(soup),
            samples,
            diagonal: surface.diagonal(),
            area: surface.area(),
        }
    }

    /// Diagonal of its box, metres.
    pub(super) fn diagonal(&self) -> f64 {
        self.diagonal
    }

    /// Places spread by its area.
    pub(super) fn places(&self) -> &[Place] {
        &self.places
    }

    /// Size in metres of a pixel where `triangles` of the surface are as large as they usually are when they are drawn.
    pub(super) fn pixel(&self, triangles: usize) -> f64 {
        (self.area / (PIXELS_OF_A_TRIANGLE * triangles.max(1) as f64)).sqrt()
    }

    /// Share of what is seen that a simplified version shows wrong, from few samples, and a little for the largest distance:
    /// of two that show as much right, the one is better that cuts off no corners. `pixel` in metres.
    pub(super) fn trial(&self, simplified: &Soup, pixel: f64) -> f64 {
        let samples = self.samples.div_ceil(FEW);
        let target = Target::new(simplified);
        let there = target.compare(&self.few, pixel);
        let most = target
            .nearest(&self.corners)
            .iter()
            .map(|&(distance, _)| f64::from(distance))
            .fold(0.0, f64::max);
        let largest = most / (most + self.diagonal).max(f64::MIN_POSITIVE);
        let back = self.target.compare(&places(simplified, &looks(simplified), samples), pixel);
        match (there, back) {
            (Some(there), Some(back)) => there.loss.max(back.loss) + LARGEST_WEIGHT * largest,
            _ => 1.0,
        }
    }

    /// How far a simplified version is off: the largest distance, and the figures by area both ways. What it stands for is at
    /// `originals`, or this surface itself.
    pub(super) fn compare(&self, simplified: &Soup, originals: Option<&[Place]>) -> (f64, Fidelity) {
        let target = Target::new(simplified);
        let back = places(simplified, &looks(simplified), self.samples);
        let back_corners = simplified.surface().corners_of(self.samples);
        let (Some(there), Some(back)) = (target.compare(&self.places, 1.0), self.target.compare(&back, 1.0))
        else {
            let missing = self.diagonal.max(simplified.surface().diagonal());
            let wrong = if missing > 0.0 { 1.0 } else { 0.0 };
            return (missing, Fidelity { mean: missing, rms: missing, wrong });
        };
        let corners = [target.nearest(&self.corners), self.target.nearest(&back_corners)];
        let corners = corners.iter().flatten().map(|&(distance, _)| f64::from(distance));
        let max = corners.fold(there.max.max(back.max), f64::max);
        let originals = originals.and_then(|originals| target.compare(originals, 1.0));
        (max, originals.unwrap_or(there).fidelity.max(back.fidelity))
    }
}

/// What cutting off as much as half the surface's extent counts beside showing all of it wrong.
const LARGEST_WEIGHT: f64 = 0.02;

/// About as large is a triangle of a proxy that is drawn, pixels.
const PIXELS_OF_A_TRIANGLE: f64 = 64.0;

/// `count` places spread over a surface by area.
pub(super) fn places(soup: &Soup, looks: &[TriangleLook], count: usize) -> Vec<Place> {
    let surface = soup.surface();
    let Points { points, triangles } = surface.samples(count, 0);
    let area = (surface.area() / count.max(1) as f64) as f32;
    let place =
        |(point, triangle): (&[f32; 3], &u32)| Place { point: *point, look: looks[*triangle as usize], area };
    points.iter().zip(&triangles).map(place).collect()
}

impl Surface<'_> {
    fn corners(&self) -> impl Iterator<Item = [usize; 3]> + '_ {
        let count = self.positions.len();
        let all = self.indices.chunks_exact(3).map(|c| [c[0] as usize, c[1] as usize, c[2] as usize]);
        all.filter(move |corners| corners.iter().all(|&v| v < count))
    }

    pub(super) fn triangles(&self) -> Vec<Triangle> {
        let triangle = |corners: [usize; 3]| {
            let [v0, v1, v2] = corners.map(|v| Vec3A::from(self.positions[v]));
            Triangle { v0, v1, v2 }
        };
        self.corners().map(triangle).collect()
    }

    fn diagonal(&self) -> f64 {
        let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for vertex in self.corners().flatten() {
            let p = DVec3::from_array(self.positions[vertex].map(f64::from));
            min = min.min(p);
            max = max.max(p);
        }
        if min.x <= max.x { (max - min).length() } else { 0.0 }
    }

    /// Square metres.
    fn area(&self) -> f64 {
        self.corners().map(|corners| area(corners.map(|v| self.positions[v]))).sum()
    }

    /// At most `count` of the vertices, as places that are no part of the area.
    fn corners_of(&self, count: usize) -> Vec<Place> {
        let points = self.samples(0, count).points;
        points.into_iter().map(|point| Place { point, look: TriangleLook::default(), area: 0.0 }).collect()
    }

    /// `count` points spread by area and at most so many of the vertices, evenly chosen.
    fn samples(&self, count: usize, most_vertices: usize) -> Points {
        let corners: Vec<[usize; 3]> = self.corners().collect();
        let mut sums = Vec::with_capacity(corners.len());
        let mut total = 0.0f64;
        for corners in &corners {
            total += area(corners.map(|v| self.positions[v]));
            sums.push(total);
        }
        let (mut points, mut triangles) = (Vec::new(), Vec::new());
        if total > 0.0 && total.is_finite() {
            for i in 0..count {
                let at = (i as f64 + 0.5) / count as f64 * total;
                let triangle = sums.partition_point(|&sum| sum < at).min(corners.len() - 1);
                let weights = weights(square(i));
                let mut point = [0.0f64; 3];
                for (&vertex, weight) in corners[triangle].iter().zip(weights) {
                    for (sum, c) in point.iter_mut().zip(self.positions[vertex]) {
                        *sum += f64::from(c) * weight;
                    }
                }
                points.push(point.map(|c| c as f32));
                triangles.push(triangle as u32);
            }
        }
        let mut used = vec![false; self.positions.len()];
        let vertices: Vec<usize> =
            corners.iter().flatten().copied().filter(|&v| !std::mem::replace(&mut used[v], true)).collect();
        let chosen = most_vertices.min(vertices.len());
        points.extend((0..chosen).map(|i| self.positions[vertices[i * vertices.len() / chosen]]));
        Points { points, triangles }
    }
}
