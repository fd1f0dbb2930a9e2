//! Textures: samplers, and images decoded once each, within bounds.

use crate::gltf::Document;
use crate::scene::alpha_mask::{Unreadable, bytes_of, decode, image_of, texels, wrap_modes};
use crate::scene::json::index;
use crate::scene::notes::Notes;
use rayon::prelude::*;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use svs_render::{Filter, Image, Sampler, TextureRef, Wrap};

/// Texels of all images together: 512 MB, as much as small graphics cards have to spare.
const MAX_TOTAL_TEXELS: u64 = 128 << 20;

/// Textures of the file that can be used.
#[derive(Debug, Default)]
pub(super) struct Textures {
    by_index: BTreeMap<usize, TextureRef>,
}

impl Textures {
    /// Reads the textures that these `textureInfo` objects name.
    pub(super) fn read<'a>(
        doc: &Document,
        infos: impl Iterator<Item = &'a Value>,
        notes: &mut Notes,
    ) -> (Textures, Vec<Image>) {
        let count = doc.json.get("textures").and_then(Value::as_array).map_or(0, Vec::len);
        let used: BTreeSet<usize> = infos.filter_map(texture_index).collect();
        let mut image_of_texture: BTreeMap<usize, usize> = BTreeMap::new();
        for texture in used {
            let image = if texture < count { image_of(&doc.json, texture).ok().flatten() } else { None };
            match image {
                Some(image) => drop(image_of_texture.insert(texture, image)),
                None => note(Unreadable::Data, format!("/textures/{texture}"), notes),
            }
        }
        let (places, images) = images(doc, image_of_texture.values().copied().collect(), notes);
        let textures = image_of_texture.into_iter().filter_map(|(texture, image)| {
            let sampler = sampler(doc, texture);
            Some((texture, TextureRef { image: *places.get(&image)?, sampler }))
        });
        (Textures { by_index: textures.collect() }, images)
    }

    /// The texture of a `textureInfo`, if it can be used.
    pub(super) fn of(&self, info: &Value) -> Option<TextureRef> {
        self.by_index.get(&texture_index(info)?).copied()
    }
}

fn texture_index(info: &Value) -> Option<usize> {
    index(info.get("index")?, String::new).ok()
}

/// Decodes images; gives the place of each that could be read.
fn images(doc: &Document, used: BTreeSet<usize>, notes: &mut Notes) -> (BTreeMap<usize, u32>, Vec<Image>) {
    // Sizes first and one after the other, so that it does not depend on threads which images find room.
    let mut texels_left = MAX_TOTAL_TEXELS;
    let mut chosen = Vec::new();
    for image in used {
        let size = bytes_of(doc, image).and_then(|bytes| texels(&bytes));
        let room = size.and_then(|size| texels_left.checked_sub(size).ok_or(Unreadable::Size));
        match room {
            Ok(left) => {
                texels_left = left;
                chosen.push(image);
            }
            Err(reason) => note(reason, format!("/images/{image}"), notes),
        }
    }
    let decoded: Vec<Result<Image, Unreadable>> = chosen
        .par_iter()
        .map(|&image| {
            let decoded = decode(&bytes_of(doc, image)?)?.into_rgba8();
            Ok(Image { width: decoded.width(), height: decoded.height(), rgba: decoded.into_raw() })
        })
        .collect();
    let (mut places, mut images) = (BTreeMap::new(), Vec::new());
    for (image, decoded) in chosen.into_iter().zip(decoded) {
        match decoded {
            Ok(decoded) => {
                places.insert(image, images.len() as u32);
                images.push(decoded);
            }
            Err(reason) => note(reason, format!("/images/{image}"), notes),
        }
    }
    (places, images)
}

fn note(reason: Unreadable, pointer: String, notes: &mut Notes) {
    let (code, message) = match reason {
        Unreadable::Data => {
            ("TEXTURE_UNREADABLE", "textures cannot be read (PNG and JPEG can): drawn without them")
        }
        Unreadable::Size => ("TEXTURE_TOO_LARGE", "textures are too large: drawn without them"),
    };
    notes.add(code, message, || pointer);
}

/// Unknown modes count as glTF's defaults.
fn sampler(doc: &Document, texture: usize) -> Sampler {
    let wrap = wrap_modes(&doc.json, texture).unwrap_or([10497; 2]).map(|mode| match mode {
        33071 => Wrap::Clamp,
        33648 => Wrap::Mirror,
        _ => Wrap::Repeat,
    });
    let filter = |key: &str| {
        let sampler = doc.json.get("textures")?.get(texture)?.get("sampler")?;
        let sampler = index(sampler, String::new).ok()?;
        doc.json.get("samplers")?.get(sampler)?.get(key)?.as_u64()
    };
    // Between mipmap levels it is always blended.
    let nearest =
        |key| if matches!(filter(key), Some(9728 | 9984 | 9986)) { Filter::Nearest } else { Filter::Linear };
    Sampler { wrap_u: wrap[0], wrap_v: wrap[1], magnify: nearest("magFilter"), minify: nearest("minFilter") }
}
