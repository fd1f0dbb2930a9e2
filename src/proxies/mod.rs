//! Proxies: simplified stand-ins for groups of objects, and simplified versions of single meshes.
//!
//! A bounding volume hierarchy over the objects of a tree is cut so that its leaves stand for about
//! [`ProxyOptions::triangles`] triangles. From the leaves up, each node gets a mesh of at most half as many, made of its
//! objects and its children's proxies: only what is visible from outside, merged by material, simplified ([`geometry`]).
//! What is stored of it is what saves most for its bytes. After Erikson, Manocha and Baxter, HLODs for Faster Display of
//! Large Static and Dynamic Environments, 2001.

mod build;
mod compress;
mod encode;
pub mod geometry;
mod hierarchy;
mod lod;
mod materials;
mod mesh_levels;
mod options;
mod pieces;
mod repeats;
mod report;
mod tables;

pub use lod::LodReport;
pub use options::{
    DEFAULT_ERROR_PIXELS, DEFAULT_SHARE, DEFAULT_TRIANGLES, ProxyFormat, ProxyMode, ProxyOptions,
    SCREEN_LINES,
};
pub use report::{ProxyLevelReport, ProxyReport};

use crate::appearance::{self, Appearance, AppearanceError};
use crate::bake::Progress;
use crate::bake::encode::EncodedTable;
use crate::bake::spheres::{SphereKind, spheres};
use crate::bake::subject::Subject;
use crate::bake::tree::Sphere;
use crate::gltf::Document;
use crate::gltf::payload::Additions;
use crate::scene::Scene;
use build::Built;
use encode::{Encoder, Triangles};
use geometry::{ClassMesh, Palette};
use hierarchy::ProxyHierarchy;
use materials::Materials;
use mesh_levels::Simplified;
use pieces::Piece;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::time::Instant;
use tables::{Row, Rows};

/// A tree that may get proxies.
#[derive(Clone, Copy, Debug)]
pub struct ProxyTree<'a> {
    /// Its objects.
    pub subject: &'a Subject,
    /// The members (document order) in the tree's order.
    pub order: &'a [u32],
}

/// What a bake adds for proxies.
#[derive(Debug, Default)]
pub struct ProxyBake {
    /// Meshes, and all that they need.
    pub additions: Additions,
    /// The extension's `meshLevels`: simplified versions of meshes.
    pub mesh_levels: Vec<Value>,
    /// The tables of each tree; none for a tree without proxies.
    pub trees: Vec<Vec<EncodedTable>>,
    /// Figures.
    pub report: ProxyReport,
}

/// Bytes of a row in the tables, about.
const ROW_BYTES: u64 = 48;

/// JSON of a tree's tables and of the buffer views, about.
const TABLES_JSON: u64 = 1_600;

/// Digits that an accessor's buffer view gets when it is attached behind those of the file, at most.
const VIEW_DIGITS: u64 = 4;

/// A tree below this many times [`ProxyOptions::triangles`] is drawn faster than it is thought about.
const LEAST_TREE: u64 = 2;

/// What a triangle of a proxy takes, about, JSON counted.
const TRIANGLE_BYTES: f64 = 34.0;

/// Leaves are made for this many times the bytes that there are, since not all of them are worth theirs.
const MADE_SHARE: f64 = 2.0;

/// The real size is found out by writing: so often at most is the choice corrected.
const CORRECTIONS: u32 = 6;

/// Makes the proxies of a scene; `geometry_bytes` are those of its meshes. The document must have no bake.
///
/// # Errors
/// [`AppearanceError`] if the looks of the scene cannot be read.
pub fn bake(
    document: &Document,
    scene: &Scene,
    trees: &[ProxyTree<'_>],
    geometry_bytes: u64,
    options: &ProxyOptions,
    progress: &dyn Progress,
) -> Result<ProxyBake, AppearanceError> {
    let start = Instant::now();
    let limit = (geometry_bytes as f64 * options.share.max(0.0)) as u64;
    progress.stage("looks", None);
    let looks = appearance::read(document, scene)?;
    let palette = Palette::new(&looks.data.materials, &looks.data.images);
    progress.stage("mesh levels", None);
    let meshes = mesh_levels::simplify(scene, trees, &looks.data.meshes);
    let mut simplified = vec![None; looks.data.meshes.len()];
    for mesh in &meshes {
        simplified[mesh.mesh as usize] = Some(mesh);
    }
    let setting = Setting {
        scene,
        meshes: &looks.data.meshes,
        simplified: &simplified,
        palette: &palette,
        options,
        limit,
    };
    let mut without = Vec::new();
    let made_trees = trees
        .iter()
        .enumerate()
        .map(|(index, tree)| setting.make(index, tree, progress, &mut without))
        .collect();
    let made = Made { trees: made_trees, meshes };

    progress.stage("proxies written", None);
    let mut allowed = limit;
    let mut result = ProxyBake::default();
    for _ in 0..CORRECTIONS {
        let chosen = made.choose(trees, allowed, options);
        result = made.write(document, scene, trees, &looks, options, &chosen);
        let bytes = result.report.bytes;
        if bytes <= limit {
            break;
        }
        // A little less than in proportion, so that the next one fits.
        allowed = (allowed as f64 * limit as f64 / bytes as f64 * 0.99) as u64;
    }
    if result.report.bytes > limit {
        result = made.write(document, scene, trees, &looks, options, &made.choose(trees, 0, options));
    }
    if options.msft_lod {
        result.report.msft_lod = Some(lod::add(document, scene, &mut result));
    }
    result.report.share = result.report.bytes as f64 / geometry_bytes.max(1) as f64;
    result.report.without = without;
    result.report.seconds = start.elapsed().as_secs_f64();
    Ok(result)
}

/// Everything that could be stored.
struct Made {
    trees: Vec<Option<MadeTree>>,
    meshes: Vec<Simplified>,
}

struct MadeTree {
    hierarchy: ProxyHierarchy,
    spheres: Vec<Sphere>,
    built: Built,
}

/// What all trees are made with.
struct Setting<'a> {
    scene: &'a Scene,
    meshes: &'a [svs_render::Mesh],
    /// Simplified versions, by mesh.
    simplified: &'a [Option<&'a Simplified>],
    palette: &'a Palette,
    options: &'a ProxyOptions,
    /// Bytes there are for all trees.
    limit: u64,
}

impl Setting<'_> {
    /// All proxies of a tree; `None`, and why, if it needs none.
    fn make(
        &self,
        index: usize,
        tree: &ProxyTree<'_>,
        progress: &dyn Progress,
        without: &mut Vec<String>,
    ) -> Option<MadeTree> {
        let subject = tree.subject;
        let drawn: Vec<bool> =
            subject.objects.iter().map(|&object| !self.scene.objects[object as usize].hidden).collect();
        let members = subject.members.iter().zip(&drawn).filter(|(_, drawn)| **drawn);
        let triangles: u64 = members.map(|(member, _)| u64::from(member.triangles)).sum();
        if triangles < LEAST_TREE * u64::from(self.options.triangles) {
            without.push(format!("tree {index}: {triangles} triangles are few enough without proxies"));
            return None;
        }
        let uncut = hierarchy::build(subject, &drawn, self.options.triangles);
        let hierarchy = uncut.cut(leaf_triangles(uncut.distinct, self.limit, self.options));
        let (members, parts) = (&subject.members, &subject.parts);
        let spheres = spheres(SphereKind::Tight, &hierarchy.hierarchy, members, parts, &self.scene.meshes);
        let copies = hierarchy.original.iter().enumerate().filter(|(node, first)| *node as u32 != **first);
        progress.stage("proxies", Some((hierarchy.original.len() - copies.count()) as u64));
        let built = build::build(self, subject, &hierarchy, &spheres, progress);
        Some(MadeTree { hierarchy, spheres, built })
    }
}

/// Triangles that leaves stand for: as asked for, or more where there are not the bytes for so many proxies anyway.
fn leaf_triangles(distinct: u64, limit: u64, options: &ProxyOptions) -> u64 {
    let proxy = f64::from(options.triangles) / 2.0 * TRIANGLE_BYTES;
    let affordable = (limit as f64 * MADE_SHARE / proxy).max(1.0);
    u64::from(options.triangles).max((distinct as f64 / affordable) as u64)
}

/// Levels to store: of each original node by tree, and of each simplified mesh.
struct Chosen {
    trees: Vec<Vec<Vec<usize>>>,
    meshes: Vec<Vec<usize>>,
    dropped: usize,
}

impl Made {
    /// The pieces that save most within `limit` bytes.
    fn choose(&self, trees: &[ProxyTree<'_>], limit: u64, options: &ProxyOptions) -> Chosen {
        let mut pieces = Vec::new();
        let mut owners = Vec::new();
        let mut fixed = 0;
        for (t, tree) in self.trees.iter().enumerate() {
            let Some(MadeTree { hierarchy, built, .. }) = tree else { continue };
            fixed += TABLES_JSON + 4 * trees[t].order.len() as u64;
            let mut uses = vec![0u64; built.levels.len()];
            for (node, &original) in hierarchy.original.iter().enumerate() {
                uses[original as usize] += u64::from(!built.redundant[node]);
            }
            for (node, levels) in built.levels.iter().enumerate().filter(|(node, _)| uses[*node] > 0) {
                for (level, geometry) in levels.iter().enumerate() {
                    let size: u64 = geometry
                        .classes
                        .iter()
                        .map(|mesh| encode::size(&of_class(mesh, None), options.format))
                        .sum();
                    pieces.push(Piece {
                        bytes: size + uses[node] * ROW_BYTES,
                        replaced: built.below[node] * uses[node],
                        triangles: geometry.triangles as u64,
                    });
                    owners.push((Some(t), node, level));
                }
            }
        }
        for (m, mesh) in self.meshes.iter().enumerate() {
            for (level, simplified) in mesh.levels.iter().enumerate() {
                let primitives = simplified.mesh.primitives.iter();
                pieces.push(Piece {
                    bytes: primitives.map(|p| encode::size(&of_primitive(p, None), options.format)).sum(),
                    replaced: mesh.triangles * mesh.uses,
                    triangles: simplified.triangles as u64,
                });
                owners.push((None, m, level));
            }
        }
        let keep = pieces::choose(&pieces, limit.saturating_sub(fixed));
        let mut chosen = Chosen {
            trees: self
                .trees
                .iter()
                .map(|tree| vec![Vec::new(); tree.as_ref().map_or(0, |tree| tree.built.levels.len())])
                .collect(),
            meshes: vec![Vec::new(); self.meshes.len()],
            dropped: keep.iter().filter(|&&keep| !keep).count(),
        };
        for ((tree, index, level), _) in owners.into_iter().zip(keep).filter(|(_, keep)| *keep) {
            match tree {
                Some(tree) => chosen.trees[tree][index].push(level),
                None => chosen.meshes[index].push(level),
            }
        }
        chosen
    }

    /// The chosen pieces as glTF.
    fn write(
        &self,
        document: &Document,
        scene: &Scene,
        trees: &[ProxyTree<'_>],
        looks: &Appearance,
        options: &ProxyOptions,
        chosen: &Chosen,
    ) -> ProxyBake {
        let mut materials = Materials::new(document, &looks.data, &looks.gltf_materials);
        let mut encoder =
            Encoder::new(options.format, document.next_accessor(), Additions::first_mesh(document));
        let mut bake = ProxyBake::default();
        for ((tree, input), kept) in self.trees.iter().zip(trees).zip(&chosen.trees) {
            let mut encoded = Vec::new();
            if let Some(tree) = tree {
                let Rows { rows, order } =
                    tables::rows(input.subject, &tree.hierarchy, &tree.built, &tree.spheres, kept);
                let meshes = write_rows(tree, &rows, &mut encoder, &mut materials, &mut bake.report);
                if !rows.is_empty() {
                    let mut places = vec![0u32; input.order.len()];
                    for (place, &member) in input.order.iter().enumerate() {
                        places[member as usize] = place as u32;
                    }
                    let places: Vec<u32> = order.iter().map(|&member| places[member as usize]).collect();
                    encoded = tables::encode(&rows, &meshes, &places);
                }
            }
            bake.trees.push(encoded);
        }
        for (simplified, kept) in self.meshes.iter().zip(&chosen.meshes).filter(|(_, kept)| !kept.is_empty())
        {
            let mut levels = Vec::new();
            for &level in kept {
                let level = &simplified.levels[level];
                let primitives = level.mesh.primitives.iter();
                let triangles: Vec<Triangles<'_>> =
                    primitives.map(|p| of_primitive(p, materials.of_original(p.material))).collect();
                if let Some(mesh) = encoder.mesh(triangles.into_iter()) {
                    let error = level.error as f32;
                    let deviation = tables::deviation(&level.fidelity, 0.0, f64::from(error));
                    levels.push(json!({"mesh": mesh, "error": error, "deviation": deviation}));
                    bake.report.mesh_level_triangles += level.triangles as u64;
                }
            }
            bake.report.simplified_meshes += 1;
            bake.report.mesh_levels += levels.len();
            bake.mesh_levels.push(json!({"mesh": simplified.gltf_mesh(document, scene), "levels": levels}));
        }
        bake.additions = encoder.finish();
        let (appended, extensions) = materials.finish();
        bake.additions.materials = appended;
        bake.additions.extensions.extend(extensions);
        bake.report.dropped = chosen.dropped;
        bake.report.bytes = bake.bytes();
        bake
    }
}

/// Writes the meshes of rows, each content once; returns the glTF mesh of each row.
fn write_rows(
    tree: &MadeTree,
    rows: &[Row],
    encoder: &mut Encoder,
    materials: &mut Materials<'_>,
    report: &mut ProxyReport,
) -> Vec<u32> {
    let mut written: BTreeMap<(u32, usize), u32> = BTreeMap::new();
    rows.iter()
        .map(|row| {
            let depth = row.depth as usize;
            while report.levels.len() <= depth {
                let (depth, least_error) = (report.levels.len() as u32, f32::INFINITY);
                report.levels.push(ProxyLevelReport { depth, least_error, ..ProxyLevelReport::default() });
            }
            let level = &mut report.levels[depth];
            level.nodes += 1;
            level.triangles += row.triangles as u64;
            level.least_error = level.least_error.min(row.error);
            level.largest_error = level.largest_error.max(row.error);
            report.nodes += 1;
            *written.entry(row.content).or_insert_with(|| {
                let geometry = &tree.built.levels[row.content.0 as usize][row.content.1];
                let classes: Vec<Triangles<'_>> = geometry
                    .classes
                    .iter()
                    .map(|mesh| of_class(mesh, materials.of_class(&mesh.class)))
                    .collect();
                report.meshes += 1;
                report.triangles += geometry.triangles as u64;
                // Pieces without triangles are never chosen.
                encoder.mesh(classes.into_iter()).unwrap_or_default() as u32
            })
        })
        .collect()
}

fn of_class(mesh: &ClassMesh, material: Option<usize>) -> Triangles<'_> {
    Triangles {
        positions: &mesh.positions,
        normals: &mesh.normals,
        colors: &mesh.colors,
        uvs: &mesh.uvs,
        indices: &mesh.indices,
        material,
    }
}

fn of_primitive(primitive: &svs_render::Primitive, material: Option<usize>) -> Triangles<'_> {
    Triangles {
        positions: &primitive.positions,
        normals: &primitive.normals,
        colors: &primitive.colors,
        uvs: &primitive.uvs,
        indices: &primitive.indices,
        material,
    }
}

impl ProxyBake {
    /// Bytes added to the file, but for the extension's own JSON: that is nearly what a few table names take.
    fn bytes(&self) -> u64 {
        let json = |values: &[Value]| -> u64 {
            values.par_iter().map(|value| value.to_string().len() as u64 + 1).sum()
        };
        let trees = self.trees.iter().filter(|tables| !tables.is_empty()).count() as u64;
        self.stored_bytes()
            + trees * TABLES_JSON
            + self.additions.accessors.len() as u64 * VIEW_DIGITS
            + self.additions.views.iter().filter(|view| view.compression.is_some()).count() as u64
                * encode::COMPRESSED_VIEW_JSON
            + json(&self.mesh_levels)
            + json(&self.additions.accessors)
            + json(&self.additions.meshes)
            + json(&self.additions.materials)
    }

    /// Bytes of buffers: vertices, indices and tables.
    pub fn stored_bytes(&self) -> u64 {
        let tables = self.trees.iter().flatten().map(|table| table.bytes.len() as u64).sum::<u64>();
        self.additions.bytes() + tables
    }
}
