//! The bake pipeline, one module per stage: read, objects, hierarchy, spheres, sample, prune, importance, write,
//! verify.

mod borrow;
mod choose;
mod clock;
pub mod encode;
pub mod hierarchy;
mod options;
pub mod pipeline;
mod progress;
pub mod prune;
pub mod rays;
mod report;
pub mod sample;
pub mod spheres;
pub mod subject;
pub mod tree;

pub use options::{BakeOptions, DEFAULT_DIRECTIONS, DEFAULT_PRUNE, HierarchyChoice, Quality, bytes_allowed};
pub use progress::{Progress, Silent};
pub use report::{BakeReport, NoteReport, StageSeconds, TableReport, TreeReport};

use crate::appearance::AppearanceError;
use crate::gltf::payload::{self, Table};
use crate::gltf::{AttachError, Document};
use crate::proxies::{self, LodReport, ProxyBake, ProxyMode, ProxyTree};
use crate::scene::{ReadOptions, Scene, SceneError, read_scene};
use crate::verify::{self, VerifyError};
use clock::Clock;
use encode::{EncodedTable, EncodedTree, encode_tree};
use pipeline::{BakedTree, bake_tree};
use subject::{Anchor, Subject, subjects};
use svs_runtime::directions::{DIRECTION_SETS, DirectionSet};
use svs_runtime::format::{Extension, Tables, TreeJson, VERSION};

/// Why a bake did not happen. The document is unchanged then, except that an old bake may be gone from it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BakeError {
    /// The scene cannot be read.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The looks of the scene, which proxies need, cannot be read.
    #[error(transparent)]
    Appearance(#[from] AppearanceError),
    /// The result cannot be stored in the document.
    #[error(transparent)]
    Attach(#[from] AttachError),
    /// The result could not be checked.
    #[error("the bake could not be verified: {0}")]
    Verify(#[from] VerifyError),
    /// No such direction set.
    #[error("there is no direction set \"{name}\"; use one of {}", DIRECTION_SETS.join(", "))]
    UnknownDirections {
        /// What was asked for.
        name: String,
    },
}

struct Baked {
    subject: Subject,
    tree: BakedTree,
    encoded: EncodedTree,
}

/// Bakes visibility into a document. An old bake in it is replaced; baking twice gives the same bytes.
///
/// A scene of fewer than two static objects gets no extension: there is nothing to hide.
///
/// # Errors
/// See [`BakeError`].
pub fn build(
    doc: &mut Document,
    options: &BakeOptions,
    progress: &dyn Progress,
) -> Result<BakeReport, BakeError> {
    let clock = Clock::new(progress);
    let directions = DirectionSet::by_name(&options.directions)
        .ok_or_else(|| BakeError::UnknownDirections { name: options.directions.clone() })?;
    clock.stage("read", None);
    payload::strip(doc);
    let scene =
        read_scene(doc, &ReadOptions { scene: options.scene, mask: options.mask, ..ReadOptions::default() })?;
    let geometry_bytes: u64 = scene.meshes.iter().map(|m| m.bytes).sum();

    // A file without scenes shows nothing by itself: a tree would have nothing to hang on.
    let subjects = if scene.index.is_some() { subjects(&scene) } else { Vec::new() };
    let baked: Vec<Baked> = subjects
        .into_iter()
        .map(|subject| {
            let allowed = bytes_allowed(
                geometry_bytes * subject.members.len() as u64 / scene.objects.len().max(1) as u64,
                subject.members.len() as u64,
            );
            let allowed = allowed.saturating_sub(JSON_BYTES).max(JSON_BYTES);
            let tree = bake_tree(&subject, &scene.meshes, directions, options, &clock, allowed);
            let encoded = encode_tree(&tree, &subject, directions);
            Baked { subject, tree, encoded }
        })
        .collect();

    let mut proxies = ProxyBake::default();
    if options.proxies.mode != ProxyMode::Off && !baked.is_empty() {
        let trees: Vec<ProxyTree<'_>> =
            baked.iter().map(|b| ProxyTree { subject: &b.subject, order: &b.tree.hierarchy.order }).collect();
        proxies = proxies::bake(doc, &scene, &trees, geometry_bytes, &options.proxies, &clock)?;
    }

    clock.stage("write", None);
    let bytes_before = json_bytes(doc);
    let proxy_bytes = proxies.stored_bytes();
    let proxy_report = (options.proxies.mode != ProxyMode::Off).then(|| proxies.report.clone());
    if !baked.is_empty() {
        attach(doc, &baked, proxies, &scene, options)?;
    }
    let table_bytes: u64 = baked.iter().map(|b| b.encoded.bytes() as u64).sum();
    let json_added = json_bytes(doc).saturating_sub(bytes_before);

    let verification = if options.verify && !baked.is_empty() {
        clock.stage("verify", None);
        Some(verify::short(doc, &clock)?)
    } else {
        None
    };
    let left = proxy_report.as_ref().and_then(|report| left_without_lod(report.msft_lod.as_ref()?));
    Ok(BakeReport {
        objects: scene.objects.len(),
        baked_objects: baked.iter().map(|b| b.subject.members.len()).sum(),
        triangles: scene
            .objects
            .iter()
            .map(|o| u64::from(scene.meshes[o.mesh as usize].drawn_triangles))
            .sum(),
        geometry_bytes,
        table_bytes,
        bytes_added: table_bytes + proxy_bytes + json_added,
        trees: baked.iter().map(|b| tree_report(b, &scene, options)).collect(),
        proxies: proxy_report,
        rays: baked.iter().map(|b| b.tree.made.rays).sum(),
        estimated_missing_ppm: baked.iter().map(|b| b.tree.made.missing_ppm).fold(0.0, f64::max),
        seconds: clock.seconds(),
        stages: clock.stages(),
        notes: scene
            .notes
            .iter()
            .map(|n| NoteReport {
                code: n.code.to_owned(),
                count: n.count,
                message: n.message.clone(),
                pointer: n.pointer.clone(),
            })
            .chain(left)
            .collect(),
        verification,
    })
}

/// Nodes that could have got `MSFT_lod`.
fn left_without_lod(report: &LodReport) -> Option<NoteReport> {
    Some(NoteReport {
        code: "MSFT_LOD_LEFT".to_owned(),
        count: report.left,
        message: "nodes get no MSFT_lod, because they move, or have children, a skin, extensions or thresholds of their own"
            .to_owned(),
        pointer: format!("/nodes/{}", report.first_left?),
    })
}

/// About what a tree's JSON takes beside its tables: the extension, a buffer view, an accessor per table.
const JSON_BYTES: u64 = 1_400;

fn attach(
    doc: &mut Document,
    baked: &[Baked],
    proxies: ProxyBake,
    scene: &Scene,
    options: &BakeOptions,
) -> Result<(), BakeError> {
    let mut next = (doc.next_accessor() + proxies.additions.accessors.len()) as u32;
    let mut trees = Vec::new();
    let mut tables = Vec::new();
    for Baked { subject, encoded, .. } in baked {
        let mut semantics = Tables::default();
        for table in &encoded.tables {
            *slot(&mut semantics, table.semantic) = Some(next);
            next += 1;
            tables.push(stored(table));
        }
        let (scene_index, anchors) = match subject.anchor {
            Anchor::Scene => (scene.index.map(|index| index as u32), Vec::new()),
            Anchor::Node(node) => (None, vec![scene.nodes[node as usize].node as u32]),
        };
        trees.push(TreeJson {
            scene: scene_index,
            anchors,
            directions: options.directions.clone(),
            object_count: subject.members.len() as u32,
            level_bits: encoded.level_bits,
            importance_area: encoded.importance_area,
            tables: semantics,
            proxies: None,
            nested: Vec::new(),
            recommended: None,
            fingerprint: Some(encoded.fingerprint.clone()),
        });
    }
    let extension = Extension {
        version: VERSION.to_owned(),
        generator: Some(concat!("svs ", env!("CARGO_PKG_VERSION")).to_owned()),
        trees,
        mesh_levels: Vec::new(),
        extras: None,
    };
    let mut json = serde_json::to_value(&extension)
        .unwrap_or_else(|error| unreachable!("the extension is plain data: {error}"));
    for (tree, encoded) in proxies.trees.iter().enumerate().filter(|(_, tables)| !tables.is_empty()) {
        let mut semantics = serde_json::Map::new();
        for table in encoded {
            semantics.insert(table.semantic.to_owned(), next.into());
            next += 1;
            tables.push(stored(table));
        }
        let visible = options.proxies.mode != ProxyMode::All;
        json["trees"][tree]["proxies"] = serde_json::json!({"visible": visible, "tables": semantics});
    }
    if !proxies.mesh_levels.is_empty() {
        json["meshLevels"] = proxies.mesh_levels.into();
    }
    payload::attach_with(doc, json, &tables, proxies.additions)?;
    Ok(())
}

fn stored(table: &EncodedTable) -> Table<'_> {
    Table {
        bytes: &table.bytes,
        component_type: table.component_type,
        kind: table.kind,
        count: table.count,
        min_max: None,
    }
}

fn slot<'a>(tables: &'a mut Tables, semantic: &str) -> &'a mut Option<u32> {
    match semantic {
        "NODE_SPHERE" => &mut tables.node_sphere,
        "NODE_SUBTREE" => &mut tables.node_subtree,
        "NODE_FIRST_OBJECT" => &mut tables.node_first_object,
        "NODE_OBJECT_COUNT" => &mut tables.node_object_count,
        "OBJECT_ORDER" => &mut tables.object_order,
        "LEVEL_ROW" => &mut tables.level_row,
        "LEVEL_ROW_INDEX" => &mut tables.level_row_index,
        "IMPORTANCE" => &mut tables.importance,
        _ => unreachable!("no table is called {semantic}"),
    }
}

fn json_bytes(doc: &Document) -> u64 {
    // Counting what a writer would write, without keeping it.
    struct Count(u64);
    impl std::io::Write for Count {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.0 += bytes.len() as u64;
            Ok(bytes.len())
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }
    let mut count = Count(0);
    serde_json::to_writer(&mut count, &doc.json).map_or(0, |()| count.0)
}

fn tree_report(baked: &Baked, scene: &Scene, options: &BakeOptions) -> TreeReport {
    TreeReport {
        anchor: match baked.subject.anchor {
            Anchor::Scene => "scene".to_owned(),
            Anchor::Node(node) => scene.nodes[node as usize].node.to_string(),
        },
        objects: baked.subject.members.len(),
        hierarchy: baked.tree.made.kind.name().to_owned(),
        nodes_before: baked.tree.made.nodes_before,
        nodes_kept: baked.tree.hierarchy.nodes.len(),
        prune: baked.tree.made.prune,
        directions: options.directions.clone(),
        level_bits: baked.encoded.level_bits,
        tables: baked
            .encoded
            .tables
            .iter()
            .map(|t| TableReport { semantic: t.semantic.to_owned(), bytes: t.bytes.len() })
            .collect(),
    }
}
