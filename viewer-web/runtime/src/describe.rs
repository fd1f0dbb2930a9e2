//! A glTF scene in numbers.

use crate::SceneError;
use glam::{DAffine3, DMat4, DVec3};

/// One scene of a glTF document. Nodes and objects are in document order (depth-first, each node before its children); an
/// object is a node with a mesh, or one instance of it.
#[derive(Clone, Debug, Default)]
pub struct Description {
    /// glTF index of the scene.
    pub scene: u32,
    /// glTF index of each node that the scene reaches.
    pub nodes: Vec<u32>,
    /// For each node the place of its parent in [`Self::nodes`], or -1.
    pub parents: Vec<i32>,
    /// For each node its own matrix, sixteen numbers by columns.
    pub matrices: Vec<f64>,
    /// For each object the place of its node.
    pub object_nodes: Vec<u32>,
    /// For each object its glTF mesh.
    pub object_meshes: Vec<u32>,
    /// For each object the place of its matrix in [`Self::instances`], or -1 where it is its node's alone.
    pub object_instances: Vec<i32>,
    /// Matrices of instances, relative to their nodes.
    pub instances: Vec<f64>,
    /// For each glTF mesh its triangles, as the specification counts them.
    pub mesh_triangles: Vec<u32>,
    /// For each glTF mesh the six numbers of its box, minimum before maximum, as its accessors state them; NaN without one.
    pub mesh_boxes: Vec<f64>,
}

/// The nodes of a scene, checked.
#[derive(Clone, Debug)]
pub(crate) struct Graph {
    pub(crate) nodes: Vec<GraphNode>,
    pub(crate) objects: Vec<Object>,
}

#[derive(Clone, Debug)]
pub(crate) struct GraphNode {
    pub(crate) gltf: u32,
    pub(crate) parent: Option<u32>,
    /// The first node after its subtree.
    pub(crate) end: u32,
    /// Objects at and below the node.
    pub(crate) first_object: u32,
    pub(crate) end_object: u32,
    pub(crate) local: DAffine3,
    /// From the node's space to the scene's.
    pub(crate) world: DAffine3,
}

#[derive(Clone, Debug)]
pub(crate) struct Object {
    pub(crate) node: u32,
    pub(crate) mesh: u32,
    pub(crate) instance: Option<DAffine3>,
}

/// The transform of sixteen numbers by columns.
pub(crate) fn affine(matrix: &[f64]) -> Option<DAffine3> {
    (matrix.len() == 16).then(|| DAffine3::from_mat4(DMat4::from_cols_slice(matrix)))
}

fn matrix(matrices: &[f64], place: usize) -> Option<DAffine3> {
    affine(matrices.chunks_exact(16).nth(place)?)
}

impl Graph {
    pub(crate) fn new(description: &Description) -> Result<Self, SceneError> {
        let count = description.nodes.len();
        let mut nodes: Vec<GraphNode> = Vec::with_capacity(count);
        if description.parents.len() != count {
            return Err(SceneError::Description("not one parent per node"));
        }
        for (place, (&gltf, &parent)) in description.nodes.iter().zip(&description.parents).enumerate() {
            let parent = u32::try_from(parent).ok();
            if parent.is_some_and(|parent| parent as usize >= place) {
                return Err(SceneError::Description("a parent does not come before its child"));
            }
            let local = matrix(&description.matrices, place)
                .ok_or(SceneError::Description("not one matrix per node"))?;
            let world = parent.map_or(local, |parent| nodes[parent as usize].world * local);
            let end = place as u32 + 1;
            nodes.push(GraphNode { gltf, parent, end, first_object: u32::MAX, end_object: 0, local, world });
        }
        let (meshes, instances) = (&description.object_meshes, &description.object_instances);
        if meshes.len() != description.object_nodes.len() || instances.len() != meshes.len() {
            return Err(SceneError::Description("not one node, mesh and instance per object"));
        }
        let mut objects = Vec::with_capacity(meshes.len());
        for (index, &node) in description.object_nodes.iter().enumerate() {
            let Some(own) = nodes.get_mut(node as usize) else {
                return Err(SceneError::Description("an object's node does not exist"));
            };
            own.first_object = own.first_object.min(index as u32);
            own.end_object = index as u32 + 1;
            let instance = match usize::try_from(instances[index]) {
                Ok(place) => Some(
                    matrix(&description.instances, place)
                        .ok_or(SceneError::Description("an instance has no matrix"))?,
                ),
                Err(_) => None,
            };
            objects.push(Object { node, mesh: meshes[index], instance });
        }
        // Children come after their parents: from the last on, each tells its parent what is below it.
        for place in (0..count).rev() {
            let GraphNode { parent, end, first_object, end_object, .. } = nodes[place];
            if let Some(parent) = parent {
                let parent = &mut nodes[parent as usize];
                parent.end = parent.end.max(end);
                parent.first_object = parent.first_object.min(first_object);
                parent.end_object = parent.end_object.max(end_object);
            }
        }
        for node in &mut nodes {
            // Without objects: an empty range that is easy to compare with.
            node.first_object = node.first_object.min(node.end_object);
        }
        Ok(Self { nodes, objects })
    }

    /// From an object's mesh to the scene's space.
    pub(crate) fn object_world(&self, object: &Object) -> DAffine3 {
        let world = self.nodes[object.node as usize].world;
        object.instance.map_or(world, |instance| world * instance)
    }
}

/// Box of a mesh; `None` if it has none that is finite.
pub(crate) fn mesh_box(description: &Description, mesh: u32) -> Option<(DVec3, DVec3)> {
    let numbers = description.mesh_boxes.chunks_exact(6).nth(mesh as usize)?;
    let (min, max) = (DVec3::from_slice(&numbers[..3]), DVec3::from_slice(&numbers[3..]));
    (min.is_finite() && max.is_finite() && min.cmple(max).all()).then_some((min, max))
}
