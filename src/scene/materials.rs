//! What materials do to what is behind them: opacity and sidedness.

use super::alpha_mask::{MaskLoader, MaskTexels};
use super::animation::Animated;
use super::json::{array, extension, index, malformed, number_or, numbers, optional_index};
use super::notes::Notes;
use super::read::MaskMode;
use super::{AlphaMask, SceneError};
use crate::gltf::Document;
use glam::{DVec2, Vec2};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// What a material does to what is behind it.
#[derive(Clone, Debug)]
pub(crate) struct Material {
    /// Both sides are drawn.
    pub(crate) double_sided: bool,
    pub(crate) cover: Cover,
    /// Alpha is tested, so alpha in vertex colours matters.
    pub(crate) alpha_tested: bool,
}

/// Where a material's surfaces are.
#[derive(Clone, Debug)]
pub(crate) enum Cover {
    Opaque,
    Transparent,
    /// The alpha test fails everywhere: nothing is drawn.
    Nothing,
    /// Where the texture passes.
    Mask(MaskTexture),
}

/// An alpha texture and how a surface is mapped to it.
#[derive(Clone, Debug)]
pub(crate) struct MaskTexture {
    pub(crate) mask: Arc<AlphaMask>,
    /// n of TEXCOORD_n.
    pub(crate) tex_coord: usize,
    pub(crate) transform: UvTransform,
}

/// `KHR_texture_transform`: scale, then rotation (radians), then offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct UvTransform {
    offset: DVec2,
    rotation: f64,
    scale: DVec2,
}

impl UvTransform {
    const IDENTITY: UvTransform = UvTransform { offset: DVec2::ZERO, rotation: 0.0, scale: DVec2::ONE };

    /// Rotates counter-clockwise as seen on the image, whose v axis points down.
    pub(crate) fn apply(&self, uv: Vec2) -> Vec2 {
        let (sin, cos) = self.rotation.sin_cos();
        let scaled = uv.as_dvec2() * self.scale;
        let rotated = DVec2::new(cos * scaled.x + sin * scaled.y, cos * scaled.y - sin * scaled.x);
        let moved = (rotated + self.offset).as_vec2();
        // Coordinates of broken files; a texture is looked up somewhere, whatever they are.
        if moved.is_finite() { moved } else { Vec2::ZERO }
    }

    /// Whether texture coordinates stay finite in f32, if they are within 1e9 before.
    fn is_usable(&self) -> bool {
        // Written so that NaN is out of range.
        self.rotation.is_finite()
            && self.offset.abs().max_element() <= 1.0e9
            && self.scale.abs().max_element() <= 1.0e9
    }

    /// Bit patterns, so that surfaces with equal transforms can share vertices.
    pub(crate) fn key(&self) -> [u64; 5] {
        [self.offset.x, self.offset.y, self.rotation, self.scale.x, self.scale.y].map(f64::to_bits)
    }
}

/// The materials in use.
#[derive(Debug)]
pub(crate) struct Materials {
    by_index: BTreeMap<usize, Material>,
    /// For primitives without material (glTF 2.0, 3.9.6).
    default: Material,
}

impl Materials {
    /// The material of a primitive that may be drawn with any of `choices`: if they do not agree on what is
    /// hidden, the surface hides nothing and counts as seen from both sides.
    pub(crate) fn resolve(&self, choices: &[Option<usize>]) -> &Material {
        const UNSURE: &Material =
            &Material { double_sided: true, cover: Cover::Transparent, alpha_tested: false };
        let material = |choice: &Option<usize>| {
            choice.and_then(|index| self.by_index.get(&index)).unwrap_or(&self.default)
        };
        let Some((first, others)) = choices.split_first() else { return &self.default };
        let first = material(first);
        if others.iter().map(material).all(|other| first.behaves_like(other)) { first } else { UNSURE }
    }
}

impl Material {
    fn behaves_like(&self, other: &Material) -> bool {
        let same_cover = match (&self.cover, &other.cover) {
            (Cover::Opaque, Cover::Opaque)
            | (Cover::Transparent, Cover::Transparent)
            | (Cover::Nothing, Cover::Nothing) => true,
            (Cover::Mask(a), Cover::Mask(b)) => {
                Arc::ptr_eq(&a.mask, &b.mask) && a.tex_coord == b.tex_coord && a.transform == b.transform
            }
            _ => false,
        };
        same_cover && self.double_sided == other.double_sided && self.alpha_tested == other.alpha_tested
    }
}

/// Reads the materials `used` (indices in range).
pub(super) fn read(
    doc: &Document,
    used: &BTreeSet<usize>,
    animated: &Animated,
    mode: MaskMode,
    notes: &mut Notes,
) -> Result<Materials, SceneError> {
    let materials = array(&doc.json, "materials", "")?;
    let mut reader = Reader { doc, mode, masks: MaskLoader::new(doc), notes };
    let mut by_index = BTreeMap::new();
    for &index in used {
        by_index.insert(index, reader.material(&materials[index], index, animated.materials[index])?);
    }
    let default = Material { double_sided: false, cover: Cover::Opaque, alpha_tested: false };
    Ok(Materials { by_index, default })
}

struct Reader<'a> {
    doc: &'a Document,
    mode: MaskMode,
    masks: MaskLoader<'a>,
    notes: &'a mut Notes,
}

impl Reader<'_> {
    fn material(&mut self, json: &Value, index: usize, animated: bool) -> Result<Material, SceneError> {
        let pointer = format!("/materials/{index}");
        if !json.is_object() {
            return Err(malformed(pointer, "an object"));
        }
        let double_sided = json.get("doubleSided") == Some(&Value::Bool(true));
        let mut alpha_tested = false;
        let cover = if transmits(json, animated) {
            Cover::Transparent
        } else {
            match json.get("alphaMode").map(Value::as_str) {
                None | Some(Some("OPAQUE")) => Cover::Opaque,
                Some(Some("BLEND")) => Cover::Transparent,
                Some(Some("MASK")) => {
                    alpha_tested = true;
                    self.alpha_test(json, &pointer, animated)?
                }
                _ => {
                    self.notes.add(
                        "ALPHA_MODE_UNKNOWN",
                        "materials have an unknown alphaMode and are taken as transparent",
                        || format!("{pointer}/alphaMode"),
                    );
                    Cover::Transparent
                }
            }
        };
        Ok(Material { double_sided, cover, alpha_tested })
    }

    /// The cover of a material with `alphaMode` MASK (glTF 2.0, 3.9.4).
    fn alpha_test(&mut self, json: &Value, pointer: &str, animated: bool) -> Result<Cover, SceneError> {
        let unsure = if animated {
            Some(("MASK_ANIMATED", "alpha-tested materials are animated and are taken as transparent"))
        } else if extension(json, "KHR_materials_pbrSpecularGlossiness").is_some() {
            // Renderers that know this extension test another texture than those that do not.
            Some((
                "MASK_SPECULAR_GLOSSINESS",
                "alpha-tested materials use KHR_materials_pbrSpecularGlossiness and are taken as transparent",
            ))
        } else {
            None
        };
        if let Some((code, message)) = unsure {
            self.notes.add(code, message, || pointer.to_owned());
            return Ok(Cover::Transparent);
        }
        let cutoff = number_or(json, "alphaCutoff", 0.5) as f32;
        let empty = Value::Null;
        let pbr = json.get("pbrMetallicRoughness").unwrap_or(&empty);
        let pointer = format!("{pointer}/pbrMetallicRoughness");
        let [_, _, _, alpha] =
            numbers::<4>(pbr, "baseColorFactor", &pointer, "4 numbers")?.unwrap_or([1.0; 4]);
        // Factors lie in 0..=1 (glTF 2.0, 5.22); NaN becomes 1.
        let alpha = if alpha.is_finite() { alpha.clamp(0.0, 1.0) as f32 } else { 1.0 };
        let Some(texture) = pbr.get("baseColorTexture") else {
            return Ok(if alpha >= cutoff { Cover::Opaque } else { Cover::Nothing });
        };
        if alpha < cutoff {
            // Texels only lower the alpha.
            return Ok(Cover::Nothing);
        }
        if self.mode == MaskMode::Transparent {
            return Ok(Cover::Transparent);
        }

        let pointer = format!("{pointer}/baseColorTexture");
        let textures = array(&self.doc.json, "textures", "")?.len();
        let texture_index = optional_index(texture, "index", "textures", textures, &pointer)?
            .ok_or_else(|| malformed(format!("{pointer}/index"), "a texture index"))?;
        let (tex_coord, transform) = uv_mapping(texture, &pointer)?;
        if !transform.is_usable() {
            self.notes.add(
                "TEXTURE_TRANSFORM_UNUSABLE",
                "alpha textures have a transform that is not finite or too large: taken as transparent",
                || pointer,
            );
            return Ok(Cover::Transparent);
        }
        Ok(match self.masks.load(texture_index, alpha, cutoff)? {
            Ok(MaskTexels::AllPass) => Cover::Opaque,
            Ok(MaskTexels::NonePass) => Cover::Nothing,
            Ok(MaskTexels::Mixed(mask)) => Cover::Mask(MaskTexture { mask, tex_coord, transform }),
            Err(reason) => {
                self.notes.add(reason.code(), reason.message(), || pointer);
                Cover::Transparent
            }
        })
    }
}

/// Light passes through: `KHR_materials_transmission`, `KHR_materials_volume`.
pub(crate) fn transmits(json: &Value, animated: bool) -> bool {
    let transmission = extension(json, "KHR_materials_transmission");
    transmission.is_some_and(|e| animated || number_or(e, "transmissionFactor", 0.0) > 0.0)
        || extension(json, "KHR_materials_volume").is_some()
}

/// The n of TEXCOORD_n and the transform of a `textureInfo`.
pub(crate) fn uv_mapping(texture: &Value, pointer: &str) -> Result<(usize, UvTransform), SceneError> {
    let set = |parent: &Value, pointer: &str| {
        let place = || format!("{pointer}/texCoord");
        parent.get("texCoord").map(|value| index(value, place)).transpose()
    };
    let own = set(texture, pointer)?.unwrap_or(0);
    let Some(json) = extension(texture, "KHR_texture_transform") else {
        return Ok((own, UvTransform::IDENTITY));
    };
    let pointer = format!("{pointer}/extensions/KHR_texture_transform");
    let pair = |key| numbers::<2>(json, key, &pointer, "2 numbers").map(|pair| pair.map(DVec2::from));
    let transform = UvTransform {
        offset: pair("offset")?.unwrap_or(DVec2::ZERO),
        rotation: number_or(json, "rotation", 0.0),
        scale: pair("scale")?.unwrap_or(DVec2::ONE),
    };
    Ok((set(json, &pointer)?.unwrap_or(own), transform))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The example of KHR_texture_transform: the lower left quadrant of the image, rotated clockwise by 90
    /// degrees.
    #[test]
    fn uv_transform_is_that_of_the_specification() {
        let transform = UvTransform {
            offset: DVec2::new(0.0, 1.0),
            rotation: std::f64::consts::FRAC_PI_2,
            scale: DVec2::splat(0.5),
        };
        for (uv, expected) in [
            (Vec2::new(0.0, 0.0), Vec2::new(0.0, 1.0)),
            (Vec2::new(1.0, 0.0), Vec2::new(0.0, 0.5)),
            (Vec2::new(0.0, 1.0), Vec2::new(0.5, 1.0)),
            (Vec2::new(1.0, 1.0), Vec2::new(0.5, 0.5)),
        ] {
            assert!(transform.apply(uv).distance(expected) < 1e-6, "{uv} {}", transform.apply(uv));
        }
        assert_eq!(UvTransform::IDENTITY.apply(Vec2::new(0.25, 7.0)), Vec2::new(0.25, 7.0));
    }
}
