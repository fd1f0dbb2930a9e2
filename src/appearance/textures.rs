//! Textures: samplers, and images decoded once each, within bounds.

use crate::gltf::Document;
use crate::parallel;
use crate::scene::alpha_mask::{Unreadable, bytes_of, image_of, wrap_modes};
use crate::scene::json::index;
use crate::scene::notes::Notes;
use crate::scene::pixels::{rgba, texels};
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
    /// Reads the textures that these `textureInfo` objects name, with their images, or (`later`) white texels in their
    /// stead; and the glTF image of each image.
    pub(super) fn read<'a>(
        doc: &Document,
        infos: impl Iterator<Item = &'a Value>,
        later: bool,
        notes: &mut Notes,
    ) -> (Textures, Vec<Image>, Vec<usize>) {
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
        let used: BTreeSet<usize> = image_of_texture.values().copied().collect();
        let (sources, images) = if later {
            let white = Image { width: 1, height: 1, rgba: vec![255; 4] };
            let sources: Vec<usize> = used.into_iter().collect();
            let images = vec![white; sources.len()];
            (sources, images)
        } else {
            images(doc, used, notes)
        };
        let places: BTreeMap<usize, u32> =
            sources.iter().enumerate().map(|(place, &image)| (image, place as u32)).collect();
        let textures = image_of_texture.into_iter().filter_map(|(texture, image)| {
            let sampler = sampler(doc, texture);
            Some((texture, TextureRef { image: *places.get(&image)?, sampler }))
        });
        (Textures { by_index: textures.collect() }, images, sources)
    }

    /// The texture of a `textureInfo`, if it can be used.
    pub(super) fn of(&self, info: &Value) -> Option<TextureRef> {
        self.by_index.get(&texture_index(info)?).copied()
    }
}

fn texture_index(info: &Value) -> Option<usize> {
    index(info.get("index")?, String::new).ok()
}

/// Decodes images; those that can be read, and which they are.
pub(super) fn images(doc: &Document, used: BTreeSet<usize>, notes: &mut Notes) -> (Vec<usize>, Vec<Image>) {
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
    let decoded = parallel::map(&chosen, |&image| {
        let (width, height, rgba) = rgba(&bytes_of(doc, image)?)?;
        Ok(Image { width, height, rgba })
    });
    let (mut sources, mut images) = (Vec::new(), Vec::new());
    for (image, decoded) in chosen.into_iter().zip(decoded) {
        match decoded {
            Ok(decoded) => {
                sources.push(image);
                images.push(decoded);
            }
            Err(reason) => note(reason, format!("/images/{image}"), notes),
        }
    }
    (sources, images)
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
