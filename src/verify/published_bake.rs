//! The bake of the published method, as a reference to compare with.
//!
//! Eikel, *Spherical Visibility Sampling* (dissertation, Paderborn 2013); Eikel, Jähn, Fischer, Meyer auf der
//! Heide, Computer Graphics Forum 32(4), 2013, sections 3 and 4: a loose octree, a simple bounding sphere for
//! **every** inner node, and for each of the 20 vertices of a dodecahedron one visibility vector: the objects that an
//! orthographic image of 1024² pixels shows, and how many pixels each has. Nothing here is shared with the bake that
//! it is compared with but the octree, the spheres and the rays.
//!
//! Images are traced, not rasterised: one ray through the centre of each pixel gives the same visibility. Where an
//! image per sphere costs too much, one grid of the same resolution over the root's sphere serves all nodes: each
//! ray's hits are walked up the tree, every node keeping those that nothing of its own subtree hides. From outside
//! the two measure the same.

use super::target::Target;
use crate::bake::Progress;
use crate::bake::hierarchy::{HierarchyKind, build};
use crate::bake::rays::{LineHit, RayScene};
use crate::bake::spheres::{SphereKind, spheres};
use crate::bake::tree::{Aabb, Hierarchy, Sphere};
use crate::scene::Mesh;
use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::sync::atomic::{AtomicU32, Ordering};
use svs_runtime::directions::DirectionSet;

/// Pixels per side of an image, as published for a screen of 1280x720.
pub const RESOLUTION: u32 = 1024;

/// An image per sphere is traced if all images together have at most this many pixels.
pub const PIXEL_LIMIT: u64 = 200_000_000;

/// Directions, as published.
const DIRECTIONS: &str = "dodecahedron";

/// Where the rays of the images go.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sampling {
    /// An image of the resolution over each sphere, as published.
    PerSphere,
    /// Parallel rays at the resolution over the root's sphere, for all spheres together.
    RootGrid,
}

/// The published data structure.
#[derive(Debug)]
pub struct PublishedBake {
    /// Loose octree over the target's members, nothing pruned.
    pub hierarchy: Hierarchy,
    /// Simple bounding sphere of each node.
    pub spheres: Vec<Sphere>,
    /// Box of each node, for frustum culling.
    pub boxes: Vec<Aabb>,
    /// The dodecahedron.
    pub directions: &'static DirectionSet,
    /// Visibility vectors: `vectors[node * directions + direction]` holds (member, pixels > 0).
    pub vectors: Vec<Vec<(u32, u32)>>,
    /// How the vectors were sampled.
    pub sampling: Sampling,
}

impl PublishedBake {
    /// Bakes `target`; `rays` must hold its parts. At most `pixel_limit` pixels (see [`PIXEL_LIMIT`]) are spent on
    /// one image per sphere. `resolution` is [`RESOLUTION`], but for tests. The result does not depend on the number
    /// of threads.
    ///
    /// # Panics
    /// Never: the dodecahedron is one of the runtime's direction sets.
    pub fn new(
        target: &Target,
        meshes: &[Mesh],
        rays: &RayScene<'_>,
        (resolution, pixel_limit): (u32, u64),
        progress: &dyn Progress,
    ) -> Self {
        let hierarchy = build(HierarchyKind::Octree, &target.members, &[]);
        let spheres = spheres(SphereKind::Simple, &hierarchy, &target.members, &target.parts, meshes);
        let directions = DirectionSet::by_name(DIRECTIONS).expect("the runtime knows the dodecahedron");
        let pixels = u64::from(resolution).pow(2) * directions.len() as u64 * hierarchy.nodes.len() as u64;
        let sampling = if pixels <= pixel_limit { Sampling::PerSphere } else { Sampling::RootGrid };
        let boxes = hierarchy.nodes.iter().map(|node| box_of(target, &hierarchy, &node.members)).collect();
        let table = Counts::new(&hierarchy, target.members.len(), directions.len());
        let roots = match sampling {
            Sampling::PerSphere => 0..hierarchy.nodes.len(),
            Sampling::RootGrid => 0..hierarchy.nodes.len().min(1),
        };
        let rows = roots.len() as u64 * u64::from(resolution) * (directions.len() / 2) as u64;
        progress.stage("baking the published method", Some(rows));
        for node in roots {
            let image = Image { rays, sphere: spheres[node], resolution };
            // Walks end below the sphere that the image is of, or rise through all.
            let nodes = match sampling {
                Sampling::PerSphere => node..node + 1,
                Sampling::RootGrid => 0..hierarchy.nodes.len(),
            };
            for (forward, backward) in opposite_pairs(directions) {
                let walk = Walk { table: &table, hierarchy: &hierarchy, nodes: nodes.clone() };
                image.trace(directions.direction_f64(forward), &walk, [forward, backward], progress);
            }
        }
        let vectors = table.vectors(&hierarchy);
        Self { hierarchy, spheres, boxes, directions, vectors, sampling }
    }

    /// Visibility vector of a node and a direction.
    pub fn vector(&self, node: usize, direction: usize) -> &[(u32, u32)] {
        &self.vectors[node * self.directions.len() + direction]
    }
}

/// Every direction with its opposite, each pair once: one line serves both.
fn opposite_pairs(directions: &DirectionSet) -> Vec<(usize, usize)> {
    (0..directions.len())
        .map(|i| (i, directions.nearest_f64(-directions.direction_f64(i))))
        .filter(|(i, opposite)| i < opposite)
        .collect()
}

fn box_of(target: &Target, hierarchy: &Hierarchy, places: &Range<u32>) -> Aabb {
    places
        .clone()
        .map(|place| target.boxes[hierarchy.order[place as usize] as usize])
        .filter(|b| !b.is_empty())
        .fold(Aabb::EMPTY, |all, b| all.union(&b))
}

/// An orthographic image over a sphere.
struct Image<'a> {
    rays: &'a RayScene<'a>,
    sphere: Sphere,
    resolution: u32,
}

impl Image<'_> {
    /// Traces the image seen from `direction` (from the centre towards the viewer), and from the other end the image
    /// seen from the opposite direction; their places in the direction set are `ends`.
    fn trace(&self, direction: DVec3, walk: &Walk<'_>, ends: [usize; 2], progress: &dyn Progress) {
        let center = (self.sphere.center - self.rays.center()) / self.rays.radius();
        let radius = self.sphere.radius / self.rays.radius();
        let (right, up) = direction.any_orthonormal_pair();
        let pixel = |i: u32| (f64::from(i) + 0.5) / f64::from(self.resolution) * 2.0 - 1.0;
        (0..self.resolution).into_par_iter().for_each_init(
            || Scratch::new(walk.hierarchy.nodes.len()),
            |scratch, row| {
                let v = pixel(row);
                for column in 0..self.resolution {
                    let u = pixel(column);
                    // Beyond the sphere there is nothing to see.
                    if u * u + v * v > 1.0 {
                        continue;
                    }
                    let point = center + (right * u + up * v) * radius;
                    // Lines start at the viewer.
                    let mut hits = std::mem::take(&mut scratch.hits);
                    self.rays.line(point, -direction, &mut hits);
                    hits.sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then(a.member.cmp(&b.member)));
                    walk.mark(hits.iter().filter(|h| h.seen_from_start), ends[0], scratch);
                    // From the other end; hits at the same place still go by member.
                    hits.sort_unstable_by(|a, b| b.t.total_cmp(&a.t).then(a.member.cmp(&b.member)));
                    walk.mark(hits.iter().filter(|h| h.seen_from_end), ends[1], scratch);
                    scratch.hits = hits;
                }
                progress.advance(1);
            },
        );
    }
}

/// Gives the hits of a line to the nodes that see them.
struct Walk<'a> {
    table: &'a Counts,
    hierarchy: &'a Hierarchy,
    /// Nodes that take part; hits are walked up from the member until an ancestor is closed or not among them.
    nodes: Range<usize>,
}

/// What a thread needs while it traces.
struct Scratch {
    hits: Vec<LineHit>,
    /// For each node the last line on which an opaque surface was met in its subtree.
    closed: Vec<u64>,
    /// Number of the current line, from 1.
    line: u64,
    seen: Vec<u32>,
}

impl Scratch {
    fn new(nodes: usize) -> Self {
        Self { hits: Vec::new(), closed: vec![0; nodes], line: 0, seen: Vec::new() }
    }
}

impl Walk<'_> {
    /// `hits` come from the viewer on. A hit counts for an ancestor if no opaque surface of that ancestor's subtree
    /// is nearer; where an ancestor is closed, all above are, too.
    fn mark<'h>(&self, hits: impl Iterator<Item = &'h LineHit>, direction: usize, scratch: &mut Scratch) {
        scratch.line += 1;
        scratch.seen.clear();
        for hit in hits {
            // A transparent object that is met again has been counted wherever it can be seen.
            let again = scratch.seen.contains(&hit.member);
            let mut ancestor = self.table.parents[hit.member as usize];
            let mut height = 0;
            while let Some(node) = ancestor {
                // Parents come before their children.
                if (node as usize) < self.nodes.start {
                    break;
                }
                let takes_part = (node as usize) < self.nodes.end;
                if takes_part && scratch.closed[node as usize] == scratch.line {
                    break;
                }
                if takes_part && !again {
                    self.table.add(hit.member, height, direction);
                }
                if takes_part && hit.opaque {
                    scratch.closed[node as usize] = scratch.line;
                }
                height += 1;
                ancestor = self.hierarchy.nodes[node as usize].parent;
            }
            scratch.seen.push(hit.member);
        }
    }
}

/// Pixels for each direction, member and ancestor.
struct Counts {
    /// Innermost node above each member.
    parents: Vec<Option<u32>>,
    /// First entry of each member within a direction; the last entry is their number.
    offsets: Vec<usize>,
    directions: usize,
    /// Sums of integers come out the same in whichever order threads add.
    pixels: Vec<AtomicU32>,
}

impl Counts {
    fn new(hierarchy: &Hierarchy, members: usize, directions: usize) -> Self {
        let mut parents = vec![None; members];
        let mut depths = vec![0; members];
        let places = hierarchy.parents_of_members().into_iter().zip(hierarchy.depths_of_members());
        for ((parent, depth), &member) in places.zip(&hierarchy.order) {
            parents[member as usize] = parent;
            depths[member as usize] = depth as usize;
        }
        let mut offsets = Vec::with_capacity(members + 1);
        let mut sum = 0;
        for depth in depths {
            offsets.push(sum);
            sum += depth;
        }
        offsets.push(sum);
        let pixels = (0..sum * directions).map(|_| AtomicU32::new(0)).collect();
        Self { parents, offsets, directions, pixels }
    }

    /// One more pixel of `member` seen by its ancestor `height` nodes above its parent.
    fn add(&self, member: u32, height: usize, direction: usize) {
        let entries = self.offsets[self.offsets.len() - 1];
        let entry = direction * entries + self.offsets[member as usize] + height;
        self.pixels[entry].fetch_add(1, Ordering::Relaxed);
    }

    fn vectors(self, hierarchy: &Hierarchy) -> Vec<Vec<(u32, u32)>> {
        let mut vectors = vec![Vec::new(); hierarchy.nodes.len() * self.directions];
        let entries = self.offsets[self.offsets.len() - 1];
        for &member in &hierarchy.order {
            let mut ancestor = self.parents[member as usize];
            let mut entry = self.offsets[member as usize];
            while let Some(node) = ancestor {
                for direction in 0..self.directions {
                    let pixels = self.pixels[direction * entries + entry].load(Ordering::Relaxed);
                    if pixels > 0 {
                        vectors[node as usize * self.directions + direction].push((member, pixels));
                    }
                }
                entry += 1;
                ancestor = hierarchy.nodes[node as usize].parent;
            }
        }
        vectors
    }
}
