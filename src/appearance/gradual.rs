//! The looks of a scene whose geometry and textures arrive bit by bit.

use super::attributes::Attributes;
use super::geometry::Geometry;
use super::materials::Materials;
use super::{AppearanceError, objects, textures, wanted};
use crate::gltf::Document;
use crate::parallel;
use crate::scene::alpha_mask::bytes_of;
use crate::scene::notes::Notes;
use crate::scene::outline;
use crate::scene::primitives;
use crate::scene::{Scene, SceneError};
use std::collections::BTreeSet;
use svs_render::{Mesh, SceneData};

/// What is to be read yet, and how: made from the JSON, before there is any other byte of the file.
#[derive(Debug)]
pub struct Gradual {
    /// For each mesh of the data its glTF mesh; `None` for the empty one.
    meshes: Vec<Option<usize>>,
    triangles: Vec<u32>,
    materials: Materials,
}

/// What a mesh needs of the file before it can be read.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    /// Accessors.
    pub accessors: BTreeSet<usize>,
    /// Images of the data, see [`Gradual::fill_images`].
    pub images: BTreeSet<u32>,
}

impl Gradual {
    /// The data as [`super::read_with`] orders it, with empty meshes and white images.
    ///
    /// # Errors
    /// [`AppearanceError`], as [`super::read_with`].
    pub fn new(doc: &Document, scene: &Scene, more: &[u32]) -> Result<(Self, SceneData), AppearanceError> {
        let wanted = wanted(doc, scene, more)?;
        let own = wanted.len() - more.len();
        let mut notes = Notes::default();
        let plan = primitives::plan(doc, &wanted, &mut notes)?;
        let primitives = plan.meshes.iter().flat_map(|mesh| &mesh.primitives);
        let materials =
            Materials::read(doc, primitives.map(|primitive| primitive.material), true, &mut notes);
        let counts = plan.meshes.iter().map(|mesh| outline::triangles(doc, mesh));
        let mut triangles = counts.collect::<Result<Vec<u32>, SceneError>>()?;
        let mut meshes: Vec<Option<usize>> = wanted.into_iter().map(Some).collect();
        meshes.insert(own, None);
        triangles.insert(own, 0);
        let data = SceneData {
            meshes: vec![Mesh::default(); meshes.len()],
            materials: materials.materials.clone(),
            images: materials.images.clone(),
            objects: objects(scene, own as u32),
        };
        Ok((Self { meshes, triangles, materials }, data))
    }

    /// Triangles of a mesh of the data, read or not; 0 for one that does not exist.
    pub fn triangles(&self, mesh: u32) -> u32 {
        self.triangles.get(mesh as usize).copied().unwrap_or(0)
    }

    /// The glTF image of each image of the data.
    pub fn image_sources(&self) -> &[usize] {
        &self.materials.image_sources
    }

    /// What each mesh of the data needs; nothing for one of which nothing can be drawn.
    pub fn needs(&self, doc: &Document) -> Vec<Needs> {
        let needs = |mesh: &Option<usize>| {
            let mut needs = Needs::default();
            let Some(mesh) = *mesh else { return needs };
            let Ok(plan) = primitives::plan(doc, &[mesh], &mut Notes::default()) else { return needs };
            let attributes = Attributes::plain();
            for primitive in plan.meshes.iter().flat_map(|mesh| &mesh.primitives) {
                let choice = attributes.choose(doc, primitive, &self.materials, &mut Notes::default());
                needs.accessors.insert(primitive.position);
                needs.accessors.extend(primitive.indices);
                needs.accessors.extend([choice.normal, choice.color, choice.uv].into_iter().flatten());
                let material = &self.materials.materials[self.materials.index(primitive.material) as usize];
                let textures = [
                    material.base_color_texture,
                    material.metallic_roughness_texture,
                    material.emissive_texture,
                ];
                needs.images.extend(textures.into_iter().flatten().map(|texture| texture.image));
            }
            needs
        };
        self.meshes.iter().map(needs).collect()
    }

    /// Reads meshes of the data whose bytes are there; those that cannot be read stay empty.
    ///
    /// # Errors
    /// [`AppearanceError`] if `doc` is not the document this was made from.
    pub fn fill(&self, doc: &Document, meshes: &[u32], data: &mut SceneData) -> Result<(), AppearanceError> {
        let places: Vec<(usize, usize)> = meshes
            .iter()
            .filter_map(|&mesh| Some((mesh as usize, (*self.meshes.get(mesh as usize)?)?)))
            .collect();
        let gltf: Vec<usize> = places.iter().map(|&(_, mesh)| mesh).collect();
        let mut notes = Notes::default();
        let plan = primitives::plan(doc, &gltf, &mut notes)?;
        let attributes = Attributes::read(doc, &plan, &self.materials, &mut notes);
        let geometry = Geometry { doc, materials: &self.materials, attributes: &attributes };
        let read = parallel::map(&plan.meshes, |mesh| geometry.mesh(mesh).0);
        for (&(place, _), mesh) in places.iter().zip(read) {
            if let Some(slot) = data.meshes.get_mut(place) {
                *slot = mesh;
            }
        }
        Ok(())
    }

    /// Decodes images of the data whose bytes are there; those that cannot be read stay white.
    pub fn fill_images(&self, doc: &Document, images: &[u32], data: &mut SceneData) {
        for &place in images {
            let Some(&source) = self.image_sources().get(place as usize) else { continue };
            let (_, read) = textures::images(doc, BTreeSet::from([source]), &mut Notes::default());
            if let (Some(slot), Some(image)) = (data.images.get_mut(place as usize), read.into_iter().next())
            {
                *slot = image;
            }
        }
    }

    /// The encoded bytes of an image of the data, if they are there: for a decoder elsewhere.
    pub fn image_bytes<'a>(&self, doc: &'a Document, place: u32) -> Option<std::borrow::Cow<'a, [u8]>> {
        bytes_of(doc, *self.image_sources().get(place as usize)?).ok()
    }
}
