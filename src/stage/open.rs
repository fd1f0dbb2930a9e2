//! Opens files.

use super::Stage;
use crate::appearance::{self, AppearanceError};
use crate::bake::subject::box_in_tree;
use crate::bake::tree::Aabb;
use crate::baked::{Baked, BakedError};
use crate::gltf::Document;
use crate::scene::{Object, ReadOptions, Scene, SceneError, read_scene};
use glam::DVec3;
use serde_json::Value;
use svs_runtime::{Bounds, BoundsError, DecodeError, Draw, SceneCuller, Settings, Visibility};

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
    /// A culler without trees cannot be made.
    #[error("the objects cannot be culled: {0}")]
    Decode(#[from] DecodeError),
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
        let (scene, trees) = trees(doc)?;
        let looks = appearance::read(doc, &scene)?;
        let bounds = |object: &Object| {
            let mesh = &scene.meshes[object.mesh as usize];
            let bounds = box_in_tree(mesh, &object.to_world);
            let is_drawn = !object.hidden && mesh.drawn_triangles > 0 && is_usable(&bounds);
            if is_drawn { bounds } else { Aabb::EMPTY }
        };
        let boxes: Vec<Aabb> = scene.objects.iter().map(bounds).collect();
        let mut draws = vec![None; scene.objects.len()];
        let mut order = Vec::with_capacity(scene.objects.len());
        for (draw, object) in trees.baked.iter().flat_map(Baked::draws) {
            // A file may name one object in two trees: the first one draws it.
            if draws[object as usize].is_none() {
                draws[object as usize] = Some(draw);
                order.push(object);
            }
        }
        let is_loose = |&object: &usize| draws[object].is_none() && !boxes[object].is_empty();
        let loose: Vec<u32> = (0..draws.len()).filter(is_loose).map(|object| object as u32).collect();
        for (place, &object) in loose.iter().enumerate() {
            draws[object as usize] = Some(Draw { tree: super::LOOSE, anchor: 0, object: place as u32 });
        }
        order.extend(&loose);
        let triangle = |object: &Object| scene.meshes[object.mesh as usize].drawn_triangles;
        let count = scene.objects.len();
        let settings = trees.baked.as_ref().map_or_else(Settings::default, Baked::settings);
        Ok(Stage {
            names: names(doc, &scene),
            triangles: scene.objects.iter().map(triangle).collect(),
            bounds: around(&boxes),
            data: looks.data,
            notes: looks.notes,
            baked: trees.baked,
            notice: trees.notice,
            culler: trees.culler,
            settings,
            order,
            draws,
            loose,
            boxes,
            hidden: vec![false; count],
            drawn: Vec::new(),
            scene,
        })
    }
}

fn trees(doc: &Document) -> Result<(Scene, Trees), StageError> {
    let read = || {
        let (scene, baked) = Baked::read(doc)?;
        let culler = baked.culler(&scene)?;
        Ok((scene, Trees { baked: Some(baked), culler, notice: None }))
    };
    let notice = match read() {
        Ok(read) => return Ok(read),
        Err(BakedError::NotBaked) => None,
        Err(BakedError::Scene(error)) => return Err(error.into()),
        Err(error) => Some(format!("{error}; culled by the frustum alone")),
    };
    let scene = read_scene(doc, &ReadOptions::default())?;
    let culler = SceneCuller::new::<Vec<Bounds>>(&Visibility::new(Vec::new())?, &[])?;
    Ok((scene, Trees { baked: None, culler, notice }))
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
