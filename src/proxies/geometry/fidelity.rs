//! How much of what a proxy stands for is shown wrong: by area, so that one small part that is gone does not decide.

use super::likeness::{TriangleLook, looks};
use super::soup::Soup;
use super::tree::TriangleTree;
use glam::{DVec3, Vec3, Vec3A};
use rayon::prelude::*;

/// A difference in looks, of 0 to 1, from which on a place counts as shown all wrong. Something dropped shows what is behind
/// it, and that is seldom as different as black and white.
const ALL_WRONG: f32 = 0.25;

/// Pixels of a distance at which a place counts as half wrong, as [`svs_runtime`] has it.
const HALF_WRONG: f64 = 8.0;

/// Means over places that are spread by area.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fidelity {
    /// Mean distance, metres.
    pub mean: f64,
    /// Root mean square of the distances, metres.
    pub rms: f64,
    /// How much of it has other colours or faces elsewhere, 0 to 1.
    pub wrong: f64,
}

impl Fidelity {
    /// The worse of the two in each figure.
    pub(super) fn max(self, other: Self) -> Self {
        Self {
            mean: self.mean.max(other.mean),
            rms: self.rms.max(other.rms),
            wrong: self.wrong.max(other.wrong),
        }
    }
}

/// A place on an original surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    /// Relative to the proxy's origin, metres.
    pub(super) point: [f32; 3],
    pub(super) look: TriangleLook,
    /// What it is one place of, square metres.
    pub(super) area: f32,
}

/// Places that stand for those of several surfaces, at most `count`: each for about the same area.
pub(super) fn thinned(places: &[Place], count: usize) -> Vec<Place> {
    let total: f64 = places.iter().map(|place| f64::from(place.area)).sum();
    if places.len() <= count || total.is_nan() || total <= 0.0 {
        return places.to_vec();
    }
    let step = total / count as f64;
    let mut thinned = Vec::with_capacity(count);
    let mut sum = 0.0;
    for place in places {
        sum += f64::from(place.area);
        while sum > (thinned.len() as f64 + 0.5) * step && thinned.len() < count {
            thinned.push(Place { area: step as f32, ..*place });
        }
    }
    thinned
}

/// Moves places to another origin.
pub(super) fn moved(places: &[Place], by: DVec3) -> impl Iterator<Item = Place> + '_ {
    places.iter().map(move |place| Place {
        point: (Vec3::from_array(place.point).as_dvec3() + by).as_vec3().to_array(),
        ..*place
    })
}

/// A surface to compare places with.
pub(super) struct Target {
    tree: TriangleTree,
    looks: Vec<TriangleLook>,
}

/// What comparing showed.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Comparison {
    pub(super) fidelity: Fidelity,
    /// Largest distance, metres.
    pub(super) max: f64,
    /// Share that is shown wrong where a pixel is as large as was asked for.
    pub(super) loss: f64,
}

impl Target {
    pub(super) fn new(soup: &Soup) -> Self {
        Self { tree: TriangleTree::new(&soup.surface().triangles()), looks: looks(soup) }
    }

    /// Nearest triangle of each place; empty if there is none.
    pub(super) fn nearest(&self, places: &[Place]) -> Vec<(f32, u32)> {
        let nearest: Option<Vec<(f32, u32)>> = places
            .par_iter()
            .with_min_len(64)
            .map_init(Vec::new, |stack, place| self.tree.nearest(Vec3A::from(place.point), stack))
            .collect();
        nearest.unwrap_or_default()
    }

    /// Compares; `None` if there is nothing to compare with. `pixel` in metres.
    pub(super) fn compare(&self, places: &[Place], pixel: f64) -> Option<Comparison> {
        let nearest = self.nearest(places);
        let mut sums = Comparison::default();
        let mut total = 0.0;
        for (place, &(distance, triangle)) in places.iter().zip(&nearest) {
            let (area, distance) = (f64::from(place.area), f64::from(distance));
            let difference = place.look.difference(&self.looks[triangle as usize]);
            let wrong = f64::from((difference / ALL_WRONG).min(1.0));
            let off = distance / (distance + HALF_WRONG * pixel).max(f64::MIN_POSITIVE);
            sums.fidelity.mean += area * distance;
            sums.fidelity.rms += area * distance * distance;
            sums.fidelity.wrong += area * wrong;
            sums.loss += area * (1.0 - (1.0 - off) * (1.0 - wrong));
            sums.max = sums.max.max(distance);
            total += area;
        }
        if total.is_nan() || total <= 0.0 {
            return None;
        }
        let Fidelity { mean, rms, wrong } = sums.fidelity;
        sums.fidelity = Fidelity { mean: mean / total, rms: (rms / total).sqrt(), wrong: wrong / total };
        sums.loss /= total;
        Some(sums)
    }
}
