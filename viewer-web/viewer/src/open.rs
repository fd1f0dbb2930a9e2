//! The open file.

use std::collections::BTreeSet;
use std::ops::Range;
use svs::appearance::Gradual;
use svs::gltf::Document;
use svs::stage::{Extra, Stage};
use svs::stream::{Loader, StreamError, priorities};
use svs_render::{Gpu, GpuScene, Image, RenderError, View};

/// Bytes that must have come since the last upload before the next one: it costs about as much as drawing some frames.
const STEP: u64 = 384 << 10;
/// Share of what is uploaded already that must be new.
const GROWTH: f64 = 0.5;

/// A file, as far as it has arrived.
#[derive(Debug)]
pub(crate) struct Open {
    pub(crate) stage: Stage,
    /// Brings more, until all is there.
    loader: Option<Loader>,
    mesh_bytes: Vec<u64>,
    /// Which meshes of the data have been read.
    read: Vec<bool>,
    uploaded: u64,
    fresh: u64,
    /// Encoded images that the page has yet to decode.
    undecoded: Vec<(u32, Vec<u8>)>,
    /// Images of which the page has not said yet what is in them.
    pub(crate) awaited: usize,
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
        let images = 0..stage.data.images.len() as u32;
        let images: Vec<(u32, Vec<u8>)> = images
            .filter_map(|place| Some((place, gradual.image_bytes(&doc, place)?.into_owned())))
            .collect();
        let read = vec![true; stage.data.meshes.len()];
        let mut open = Self::new(stage, None, Vec::new(), read);
        (open.awaited, open.undecoded) = (images.len(), images);
        open.upload(gpu).map_err(|error| text(&error))?;
        Ok(open)
    }

    /// A file of which only what is needed first has come.
    pub(crate) fn streamed(mut loader: Loader) -> Result<Self, StreamError> {
        let stage = loader.open()?;
        let mesh_bytes = loader.mesh_bytes();
        let read = vec![false; stage.data.meshes.len()];
        Ok(Self::new(stage, Some(loader), mesh_bytes, read))
    }

    fn new(stage: Stage, loader: Option<Loader>, mesh_bytes: Vec<u64>, read: Vec<bool>) -> Self {
        let (gpu_scene, hidden) = (None, BTreeSet::new());
        Self {
            stage,
            loader,
            mesh_bytes,
            read,
            uploaded: 0,
            fresh: 0,
            undecoded: Vec::new(),
            awaited: 0,
            gpu_scene,
            hidden,
        }
    }

    /// Bytes are still to come.
    pub(crate) fn is_loading(&self) -> bool {
        self.loader.is_some()
    }

    /// The object, level or proxy can be drawn already.
    pub(crate) fn has(&self, id: u32) -> bool {
        let object = self.stage.data.objects.get(id as usize);
        object.is_some_and(|object| self.read.get(object.mesh as usize) == Some(&true))
    }

    /// Takes bytes of the file.
    pub(crate) fn receive(&mut self, at: u64, bytes: &[u8]) -> Result<(), StreamError> {
        self.loader.as_mut().map_or(Ok(()), |loader| loader.receive(at, bytes))
    }

    /// What to fetch next for a view.
    pub(crate) fn wanted(&mut self, view: &View, [width, height]: [u32; 2]) -> Vec<Range<u64>> {
        let Some(loader) = &mut self.loader else { return Vec::new() };
        let order = priorities(&mut self.stage, view, width, height, &self.mesh_bytes);
        loader.wanted(&order)
    }

    /// Reads what has come, and puts it on the GPU when it is worth it; says whether it did.
    pub(crate) fn advance(&mut self, gpu: &Gpu) -> Result<bool, String> {
        let Some(loader) = &mut self.loader else { return Ok(false) };
        let ready = loader.ready();
        loader.fill(&ready, &mut self.stage).map_err(|error| error.to_string())?;
        for &place in &ready.images {
            if let Some(bytes) = loader.image_bytes(place) {
                self.undecoded.push((place, bytes.into_owned()));
                self.awaited += 1;
            }
        }
        for &mesh in &ready.meshes {
            self.read[mesh as usize] = true;
            self.fresh += self.mesh_bytes.get(mesh as usize).copied().unwrap_or(0);
        }
        let done = loader.is_done();
        let due = self.fresh >= STEP && self.fresh as f64 >= self.uploaded as f64 * GROWTH;
        if !(done || due) {
            return Ok(false);
        }
        self.uploaded += std::mem::take(&mut self.fresh);
        if done {
            self.loader = None;
        }
        self.upload(gpu).map_err(|error| error.to_string())?;
        Ok(true)
    }

    /// The next image to be decoded: its place and its bytes.
    pub(crate) fn next_image(&mut self) -> Option<(u32, Vec<u8>)> {
        self.undecoded.pop()
    }

    /// Takes a decoded image (`None`: it could not be decoded, and stays white) and uploads when all are there.
    pub(crate) fn set_image(&mut self, gpu: &Gpu, place: u32, image: Option<Image>) -> Result<bool, String> {
        let fits = |image: &Image| {
            let texels = u64::from(image.width) * u64::from(image.height);
            texels > 0 && texels * 4 == image.rgba.len() as u64
        };
        if let (Some(slot), Some(image)) =
            (self.stage.data.images.get_mut(place as usize), image.filter(fits))
        {
            *slot = image;
        }
        self.awaited = self.awaited.saturating_sub(1);
        if self.awaited > 0 || self.loader.is_some() {
            return Ok(false);
        }
        self.upload(gpu).map_err(|error| error.to_string())?;
        Ok(true)
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
            if hidden {
                self.hidden.insert(object)
            } else {
                self.hidden.remove(&object)
            };
        }
    }
}
