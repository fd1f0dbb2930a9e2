//! Proxies and simplified levels as further objects of the scene to draw, after its own: the renderer knows no difference.

use crate::baked::Baked;
use crate::gltf::Document;
use crate::scene::{Role, Scene};
use glam::DAffine3;
use serde_json::Value;
use std::collections::{BTreeSet, HashMap};
use svs_render::{Object, SceneData};
use svs_runtime::{BoundsError, Draw, LOOSE, Level, SceneCuller, Selected, SelectedKind, stretch};

/// No object.
const NONE: u32 = u32::MAX;

/// What an object after the scene's own stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Extra {
    /// The objects of a proxy node.
    Proxy {
        /// Index of the tree.
        tree: u32,
        /// Index of the anchor.
        anchor: u32,
        /// Index of the proxy node.
        node: u32,
    },
    /// One object.
    Level {
        /// Index of the object in the scene.
        object: u32,
        /// 1 is the first simplified level.
        level: u8,
    },
}

/// Why proxies cannot be drawn.
#[derive(Debug, thiserror::Error)]
pub(super) enum ExtraError {
    #[error("mesh {mesh} holds no triangles")]
    Empty { mesh: u32 },
    #[error("their objects would be more than can be counted")]
    TooMany,
    #[error(transparent)]
    Bounds(#[from] BoundsError),
}

/// The simplified levels of a mesh: glTF mesh and error in metres of mesh space.
type Levels<'a> = &'a [svs_runtime::MeshLevel];

/// What is added to a scene.
#[derive(Debug, Default)]
pub(super) struct Extras {
    /// Objects of the scene itself.
    own: u32,
    list: Vec<Extra>,
    /// Per tree, per anchor: the id of its first proxy node, or [`NONE`].
    proxies: Vec<Vec<u32>>,
    /// Per object of the scene: the id of its first level, or [`NONE`].
    levels: Vec<u32>,
    /// Per tree, per place: the innermost proxy node around it, or [`NONE`].
    owners: Vec<Vec<u32>>,
    /// Levels of objects in no tree, errors in metres of world space.
    loose: HashMap<u32, Vec<Level>>,
}

/// glTF meshes that proxies and levels draw, ascending; empty if there are none.
pub(super) fn meshes(doc: &Document, scene: &Scene, baked: &Baked) -> Vec<u32> {
    let mut wanted: BTreeSet<u32> = BTreeSet::new();
    for (tree, data) in baked.trees().iter().enumerate() {
        if let Some(proxies) = data.proxies().filter(|_| baked.places(tree).next().is_some()) {
            wanted.extend(proxies.nodes().iter().map(|node| node.mesh));
        }
    }
    let used: BTreeSet<u32> = scene.objects.iter().filter_map(|object| mesh_of(doc, object.node)).collect();
    for levels in baked.visibility().mesh_levels().iter().filter(|levels| used.contains(&levels.mesh)) {
        wanted.extend(levels.levels.iter().map(|level| level.mesh));
    }
    wanted.into_iter().collect()
}

/// The glTF mesh of a node.
fn mesh_of(doc: &Document, node: usize) -> Option<u32> {
    let mesh = doc.json.get("nodes").and_then(|nodes| nodes.get(node)?.get("mesh"));
    mesh.and_then(Value::as_u64).and_then(|mesh| u32::try_from(mesh).ok())
}

impl Extras {
    /// Appends the objects to `data`, whose meshes end with those of `meshes` (which have so many triangles), and tells the
    /// culler what they cost.
    pub(super) fn add(
        doc: &Document,
        scene: &Scene,
        baked: &Baked,
        (meshes, triangles): (&[u32], &[u32]),
        data: &mut SceneData,
        culler: &mut SceneCuller,
    ) -> Result<Self, ExtraError> {
        let first = data.meshes.len() - meshes.len();
        let places: HashMap<u32, u32> =
            meshes.iter().enumerate().map(|(at, &mesh)| (mesh, (first + at) as u32)).collect();
        let triangles = |mesh: u32| triangles[places[&mesh] as usize - first];
        if let Some(&mesh) = meshes.iter().find(|&&mesh| triangles(mesh) == 0) {
            return Err(ExtraError::Empty { mesh });
        }
        let levels_of: HashMap<u32, Levels<'_>> = baked
            .visibility()
            .mesh_levels()
            .iter()
            .map(|entry| (entry.mesh, entry.levels.as_slice()))
            .collect();
        let levels_of = |object: u32| -> Levels<'_> {
            let object = &scene.objects[object as usize];
            let mesh = mesh_of(doc, object.node).filter(|_| !object.hidden);
            mesh.and_then(|mesh| levels_of.get(&mesh)).copied().unwrap_or_default()
        };
        for (tree, tree_data) in baked.trees().iter().enumerate() {
            let Some((anchor, to_world)) = baked.places(tree).next() else { continue };
            if let Some(proxies) = tree_data.proxies() {
                let triangles: Vec<u32> = proxies.nodes().iter().map(|node| triangles(node.mesh)).collect();
                culler.set_proxy_triangles(tree as u32, &triangles)?;
            }
            let from_world = to_world.inverse();
            // What stands for a tree has no mesh of its own.
            let nested: BTreeSet<u32> = tree_data.nested().iter().map(|nested| nested.object).collect();
            let (mut starts, mut levels) = (vec![0], Vec::new());
            for place in 0..tree_data.object_count() {
                let draw = Draw { tree: tree as u32, anchor: anchor as u32, object: place as u32 };
                let object = baked.object_of(draw).filter(|_| !nested.contains(&draw.object));
                if let Some(object) = object {
                    let to_tree = from_world * scene.objects[object as usize].to_world;
                    levels.extend(placed(levels_of(object), &to_tree, &triangles));
                }
                starts.push(levels.len() as u32);
            }
            if !levels.is_empty() {
                culler.set_levels(tree as u32, &starts, &levels)?;
            }
        }
        let mut extras = Self { own: scene.objects.len() as u32, ..Self::default() };
        extras.levels = vec![NONE; scene.objects.len()];
        let in_trees: BTreeSet<u32> = baked.draws().map(|(_, object)| object).collect();
        let is_loose =
            |object: &u32| !in_trees.contains(object) && scene.objects[*object as usize].role == Role::Static;
        for object in (0..extras.own).filter(is_loose) {
            let levels = levels_of(object);
            if !levels.is_empty() {
                let placed = placed(levels, &scene.objects[object as usize].to_world, &triangles);
                extras.loose.insert(object, placed.collect());
            }
        }
        let loose = (0..extras.own).filter(is_loose);
        for object in baked.draws().map(|(_, object)| object).chain(loose) {
            let levels = levels_of(object);
            if levels.is_empty() || extras.levels[object as usize] != NONE {
                continue;
            }
            extras.levels[object as usize] = extras.next_id()?;
            let to_world = scene.objects[object as usize].to_world;
            for (at, level) in levels.iter().enumerate().take(usize::from(u8::MAX)) {
                extras.list.push(Extra::Level { object, level: at as u8 + 1 });
                data.objects.push(Object { mesh: places[&level.mesh], to_world });
            }
        }
        for (tree, tree_data) in baked.trees().iter().enumerate() {
            let mut ids = vec![NONE; tree_data.placement().count()];
            let nodes = tree_data.proxies().map_or(&[][..], |proxies| proxies.nodes());
            for (anchor, to_world) in baked.places(tree).filter(|_| !nodes.is_empty()) {
                ids[anchor] = extras.next_id()?;
                for (node, proxy) in nodes.iter().enumerate() {
                    let to_world = to_world * DAffine3::from_translation(proxy.origin.as_dvec3());
                    let (tree, anchor, node) = (tree as u32, anchor as u32, node as u32);
                    extras.list.push(Extra::Proxy { tree, anchor, node });
                    data.objects.push(Object { mesh: places[&proxy.mesh], to_world });
                }
            }
            extras.proxies.push(ids);
            extras.owners.push(owners(tree_data));
        }
        extras.next_id()?;
        Ok(extras)
    }

    fn next_id(&self) -> Result<u32, ExtraError> {
        let id = u32::try_from(self.own as usize + self.list.len()).ok().filter(|&id| id < NONE);
        id.ok_or(ExtraError::TooMany)
    }

    /// What an id stands for; `None` for the scene's own objects and what does not exist.
    pub(super) fn get(&self, id: u32) -> Option<Extra> {
        self.list.get(id.checked_sub(self.own)? as usize).copied()
    }

    /// The ids of an object's levels.
    pub(super) fn levels_of(&self, object: u32) -> std::ops::Range<u32> {
        let Some(&first) = self.levels.get(object as usize).filter(|&&first| first != NONE) else {
            return 0..0;
        };
        let is_its =
            |id: &u32| matches!(self.get(*id), Some(Extra::Level { object: of, .. }) if of == object);
        first..first + (first..).take_while(is_its).count() as u32
    }

    /// The levels of these objects, which are in no tree, as [`SceneCuller::set_loose_levels`] takes them.
    pub(super) fn loose_levels(&self, objects: &[u32]) -> (Vec<u32>, Vec<Level>) {
        let (mut starts, mut levels) = (vec![0], Vec::new());
        for object in objects {
            levels.extend(self.loose.get(object).into_iter().flatten());
            starts.push(levels.len() as u32);
        }
        (starts, levels)
    }

    /// All ids and what they stand for.
    pub(super) fn all(&self) -> impl Iterator<Item = (u32, Extra)> {
        self.list.iter().enumerate().map(|(at, &extra)| (self.own + at as u32, extra))
    }

    /// The id that draws what the culler has selected; `object` is the scene's object of the draw.
    pub(super) fn id(&self, selected: &Selected, object: impl Fn(Draw) -> Option<u32>) -> Option<u32> {
        let draw = selected.draw;
        match selected.kind {
            SelectedKind::Object => object(draw),
            SelectedKind::Level(level) => {
                let first = *self.levels.get(object(draw)? as usize).filter(|&&first| first != NONE)?;
                Some(first + u32::from(level.checked_sub(1)?))
            }
            SelectedKind::Proxy => self.proxy(draw.tree, draw.anchor, draw.object),
        }
    }

    /// The id of a proxy node at an anchor.
    pub(super) fn proxy(&self, tree: u32, anchor: u32, node: u32) -> Option<u32> {
        let anchors = self.proxies.get(tree as usize)?;
        let first = *anchors.get(anchor as usize).filter(|&&first| first != NONE)?;
        Some(first + node)
    }

    /// The innermost proxy node around a place of a tree.
    pub(super) fn owner(&self, draw: Draw) -> Option<u32> {
        let owners = self.owners.get(draw.tree as usize).filter(|_| draw.tree != LOOSE)?;
        owners.get(draw.object as usize).copied().filter(|&node| node != NONE)
    }

    /// Ids in a good order for drawing: what is drawn together lies together. A cut through the nodes of a tree takes
    /// neighbours of one depth more often than a node and its child, which it never takes both.
    pub(super) fn order(&self, objects: &[u32], depth: impl Fn(u32, u32) -> u32) -> Vec<u32> {
        let mut rank = vec![NONE; self.own as usize];
        objects.iter().enumerate().for_each(|(at, &object)| rank[object as usize] = at as u32);
        let mut keyed: Vec<([u32; 4], u32)> = self
            .all()
            .map(|(id, extra)| match extra {
                Extra::Level { object, level } => ([0, u32::from(level), rank[object as usize], 0], id),
                Extra::Proxy { tree, anchor, node } => ([1 + tree, depth(tree, node), anchor, node], id),
            })
            .collect();
        keyed.sort_unstable();
        keyed.into_iter().map(|(_, id)| id).collect()
    }
}

/// Levels as they are where the object is, which `transform` leads to.
fn placed(
    levels: Levels<'_>,
    transform: &DAffine3,
    triangles: impl Fn(u32) -> u32,
) -> impl Iterator<Item = Level> {
    let stretch = stretch(transform);
    let stretched = move |length: f32| (f64::from(length) * stretch).min(f64::from(f32::MAX)) as f32;
    levels.iter().map(move |level| Level {
        triangles: triangles(level.mesh),
        error: stretched(level.error),
        deviation: level.deviation.stretched(stretch),
    })
}

fn owners(tree: &svs_runtime::Tree) -> Vec<u32> {
    let mut owners = vec![NONE; tree.object_count()];
    if let Some(proxies) = tree.proxies() {
        // Parents come first: what lies deeper overwrites them.
        for (node, proxy) in proxies.nodes().iter().enumerate() {
            for position in proxy.first_object..proxy.first_object + proxy.object_count {
                if let Some(owner) = owners.get_mut(proxies.object(position) as usize) {
                    *owner = node as u32;
                }
            }
        }
    }
    owners
}
