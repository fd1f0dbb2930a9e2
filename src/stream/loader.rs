//! Which bytes are fetched next, and what can be read of those that came.

use super::StreamError;
use super::head::Known;
use super::ranges::{Ranges, coalesce};
use crate::appearance::Gradual;
use crate::gltf::Document;
use crate::scene::json::index;
use crate::scene::primitives;
use crate::stage::Stage;
use serde_json::Value;
use std::ops::Range;
use svs_runtime::format::{EXTENSION_NAME, Extension};

/// Gaps of so many bytes are fetched with what lies around them: at 20 Mbit/s they take 13 ms, less than a request.
const GAP: u64 = 32 << 10;
/// Bytes that are asked for at a time: small enough that a camera that moves is soon followed.
const BATCH: u64 = 512 << 10;

/// What a mesh or an image still needs.
#[derive(Clone, Debug, Default)]
struct Need {
    ranges: Vec<Range<u64>>,
    images: Vec<u32>,
    done: bool,
}

/// Meshes and images of the data that can be read now.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Ready {
    /// Places in [`svs_render::SceneData::meshes`].
    pub meshes: Vec<u32>,
    /// Places in [`svs_render::SceneData::images`].
    pub images: Vec<u32>,
}

/// A file on its way: its JSON is known, its bytes come in any order.
#[derive(Debug)]
pub struct Loader {
    document: Document,
    bin: u64,
    length: u64,
    have: Ranges,
    asked: Ranges,
    /// What the stage needs before it can be opened.
    first: Vec<Range<u64>>,
    gradual: Option<Gradual>,
    meshes: Vec<Need>,
    images: Vec<Need>,
    /// All meshes as their bytes lie in the file.
    in_file: Vec<u32>,
}

impl Loader {
    /// Takes over what the head of the file was.
    ///
    /// # Errors
    /// [`StreamError`] if an accessor that is needed first is broken.
    pub fn new(known: Known) -> Result<Self, StreamError> {
        let Known { document, bin, length, parts } = known;
        let mut loader = Self {
            document,
            bin,
            length,
            have: Ranges::default(),
            asked: Ranges::default(),
            first: Vec::new(),
            gradual: None,
            meshes: Vec::new(),
            images: Vec::new(),
            in_file: Vec::new(),
        };
        for (at, bytes) in parts {
            loader.receive(at, &bytes)?;
        }
        let mut first = Vec::new();
        for accessor in accessors_first(&loader.document) {
            first.extend(loader.ranges_of(accessor));
        }
        // Compressed data do not say what of them a mesh needs: such a file is read as a whole, where it can be at all.
        if cfg!(feature = "bake") && loader.document.has_compressed_views() {
            first.push(loader.bin..loader.length);
        }
        loader.first = coalesce(first, GAP);
        Ok(loader)
    }

    /// Bytes of the file.
    pub fn length(&self) -> u64 {
        self.length
    }

    /// Bytes of an accessor in the file; of one that is broken none, it is left out when it is read.
    fn ranges_of(&self, accessor: usize) -> Vec<Range<u64>> {
        let Ok(ranges) = self.document.accessor_ranges(accessor) else { return Vec::new() };
        // Only buffer 0 is in the file.
        let own = ranges.into_iter().filter(|(buffer, _)| *buffer == 0);
        own.map(|(_, range)| self.bin + range.start as u64..self.bin + range.end as u64).collect()
    }

    /// Takes bytes of the file.
    ///
    /// # Errors
    /// [`StreamError::Outside`] if they lie outside it.
    pub fn receive(&mut self, at: u64, bytes: &[u8]) -> Result<(), StreamError> {
        let end = at.saturating_add(bytes.len() as u64);
        if end > self.length {
            return Err(StreamError::Outside { start: at, end, length: self.length });
        }
        self.have.insert(at..end);
        let Some(buffer) = self.document.buffers.first_mut() else { return Ok(()) };
        // The part of it that lies in the buffer.
        let (from, to) = (at.max(self.bin), end.min(self.bin + buffer.len() as u64));
        if from < to {
            buffer[(from - self.bin) as usize..(to - self.bin) as usize]
                .copy_from_slice(&bytes[(from - at) as usize..(to - at) as usize]);
        }
        Ok(())
    }

    /// What is needed before [`Self::open`] is there.
    pub fn can_open(&self) -> bool {
        self.first.iter().all(|range| self.have.contains(range))
    }

    /// Opens the stage, its meshes all empty.
    ///
    /// # Errors
    /// [`StreamError::Stage`] if the file cannot be drawn.
    pub fn open(&mut self) -> Result<Stage, StreamError> {
        let (stage, gradual) = Stage::outline(&self.document)?;
        self.meshes = (gradual.needs(&self.document).into_iter())
            .map(|needs| Need {
                ranges: needs.accessors.iter().flat_map(|&accessor| self.ranges_of(accessor)).collect(),
                images: needs.images.into_iter().collect(),
                done: false,
            })
            .collect();
        let view = |image: &usize| {
            let image = self.document.json.get("images")?.get(*image)?;
            index(image.get("bufferView")?, String::new).ok()
        };
        self.images = (gradual.image_sources().iter())
            .map(|image| {
                let range = view(image).and_then(|view| self.document.buffer_view_range(view).ok());
                let range = range.filter(|(buffer, _)| *buffer == 0).map(|(_, range)| range);
                let ranges = range.map(|range| self.bin + range.start as u64..self.bin + range.end as u64);
                Need { ranges: ranges.into_iter().collect(), images: Vec::new(), done: false }
            })
            .collect();
        self.in_file = (0..self.meshes.len() as u32).collect();
        let begin = |&mesh: &u32| self.meshes[mesh as usize].ranges.iter().map(|range| range.start).min();
        self.in_file.sort_by_key(begin);
        self.gradual = Some(gradual);
        Ok(stage)
    }

    /// What to fetch next: at most about half a megabyte, of the meshes that come first in `order`, then of all others as they
    /// lie in the file, in few requests. Empty if all is there or on its way.
    pub fn wanted(&mut self, order: &[u32]) -> Vec<Range<u64>> {
        let mut batch = Vec::new();
        let mut bytes = 0;
        let mut add = |ranges: &[Range<u64>], asked: &mut Ranges, have: &Ranges| {
            for range in ranges.iter().flat_map(|range| have.missing(range.clone())) {
                for range in asked.missing(range) {
                    bytes += range.end - range.start;
                    asked.insert(range.clone());
                    batch.push(range);
                }
            }
            bytes >= BATCH
        };
        if self.gradual.is_none() {
            let first = self.first.clone();
            add(&first, &mut self.asked, &self.have);
        } else {
            for &mesh in order.iter().chain(&self.in_file) {
                let Some(need) = self.meshes.get(mesh as usize).filter(|need| !need.done) else { continue };
                let mut full = add(&need.ranges, &mut self.asked, &self.have);
                for &image in &need.images {
                    full |= add(&self.images[image as usize].ranges, &mut self.asked, &self.have);
                }
                if full {
                    break;
                }
            }
        }
        let batch = coalesce(batch, GAP);
        batch.iter().for_each(|range| self.asked.insert(range.clone()));
        batch
    }

    /// Meshes and images whose bytes have all come since the last call; read them with [`Self::fill`].
    pub fn ready(&mut self) -> Ready {
        let have = &self.have;
        let pick = |needs: &mut [Need]| -> Vec<u32> {
            let mut ready = Vec::new();
            for (place, need) in needs.iter_mut().enumerate() {
                if !need.done && need.ranges.iter().all(|range| have.contains(range)) {
                    need.done = true;
                    ready.push(place as u32);
                }
            }
            ready
        };
        Ready { images: pick(&mut self.images), meshes: pick(&mut self.meshes) }
    }

    /// Reads what is ready into the stage's data.
    ///
    /// # Errors
    /// [`StreamError`] if the stage is not the one of [`Self::open`].
    pub fn fill(&self, ready: &Ready, stage: &mut Stage) -> Result<(), StreamError> {
        if let Some(gradual) = &self.gradual {
            // Where there is a decoder; see `image_bytes`.
            gradual.fill_images(&self.document, &ready.images, &mut stage.data);
            let filled = gradual.fill(&self.document, &ready.meshes, &mut stage.data);
            filled.map_err(crate::stage::StageError::from)?;
        }
        Ok(())
    }

    /// The encoded bytes of an image that is ready: for a decoder elsewhere. What it makes of them goes to
    /// [`svs_render::SceneData::images`].
    pub fn image_bytes(&self, place: u32) -> Option<std::borrow::Cow<'_, [u8]>> {
        self.gradual.as_ref()?.image_bytes(&self.document, place)
    }

    /// Everything has been read.
    pub fn is_done(&self) -> bool {
        self.gradual.is_some() && self.meshes.iter().chain(&self.images).all(|need| need.done)
    }

    /// Bytes of each mesh in the file.
    pub fn mesh_bytes(&self) -> Vec<u64> {
        self.meshes.iter().map(|need| need.ranges.iter().map(|range| range.end - range.start).sum()).collect()
    }
}

/// The tables of the baked visibility, and the positions of meshes whose boxes the file does not state.
fn accessors_first(document: &Document) -> Vec<usize> {
    let extension = document.json.get("extensions").and_then(|all| all.get(EXTENSION_NAME));
    let extension = extension.and_then(|json| <Extension as serde::Deserialize>::deserialize(json).ok());
    let mut first: Vec<usize> = extension
        .iter()
        .flat_map(|extension| extension.trees.iter().flat_map(|tree| tree.accessors()))
        .map(|accessor| accessor as usize)
        .collect();
    for position in primitives::positions(&document.json) {
        let accessor = document.json.get("accessors").and_then(|all| all.get(position));
        let has = |key: &str| accessor.is_some_and(|accessor| accessor.get(key).is_some_and(Value::is_array));
        if !(has("min") && has("max")) {
            first.push(position);
        }
    }
    first
}
