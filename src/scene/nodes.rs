//! Walks the node graph of one scene: world transforms, objects, subtrees.

use super::animation::Animated;
use super::json::{array, extension, index, malformed, optional_index};
use super::notes::Notes;
use super::transform::{self, OUT_OF_RANGE, Unusable};
use super::{Object, Role, SceneError, SceneNode, instancing};
use crate::gltf::Document;
use glam::DAffine3;
use serde_json::Value;

/// Instances cost at least a byte each in the file, so more objects than this plus the file's size come
/// from many nodes that share one instance buffer.
const FREE_OBJECTS: u64 = 1 << 20;

/// What a walk over the scene found. Roles do not yet know the meshes.
#[derive(Debug, Default)]
pub(super) struct Walk {
    /// glTF index of the scene; `None` for a file without scenes.
    pub(super) scene: Option<usize>,
    pub(super) nodes: Vec<SceneNode>,
    pub(super) objects: Vec<Object>,
    /// glTF mesh index of each mesh in use, by first use; `Object::mesh` indexes this.
    pub(super) meshes: Vec<usize>,
}

/// A scene's root: the node and where it is listed.
#[derive(Debug)]
struct Root {
    node: usize,
    pointer: String,
}

/// Walks the scene asked for: `scene`, else the file's default scene, else its first; a file without scenes
/// is read as one scene of all nodes that are nobody's child.
pub(super) fn walk(
    doc: &Document,
    scene: Option<usize>,
    animated: &Animated,
    notes: &mut Notes,
) -> Result<Walk, SceneError> {
    let nodes = array(&doc.json, "nodes", "")?;
    let (scene, roots) = roots(&doc.json, scene, nodes, notes)?;
    let bytes = doc.described_bytes();
    let mut walker = Walker {
        doc,
        nodes,
        animated,
        notes,
        state: vec![State::New; nodes.len()],
        mesh_of: vec![None; array(&doc.json, "meshes", "")?.len()],
        object_limit: bytes.saturating_add(FREE_OBJECTS + nodes.len() as u64).min(u64::from(u32::MAX)),
        out: Walk { scene, ..Walk::default() },
    };
    for root in roots {
        walker.walk_root(root)?;
    }
    Ok(walker.out)
}

fn roots(
    json: &Value,
    scene: Option<usize>,
    nodes: &[Value],
    notes: &mut Notes,
) -> Result<(Option<usize>, Vec<Root>), SceneError> {
    let scenes = array(json, "scenes", "")?;
    let default = optional_index(json, "scene", "scenes", scenes.len(), "");
    let chosen = match scene {
        Some(index) if index < scenes.len() => index,
        Some(index) => return Err(SceneError::NoSuchScene { index, count: scenes.len() }),
        None if scenes.is_empty() => return Ok((None, parentless(nodes, notes)?)),
        None => default?.unwrap_or(0),
    };
    let pointer = format!("/scenes/{chosen}");
    let listed = array(&scenes[chosen], "nodes", &pointer)?.iter().enumerate();
    let roots: Result<_, SceneError> =
        listed.map(|(i, value)| root(value, nodes.len(), format!("{pointer}/nodes/{i}"))).collect();
    Ok((Some(chosen), roots?))
}

fn root(value: &Value, count: usize, pointer: String) -> Result<Root, SceneError> {
    let node = node_index(value, count, || pointer.clone())?;
    Ok(Root { node, pointer })
}

fn node_index(value: &Value, count: usize, pointer: impl Fn() -> String) -> Result<usize, SceneError> {
    let node = index(value, &pointer)?;
    if node < count {
        Ok(node)
    } else {
        Err(SceneError::IndexOutOfRange { pointer: pointer(), index: node, array: "nodes", count })
    }
}

/// Nodes that are nobody's child, in order.
fn parentless(nodes: &[Value], notes: &mut Notes) -> Result<Vec<Root>, SceneError> {
    notes.add("NO_SCENE", "the file has no scene: all its nodes are read as one", || "/nodes".into());
    let mut has_parent = vec![false; nodes.len()];
    for (n, node) in nodes.iter().enumerate() {
        let pointer = format!("/nodes/{n}");
        for (i, child) in array(node, "children", &pointer)?.iter().enumerate() {
            has_parent[node_index(child, nodes.len(), || format!("{pointer}/children/{i}"))?] = true;
        }
    }
    let roots: Vec<Root> = (0..nodes.len())
        .filter(|&node| !has_parent[node])
        .map(|node| Root { node, pointer: format!("/nodes/{node}") })
        .collect();
    if roots.is_empty() && !nodes.is_empty() {
        return Err(SceneError::Cycle { pointer: "/nodes/0".into(), node: 0 });
    }
    Ok(roots)
}

/// How far the walk is with a node.
#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    New,
    /// An ancestor of the current node, or that node.
    Open,
    Done,
}

/// An ancestor of the current node: the stack is on the heap, so depth is bounded by the file only.
struct Frame<'a> {
    node: usize,
    scene_node: u32,
    children: &'a [Value],
    next_child: usize,
    /// Not replaced by the identity if it is not finite, so that children inherit the fault.
    world: DAffine3,
    hidden: bool,
}

struct Walker<'a> {
    doc: &'a Document,
    nodes: &'a [Value],
    animated: &'a Animated,
    notes: &'a mut Notes,
    state: Vec<State>,
    mesh_of: Vec<Option<u32>>,
    object_limit: u64,
    out: Walk,
}

impl<'a> Walker<'a> {
    fn walk_root(&mut self, root: Root) -> Result<(), SceneError> {
        let mut stack = vec![self.enter(root.node, None, || root.pointer)?];
        while let Some(frame) = stack.last_mut() {
            let Some(child) = frame.children.get(frame.next_child) else {
                let node = &mut self.out.nodes[frame.scene_node as usize];
                node.objects.end = self.out.objects.len() as u32;
                self.state[frame.node] = State::Done;
                let scene_node = frame.scene_node as usize;
                stack.pop();
                self.out.nodes[scene_node].subtree_end = self.out.nodes.len() as u32;
                continue;
            };
            let (parent, place) = (frame.node, frame.next_child);
            frame.next_child += 1;
            let pointer = || format!("/nodes/{parent}/children/{place}");
            let node = node_index(child, self.nodes.len(), pointer)?;
            let frame = self.enter(node, stack.last(), pointer)?;
            stack.push(frame);
        }
        Ok(())
    }

    /// Adds a node and its objects; `listed` is where the node is listed.
    fn enter(
        &mut self,
        node: usize,
        parent: Option<&Frame<'a>>,
        listed: impl FnOnce() -> String,
    ) -> Result<Frame<'a>, SceneError> {
        match self.state[node] {
            State::New => self.state[node] = State::Open,
            State::Open => return Err(SceneError::Cycle { pointer: listed(), node }),
            State::Done => return Err(SceneError::TwoParents { pointer: listed(), node }),
        }
        let value = &self.nodes[node];
        let pointer = format!("/nodes/{node}");
        if !value.is_object() {
            return Err(malformed(pointer, "an object"));
        }
        let local = transform::of_node(value, &pointer)?;
        let world = parent.map_or(local, |parent| parent.world * local);
        let visible = extension(value, "KHR_node_visibility").and_then(|e| e.get("visible"));
        let hidden = parent.is_some_and(|parent| parent.hidden) || visible == Some(&Value::Bool(false));
        // Nodes are at most one per JSON value of a file in memory: far below u32::MAX entries of 160 bytes.
        let scene_node = u32::try_from(self.out.nodes.len()).map_err(|_| SceneError::TooLarge {
            pointer: pointer.clone(),
            what: "nodes",
            limit: u64::from(u32::MAX),
        })?;
        let first_object = self.out.objects.len() as u32;
        self.out.nodes.push(SceneNode {
            node,
            parent: parent.map(|parent| parent.scene_node),
            to_world: finite_or_identity(world),
            moving: self.animated.nodes[node],
            subtree_end: scene_node + 1,
            objects: first_object..first_object,
        });
        let children = array(value, "children", &pointer)?;
        let frame = Frame { node, scene_node, children, next_child: 0, world, hidden };
        self.add_objects(value, &frame, &pointer)?;
        Ok(frame)
    }

    fn add_objects(&mut self, value: &Value, frame: &Frame<'_>, pointer: &str) -> Result<(), SceneError> {
        let meshes = self.mesh_of.len();
        let Some(mesh) = optional_index(value, "mesh", "meshes", meshes, pointer)? else { return Ok(()) };
        let used = &mut self.out.meshes;
        let mesh = *self.mesh_of[mesh].get_or_insert_with(|| {
            used.push(mesh);
            // Fewer meshes than nodes.
            (used.len() - 1) as u32
        });
        let skinned = value.get("skin").is_some();
        let room = self.object_limit - self.out.objects.len() as u64;
        let too_many = || SceneError::TooLarge {
            pointer: pointer.to_owned(),
            what: "objects",
            limit: self.object_limit,
        };
        match instancing::read(self.doc, value, pointer, room, too_many)? {
            None if room == 0 => Err(too_many()),
            None => {
                self.add_object(frame, mesh, None, frame.world, skinned);
                Ok(())
            }
            Some(instances) => {
                for (i, local) in instances.into_iter().enumerate() {
                    // At most u32::MAX objects, hence instances.
                    self.add_object(frame, mesh, Some(i as u32), frame.world * local, skinned);
                }
                Ok(())
            }
        }
    }

    fn add_object(
        &mut self,
        frame: &Frame<'_>,
        mesh: u32,
        instance: Option<u32>,
        world: DAffine3,
        skinned: bool,
    ) {
        let fault = if frame.hidden {
            Some(("NODE_HIDDEN", "hidden objects (KHR_node_visibility) are left out of the bake"))
        } else if skinned {
            Some(("SKINNED", "skinned objects deform and are left out of the bake"))
        } else {
            match transform::check(&world) {
                Ok(()) => None,
                Err(Unusable::NotFinite) => Some((
                    "TRANSFORM_NOT_FINITE",
                    "objects without a finite transform are left out of the bake",
                )),
                Err(Unusable::OutOfRange) => Some(OUT_OF_RANGE),
                Err(Unusable::Degenerate) => Some((
                    "TRANSFORM_DEGENERATE",
                    "objects flattened by their transform are left out of the bake",
                )),
            }
        };
        if let Some((code, message)) = fault {
            self.notes.add(code, message, || format!("/nodes/{}", frame.node));
        }
        self.out.objects.push(Object {
            node: frame.node,
            instance,
            mesh,
            scene_node: frame.scene_node,
            to_world: finite_or_identity(world),
            role: if fault.is_some() { Role::Excluded } else { Role::Static },
            hidden: frame.hidden || !world.is_finite(),
        });
    }
}

/// No NaN leaves this module; what had one is excluded or has excluded objects only.
fn finite_or_identity(transform: DAffine3) -> DAffine3 {
    if transform.is_finite() { transform } else { DAffine3::IDENTITY }
}
