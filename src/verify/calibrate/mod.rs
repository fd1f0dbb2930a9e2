//! Whether proxies and simplified meshes are as near to what they stand for as the file says.
//!
//! Each of a sample of them is looked at from random sides, from exactly as far away as its stated error is one pixel:
//! the nearest from which it is drawn for its error alone at a threshold of one pixel. A ray through a random place of its
//! sphere meets it, or the originals, at a point. How far the other surface is from there is found by rays beside the
//! first one, up to two pixels off, ever closer to the best: each of their crossings with the other surface is a place of
//! it, so the distance to the nearest of them is never less than the true one. In pixels it should be at most 1, and the
//! same at any other threshold and distance, for pixels and stated error shrink alike.
//!
//! Both directions count: what is drawn and not there, and what is there and not drawn. Surfaces are taken as opaque.

mod pair;

use super::random::Random;
use super::statistics::{median, nearest_rank};
use crate::appearance::{self, AppearanceError};
use crate::bake::tree::Part;
use crate::baked::Baked;
use crate::gltf::Document;
use crate::scene::{Mesh, Scene};
use glam::{DAffine3, DVec3};
use pair::{Pair, mesh};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Proxies, and levels of meshes, that are looked at: the first and then evenly spread over the file's.
const MOST_PROXIES: usize = 64;
const MOST_LEVELS: usize = 32;

/// How far simplified surfaces are from what they stand for, in pixels where the stated error is one pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CalibrationReport {
    /// Proxies looked at.
    pub proxies: usize,
    /// Simplified levels of meshes looked at.
    pub levels: usize,
    /// Points whose distance from the other surface was measured.
    pub points: usize,
    /// Middle of the distances, pixels.
    pub median_px: f64,
    /// 99 % of them are at most this, pixels.
    pub p99_px: f64,
    /// Largest, pixels, of those that found the other surface within about two pixels.
    pub worst_px: f64,
    /// Share of the points from which the other surface is farther than one pixel, those included that found nothing.
    pub share_above: f64,
    /// Share of the points that found nothing within about two pixels.
    pub share_lost: f64,
}

impl fmt::Display for CalibrationReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { proxies, levels, points, median_px, p99_px, worst_px, share_above, share_lost } = self;
        writeln!(f, "{proxies} proxies and {levels} simplified meshes, where their stated error is 1 px:")?;
        writeln!(
            f,
            "  off by {median_px:.2} px (median), {p99_px:.2} px (99 %), {worst_px:.2} px (worst); {:.2} % of {points} points by \
             more than 1 px, {:.2} % by more than about 2 px",
            share_above * 100.0,
            share_lost * 100.0,
        )
    }
}

/// Looks at the proxies and levels of a file; `None` if it has none.
///
/// # Errors
/// If the meshes of proxies cannot be read.
pub(super) fn calibrate(
    doc: &Document,
    scene: &Scene,
    baked: &Baked,
    seed: u64,
) -> Result<Option<CalibrationReport>, AppearanceError> {
    let mut wanted: Vec<Wanted> = Vec::new();
    let proxies = spread(all_proxies(baked), MOST_PROXIES);
    let levels = spread(all_levels(doc, scene, baked), MOST_LEVELS);
    let counts = (proxies.len(), levels.len());
    wanted.extend(proxies.into_iter().chain(levels));
    if wanted.is_empty() {
        return Ok(None);
    }
    let meshes: Vec<u32> = wanted.iter().map(|wanted| wanted.mesh).collect();
    let looks = appearance::read_with(doc, scene, &meshes)?;
    let first = looks.data.meshes.len() - meshes.len();
    let distances: Vec<Vec<f64>> = wanted
        .par_iter()
        .enumerate()
        .map(|(index, wanted)| {
            let drawn = mesh(&looks.data.meshes[first + index], &looks.data.materials);
            let pair = wanted.pair(scene, baked, drawn);
            pair.distances(&mut Random::new(seed, 0x0CA1_1B4A, index as u64))
        })
        .collect();
    let all: Vec<f64> = distances.into_iter().flatten().collect();
    Ok(Some(report(counts, &all)))
}

fn report((proxies, levels): (usize, usize), all: &[f64]) -> CalibrationReport {
    let mut found: Vec<f64> = all.iter().copied().filter(|distance| distance.is_finite()).collect();
    found.sort_unstable_by(f64::total_cmp);
    let share = |count: usize| count as f64 / all.len().max(1) as f64;
    CalibrationReport {
        proxies,
        levels,
        points: all.len(),
        median_px: median(&found),
        p99_px: nearest_rank(&found, 99),
        worst_px: nearest_rank(&found, 100),
        share_above: share(all.iter().filter(|&&distance| distance > 1.0).count()),
        share_lost: share(all.len() - found.len()),
    }
}

/// Something simplified.
#[derive(Clone, Copy, Debug)]
struct Wanted {
    /// Its glTF mesh.
    mesh: u32,
    of: Of,
    error: f64,
}

#[derive(Clone, Copy, Debug)]
enum Of {
    Proxy {
        tree: usize,
        anchor: usize,
        node: usize,
    },
    /// Index of the scene's mesh.
    Level {
        mesh: u32,
    },
}

fn all_proxies(baked: &Baked) -> Vec<Wanted> {
    let mut all = Vec::new();
    for (tree, data) in baked.trees().iter().enumerate() {
        let Some((anchor, _)) = baked.places(tree).next() else { continue };
        let nodes = data.proxies().map_or(&[][..], |proxies| proxies.nodes());
        all.extend(nodes.iter().enumerate().map(|(node, proxy)| Wanted {
            mesh: proxy.mesh,
            of: Of::Proxy { tree, anchor, node },
            error: f64::from(proxy.error),
        }));
    }
    all
}

fn all_levels(doc: &Document, scene: &Scene, baked: &Baked) -> Vec<Wanted> {
    let mut all = Vec::new();
    let nodes = doc.json.get("nodes");
    for entry in baked.visibility().mesh_levels() {
        let has_it = |node: usize| {
            let mesh = nodes.and_then(|nodes| nodes.get(node)?.get("mesh")?.as_u64());
            mesh == Some(u64::from(entry.mesh))
        };
        let Some(object) = scene.objects.iter().find(|object| has_it(object.node)) else { continue };
        all.extend(entry.levels.iter().map(|level| Wanted {
            mesh: level.mesh,
            of: Of::Level { mesh: object.mesh },
            error: f64::from(level.error),
        }));
    }
    all
}

/// At most `count` of them, evenly spread, the first among them.
fn spread(all: Vec<Wanted>, count: usize) -> Vec<Wanted> {
    let step = all.len().div_ceil(count).max(1);
    all.into_iter().step_by(step).collect()
}

impl Wanted {
    fn pair<'a>(&self, scene: &'a Scene, baked: &Baked, simplified: Mesh) -> Pair<'a> {
        let (parts, to_space, center, radius) = match self.of {
            Of::Level { mesh } => {
                let part = Part { mesh, member: 0, to_tree: DAffine3::IDENTITY };
                let Mesh { min, max, .. } = scene.meshes[mesh as usize];
                (vec![part], DAffine3::IDENTITY, (min + max) * 0.5, (max - min).length() * 0.5)
            }
            Of::Proxy { tree, anchor, node } => {
                let from_world =
                    baked.places(tree).find(|&(at, _)| at == anchor).map(|(_, to_world)| to_world.inverse());
                let from_world = from_world.unwrap_or(DAffine3::IDENTITY);
                let mut parts = Vec::new();
                let mut at = (DAffine3::IDENTITY, DVec3::ZERO, 0.0);
                if let Some(proxies) = baked.trees()[tree].proxies() {
                    let proxy = &proxies.nodes()[node];
                    at = (
                        DAffine3::from_translation(proxy.origin.as_dvec3()),
                        proxy.center.as_dvec3(),
                        f64::from(proxy.radius),
                    );
                    for position in proxy.first_object..proxy.first_object + proxy.object_count {
                        for object in baked.below(tree, anchor, proxies.object(position)) {
                            let object = &scene.objects[object as usize];
                            let to_tree = from_world * object.to_world;
                            parts.push(Part { mesh: object.mesh, member: parts.len() as u32, to_tree });
                        }
                    }
                }
                (parts, at.0, at.1, at.2)
            }
        };
        Pair { meshes: &scene.meshes, parts, simplified, to_space, center, radius, error: self.error }
    }
}
