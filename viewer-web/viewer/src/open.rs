//! The open file.

use svs::appearance::Gradual;
use svs::gltf::Document;
use svs::stage::{Extra, Stage};
use svs_render::{Gpu, GpuScene, RenderError};
use std::collections::BTreeSet;

/// A file, as far as it has arrived.
#[derive(Debug)]
pub(crate) struct Open {
    pub(crate) stage: Stage,
    pub(crate) gpu_scene: Option<GpuScene>,
    pub(crate) hidden: BTreeSet<u32>,
}

impl Open {
    /// A whole file.
    pub(crate) fn whole(gpu: &Gpu, bytes: &[u8]) -> Result<Self, String> {
        let text = |error: &dyn std::error::Error| error.to_string();
        let doc = Document::from_slice(bytes, None).map_err(|error| text(&error))?;
        let (mut stage, gradual): (Stage, Gradual) = Stage::outline(&doc).map_err(|error| text(&error))?;
        let meshes: Vec<u32> = (0..stage.data.meshes.len() as u32).collect();
        gradual.fill(&doc, &meshes, &mut stage.data).map_err(|error| text(&error))?;
        let images: Vec<u32> = (0..stage.data.images.len() as u32).collect();
        gradual.fill_images(&doc, &images, &mut stage.data);
        let mut open = Self { stage, gpu_scene: None, hidden: BTreeSet::new() };
        open.upload(gpu).map_err(|error| text(&error))?;
        Ok(open)
    }

    /// Puts what has arrived on the GPU.
    pub(crate) fn upload(&mut self, gpu: &Gpu) -> Result<(), RenderError> {
        // The old one first: there may be no room for both.
        self.gpu_scene = None;
        self.gpu_scene = Some(GpuScene::upload(gpu, &self.stage.data, self.stage.upload_order())?);
        Ok(())
    }

    /// The object of the scene that an id stands for; of a proxy none.
    pub(crate) fn object_of(&self, id: u32) -> Option<u32> {
        match self.stage.extra(id) {
            None => Some(id).filter(|&id| (id as usize) < self.stage.scene.objects.len()),
            Some(Extra::Level { object, .. }) => Some(object),
            Some(Extra::Proxy { .. }) => None,
        }
    }

    pub(crate) fn set_hidden(&mut self, object: u32, hidden: bool) {
        if (object as usize) < self.stage.scene.objects.len() {
            self.stage.set_hidden(object, hidden);
            if hidden { self.hidden.insert(object) } else { self.hidden.remove(&object) };
        }
    }
}
