//! Which triangles of a node can be seen from outside of it.
//!
//! Two samplings that make up for each other: lines through the node's sphere, spread evenly over all lines, find what
//! shows large; rays from each triangle not yet found find what is small or seen through narrow gaps.

use super::palette::Palette;
use super::sequence::{cube4, direction, weights};
use super::soup::Soup;
use super::tree::TriangleTree;
use glam::DVec3;
use obvhs::triangle::Triangle;
use rayon::prelude::*;
use std::collections::HashSet;
use std::sync::atomic::{AtomicBool, Ordering};

/// Lines through the sphere: at least this many …
const LEAST_LINES: usize = 2048;
/// … and this many per triangle, but no more than …
const LINES_PER_TRIANGLE: usize = 2;
/// … this many.
const MOST_LINES: usize = 1 << 20;

/// Rays from a triangle that no line has found: at least this many …
const LEAST_RAYS: usize = 24;
/// … plus one for each of these parts of the sphere's cross section, but no more than …
const PART_OF_SECTION: f64 = 1.0 / 4096.0;
/// … this many.
const MOST_RAYS: usize = 256;

/// Surfaces nearer to each other than this, in radii of the sphere, hide each other no more than they flicker.
const TOUCHING: f32 = 1.0 / 65_536.0;

/// Hides what is behind it.
const OCCLUDES: u8 = 1;
/// Both sides are drawn.
const DOUBLE_SIDED: u8 = 2;

/// By triangle: seen from outside of the node's sphere, or next to one that is.
pub(super) fn visible_triangles(soup: &Soup, palette: &Palette) -> Vec<bool> {
    let Some(scene) = Rays::new(soup, palette) else { return Vec::new() };
    let seen: Vec<AtomicBool> = (0..soup.triangle_count()).map(|_| AtomicBool::new(false)).collect();
    let lines = (soup.triangle_count().saturating_mul(LINES_PER_TRIANGLE)).clamp(LEAST_LINES, MOST_LINES);
    (0..lines).into_par_iter().with_min_len(256).for_each_init(Vec::new, |met, index| {
        let [u, v, x, y] = cube4(index);
        let along = direction([u, v]);
        let (right, up) = along.any_orthonormal_pair();
        let (sin, cos) = (std::f64::consts::TAU * y).sin_cos();
        let offset = (right * cos + up * sin) * x.sqrt();
        for along in [along, -along] {
            let nearest = scene.look(offset - along * 1.01, along, met);
            for &(_, triangle) in met.iter().filter(|&&(t, _)| t <= nearest + TOUCHING) {
                seen[triangle as usize].store(true, Ordering::Relaxed);
            }
        }
    });
    let found: Vec<bool> = seen.iter().map(|seen| seen.load(Ordering::Relaxed)).collect();
    let found: Vec<bool> = found
        .par_iter()
        .enumerate()
        .with_min_len(64)
        .map(|(triangle, &found)| found || scene.escapes(triangle))
        .collect();
    dilated(soup, &found)
}

/// A node's triangles in the unit ball.
struct Rays {
    tree: TriangleTree,
    triangles: Vec<Triangle>,
    flags: Vec<u8>,
}

impl Rays {
    /// `None` without triangles.
    fn new(soup: &Soup, palette: &Palette) -> Option<Self> {
        let count = soup.triangle_count();
        let corners =
            || soup.indices.iter().map(|&v| DVec3::from_array(soup.positions[v as usize].map(f64::from)));
        let (min, max) =
            corners().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(a, b), p| (a.min(p), b.max(p)));
        if count == 0 {
            return None;
        }
        let center = (min + max) * 0.5;
        let radius = corners().map(|p| p.distance_squared(center)).fold(0.0, f64::max).sqrt();
        let scale = 1.0 / radius.max(f64::MIN_POSITIVE);
        let unit = |v: u32| {
            ((DVec3::from_array(soup.positions[v as usize].map(f64::from)) - center) * scale).as_vec3a()
        };
        let triangles: Vec<Triangle> = (0..count)
            .map(|t| {
                let [v0, v1, v2] = soup.corners(t).map(unit);
                Triangle { v0, v1, v2 }
            })
            .collect();
        let of_class: Vec<u8> = soup
            .classes
            .iter()
            .map(|class| {
                let occludes = if palette.occludes(class) { OCCLUDES } else { 0 };
                occludes | if palette.double_sided(class) { DOUBLE_SIDED } else { 0 }
            })
            .collect();
        let flags = (0..count).map(|t| of_class[soup.class(t)]).collect();
        Some(Self { tree: TriangleTree::new(&triangles), triangles, flags })
    }

    /// Collects what a viewer meets along a ray up to the nearest occluder, and some behind it, as parameter and triangle;
    /// returns the parameter of that occluder.
    fn look(&self, origin: DVec3, along: DVec3, met: &mut Vec<(f32, u32)>) -> f32 {
        met.clear();
        let mut nearest = f32::INFINITY;
        self.tree.trace(origin.as_vec3a(), along.as_vec3a(), f32::INFINITY, |t, index, front| {
            let flags = self.flags[index as usize];
            if front || flags & DOUBLE_SIDED != 0 {
                met.push((t, index));
                if flags & OCCLUDES != 0 {
                    nearest = nearest.min(t);
                }
            }
            nearest + TOUCHING
        });
        nearest
    }

    /// Whether some ray from a triangle gets out.
    fn escapes(&self, index: usize) -> bool {
        let triangle = &self.triangles[index];
        let normal = (triangle.v1 - triangle.v0).cross(triangle.v2 - triangle.v0);
        let parts = f64::from(normal.length()) * 0.5 / (std::f64::consts::PI * PART_OF_SECTION);
        let count = LEAST_RAYS.saturating_add(parts as usize).min(MOST_RAYS);
        let double_sided = self.flags[index] & DOUBLE_SIDED != 0;
        // Another part of the sequence for each triangle.
        let start = index.wrapping_mul(7919) & 0xF_FFFF;
        (start..start + count).any(|i| {
            let [u, v, x, y] = cube4(i);
            let mut away = direction([u, v]).as_vec3a();
            if !double_sided && away.dot(normal) < 0.0 {
                away = -away;
            }
            let [a, b, c] = weights([x, y]).map(|w| w as f32);
            let origin = triangle.v0 * a + triangle.v1 * b + triangle.v2 * c;
            let mut hidden = false;
            self.tree.trace(origin, away, f32::INFINITY, |t, other, front| {
                let flags = self.flags[other as usize];
                // A viewer out there looks along the opposite direction.
                let faces = !front || flags & DOUBLE_SIDED != 0;
                if other as usize != index && t > TOUCHING && faces && flags & OCCLUDES != 0 {
                    hidden = true;
                    return -1.0;
                }
                f32::INFINITY
            });
            !hidden
        })
    }
}

/// Adds the triangles that share a corner with a chosen one: samples miss slivers and what shows through narrow gaps, and
/// simplification needs whole borders.
fn dilated(soup: &Soup, chosen: &[bool]) -> Vec<bool> {
    let corners = |t: usize| soup.corners(t).map(|v| soup.positions[v as usize].map(f32::to_bits));
    let touched: HashSet<[u32; 3]> = (0..chosen.len()).filter(|&t| chosen[t]).flat_map(corners).collect();
    (0..chosen.len()).map(|t| chosen[t] || corners(t).iter().any(|corner| touched.contains(corner))).collect()
}
