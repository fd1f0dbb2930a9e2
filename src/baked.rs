//! The baked file as a user of the runtime has it: decoded trees, placed in the scene, and their culler.

use crate::gltf::{Document, DocumentTables};
use crate::scene::{ReadOptions, Role, Scene, SceneError, read_scene};
use crate::volume::{Aabb, box_in_tree};
use glam::{DAffine3, DVec3, Vec3};
use serde::Deserialize;
use serde_json::Value;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;
use svs_runtime::format::{EXTENSION_NAME, Extension};
use svs_runtime::{
    Bounds, BoundsError, DecodeError, Draw, Placement, SceneCuller, Settings, Tree, Visibility,
};

/// Why the baked visibility of a file cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum BakedError {
    /// The file has no baked visibility.
    #[error("the file holds no baked visibility: run `svs build` on it first")]
    NotBaked,
    /// The baked visibility is broken.
    #[error(
        "the baked visibility cannot be read ({0}): run `svs validate` for details, or `svs build` again"
    )]
    Decode(#[from] DecodeError),
    /// The scene has changed since it was baked.
    #[error("tree {tree} was baked from another state of the scene: run `svs build` again")]
    Stale {
        /// Index of the tree.
        tree: usize,
    },
    /// The runtime refuses the objects' boxes.
    #[error("the objects do not fit the baked visibility: {0}")]
    Bounds(#[from] BoundsError),
    /// The scene cannot be read.
    #[error(transparent)]
    Scene(#[from] SceneError),
}

/// Trees of a file and where they are in its scene.
#[derive(Debug)]
pub(crate) struct Baked {
    visibility: Visibility,
    /// For each tree its anchors.
    anchors: Vec<Vec<Anchor>>,
    /// Why its proxies and simplified meshes were left out, if there are any.
    broken_proxies: Option<DecodeError>,
}

/// One place of a tree.
#[derive(Debug)]
struct Anchor {
    to_world: DAffine3,
    /// Objects of the scene below it; `None` if the scene does not show it.
    objects: Option<Range<u32>>,
}

impl Baked {
    /// Decodes the extension of `doc` and reads the scene that its first tree with a scene names, else the default
    /// one, as an `outline` if so asked (see [`ReadOptions::outline`]). If nothing but its proxies is broken, they are left
    /// out, see [`Self::broken_proxies`].
    pub(crate) fn read(doc: &Document, outline: bool) -> Result<(Scene, Self), BakedError> {
        let json = doc.json.get("extensions").and_then(|all| all.get(EXTENSION_NAME));
        let json = json.ok_or(BakedError::NotBaked)?;
        let (extension, visibility, broken_proxies) = match decode(doc, json) {
            Ok((extension, visibility)) => (extension, visibility, None),
            Err(error) => {
                let bare = without_proxies(json).ok_or(()).and_then(|json| decode(doc, &json).map_err(drop));
                match bare {
                    Ok((extension, visibility)) => (extension, visibility, Some(error)),
                    Err(()) => return Err(error.into()),
                }
            }
        };
        let index = extension.trees.iter().find_map(|tree| tree.scene);
        let index = index.map(|index| index as usize);
        let scene = read_scene(doc, &ReadOptions { scene: index, outline, ..ReadOptions::default() })?;
        let node_of: HashMap<usize, usize> =
            scene.nodes.iter().enumerate().map(|(place, node)| (node.node, place)).collect();
        let place = |placement: &Placement| match placement {
            Placement::Scene(at) => {
                let objects = (scene.index == Some(*at as usize)).then_some(0..scene.objects.len() as u32);
                vec![Anchor { to_world: DAffine3::IDENTITY, objects }]
            }
            Placement::Anchors(nodes) => nodes
                .iter()
                .map(|&node| match node_of.get(&(node as usize)) {
                    Some(&at) => Anchor {
                        to_world: scene.nodes[at].to_world,
                        objects: Some(scene.nodes[at].objects.clone()),
                    },
                    None => Anchor { to_world: DAffine3::IDENTITY, objects: None },
                })
                .collect(),
        };
        let anchors = visibility.trees().iter().map(|tree| place(tree.placement())).collect();
        let baked = Self { visibility, anchors, broken_proxies };
        baked.check(&scene)?;
        Ok((scene, baked))
    }

    /// Every object exists and has the triangles it was baked with.
    fn check(&self, scene: &Scene) -> Result<(), BakedError> {
        for (index, tree) in self.visibility.trees().iter().enumerate() {
            for range in self.anchors[index].iter().filter_map(|a| a.objects.as_ref()) {
                let triangles: Option<Vec<u32>> = (0..tree.object_count())
                    .map(|place| {
                        let object = self.object(tree, range, place)?;
                        let mesh = scene.objects[object as usize].mesh;
                        Some(scene.meshes[mesh as usize].drawn_triangles)
                    })
                    .collect();
                // An object that stands for a tree has no triangles of its own to compare.
                let is_stale =
                    triangles.is_none_or(|counts| tree.nested().is_empty() && tree.is_stale(&counts));
                if is_stale {
                    return Err(BakedError::Stale { tree: index });
                }
            }
        }
        Ok(())
    }

    /// Index in the scene's objects; `None` if the scene has fewer below the anchor.
    fn object(&self, tree: &Tree, below: &Range<u32>, place: usize) -> Option<u32> {
        let object = below.start.checked_add(tree.document_index(place))?;
        below.contains(&object).then_some(object)
    }

    /// The trees, in the order of the file.
    pub(crate) fn trees(&self) -> &[Arc<Tree>] {
        self.visibility.trees()
    }

    /// What was decoded.
    pub(crate) fn visibility(&self) -> &Visibility {
        &self.visibility
    }

    /// Why the file's proxies and simplified meshes were left out.
    pub(crate) fn broken_proxies(&self) -> Option<&DecodeError> {
        self.broken_proxies.as_ref()
    }

    /// Where the scene shows a tree: the indices of its anchors, and their transforms from tree space to world space.
    pub(crate) fn places(&self, tree: usize) -> impl Iterator<Item = (usize, DAffine3)> {
        let anchors = self.anchors.get(tree).into_iter().flatten().enumerate();
        anchors.filter(|(_, at)| at.objects.is_some()).map(|(anchor, at)| (anchor, at.to_world))
    }

    /// The objects of the scene that a place of a tree stands for at one of its anchors: one, or those of a whole tree
    /// inside it; none where the scene does not show it.
    pub(crate) fn below(&self, tree: usize, anchor: usize, place: u32) -> Range<u32> {
        let objects = || {
            let data = self.visibility.trees().get(tree)?;
            let at = self.anchors[tree].get(anchor)?.objects.as_ref()?;
            let Some(nested) = data.nested().iter().find(|nested| nested.object == place) else {
                let object = self.object(data, at, place as usize)?;
                return Some(object..object + 1);
            };
            let guest = data.nested_anchor(nested, anchor);
            self.anchors[nested.tree as usize].get(guest)?.objects.clone()
        };
        objects().unwrap_or(0..0)
    }

    /// Everything that the trees decide about, tree by tree: what the runtime says to draw, and its object of the scene.
    pub(crate) fn draws(&self) -> impl Iterator<Item = (Draw, u32)> {
        self.visibility.trees().iter().zip(&self.anchors).enumerate().flat_map(
            move |(index, (tree, anchors))| {
                let mut is_nested = vec![false; tree.object_count()];
                for nested in tree.nested() {
                    is_nested[nested.object as usize] = true;
                }
                let places: Vec<usize> =
                    (0..tree.object_count()).filter(|&place| !is_nested[place]).collect();
                anchors.iter().enumerate().flat_map(move |(anchor, at)| {
                    let draws: Vec<(Draw, u32)> = (places.iter())
                        .filter_map(|&place| {
                            let object = self.object(tree, at.objects.as_ref()?, place)?;
                            Some((
                                Draw { tree: index as u32, anchor: anchor as u32, object: place as u32 },
                                object,
                            ))
                        })
                        .collect();
                    draws
                })
            },
        )
    }

    /// The object of the scene that the runtime says to draw; `None` if the scene does not show it.
    pub(crate) fn object_of(&self, draw: Draw) -> Option<u32> {
        let tree = self.visibility.trees().get(draw.tree as usize)?;
        let anchor = self.anchors[draw.tree as usize].get(draw.anchor as usize)?;
        let place = Some(draw.object as usize).filter(|&place| place < tree.object_count())?;
        self.object(tree, anchor.objects.as_ref()?, place)
    }

    /// For each object of the scene: a tree decides whether it is drawn.
    pub(crate) fn covered(&self, scene: &Scene) -> Vec<bool> {
        let mut covered = vec![false; scene.objects.len()];
        for (_, object) in self.draws() {
            covered[object as usize] = true;
        }
        covered
    }

    /// Quality that the file recommends: the highest of its trees', since all share one slider.
    pub(crate) fn recommended(&self) -> Option<f32> {
        let qualities = self.visibility.trees().iter().filter_map(|tree| tree.recommended_quality());
        qualities.reduce(f32::max)
    }

    /// Default settings: at the recommended quality, if there is one.
    #[cfg_attr(not(feature = "stage"), expect(dead_code, reason = "for drawing"))]
    pub(crate) fn settings(&self) -> Settings {
        self.recommended().map_or_else(Settings::default, Settings::from_quality)
    }

    /// The runtime's culler over all trees.
    pub(crate) fn culler(&self, scene: &Scene) -> Result<SceneCuller, BakedError> {
        let trees = self.visibility.trees();
        let bounds: Vec<Vec<Bounds>> = (0..trees.len()).map(|tree| self.boxes(scene, tree)).collect();
        let mut culler = SceneCuller::new(&self.visibility, &bounds)?;
        for (tree, anchors) in self.anchors.iter().enumerate() {
            if !anchors.is_empty() {
                culler.set_triangles(tree as u32, &self.triangles(scene, tree))?;
            }
            for (anchor, place) in anchors.iter().enumerate() {
                culler.set_anchor(tree as u32, anchor as u32, place.to_world);
                culler.set_shown(tree as u32, anchor as u32, place.objects.is_some());
            }
        }
        Ok(culler)
    }

    /// Triangles of a tree's objects, below the first anchor that is shown; none of objects that stand for trees.
    fn triangles(&self, scene: &Scene, tree: usize) -> Vec<u32> {
        let data = &self.visibility.trees()[tree];
        let mut triangles = vec![0; data.object_count()];
        if let Some(range) = self.anchors[tree].iter().find_map(|anchor| anchor.objects.as_ref()) {
            for (place, count) in triangles.iter_mut().enumerate() {
                let object = self.object(data, range, place).map(|object| &scene.objects[object as usize]);
                *count = object.map_or(0, |object| scene.meshes[object.mesh as usize].drawn_triangles);
            }
        }
        for nested in data.nested() {
            triangles[nested.object as usize] = 0;
        }
        triangles
    }

    /// Boxes of a tree's objects in its space, as a loader has them, below the first anchor that is shown.
    fn boxes(&self, scene: &Scene, tree: usize) -> Vec<Bounds> {
        const NOWHERE: Bounds = Bounds { min: Vec3::ZERO, max: Vec3::ZERO };
        let data = &self.visibility.trees()[tree];
        let mut boxes = vec![NOWHERE; data.object_count()];
        let Some((anchor, place)) =
            self.anchors[tree].iter().enumerate().find(|(_, place)| place.objects.is_some())
        else {
            return boxes;
        };
        let from_world = place.to_world.inverse();
        let Some(range) = &place.objects else { return boxes };
        let mut guests = vec![None; data.object_count()];
        for nested in data.nested() {
            let guest = data.nested_anchor(nested, anchor);
            guests[nested.object as usize] = self.anchors[nested.tree as usize].get(guest);
        }
        for (at, bounds) in boxes.iter_mut().enumerate() {
            let objects = match guests[at] {
                Some(guest) => guest.objects.clone().unwrap_or(0..0),
                None => self.object(data, range, at).map_or(0..0, |object| object..object + 1),
            };
            let around = objects
                .map(|object| &scene.objects[object as usize])
                .filter(|object| object.role == Role::Static)
                .map(|object| {
                    box_in_tree(&scene.meshes[object.mesh as usize], &(from_world * object.to_world))
                })
                .filter(|b| !b.is_empty())
                .fold(Aabb::EMPTY, |all, b| all.union(&b));
            *bounds = outward(&around).unwrap_or(NOWHERE);
        }
        boxes
    }
}

fn decode(doc: &Document, json: &Value) -> Result<(Extension, Visibility), DecodeError> {
    let extension = Extension::deserialize(json)?;
    let visibility = Visibility::decode(json, &DocumentTables::of_extension(doc, &extension))?;
    Ok((extension, visibility))
}

/// The extension's JSON without proxies and simplified meshes; `None` if it has none.
fn without_proxies(json: &Value) -> Option<Value> {
    let mut bare = json.clone();
    let mut had = bare.as_object_mut()?.shift_remove("meshLevels").is_some();
    for tree in bare.get_mut("trees").and_then(Value::as_array_mut).into_iter().flatten() {
        had |= tree.as_object_mut().is_some_and(|tree| tree.shift_remove("proxies").is_some());
    }
    had.then_some(bare)
}

/// The smallest `f32` box around a box; `None` for an empty one.
pub(crate) fn outward(bounds: &Aabb) -> Option<Bounds> {
    if bounds.is_empty() {
        return None;
    }
    let down = |v: f64| {
        let rounded = v.clamp(f64::from(f32::MIN), f64::from(f32::MAX)) as f32;
        if f64::from(rounded) > v { rounded.next_down() } else { rounded }
    };
    let pick = |v: DVec3, round: &dyn Fn(f64) -> f32| Vec3::new(round(v.x), round(v.y), round(v.z));
    Some(Bounds { min: pick(bounds.min, &down), max: pick(bounds.max, &|v| -down(-v)) })
}
