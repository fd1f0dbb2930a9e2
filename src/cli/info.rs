//! `svs info`: what a baked file holds.

use super::args::{Common, Info};
use super::error::Failure;
use super::file;
use super::level_share::{self, LevelShare, Node};
use super::lods::Lods;
use super::output::{self, bytes, count, counted, number, percent, ratio};
use super::tree_weights::{tree_weights, triangles_of};
use serde::Deserialize;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::Path;
use svs::gltf::{Document, DocumentTables};
use svs::scene::{ReadOptions, read_scene};
use svs_runtime::format::{EXTENSION_NAME, Extension};
use svs_runtime::{Placement, Proxies, Tree, Visibility};

pub(crate) fn run(args: &Info, common: &Common) -> Result<(), Failure> {
    let document = file::read(&args.file)?;
    let info = FileInfo::of(&document, &args.file)?;
    output::print(common, &info.to_json(&args.file), &info.to_text(&args.file))
}

/// Everything there is to tell.
struct FileInfo {
    version: String,
    generator: String,
    trees: Vec<TreeInfo>,
    /// Bytes of the scene's vertices and indices.
    geometry_bytes: u64,
    objects: u64,
    triangles: u64,
    /// Simplified versions of meshes, and their triangles.
    mesh_levels: [u64; 2],
    lods: Lods,
}

struct TreeInfo {
    /// "scene 0" or "node 7 and 255 more".
    anchor: String,
    anchors: u64,
    objects: u64,
    spheres: u64,
    triangles: u64,
    nested: u64,
    directions: &'static str,
    direction_count: u64,
    level_bits: u64,
    quality: Option<f64>,
    tables: Vec<(String, u64)>,
    levels: Vec<LevelShare>,
    proxies: Option<ProxyInfo>,
}

/// The proxies of a tree.
struct ProxyInfo {
    nodes: u64,
    depth: u64,
    meshes: u64,
    /// Of the meshes, each once.
    triangles: u64,
    /// Of the coarsest proxies, those below no other.
    coarsest: u64,
    /// Smallest and largest geometric error, metres.
    errors: [f32; 2],
    visible: bool,
}

impl FileInfo {
    fn of(document: &Document, path: &Path) -> Result<Self, Failure> {
        let scene = read_scene(document, &ReadOptions::default())
            .map_err(|error| Failure::doing("read the scene of", path, &error))?;
        let mut info = Self {
            version: String::new(),
            generator: String::new(),
            trees: Vec::new(),
            geometry_bytes: scene.meshes.iter().map(|mesh| mesh.bytes).sum(),
            objects: scene.objects.len() as u64,
            triangles: scene.objects.iter().map(|object| triangles_of(&scene, object.mesh)).sum(),
            mesh_levels: [0; 2],
            lods: Lods::of(document),
        };
        let Some(extension) = document.json.get("extensions").and_then(|all| all.get(EXTENSION_NAME)) else {
            return Ok(info);
        };
        let broken = |error: &dyn std::fmt::Display| {
            Failure::Input(format!(
                "the baked visibility of {0} is broken: {error}; `svs validate {0}` lists what is wrong, \
                 `svs build` replaces it",
                path.display()
            ))
        };
        let tables = Extension::deserialize(extension).map_err(|error| broken(&error))?;
        let tables = DocumentTables::of_extension(document, &tables);
        let visibility = Visibility::decode(extension, &tables).map_err(|error| broken(&error))?;
        let text = |key: &str| extension.get(key).and_then(Value::as_str).unwrap_or_default().to_owned();
        info.version = text("version");
        info.generator = text("generator");
        let levels = visibility.mesh_levels().iter().flat_map(|mesh| &mesh.levels);
        for level in levels {
            info.mesh_levels[0] += 1;
            info.mesh_levels[1] += triangles_of_mesh(document, level.mesh);
        }
        let weights = tree_weights(&scene, visibility.trees());
        for (index, (tree, weights)) in visibility.trees().iter().zip(&weights).enumerate() {
            let json = extension.pointer(&format!("/trees/{index}")).unwrap_or(&Value::Null);
            info.trees.push(TreeInfo::of(document, tree, json, weights));
        }
        Ok(info)
    }

    fn bytes(&self) -> u64 {
        self.trees.iter().map(TreeInfo::bytes).sum()
    }

    fn to_json(&self, path: &Path) -> Value {
        json!({
            "file": path.display().to_string(),
            "version": self.version,
            "generator": self.generator,
            "objects": self.objects,
            "triangles": self.triangles,
            "geometry_bytes": self.geometry_bytes,
            "bytes": self.bytes(),
            "mesh_levels": { "count": self.mesh_levels[0], "triangles": self.mesh_levels[1] },
            "msft_lod": self.lods,
            "trees": self.trees.iter().map(TreeInfo::to_json).collect::<Vec<_>>(),
        })
    }

    fn to_text(&self, path: &Path) -> String {
        let path = path.display();
        let scene = format!("{}, {}", counted(self.objects, "object"), counted(self.triangles, "triangle"));
        if self.trees.is_empty() {
            return format!("{path}: no baked visibility; {scene}\n{}", self.lods.to_text());
        }
        let mut text = format!(
            "{path}: {}, {}, {} ({} of the geometry); {scene}\n",
            counted(self.trees.len() as u64, "tree"),
            counted(self.trees.iter().map(|tree| tree.spheres).sum(), "sphere"),
            bytes(self.bytes()),
            percent(ratio(self.bytes(), self.geometry_bytes)),
        );
        let _ = writeln!(text, "baked by {}, format {}", self.generator, self.version);
        let [levels, triangles] = self.mesh_levels;
        if levels > 0 {
            let (levels, triangles) = (counted(levels, "simplified version"), counted(triangles, "triangle"));
            let _ = writeln!(text, "{levels} of meshes, {triangles}");
        }
        text += &self.lods.to_text();
        for (index, tree) in self.trees.iter().enumerate() {
            let _ = write!(text, "\ntree {index}: {}", tree.to_text());
        }
        text
    }
}

impl TreeInfo {
    fn of(document: &Document, tree: &Tree, json: &Value, triangles: &[u64]) -> Self {
        let nodes: Vec<Node> = tree
            .nodes()
            .iter()
            .map(|node| {
                let objects = node.objects();
                Node { objects: objects.start as usize..objects.end as usize, subtree: node.subtree as usize }
            })
            .collect();
        let set = tree.direction_set();
        let anchor = match tree.placement() {
            Placement::Scene(scene) => format!("scene {scene}"),
            Placement::Anchors(nodes) => match nodes.as_slice() {
                [] => "nothing".to_owned(),
                [only] => format!("node {only}"),
                [first, others @ ..] => format!("node {first} and {} more like it", others.len()),
            },
        };
        Self {
            anchor,
            anchors: tree.placement().count() as u64,
            objects: triangles.len() as u64,
            spheres: nodes.len() as u64,
            triangles: triangles.iter().sum(),
            nested: tree.nested().len() as u64,
            directions: set.name(),
            direction_count: set.len() as u64,
            level_bits: json.get("levelBits").and_then(Value::as_u64).unwrap_or(0),
            quality: tree.recommended_quality().map(f64::from),
            tables: table_bytes(document, json),
            levels: level_share::by_depth(
                &nodes,
                set.len(),
                |object, direction| tree.level(object, direction),
                triangles,
            ),
            proxies: tree.proxies().map(|proxies| ProxyInfo::of(document, proxies)),
        }
    }

    fn bytes(&self) -> u64 {
        self.tables.iter().map(|(_, bytes)| bytes).sum()
    }

    fn to_json(&self) -> Value {
        let level = |(depth, level): (usize, &LevelShare)| {
            json!({
                "depth": depth,
                "spheres": level.spheres,
                "objects": level.objects,
                "triangles": level.triangles,
                "culled": level.culled,
            })
        };
        json!({
            "anchor": self.anchor,
            "anchors": self.anchors,
            "objects": self.objects,
            "triangles": self.triangles,
            "spheres": self.spheres,
            "nested": self.nested,
            "directions": { "name": self.directions, "count": self.direction_count },
            "level_bits": self.level_bits,
            "recommended_quality": self.quality,
            "bytes": self.bytes(),
            "tables": self.tables.iter().map(|(name, bytes)| (name.clone(), json!(bytes))).collect::<serde_json::Map<_, _>>(),
            "levels": self.levels.iter().enumerate().map(level).collect::<Vec<_>>(),
            "proxies": self.proxies.as_ref().map(ProxyInfo::to_json),
        })
    }

    fn to_text(&self) -> String {
        let mut text = format!(
            "{}, {}, {}, {} ({}), {} per level\n",
            self.anchor,
            counted(self.objects, "object"),
            counted(self.spheres, "sphere"),
            counted(self.direction_count, "direction"),
            self.directions,
            counted(self.level_bits, "bit"),
        );
        if self.nested > 0 {
            let _ = writeln!(text, "  {} of its objects stand for other trees", count(self.nested));
        }
        if let Some(quality) = self.quality {
            let _ = writeln!(text, "  recommended quality {}", number(quality));
        }
        let row = |cells: [String; 4]| cells.to_vec();
        let mut rows = vec![row(["depth", "spheres", "triangles", "hidden"].map(str::to_owned))];
        for (depth, level) in self.levels.iter().enumerate() {
            rows.push(row([
                depth.to_string(),
                count(level.spheres),
                count(level.triangles),
                percent(level.culled),
            ]));
        }
        if !self.levels.is_empty() {
            text += &output::table(&rows);
        }
        if let Some(proxies) = &self.proxies {
            text += &proxies.to_text();
        }
        let mut rows = vec![vec!["table".to_owned(), "bytes".to_owned()]];
        rows.extend(self.tables.iter().map(|(name, bytes)| vec![name.clone(), count(*bytes)]));
        rows.push(vec!["all".to_owned(), count(self.bytes())]);
        text + &output::table(&rows)
    }
}

impl ProxyInfo {
    fn of(document: &Document, proxies: &Proxies) -> Self {
        let nodes = proxies.nodes();
        let meshes: BTreeSet<u32> = nodes.iter().map(|node| node.mesh).collect();
        let roots = nodes.iter().filter(|node| node.depth == 0);
        Self {
            nodes: nodes.len() as u64,
            depth: nodes.iter().map(|node| u64::from(node.depth) + 1).max().unwrap_or(0),
            meshes: meshes.len() as u64,
            triangles: meshes.iter().map(|&mesh| triangles_of_mesh(document, mesh)).sum(),
            coarsest: roots.map(|node| triangles_of_mesh(document, node.mesh)).sum(),
            errors: nodes.iter().fold([f32::INFINITY, 0.0], |[least, largest], node| {
                [least.min(node.error), largest.max(node.error)]
            }),
            visible: proxies.visible_only(),
        }
    }

    fn to_json(&self) -> Value {
        json!({
            "nodes": self.nodes,
            "depth": self.depth,
            "meshes": self.meshes,
            "triangles": self.triangles,
            "coarsest_triangles": self.coarsest,
            "least_error": self.errors[0],
            "largest_error": self.errors[1],
            "visible_only": self.visible,
        })
    }

    fn to_text(&self) -> String {
        format!(
            "  {} in {} levels, {} in all, the coarsest {}; errors {} to {} m; {}\n",
            if self.nodes == 1 { "1 proxy".to_owned() } else { format!("{} proxies", count(self.nodes)) },
            count(self.depth),
            counted(self.triangles, "triangle"),
            count(self.coarsest),
            number(f64::from(self.errors[0])),
            number(f64::from(self.errors[1])),
            if self.visible { "of what is visible from outside" } else { "of everything" },
        )
    }
}

/// Triangles of a glTF mesh whose primitives are indexed triangles, as those that a bake adds are.
fn triangles_of_mesh(document: &Document, mesh: u32) -> u64 {
    let mesh = document.json.get("meshes").and_then(|meshes| meshes.get(mesh as usize));
    let primitives = mesh.and_then(|mesh| mesh.get("primitives")?.as_array()).into_iter().flatten();
    primitives
        .filter_map(|primitive| {
            let accessor = primitive.get("indices")?.as_u64()?;
            document.json.get("accessors")?.get(accessor as usize)?.get("count")?.as_u64()
        })
        .map(|indices| indices / 3)
        .sum()
}

/// Bytes of each table of a tree, by name.
fn table_bytes(document: &Document, tree: &Value) -> Vec<(String, u64)> {
    let size = |index: &Value| -> Option<u64> {
        let accessor = document.json.get("accessors")?.get(index.as_u64()? as usize)?;
        let component = match accessor.get("componentType")?.as_u64()? {
            5120 | 5121 => 1,
            5122 | 5123 => 2,
            _ => 4,
        };
        let components = match accessor.get("type")?.as_str()? {
            "VEC4" => 4,
            "VEC3" => 3,
            _ => 1,
        };
        Some(accessor.get("count")?.as_u64()? * component * components)
    };
    let tables = [tree.get("tables"), tree.pointer("/proxies/tables")];
    let tables = tables.into_iter().flatten().filter_map(Value::as_object).flatten();
    tables.map(|(name, index)| (name.clone(), size(index).unwrap_or(0))).collect()
}
