//! Material classes: what may be merged into one mesh.

use svs_render::{AlphaMode, Material, Primitive};

/// Steps of the metallic value.
const METALLIC_STEPS: f32 = 20.0;
/// Steps of roughness.
const ROUGHNESS_STEPS: f32 = 20.0;
/// Steps of each emissive channel, per 1.
const EMISSIVE_STEPS: f32 = 15.0;

/// What a vertex colour of 255 stands for, by brightness. Linear colours in bytes are coarse in the dark: 0.01 would be
/// 2.55 of 255.
pub(super) const BRIGHTNESS: [f32; 3] = [1.0, 0.2, 0.03];

/// Everything that meshes which are merged have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Class {
    /// Vertex colours say how it looks.
    Plain(PlainClass),
    /// A material whose texture matters.
    Kept {
        /// Index into the materials that the [`super::Palette`] was made of.
        material: u32,
        /// No normals.
        flat: bool,
    },
}

/// A class without textures. The values are steps, so that few classes come of many materials.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PlainClass {
    /// Alpha is how much it covers; else it is opaque.
    pub blend: bool,
    /// Both sides are drawn.
    pub double_sided: bool,
    /// Shown as it is, without light.
    pub unlit: bool,
    /// Metallic value in twentieths.
    pub metallic: u8,
    /// Roughness in twentieths.
    pub roughness: u8,
    /// Linear emitted colour in fifteenths, at most 17 times 1.
    pub emissive: [u8; 3],
    /// How bright a vertex colour of 255 is: 0 for 1, 1 for 0.2, 2 for 0.03 (linear).
    pub brightness: u8,
    /// No normals: faces are flat.
    pub flat: bool,
}

impl PlainClass {
    /// The class nearest to a material without its textures, for colours around `color` (linear).
    pub(super) fn nearest(material: &Material, color: [f32; 4], emissive: [f32; 3], flat: bool) -> Self {
        let step = |value: f32, steps: f32| (value.clamp(0.0, 1.0) * steps).round() as u8;
        let brightest = color[..3].iter().fold(0.0f32, |a, &b| a.max(b));
        let brightness = BRIGHTNESS.iter().rposition(|&top| brightest <= top).unwrap_or(0);
        Self {
            blend: material.alpha == AlphaMode::Blend,
            double_sided: material.double_sided,
            unlit: material.unlit,
            metallic: step(material.metallic, METALLIC_STEPS),
            roughness: step(material.roughness, ROUGHNESS_STEPS),
            emissive: emissive.map(|c| (c.max(0.0) * EMISSIVE_STEPS).round().min(255.0) as u8),
            brightness: brightness as u8,
            flat,
        }
    }

    /// Linear colour of a vertex colour of 255.
    pub fn top(&self) -> f32 {
        BRIGHTNESS[usize::from(self.brightness).min(BRIGHTNESS.len() - 1)]
    }

    /// The material that draws the class together with vertex colours.
    pub fn material(&self) -> Material {
        let top = self.top();
        Material {
            base_color: [top, top, top, 1.0],
            metallic: f32::from(self.metallic) / METALLIC_STEPS,
            roughness: f32::from(self.roughness) / ROUGHNESS_STEPS,
            emissive: self.emissive.map(|c| f32::from(c) / EMISSIVE_STEPS),
            alpha: if self.blend { AlphaMode::Blend } else { AlphaMode::Opaque },
            double_sided: self.double_sided,
            unlit: self.unlit,
            ..Material::default()
        }
    }
}

impl Class {
    /// No normals: faces are flat.
    pub fn is_flat(&self) -> bool {
        match self {
            Class::Plain(plain) => plain.flat,
            Class::Kept { flat, .. } => *flat,
        }
    }
}

/// Triangles of one class. All attributes have one entry per position or are empty.
#[derive(Clone, Debug, PartialEq)]
pub struct ClassMesh {
    /// What they have in common.
    pub class: Class,
    /// Relative to the proxy's origin, metres.
    pub positions: Vec<[f32; 3]>,
    /// Unit normals; empty: faces are flat.
    pub normals: Vec<[f32; 3]>,
    /// Linear colours and alpha that multiply the class material's base colour, 255 for 1; empty: white.
    pub colors: Vec<[u8; 4]>,
    /// Texture coordinates of a kept material, its `KHR_texture_transform` applied; else empty.
    pub uvs: Vec<[f32; 2]>,
    /// Triangles, three indices each, all in range.
    pub indices: Vec<u32>,
}

impl ClassMesh {
    /// Number of triangles.
    pub fn triangles(&self) -> usize {
        self.indices.len() / 3
    }

    /// The only vertex colour, if there is but one.
    pub fn uniform_color(&self) -> Option<[u8; 4]> {
        let first = self.colors.first().copied().unwrap_or([255; 4]);
        self.colors.iter().all(|&color| color == first).then_some(first)
    }

    /// The same triangles as the renderer takes them.
    pub fn to_primitive(&self, material: u32) -> Primitive {
        Primitive {
            positions: self.positions.clone(),
            normals: self.normals.clone(),
            colors: self.colors.clone(),
            uvs: self.uvs.clone(),
            indices: self.indices.clone(),
            material,
        }
    }
}
