//! From a document to what the runtime sees, and to exact views of the same scene.

use glam::DVec3;
use serde::Deserialize;
use std::sync::Arc;
use svs::bake::hierarchy::{self, HierarchyKind};
use svs::bake::rays::RayScene;
use svs::bake::sample::{Ancestry, levels_from};
use svs::bake::subject::{Subject, subjects};
use svs::bake::tree::Hierarchy;
use svs::bake::{self, BakeOptions, BakeReport, HierarchyChoice, Silent};
use svs::generate::Sample;
use svs::gltf::Document;
use svs::gltf::DocumentTables;
use svs::scene::{ReadOptions, Scene, read_scene};
use svs_runtime::format::{EXTENSION_NAME, Extension};
use svs_runtime::{Tree, Visibility};

pub(crate) fn document(sample: Sample) -> Document {
    Document::from_parts(sample.json, Some(sample.bin)).expect("a document")
}

/// The scene's own groups, as many rays as `rays`, nothing left out except spheres that cull nothing at all.
pub(crate) fn options(rays: u64) -> BakeOptions {
    BakeOptions {
        rays: Some(rays),
        max_missing_ppm: Some(0.0),
        hierarchy: HierarchyChoice::Kind(HierarchyKind::Scene),
        prune: Some(0.0),
        verify: false,
        ..BakeOptions::default()
    }
}

/// Bakes, checks that the result is valid, and decodes it as a user of the runtime does.
pub(crate) fn bake(doc: &mut Document, options: &BakeOptions) -> (Vec<Arc<Tree>>, BakeReport) {
    let report = bake::build(doc, options, &Silent).expect("a bake");
    let issues = svs::validate::validate(doc);
    assert!(!issues.has_errors(), "{}", issues.to_json());
    (trees(doc), report)
}

/// The trees of a document; none if it is not baked.
pub(crate) fn trees(doc: &Document) -> Vec<Arc<Tree>> {
    let Some(json) = doc.json.get("extensions").and_then(|all| all.get(EXTENSION_NAME)) else {
        return Vec::new();
    };
    let extension = Extension::deserialize(json).expect("an extension");
    Visibility::decode(json, &DocumentTables::of_extension(doc, &extension)).expect("valid").trees().to_vec()
}

/// For each object in document order its levels for all directions.
pub(crate) fn rows(tree: &Tree) -> Vec<Vec<u8>> {
    let mut rows = vec![Vec::new(); tree.object_count()];
    for place in 0..tree.object_count() {
        rows[tree.document_index(place) as usize] =
            (0..tree.direction_set().len()).map(|direction| tree.level(place, direction)).collect();
    }
    rows
}

/// A scene that stands still, not pruned.
#[derive(Debug)]
pub(crate) struct Unpruned {
    scene: Scene,
    pub(crate) subject: Subject,
    pub(crate) hierarchy: Hierarchy,
    pub(crate) ancestry: Ancestry,
}

impl Unpruned {
    pub(crate) fn new(doc: &Document, kind: HierarchyKind) -> Self {
        let scene = read_scene(doc, &ReadOptions::default()).expect("a scene");
        let subject = subjects(&scene).into_iter().next().expect("two objects");
        let hierarchy = hierarchy::build(kind, &subject.members, &subject.groups);
        let ancestry = Ancestry::new(&hierarchy);
        Self { scene, subject, hierarchy, ancestry }
    }

    pub(crate) fn rays(&self) -> RayScene<'_> {
        RayScene::new(&self.scene.meshes, &self.subject.parts)
    }

    /// Levels in document order as seen from infinitely far away.
    pub(crate) fn levels_from(&self, direction: DVec3, lines: usize) -> Vec<u8> {
        levels_from(&self.rays(), &self.ancestry, direction, lines)
    }
}
