//! What is verified: every object that a visibility tree of the file holds, as it stands in the scene at rest.

use super::cameras::Surroundings;
use crate::bake::hierarchy::is_usable;
use crate::bake::spheres::{SphereKind, spheres};
use crate::bake::subject::box_in_tree;
use crate::bake::tree::{Aabb, Hierarchy, HierarchyNode, Member, Part, Sphere};
use crate::scene::Scene;
use glam::DVec3;

/// The objects under test, in document order, in world space.
///
/// Objects in no tree (skinned, morphed, without geometry, …) are drawn by every method alike: they are left out,
/// as occluders too, just as the bake leaves them out.
#[derive(Debug)]
pub struct Target {
    /// The objects.
    pub members: Vec<Member>,
    /// Their geometry.
    pub parts: Vec<Part>,
    /// For every object of the scene its member, if it is one.
    pub member_of_object: Vec<Option<u32>>,
    /// World-space box of each member.
    pub boxes: Vec<Aabb>,
    /// Box around all of them.
    pub bounds: Aabb,
    /// Tight sphere around all of them.
    pub sphere: Sphere,
}

impl Target {
    /// Those objects of `scene` whose entry in `covered` is set.
    pub fn new(scene: &Scene, covered: &[bool]) -> Self {
        let mut members = Vec::new();
        let mut parts = Vec::new();
        let mut member_of_object = vec![None; scene.objects.len()];
        for (index, object) in scene.objects.iter().enumerate() {
            if !covered.get(index).copied().unwrap_or(false) {
                continue;
            }
            let mesh = &scene.meshes[object.mesh as usize];
            let member = members.len() as u32;
            member_of_object[index] = Some(member);
            parts.push(Part { mesh: object.mesh, member, to_tree: object.to_world });
            members.push(Member {
                bounds: box_in_tree(mesh, &object.to_world),
                triangles: mesh.drawn_triangles,
                parts: member..member + 1,
            });
        }
        let boxes: Vec<Aabb> = members.iter().map(|m| m.bounds).collect();
        let bounds = boxes.iter().filter(|b| is_usable(b)).fold(Aabb::EMPTY, |all, b| all.union(b));
        let sphere = if members.is_empty() {
            Sphere { center: DVec3::ZERO, radius: 0.0 }
        } else {
            let count = members.len() as u32;
            let root = Hierarchy {
                nodes: vec![HierarchyNode { parent: None, subtree: 1, members: 0..count }],
                order: (0..count).collect(),
            };
            spheres(SphereKind::Tight, &root, &members, &parts, &scene.meshes)[0]
        };
        Self { members, parts, member_of_object, boxes, bounds, sphere }
    }

    /// There is nothing that a camera could look at.
    pub fn is_empty(&self) -> bool {
        self.bounds.is_empty() || self.sphere.radius <= 0.0
    }

    /// What cameras are placed around.
    pub fn surroundings(&self) -> Surroundings<'_> {
        Surroundings { sphere: self.sphere, bounds: self.bounds, objects: &self.boxes }
    }

    /// Triangles drawn for a member.
    pub fn triangles(&self, member: u32) -> u64 {
        u64::from(self.members[member as usize].triangles)
    }
}
