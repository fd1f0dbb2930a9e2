//! The geometric error of a simplified surface, measured: how far points of one surface are from the other, both ways.
//!
//! The maximum is an estimate of the Hausdorff distance from samples and vertices (Cignoni, Rocchini, Scopigno: Metro,
//! 1998): never above it, and below it only by what lies between the samples.

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
    let reference = Reference::new(original, samples);
    reference.deviation(simplified)
}

/// An original surface, prepared for several comparisons.
pub(super) struct Reference {
    tree: TriangleTree,
    points: Points,
    samples: usize,
    diagonal: f64,
    /// By triangle; empty if only geometry counts.
    looks: Vec<TriangleLook>,
}

/// Sample points: as many as there are `triangles` are spread by area, the others are vertices.
#[derive(Clone, Debug, Default)]
struct Points {
    points: Vec<[f32; 3]>,
    /// Where the area samples are.
    triangles: Vec<u32>,
}

/// One way of a comparison.
struct OneWay {
    deviation: Deviation,
    /// By area sample: nearest triangle of the other surface.
    nearest: Vec<u32>,
}

impl Reference {
    fn new(surface: Surface<'_>, samples: usize) -> Self {
        let tree = TriangleTree::new(&surface.triangles());
        let points = surface.samples(samples);
        Self { tree, points, samples, diagonal: surface.diagonal(), looks: Vec::new() }
    }

    /// An original whose looks count too.
    pub(super) fn of_soup(soup: &Soup, samples: usize) -> Self {
        Self { looks: looks(soup), ..Self::new(soup.surface(), samples) }
    }

    /// Diagonal of its box, metres.
    pub(super) fn diagonal(&self) -> f64 {
        self.diagonal
    }

    fn deviation(&self, simplified: Surface<'_>) -> Deviation {
        let (deviation, _, _) = self.both_ways(simplified);
        deviation
    }

    /// How far a simplified version is off, and how different it looks, from 0 to 1.
    pub(super) fn compare(&self, simplified: &Soup) -> (Deviation, f64) {
        let (deviation, there, back) = self.both_ways(simplified.surface());
        let (Some(there), Some((points, back))) = (there, back) else { return (deviation, 1.0) };
        let others = looks(simplified);
        let look = |own: &[u32], other: &[u32], a: &[TriangleLook], b: &[TriangleLook]| {
            let (mut sum, mut count) = (0.0f64, 0.0f64);
            for (&i, &j) in own.iter().zip(other) {
                if let (Some(a), Some(b)) = (a.get(i as usize), b.get(j as usize)) {
                    sum += f64::from(a.difference(b));
                    count += 1.0;
                }
            }
            if count > 0.0 { sum / count } else { 0.0 }
        };
        let there = look(&self.points.triangles, &there.nearest, &self.looks, &others);
        let back = look(&points.triangles, &back.nearest, &others, &self.looks);
        (deviation, there.max(back))
    }

    fn both_ways(&self, simplified: Surface<'_>) -> (Deviation, Option<OneWay>, Option<(Points, OneWay)>) {
        let there = one_way(&self.points, &TriangleTree::new(&simplified.triangles()));
        let points = simplified.samples(self.samples);
        let back = one_way(&points, &self.tree);
        let deviation = match (&there, &back) {
            (Some(OneWay { deviation: a, .. }), Some(OneWay { deviation: b, .. })) => {
                Deviation { max: a.max.max(b.max), mean: a.mean.max(b.mean) }
            }
            // One of the two is empty, or both are.
            _ => {
                let missing = self.diagonal.max(simplified.diagonal());
                Deviation { max: missing, mean: missing }
            }
        };
        (deviation, there, back.map(|back| (points, back)))
    }
}

/// Distances of points from a surface; `None` if either is empty.
fn one_way(points: &Points, tree: &TriangleTree) -> Option<OneWay> {
    let nearest: Vec<(f32, u32)> = points
        .points
        .par_iter()
        .with_min_len(64)
        .map_init(Vec::new, |stack, &point| tree.nearest(Vec3A::from(point), stack))
        .collect::<Option<_>>()?;
    let max = nearest.iter().map(|&(distance, _)| distance).reduce(f32::max)?;
    let by_area = &nearest[..points.triangles.len()];
    let sum: f64 = by_area.iter().map(|&(distance, _)| f64::from(distance)).sum();
    let mean = sum / by_area.len().max(1) as f64;
    let nearest = by_area.iter().map(|&(_, triangle)| triangle).collect();
    Some(OneWay { deviation: Deviation { max: f64::from(max), mean }, nearest })
}

impl Surface<'_> {
    fn corners(&self) -> impl Iterator<Item = [usize; 3]> + '_ {
        let count = self.positions.len();
        let all = self.indices.chunks_exact(3).map(|c| [c[0] as usize, c[1] as usize, c[2] as usize]);
        all.filter(move |corners| corners.iter().all(|&v| v < count))
    }

    fn triangles(&self) -> Vec<Triangle> {
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

    /// `count` points spread by area and at most as many vertices, evenly chosen.
    fn samples(&self, count: usize) -> Points {
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
        let chosen = count.min(vertices.len());
        points.extend((0..chosen).map(|i| self.positions[vertices[i * vertices.len() / chosen]]));
        Points { points, triangles }
    }
}
