//! How a scene looks: geometry with normals, colours and texture coordinates, materials and textures, as plain data for
//! the renderer.
//!
//! What a look needs beyond positions is optional: attributes, materials and textures that cannot be used are left out and
//! counted in [`Appearance::notes`], never an error. Skinned and morphed meshes are taken in their rest pose.

mod attributes;
mod geometry;
mod gradual;
mod materials;
#[cfg(test)]
mod tests;
mod textures;

use crate::gltf::Document;
use crate::parallel;
use crate::scene::notes::Notes;
use crate::scene::{Note, Scene, SceneError, json, primitives};
pub use gradual::Gradual;

use attributes::Attributes;
use geometry::Geometry;
use materials::Materials;
use svs_render::{Mesh, Object, SceneData};

/// A scene as the renderer takes it.
#[derive(Debug, Default)]
pub struct Appearance {
    /// Objects are those of [`Scene::objects`], in their order; meshes those of [`Scene::meshes`], then an empty one for
    /// objects that are not to be drawn, then those that were asked for with [`read_with`].
    pub data: SceneData,
    /// For each material of the data its index in the file; `None` for glTF's default material.
    pub gltf_materials: Vec<Option<usize>>,
    /// Counted notes on what was left out.
    pub notes: Vec<Note>,
}

/// Why the looks of a scene cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AppearanceError {
    /// The document is broken, or asks for too much.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A mesh that is asked for by its number is not there.
    #[error("there is no mesh {mesh}")]
    NoMesh {
        /// Index of the glTF mesh.
        mesh: usize,
    },
    /// The scene was read from another document.
    #[error("the scene does not belong to this document: its node {node} has no such mesh")]
    OtherDocument {
        /// Index of the glTF node.
        node: usize,
    },
}

/// Reads the looks of `scene`, which was read from `doc`. The result does not depend on the number of threads.
///
/// # Errors
/// [`AppearanceError`]; a document that [`crate::scene::read_scene`] could read gives none.
pub fn read(doc: &Document, scene: &Scene) -> Result<Appearance, AppearanceError> {
    read_with(doc, scene, &[])
}

/// As [`read`], and glTF meshes that no node names: they follow after the empty mesh, in the order of `more`.
///
/// # Errors
/// [`AppearanceError`], also if one of `more` is not there or is broken.
pub fn read_with(doc: &Document, scene: &Scene, more: &[u32]) -> Result<Appearance, AppearanceError> {
    let mut notes = Notes::default();
    let wanted = wanted(doc, scene, more)?;
    let own = wanted.len() - more.len();
    let plan = primitives::plan(doc, &wanted, &mut Notes::default())?;
    let primitives = || plan.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let materials = Materials::read(doc, primitives().map(|primitive| primitive.material), false, &mut notes);
    let attributes = Attributes::read(doc, &plan, &materials, &mut notes);
    let geometry = Geometry { doc, materials: &materials, attributes: &attributes };
    let read = parallel::map(&plan.meshes, |mesh| geometry.mesh(mesh));
    let mut meshes = Vec::with_capacity(read.len() + 1);
    for (mesh, mesh_notes) in read {
        meshes.push(mesh);
        notes.append(mesh_notes);
    }
    meshes.insert(own, Mesh::default());
    let objects = objects(scene, own as u32);
    let gltf_materials = materials.sources();
    let Materials { materials, images, .. } = materials;
    let data = SceneData { meshes, materials, images, objects };
    Ok(Appearance { data, gltf_materials, notes: notes.into_vec() })
}

/// The objects of a scene, those that are not to be drawn with the mesh `nothing`.
fn objects(scene: &Scene, nothing: u32) -> Vec<Object> {
    let object = |object: &crate::scene::Object| Object {
        mesh: if object.hidden { nothing } else { object.mesh },
        to_world: object.to_world,
    };
    scene.objects.iter().map(object).collect()
}

/// The glTF mesh of each mesh of the scene, then `more`.
fn wanted(doc: &Document, scene: &Scene, more: &[u32]) -> Result<Vec<usize>, AppearanceError> {
    let mut wanted = gltf_meshes(doc, scene)?;
    let count = json::array(&doc.json, "meshes", "")?.len();
    for &mesh in more {
        let mesh = mesh as usize;
        wanted.push(Some(mesh).filter(|&mesh| mesh < count).ok_or(AppearanceError::NoMesh { mesh })?);
    }
    Ok(wanted)
}

/// The glTF mesh of each mesh of the scene.
fn gltf_meshes(doc: &Document, scene: &Scene) -> Result<Vec<usize>, AppearanceError> {
    let count = json::array(&doc.json, "meshes", "")?.len();
    let mut meshes = vec![usize::MAX; scene.meshes.len()];
    for object in &scene.objects {
        let mesh = doc.json.get("nodes").and_then(|nodes| nodes.get(object.node)?.get("mesh"));
        let mesh = mesh.and_then(|mesh| json::index(mesh, String::new).ok()).filter(|&mesh| mesh < count);
        let place = meshes.get_mut(object.mesh as usize);
        let (Some(mesh), Some(place)) = (mesh, place) else {
            return Err(AppearanceError::OtherDocument { node: object.node });
        };
        *place = mesh;
    }
    // Meshes in use have an object each.
    if meshes.contains(&usize::MAX) { Err(AppearanceError::OtherDocument { node: 0 }) } else { Ok(meshes) }
}
