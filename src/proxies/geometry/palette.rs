//! The materials of a scene, prepared once for all of its proxies.

use super::class::{Class, PlainClass};
use super::texture::Pyramid;
use rayon::prelude::*;
use svs_render::{AlphaMode, Image, Material, Sampler};

/// A texture is kept if its brightness varies more than this (standard deviation in steps of sRGB from 0 to 1) …
const LEAST_SPREAD: f32 = 0.06;
/// … on more than this share of the node's area.
const LEAST_SHARE: f64 = 0.1;

/// Materials and small copies of their textures.
#[derive(Clone, Debug, Default)]
pub struct Palette {
    materials: Vec<Material>,
    /// Base colour textures by image, sRGB taken out.
    colors: Vec<Option<Pyramid>>,
    /// Means of the images: as they are, and with sRGB taken out.
    means: Vec<[[f32; 4]; 2]>,
}

/// How a primitive goes into a proxy.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look<'a> {
    pub(super) class: Class,
    /// Linear colour that multiplies the vertex colours.
    pub(super) color: [f32; 4],
    /// Multiplies them too.
    pub(super) texture: Option<(&'a Pyramid, Sampler)>,
}

impl Palette {
    /// Prepares the materials of a scene; `images` are those that they name.
    pub fn new(materials: &[Material], images: &[Image]) -> Self {
        let mut wanted = vec![false; images.len()];
        for texture in materials.iter().filter_map(|m| m.base_color_texture) {
            if let Some(wanted) = wanted.get_mut(texture.image as usize) {
                *wanted = true;
            }
        }
        let mean = |image: &Image, srgb| Pyramid::new(image, srgb).map_or([1.0; 4], |p| p.mean());
        let colors = images
            .par_iter()
            .zip(&wanted)
            .map(|(image, &wanted)| if wanted { Pyramid::new(image, true) } else { None })
            .collect();
        let means = images.par_iter().map(|image| [mean(image, false), mean(image, true)]).collect();
        Self { materials: materials.to_vec(), colors, means }
    }

    /// The materials.
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    fn pyramid(&self, material: &Material) -> Option<(&Pyramid, Sampler)> {
        let texture = material.base_color_texture?;
        Some((self.colors.get(texture.image as usize)?.as_ref()?, texture.sampler))
    }

    /// The texture matters if it covers enough: cut-outs always do.
    pub(super) fn may_keep(&self, material: u32) -> bool {
        let Some(material) = self.materials.get(material as usize) else { return false };
        self.pyramid(material).is_some_and(|(pyramid, _)| pyramid.spread > LEAST_SPREAD)
    }

    /// Whether a texture that varies is kept, given its share of the node's area.
    pub(super) fn keeps(share: f64) -> bool {
        share > LEAST_SHARE
    }

    /// Whether a class hides what is behind it.
    pub(super) fn occludes(&self, class: &Class) -> bool {
        match class {
            Class::Plain(plain) => !plain.blend,
            Class::Kept { material, .. } => {
                self.materials.get(*material as usize).is_some_and(|m| match m.alpha {
                    AlphaMode::Opaque => true,
                    AlphaMode::Mask(cutoff) => self.least_alpha(m) >= cutoff,
                    AlphaMode::Blend => false,
                })
            }
        }
    }

    /// Whether both sides of a class are drawn.
    pub(super) fn double_sided(&self, class: &Class) -> bool {
        match class {
            Class::Plain(plain) => plain.double_sided,
            Class::Kept { material, .. } => {
                self.materials.get(*material as usize).is_some_and(|m| m.double_sided)
            }
        }
    }

    fn least_alpha(&self, material: &Material) -> f32 {
        material.base_color[3] * self.pyramid(material).map_or(1.0, |(pyramid, _)| pyramid.least_alpha)
    }

    /// How primitives of a material are drawn; `None` if they are nowhere to be seen.
    pub(super) fn look(&self, index: u32, has_uvs: bool, flat: bool, keep: bool) -> Option<Look<'_>> {
        let default = Material::default();
        let material = self.materials.get(index as usize).unwrap_or(&default);
        let texture = self.pyramid(material).filter(|_| has_uvs);
        if let AlphaMode::Mask(cutoff) = material.alpha {
            if texture.is_some() && self.least_alpha(material) < cutoff {
                return Some(Look {
                    class: Class::Kept { material: index, flat },
                    color: [1.0; 4],
                    texture: None,
                });
            }
            if texture.is_none() && material.base_color[3] < cutoff {
                return None;
            }
        }
        if material.alpha == AlphaMode::Blend && material.base_color[3] <= 0.0 {
            return None;
        }
        if keep && texture.is_some() {
            return Some(Look {
                class: Class::Kept { material: index, flat },
                color: [1.0; 4],
                texture: None,
            });
        }
        let mut color = material.base_color.map(|c| if c.is_finite() { c.clamp(0.0, 1.0) } else { 1.0 });
        if material.alpha != AlphaMode::Blend {
            color[3] = 1.0;
        }
        let mut mean = color;
        if let Some((pyramid, _)) = texture {
            for (mean, texel) in mean.iter_mut().zip(pyramid.mean()) {
                // Twice: texels may be brighter than their mean.
                *mean = (*mean * texel * 2.0).min(1.0);
            }
        }
        let mut averaged = material.clone();
        if has_uvs {
            if let Some(texels) = self.mean_of(material.metallic_roughness_texture, 0) {
                averaged.roughness *= texels[1];
                averaged.metallic *= texels[2];
            }
            if let Some(texels) = self.mean_of(material.emissive_texture, 1) {
                averaged.emissive = std::array::from_fn(|c| averaged.emissive[c] * texels[c]);
            }
        }
        let class = Class::Plain(PlainClass::nearest(&averaged, mean, averaged.emissive, flat));
        Some(Look { class, color, texture })
    }

    fn mean_of(&self, texture: Option<svs_render::TextureRef>, srgb: usize) -> Option<[f32; 4]> {
        Some(self.means.get(texture?.image as usize)?[srgb])
    }
}
