//! Reduces triangles with meshoptimizer, in several ways: which one is best depends on the mesh, so the caller measures.

use super::class::Class;
use super::soup::{Soup, area};
use super::weld::weld;
use glam::Vec3;
use meshopt::{SimplifyOptions, SimplifyVertex, VertexDataAdapter};
use std::collections::{BTreeMap, HashMap};

/// Weight of normals (unit vectors) against positions (as parts of the mesh's size).
const NORMAL_WEIGHT: f32 = 0.2;
/// Weight of colours (0 to 1, roughly as the eye sees them).
const COLOR_WEIGHT: f32 = 0.3;
/// Weight of texture coordinates.
const UV_WEIGHT: f32 = 0.5;

/// Colours that differ in these bits are not clustered together.
const COLOR_BITS: u8 = 0xE0;

/// A vertex normal that is further off its triangle than this (cosine) was carried around an edge: it would be a dark spot.
const LEAST_AGREEMENT: f32 = 0.5;

/// How triangles were reduced.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Strategy {
    /// Not at all.
    Unchanged,
    /// Edge collapses that keep seams of attributes.
    Plain,
    /// Edge collapses across seams of attributes, but not across classes.
    Permissive,
    /// As permissive, after near vertices were made one.
    Welded,
    /// Vertices are clustered in a grid: holes close, parts merge.
    Sloppy,
}

impl Strategy {
    /// All that reduce, cheapest in error on well-made meshes first.
    pub(super) const REDUCING: [Strategy; 4] =
        [Strategy::Plain, Strategy::Permissive, Strategy::Welded, Strategy::Sloppy];
}

/// Reduces to about `target` triangles, or as far as the strategy gets within an error of about `limit` metres. Never
/// more triangles than before.
pub(super) fn reduce(soup: &Soup, target: usize, limit: f32, strategy: Strategy) -> Soup {
    let count = soup.triangle_count();
    if count == 0 || count <= target && strategy != Strategy::Plain {
        return soup.clone();
    }
    let reduced = match strategy {
        Strategy::Unchanged => return soup.clone(),
        Strategy::Plain => collapse(soup, target, limit, SimplifyOptions::Prune),
        Strategy::Permissive => {
            collapse(soup, target, limit, SimplifyOptions::Prune | SimplifyOptions::Permissive)
        }
        Strategy::Welded => {
            // As wide as an edge of the result, roughly.
            let area: f64 = (0..count).map(|t| soup.area(t)).sum();
            let edge = (area / target.max(1) as f64).sqrt() as f32;
            let welded = weld(soup, (edge * 0.25).min(limit));
            collapse(&welded, target, limit, SimplifyOptions::Prune | SimplifyOptions::Permissive)
        }
        Strategy::Sloppy => cluster(soup, target),
    };
    if reduced.triangle_count() <= count { reduced } else { soup.clone() }
}

fn collapse(soup: &Soup, target: usize, limit: f32, options: SimplifyOptions) -> Soup {
    let stride = size_of::<[f32; 3]>();
    let Ok(vertices) = VertexDataAdapter::new(bytemuck::cast_slice(&soup.positions), stride, 0) else {
        return soup.clone();
    };
    let attributes: Vec<[f32; 9]> = (0..soup.positions.len()).map(|v| attributes(soup, v)).collect();
    let weights =
        [[NORMAL_WEIGHT; 3].as_slice(), [COLOR_WEIGHT; 4].as_slice(), [UV_WEIGHT; 2].as_slice()].concat();
    let locks = if options.contains(SimplifyOptions::Permissive) {
        protected(soup, &vertices)
    } else {
        vec![SimplifyVertex::None; soup.positions.len()]
    };
    let indices = meshopt::simplify_with_attributes_and_locks(
        &soup.indices,
        &vertices,
        bytemuck::cast_slice(&attributes),
        &weights,
        size_of::<[f32; 9]>(),
        &locks,
        target * 3,
        limit,
        options | SimplifyOptions::ErrorAbsolute,
        None,
    );
    tidy(soup, indices)
}

/// Vertices where classes meet keep them apart.
fn protected(soup: &Soup, vertices: &VertexDataAdapter<'_>) -> Vec<SimplifyVertex> {
    let mut locks = vec![SimplifyVertex::None; soup.positions.len()];
    if soup.classes.len() < 2 {
        return locks;
    }
    let first = meshopt::generate_position_remap(vertices);
    let mut mixed = vec![false; soup.positions.len()];
    for (vertex, &first) in first.iter().enumerate() {
        mixed[first as usize] |= soup.vertex_class[vertex] != soup.vertex_class[first as usize];
    }
    for (lock, &first) in locks.iter_mut().zip(&first) {
        if mixed[first as usize] {
            *lock = SimplifyVertex::Protect;
        }
    }
    locks
}

fn attributes(soup: &Soup, vertex: usize) -> [f32; 9] {
    let class = &soup.classes[soup.vertex_class[vertex] as usize];
    let top = match class {
        Class::Plain(plain) => plain.top(),
        Class::Kept { .. } => 1.0,
    };
    let [x, y, z] = soup.normals[vertex];
    let [r, g, b, a] = soup.colors[vertex].map(|c| f32::from(c) / 255.0);
    let [u, v] = soup.uvs[vertex];
    [x, y, z, (r * top).sqrt(), (g * top).sqrt(), (b * top).sqrt(), a, u, v]
}

/// Clusters what has one class and one colour by itself, with its share of the triangles: a cluster has but one colour.
fn cluster(soup: &Soup, target: usize) -> Soup {
    let stride = size_of::<[f32; 3]>();
    let Ok(vertices) = VertexDataAdapter::new(bytemuck::cast_slice(&soup.positions), stride, 0) else {
        return soup.clone();
    };
    let mut parts: BTreeMap<(usize, [u8; 4]), Vec<u32>> = BTreeMap::new();
    for triangle in 0..soup.triangle_count() {
        let corners = soup.corners(triangle);
        let color = soup.colors[corners[0] as usize].map(|c| c & COLOR_BITS);
        parts.entry((soup.class(triangle), color)).or_default().extend(corners);
    }
    let mut indices = Vec::new();
    for own in parts.values() {
        let share = own.len() as f64 / soup.indices.len() as f64;
        let own_target = (target as f64 * share) as usize * 3;
        indices.extend(meshopt::simplify_sloppy(own, &vertices, own_target, 1.0, None));
    }
    tidy(soup, indices)
}

/// Triangles without area go; a triangle whose corners are of several classes takes the first one's; normals that do not
/// fit their triangle any more become the triangle's.
fn tidy(soup: &Soup, indices: Vec<u32>) -> Soup {
    let mut out = soup.with_indices(Vec::with_capacity(indices.len()));
    // By vertex and direction, coarsely: copies with the normal of a face.
    let mut turned: HashMap<(u32, [i8; 3]), u32> = HashMap::new();
    for corners in indices.chunks_exact(3) {
        let mut corners = [corners[0], corners[1], corners[2]];
        let positions = corners.map(|v| soup.positions[v as usize]);
        let has_area = area(positions) > 0.0;
        if !has_area {
            continue;
        }
        let class = out.vertex_class[corners[0] as usize];
        for vertex in &mut corners[1..] {
            if out.vertex_class[*vertex as usize] != class {
                *vertex = out.push_copy(*vertex as usize, class);
            }
        }
        if !out.classes[class as usize].is_flat() {
            let [a, b, c] = positions.map(Vec3::from_array);
            let face = (b - a).cross(c - a).try_normalize().unwrap_or(Vec3::Y);
            for vertex in &mut corners {
                if Vec3::from_array(out.normals[*vertex as usize]).dot(face) < LEAST_AGREEMENT {
                    let key = (*vertex, (face * 15.0).round().as_i8vec3().to_array());
                    *vertex = *turned.entry(key).or_insert_with(|| {
                        let copy = out.push_copy(*vertex as usize, class);
                        out.normals[copy as usize] = face.to_array();
                        copy
                    });
                }
            }
        }
        out.indices.extend(corners);
    }
    out
}
