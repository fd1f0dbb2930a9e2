//! Alpha textures of MASK materials, as one bit per texel.

use super::json::{array, index, malformed, optional_index};
use super::{AlphaMask, SceneError, pixels};
use crate::gltf::Document;
use serde_json::Value;
use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::Arc;

/// Largest image file that is read, in bytes.
const MAX_BYTES: u64 = 1 << 29;

/// Texels kept for all textures together.
const MAX_TOTAL_TEXELS: u64 = 512 << 20;

/// Where a texture passes the alpha test.
#[derive(Clone, Debug)]
pub(crate) enum MaskTexels {
    AllPass,
    NonePass,
    Mixed(Arc<AlphaMask>),
}

/// Why a texture could not be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Unreadable {
    /// No PNG or JPEG data where the file says, or broken data.
    Data,
    /// More texels than [`pixels::MAX_TEXELS`] or, together, [`MAX_TOTAL_TEXELS`].
    Size,
}

impl Unreadable {
    pub(crate) fn code(self) -> &'static str {
        match self {
            Unreadable::Data => "MASK_TEXTURE_UNREADABLE",
            Unreadable::Size => "MASK_TEXTURE_TOO_LARGE",
        }
    }

    pub(crate) fn message(self) -> &'static str {
        match self {
            Unreadable::Data => "alpha textures cannot be read (PNG and JPEG can): taken as transparent",
            Unreadable::Size => "alpha textures are too large to be tested: taken as transparent",
        }
    }
}

type Loaded = Result<MaskTexels, Unreadable>;

/// Loads each alpha test once.
#[derive(Debug)]
pub(crate) struct MaskLoader<'a> {
    doc: &'a Document,
    /// By texture, alpha factor and cutoff.
    loaded: HashMap<(usize, u32, u32), Loaded>,
    texels_left: u64,
}

impl<'a> MaskLoader<'a> {
    pub(crate) fn new(doc: &'a Document) -> MaskLoader<'a> {
        MaskLoader { doc, loaded: HashMap::new(), texels_left: MAX_TOTAL_TEXELS }
    }

    /// Tests `alpha * texel alpha >= cutoff` for every texel of a texture (index in range).
    ///
    /// # Errors
    /// The outer error is a file with broken references; the inner one a texture that cannot be used.
    pub(crate) fn load(&mut self, texture: usize, alpha: f32, cutoff: f32) -> Result<Loaded, SceneError> {
        let key = (texture, alpha.to_bits(), cutoff.to_bits());
        if let Some(loaded) = self.loaded.get(&key) {
            return Ok(loaded.clone());
        }
        let wrap = wrap_modes(&self.doc.json, texture)?;
        let loaded = match image_of(&self.doc.json, texture)? {
            Some(image) => self.test(image, wrap, alpha, cutoff),
            None => Err(Unreadable::Data),
        };
        self.loaded.insert(key, loaded.clone());
        Ok(loaded)
    }

    fn test(&mut self, image: usize, wrap: [u32; 2], alpha: f32, cutoff: f32) -> Loaded {
        let Some((width, height, passes)) = pixels::alpha_test(&bytes_of(self.doc, image)?, alpha, cutoff)?
        else {
            return Ok(if alpha >= cutoff { MaskTexels::AllPass } else { MaskTexels::NonePass });
        };
        if passes.iter().all(|&pass| pass) {
            return Ok(MaskTexels::AllPass);
        }
        if !passes.contains(&true) {
            return Ok(MaskTexels::NonePass);
        }
        self.texels_left = self.texels_left.checked_sub(passes.len() as u64).ok_or(Unreadable::Size)?;
        Ok(MaskTexels::Mixed(Arc::new(AlphaMask { width, height, passes, wrap })))
    }
}

/// The image of a texture (index in range). `source` is the PNG or JPEG; extensions may only add other formats.
pub(crate) fn image_of(json: &Value, texture: usize) -> Result<Option<usize>, SceneError> {
    let images = array(json, "images", "")?.len();
    let textures = array(json, "textures", "")?;
    optional_index(&textures[texture], "source", "images", images, &format!("/textures/{texture}"))
}

/// The encoded bytes of an image (index in range).
pub(crate) fn bytes_of(doc: &Document, image: usize) -> Result<Cow<'_, [u8]>, Unreadable> {
    let json = doc.json.get("images").and_then(|images| images.get(image)).ok_or(Unreadable::Data)?;
    if let Some(view) = json.get("bufferView") {
        let view = index(view, || format!("/images/{image}/bufferView")).map_err(|_| Unreadable::Data)?;
        return doc.buffer_view(view).map(Cow::Borrowed).map_err(|_| Unreadable::Data);
    }
    let uri = json.get("uri").and_then(Value::as_str).ok_or(Unreadable::Data)?;
    doc.read_uri(uri, &format!("/images/{image}/uri"), MAX_BYTES).map_err(|_| Unreadable::Data)
}

pub(crate) fn wrap_modes(json: &Value, texture: usize) -> Result<[u32; 2], SceneError> {
    const REPEAT: u32 = 10497;
    let samplers = array(json, "samplers", "")?;
    let textures = array(json, "textures", "")?;
    let pointer = format!("/textures/{texture}");
    let Some(index) = optional_index(&textures[texture], "sampler", "samplers", samplers.len(), &pointer)?
    else {
        return Ok([REPEAT; 2]);
    };
    let mode = |key: &str| match samplers[index].get(key).map(Value::as_u64) {
        None => Ok(REPEAT),
        Some(Some(mode @ (10497 | 33071 | 33648))) => Ok(mode as u32),
        Some(_) => Err(malformed(format!("/samplers/{index}/{key}"), "10497, 33071 or 33648")),
    };
    Ok([mode("wrapS")?, mode("wrapT")?])
}
