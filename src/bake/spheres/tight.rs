//! Tight spheres: smallest ball of the extreme points, made that of all vertices.
//!
//! Larsson's method enlarges the ball of the extreme points until it holds all vertices. Here the farthest vertex
//! outside joins the extreme points and the ball is computed anew, which ends at the smallest ball of all vertices
//! after a few rounds. Memory does not grow with the number of vertices: a batch of nodes is open at a time.

use super::epos98::Extremes;
use super::exact_ball::exact_ball;
use super::points::PlacedPart;
use super::{Geometry, round, storable};
use crate::bake::tree::Sphere;
use glam::DVec3;
use rayon::prelude::*;

/// Rounds before the rest is left to enlarging.
const ROUNDS: usize = 16;

/// Vertices this far outside (part of the radius) do not move the centre.
const TOLERANCE: f64 = 1e-6;

/// Members whose extreme points are computed at once, and nodes whose balls are.
const BATCH: usize = 512;

/// The smallest ball that holds all vertices of some parts, given their extreme points; `None` without vertices. Its
/// radius holds all of them, its centre is the smallest ball's but for `TOLERANCE`.
pub(super) fn ball<'a, P>(mut points: Vec<DVec3>, parts: impl Fn() -> P) -> Option<Sphere>
where
    P: Iterator<Item = PlacedPart<'a>>,
{
    let mut ball = exact_ball(&points)?;
    for _ in 0..ROUNDS {
        let limit = ball.radius * (1.0 + TOLERANCE);
        let Some((point, _)) = farthest(parts(), ball.center, limit * limit) else { break };
        points.push(point);
        ball = exact_ball(&points)?;
    }
    Some(about(ball.center, &points, parts()))
}

/// The smallest sphere about `center` that holds all vertices of the parts, some of which are `points`.
fn about<'a>(center: DVec3, points: &[DVec3], parts: impl Iterator<Item = PlacedPart<'a>>) -> Sphere {
    let squared = points.iter().map(|point| point.distance_squared(center)).fold(0.0, f64::max);
    let squared = farthest(parts, center, squared).map_or(squared, |(_, squared)| squared);
    Sphere { center, radius: squared.sqrt() }
}

fn farthest<'a>(
    parts: impl Iterator<Item = PlacedPart<'a>>,
    center: DVec3,
    squared: f64,
) -> Option<(DVec3, f64)> {
    parts
        .fold(None, |best, part| part.farthest(center, best.map_or(squared, |(_, squared)| squared)).or(best))
}

/// One sphere per node.
pub(super) fn spheres(geometry: &Geometry<'_>) -> Vec<Sphere> {
    let nodes = &geometry.hierarchy.nodes;
    let mut spheres = vec![Sphere { center: DVec3::ZERO, radius: 0.0 }; nodes.len()];
    // Extreme points gathered so far, for the ancestors of the current node alone.
    let mut open: Vec<Option<Box<Extremes>>> = vec![None; nodes.len()];
    // Extreme points of the members at the places from `first` on.
    let mut members = Vec::new();
    let mut first = geometry.hierarchy.order.len() as u32;
    let mut batch = Vec::with_capacity(BATCH);
    // Backwards through depth-first order, children come before their parents and places descend.
    for node in (0..nodes.len()).rev() {
        let mut extremes = open[node].take().unwrap_or_else(|| Box::new(Extremes::EMPTY));
        for place in geometry.direct_places(node).rev() {
            if place < first {
                first = (place + 1).saturating_sub(BATCH as u32);
                members = (first..=place).into_par_iter().map(|place| of_member(geometry, place)).collect();
            }
            extremes.merge(&members[(place - first) as usize]);
        }
        batch.push((node, extremes.points()));
        if let Some(parent) = nodes[node].parent {
            let above = &mut open[parent as usize];
            match above {
                Some(above) => above.merge(&extremes),
                None => *above = Some(extremes),
            }
        }
        if batch.len() == BATCH || node == 0 {
            let done: Vec<(usize, Sphere)> =
                batch.par_drain(..).map(|(node, points)| (node, of_node(geometry, node, points))).collect();
            for (node, sphere) in done {
                spheres[node] = sphere;
            }
        }
    }
    spheres
}

/// The extreme points of the member at a place.
pub(super) fn of_member(geometry: &Geometry<'_>, place: u32) -> Extremes {
    let mut extremes = Extremes::EMPTY;
    for part in geometry.parts_at(place) {
        extremes.add_part(&part);
    }
    extremes
}

fn of_node(geometry: &Geometry<'_>, node: usize, points: Vec<DVec3>) -> Sphere {
    let places = geometry.hierarchy.nodes[node].members.clone();
    let parts = || places.clone().flat_map(|place| geometry.parts_at(place));
    match ball(points.clone(), parts) {
        Some(ball) => {
            let sphere = about(round(ball.center), &points, parts());
            storable(sphere.center, sphere.radius)
        }
        None => geometry.point_sphere(node),
    }
}
