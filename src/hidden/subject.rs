//! What takes part: which objects hide others, and which may be dropped.

use crate::bake::tree::Part;
use crate::gltf::Document;
use crate::scene::json::{array, extension};
use crate::scene::{Role, Scene};
use serde_json::Value;

/// Extensions by which a run time shows, hides or exchanges a node.
const SWITCHES: [&str; 2] = ["KHR_node_visibility", "MSFT_lod"];

/// The objects of a scene by their part in it.
#[derive(Debug)]
pub(super) struct Subject {
    /// What hides and can be seen; `member` is the index in [`Scene::objects`].
    pub(super) parts: Vec<Part>,
    /// By object: it goes if it is hidden.
    pub(super) judged: Vec<bool>,
    /// By mesh of the scene: all that draws it is judged, so its triangles may be.
    pub(super) judged_meshes: Vec<bool>,
    /// Primitives of a mesh, as indices into `meshes` of the document.
    pub(super) mesh_indices: Vec<usize>,
}

impl Subject {
    pub(super) fn new(doc: &Document, scene: &Scene) -> Self {
        let nodes = items(&doc.json, "nodes");
        let meshes = items(&doc.json, "meshes");
        let loose = loose_nodes(scene, nodes);
        let elsewhere = nodes_of_other_scenes(&doc.json, scene, nodes);
        let mesh_of = |node: usize| nodes.get(node).and_then(|node| index(node, "mesh"));
        let mut mesh_indices = vec![usize::MAX; scene.meshes.len()];
        for object in &scene.objects {
            if let Some(mesh) = mesh_of(object.node) {
                mesh_indices[object.mesh as usize] = mesh;
            }
        }
        let plain: Vec<bool> = mesh_indices
            .iter()
            .map(|&mesh| meshes.get(mesh).is_some_and(|mesh| is_plain(&doc.json, mesh)))
            .collect();

        let mut parts = Vec::new();
        let mut judged = vec![false; scene.objects.len()];
        for (member, object) in scene.objects.iter().enumerate() {
            if object.role != Role::Static || object.hidden || loose[object.scene_node as usize] {
                continue;
            }
            // At most u32::MAX objects.
            parts.push(Part { mesh: object.mesh, member: member as u32, to_tree: object.to_world });
            judged[member] = plain[object.mesh as usize] && !elsewhere[object.node];
        }

        let mut judged_meshes = plain;
        let mut reached = vec![false; nodes.len()];
        for (object, &judged) in scene.objects.iter().zip(&judged) {
            reached[object.node] = true;
            judged_meshes[object.mesh as usize] &= judged;
        }
        // Nodes that no scene reaches may be shown by other means.
        let mut used_elsewhere = vec![false; meshes.len()];
        for (node, _) in nodes.iter().enumerate().filter(|(node, _)| !reached[*node]) {
            if let Some(used) = mesh_of(node).and_then(|mesh| used_elsewhere.get_mut(mesh)) {
                *used = true;
            }
        }
        for (judged, &mesh) in judged_meshes.iter_mut().zip(&mesh_indices) {
            *judged &= used_elsewhere.get(mesh) == Some(&false);
        }
        Self { parts, judged, judged_meshes, mesh_indices }
    }
}

/// By scene node: it or an ancestor moves, or may be hidden or exchanged.
fn loose_nodes(scene: &Scene, nodes: &[Value]) -> Vec<bool> {
    let mut loose = Vec::with_capacity(scene.nodes.len());
    for node in &scene.nodes {
        let switched = SWITCHES.iter().any(|name| extension(&nodes[node.node], name).is_some());
        let above = node.parent.is_some_and(|parent| loose[parent as usize]);
        loose.push(node.moving || switched || above);
    }
    loose
}

/// By node: a scene other than the one read reaches it.
fn nodes_of_other_scenes(json: &Value, scene: &Scene, nodes: &[Value]) -> Vec<bool> {
    let mut reached = vec![false; nodes.len()];
    for (_, other) in
        items(json, "scenes").iter().enumerate().filter(|(index, _)| Some(*index) != scene.index)
    {
        let mut stack: Vec<usize> = indices(other, "nodes").collect();
        while let Some(node) = stack.pop() {
            // Each node once, so that a broken graph of another scene ends too.
            if reached.get(node) == Some(&false) {
                reached[node] = true;
                stack.extend(indices(&nodes[node], "children"));
            }
        }
    }
    reached
}

/// Triangles only, and none of them alpha-tested: rays can tell whether it is seen.
fn is_plain(json: &Value, mesh: &Value) -> bool {
    let materials = items(json, "materials");
    let masked = |material: usize| {
        materials.get(material).and_then(|material| material.get("alphaMode")) == Some(&Value::from("MASK"))
    };
    items(mesh, "primitives").iter().all(|primitive| {
        let triangles =
            primitive.get("mode").is_none_or(|mode| mode.as_f64().is_some_and(|mode| mode >= 4.0));
        let variants = extension(primitive, "KHR_materials_variants");
        let variants = variants.map_or(&[][..], |variants| items(variants, "mappings"));
        let mut choices = variants.iter().chain([primitive]).filter_map(|choice| index(choice, "material"));
        triangles && !choices.any(masked)
    })
}

/// A property that is an array; empty if it is anything else: the scene has been read, what matters is in order.
pub(super) fn items<'a>(object: &'a Value, key: &str) -> &'a [Value] {
    array(object, key, "").unwrap_or_default()
}

/// A property that is an index.
pub(super) fn index(object: &Value, key: &str) -> Option<usize> {
    crate::scene::json::index(object.get(key)?, String::new).ok()
}

fn indices<'a>(object: &'a Value, key: &str) -> impl Iterator<Item = usize> + 'a {
    items(object, key).iter().filter_map(|value| crate::scene::json::index(value, String::new).ok())
}
