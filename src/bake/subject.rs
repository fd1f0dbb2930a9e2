//! Splits a scene into the trees to bake: what stands still, and each subtree that moves on its own.

use super::tree::{Group, Member, Part};
use crate::scene::{Role, Scene};
pub use crate::volume::box_in_tree;
use glam::DAffine3;

/// What a tree hangs on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// The scene itself: tree space is world space.
    Scene,
    /// A glTF node (index in [`Scene::nodes`]): the tree moves with it.
    Node(u32),
}

/// One tree to be baked, before it has a hierarchy.
#[derive(Clone, Debug)]
pub struct Subject {
    /// What the tree hangs on.
    pub anchor: Anchor,
    /// Its objects, in document order.
    pub members: Vec<Member>,
    /// Their geometry in tree space.
    pub parts: Vec<Part>,
    /// The scene's own grouping of the members.
    pub groups: Vec<Group>,
    /// For each member its index in [`Scene::objects`].
    pub objects: Vec<u32>,
    /// For each member its index among all objects below the anchor, in depth-first document order.
    pub order_values: Vec<u32>,
    /// Objects below the anchor, baked or not.
    pub objects_below: u32,
}

/// The trees of a scene: everything that stands still first, then each moving subtree in document order.
///
/// A tree of one object has nothing to hide and is left out.
pub fn subjects(scene: &Scene) -> Vec<Subject> {
    // The innermost moving node above each object, if any.
    let mut mover = vec![None; scene.objects.len()];
    let moving: Vec<u32> =
        (0..scene.nodes.len() as u32).filter(|&n| scene.nodes[n as usize].moving).collect();
    for &node in &moving {
        for object in scene.nodes[node as usize].objects.clone() {
            mover[object as usize] = Some(node);
        }
    }
    std::iter::once(None)
        .chain(moving.into_iter().map(Some))
        .map(|anchor| subject(scene, anchor, &mover))
        .filter(|s| s.members.len() > 1)
        .collect()
}

fn subject(scene: &Scene, anchor: Option<u32>, mover: &[Option<u32>]) -> Subject {
    let (below, from_world) = match anchor {
        None => (0..scene.objects.len() as u32, DAffine3::IDENTITY),
        Some(node) => {
            let node = &scene.nodes[node as usize];
            (node.objects.clone(), node.to_world.inverse())
        }
    };
    let mut subject = Subject {
        anchor: anchor.map_or(Anchor::Scene, Anchor::Node),
        members: Vec::new(),
        parts: Vec::new(),
        groups: Vec::new(),
        objects: Vec::new(),
        order_values: Vec::new(),
        objects_below: below.len() as u32,
    };
    if !from_world.is_finite() {
        return subject;
    }
    for (order_value, index) in below.clone().enumerate() {
        let object = &scene.objects[index as usize];
        if object.role != Role::Static || mover[index as usize] != anchor {
            continue;
        }
        let mesh = &scene.meshes[object.mesh as usize];
        let to_tree = from_world * object.to_world;
        let member = subject.members.len() as u32;
        subject.members.push(Member {
            bounds: box_in_tree(mesh, &to_tree),
            triangles: mesh.drawn_triangles,
            parts: member..member + 1,
        });
        subject.parts.push(Part { mesh: object.mesh, member, to_tree });
        subject.objects.push(index);
        subject.order_values.push(order_value as u32);
    }
    subject.groups = groups(scene, anchor, &subject.objects);
    subject
}

/// The scene's nodes as groups of members; nodes without members below them are left out.
fn groups(scene: &Scene, anchor: Option<u32>, objects: &[u32]) -> Vec<Group> {
    let first_member_from = |object: u32| objects.partition_point(|&o| o < object) as u32;
    let nodes = match anchor {
        None => 0..scene.nodes.len() as u32,
        Some(node) => node..scene.nodes[node as usize].subtree_end,
    };
    let mut groups = vec![Group { parent: None, members: 0..objects.len() as u32 }];
    // Group of each node; nodes left out pass on their parent's.
    let mut group_of_node = vec![0u32; nodes.len()];
    for (offset, node) in nodes.clone().enumerate() {
        let node = &scene.nodes[node as usize];
        let parent = match node.parent {
            Some(parent) if parent >= nodes.start => group_of_node[(parent - nodes.start) as usize],
            _ => 0,
        };
        let members = first_member_from(node.objects.start)..first_member_from(node.objects.end);
        group_of_node[offset] = if members.len() > 1 && groups[parent as usize].members != members {
            groups.push(Group { parent: Some(parent), members });
            groups.len() as u32 - 1
        } else {
            parent
        };
    }
    groups
}
