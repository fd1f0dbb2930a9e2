//! Opens files.

use super::extras::{self, Extras};
use super::{Stage, object_of};
use crate::appearance::{self, Appearance, AppearanceError, Gradual};
use crate::baked::{Baked, BakedError, outward};
use crate::gltf::Document;
use crate::scene::{Note, Object, ReadOptions, Scene, SceneError, read_scene};
use crate::volume::{Aabb, box_in_tree};
use glam::{DMat4, DVec3};
use serde_json::Value;
use std::collections::HashSet;
use svs_render::SceneData;
use svs_runtime::{Bounds, BoundsError, Camera, Draw, LOOSE, SceneCuller, Settings};

/// Coordinates beyond this do not fit the culler's boxes with room for arithmetic.
const MAX_COORDINATE: f64 = 1e18;

/// Why a file cannot be drawn.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StageError {
    /// The scene cannot be read.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// Its looks cannot be read.
    #[error(transparent)]
    Appearance(#[from] AppearanceError),
    /// The culler refuses the objects' boxes.
    #[error("the objects cannot be culled: {0}")]
    Bounds(#[from] BoundsError),
}

/// Trees that can be used, and their culler.
struct Trees {
    baked: Option<Baked>,
    culler: SceneCuller,
    notice: Option<String>,
}

impl Stage {
    /// Opens the scene that was baked, else the file's default scene.
    ///
    /// # Errors
    /// [`StageError`] if there is no scene that could be drawn. Baked visibility that cannot be used is no error, see
    /// [`Stage::notice`].
    pub fn open(doc: &Document) -> Result<Stage, StageError> {
        let (scene, mut trees) = trees(doc, false)?;
        let (looks, extras, broken) = looks(doc, &scene, trees.baked.as_ref(), &mut trees.culler)?;
        Self::assemble(doc, scene, trees, (looks.data, looks.notes), extras, broken)
    }

    /// As [`Stage::open`], but all meshes are still empty and all images white: nothing is read but the JSON and the tables
    /// of the baked visibility. [`Gradual`] reads the rest, in any order.
    ///
    /// # Errors
    /// [`StageError`], as far as it shows without the geometry.
    pub fn outline(doc: &Document) -> Result<(Stage, Gradual), StageError> {
        let (scene, mut trees) = trees(doc, true)?;
        let mut broken = trees.baked.as_ref().and_then(Baked::broken_proxies).map(ToString::to_string);
        let meshes = match &trees.baked {
            Some(baked) if broken.is_none() => extras::meshes(doc, &scene, baked),
            _ => Vec::new(),
        };
        let mut extras = None;
        let mut opened = None;
        if let (Some(baked), false) = (&trees.baked, meshes.is_empty()) {
            match Gradual::new(doc, &scene, &meshes) {
                Ok((gradual, mut data)) => {
                    let triangles: Vec<u32> = (data.meshes.len() - meshes.len()..data.meshes.len())
                        .map(|mesh| gradual.triangles(mesh as u32))
                        .collect();
                    match Extras::add(doc, &scene, baked, (&meshes, &triangles), &mut data, &mut trees.culler)
                    {
                        Ok(added) => (extras, opened) = (Some(added), Some((gradual, data))),
                        Err(error) => broken = Some(error.to_string()),
                    }
                }
                Err(error) => broken = Some(error.to_string()),
            }
        }
        let (gradual, data) = match opened {
            Some(opened) => opened,
            None => Gradual::new(doc, &scene, &[])?,
        };
        let stage = Self::assemble(doc, scene, trees, (data, Vec::new()), extras, broken)?;
        Ok((stage, gradual))
    }

    fn assemble(
        doc: &Document,
        scene: Scene,
        trees: Trees,
        (data, notes): (SceneData, Vec<Note>),
        extras: Option<Extras>,
        broken: Option<String>,
    ) -> Result<Stage, StageError> {
        let Trees { baked, mut culler, mut notice } = trees;
        if let Some(broken) = broken {
            notice.get_or_insert(format!("the proxies cannot be used ({broken}); shown without them"));
        }
        let bounds = |object: &Object| {
            let mesh = &scene.meshes[object.mesh as usize];
            let bounds = box_in_tree(mesh, &object.to_world);
            let is_drawn = !object.hidden && mesh.drawn_triangles > 0 && is_usable(&bounds);
            if is_drawn { bounds } else { Aabb::EMPTY }
        };
        let boxes: Vec<Aabb> = scene.objects.iter().map(bounds).collect();
        let triangle = |object: &Object| scene.meshes[object.mesh as usize].drawn_triangles;
        let triangles: Vec<u32> = scene.objects.iter().map(triangle).collect();
        let mut draws = vec![None; scene.objects.len()];
        for (draw, object) in baked.iter().flat_map(Baked::draws) {
            // A file may name one object in two trees: the first one stands for it.
            draws[object as usize].get_or_insert(draw);
        }
        let is_loose = |&object: &usize| draws[object].is_none() && !boxes[object].is_empty();
        let loose: Vec<u32> = (0..draws.len()).filter(is_loose).map(|object| object as u32).collect();
        for (place, &object) in loose.iter().enumerate() {
            draws[object as usize] = Some(Draw { tree: LOOSE, anchor: 0, object: place as u32 });
        }
        let loose_boxes: Vec<Bounds> =
            loose.iter().filter_map(|&object| outward(&boxes[object as usize])).collect();
        let loose_triangles: Vec<u32> = loose.iter().map(|&object| triangles[object as usize]).collect();
        culler.set_loose(&loose_boxes, &loose_triangles)?;
        if let Some(extras) = &extras {
            let (starts, levels) = extras.loose_levels(&loose);
            culler.set_loose_levels(&starts, &levels)?;
        }
        let mut order = order(&mut culler, |draw| object_of(baked.as_ref(), &loose, draw));
        let own = order.len();
        if let Some(extras) = &extras {
            let trees = baked.as_ref().map_or(&[][..], Baked::trees);
            let depth = |tree: u32, node: u32| {
                let nodes = trees.get(tree as usize).and_then(|tree| tree.proxies()).map(|all| all.nodes());
                nodes.and_then(|nodes| nodes.get(node as usize)).map_or(0, |node| node.depth)
            };
            order.extend(extras.order(&order, depth));
        }
        let settings = baked.as_ref().map_or_else(Settings::default, Baked::settings);
        Ok(Stage {
            names: names(doc, &scene),
            bounds: around(&boxes),
            data,
            notes,
            hidden: vec![false; triangles.len()],
            drawn: Vec::with_capacity(order.len()),
            ratios: Vec::new(),
            extras,
            own,
            scene,
            triangles,
            baked,
            notice,
            culler,
            settings,
            order,
            draws,
            loose,
            boxes,
        })
    }
}

/// Looks of the scene, and of its proxies and levels if there are any and they can be used; else why not.
fn looks(
    doc: &Document,
    scene: &Scene,
    baked: Option<&Baked>,
    culler: &mut SceneCuller,
) -> Result<(Appearance, Option<Extras>, Option<String>), StageError> {
    let plain = |broken| -> Result<_, StageError> { Ok((appearance::read(doc, scene)?, None, broken)) };
    let Some(baked) = baked else { return plain(None) };
    if let Some(error) = baked.broken_proxies() {
        return plain(Some(error.to_string()));
    }
    let meshes = extras::meshes(doc, scene, baked);
    if meshes.is_empty() {
        return plain(None);
    }
    let mut looks = match appearance::read_with(doc, scene, &meshes) {
        Ok(looks) => looks,
        Err(error) => return plain(Some(error.to_string())),
    };
    let drawn =
        |mesh: &svs_render::Mesh| mesh.primitives.iter().map(|p| p.indices.len() / 3).sum::<usize>() as u32;
    let first = looks.data.meshes.len() - meshes.len();
    let triangles: Vec<u32> = looks.data.meshes[first..].iter().map(drawn).collect();
    match Extras::add(doc, scene, baked, (&meshes, &triangles), &mut looks.data, culler) {
        Ok(extras) => Ok((looks, Some(extras), None)),
        Err(error) => plain(Some(error.to_string())),
    }
}

/// Everything that can be drawn, each object once, as the culler answers.
fn order(culler: &mut SceneCuller, object_of: impl Fn(Draw) -> Option<u32>) -> Vec<u32> {
    let everywhere = Camera::perspective(DMat4::IDENTITY, 1.0, 1.0, 1.0, 0.0);
    let everything = Settings { frustum: false, ..Settings::FRUSTUM };
    let mut seen = HashSet::new();
    let objects = culler.cull(&everywhere, &everything).iter().filter_map(|&draw| object_of(draw));
    objects.filter(|&object| seen.insert(object)).collect()
}

fn trees(doc: &Document, outline: bool) -> Result<(Scene, Trees), StageError> {
    let read = || {
        let (scene, baked) = Baked::read(doc, outline)?;
        let culler = baked.culler(&scene)?;
        Ok((scene, Trees { baked: Some(baked), culler, notice: None }))
    };
    let notice = match read() {
        Ok(read) => return Ok(read),
        Err(BakedError::NotBaked) => None,
        Err(BakedError::Scene(error)) => return Err(error.into()),
        Err(error) => Some(format!("{error}; culled by the frustum alone")),
    };
    let scene = read_scene(doc, &ReadOptions { outline, ..ReadOptions::default() })?;
    Ok((scene, Trees { baked: None, culler: SceneCuller::empty(), notice }))
}

/// Finite and of a size that boxes in single precision can hold.
fn is_usable(bounds: &Aabb) -> bool {
    !bounds.is_empty() && bounds.min.abs().max(bounds.max.abs()).max_element() <= MAX_COORDINATE
}

/// Box around boxes; a unit cube around the origin if all are empty.
fn around(boxes: &[Aabb]) -> Aabb {
    let all = boxes.iter().fold(Aabb::EMPTY, |all, bounds| all.union(bounds));
    if all.is_empty() { Aabb { min: DVec3::splat(-0.5), max: DVec3::splat(0.5) } } else { all }
}

fn names(doc: &Document, scene: &Scene) -> Vec<Option<String>> {
    let nodes = doc.json.get("nodes");
    let name = |node: usize| nodes?.get(node)?.get("name").and_then(Value::as_str).map(str::to_owned);
    scene.objects.iter().map(|object| name(object.node)).collect()
}
