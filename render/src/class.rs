//! Material classes: what must be equal for parts to share one draw call.

use std::collections::HashMap;

use crate::{AlphaMode, Material, Primitive, SceneData, TextureRef};

/// What alpha means, without the cutoff, which every vertex carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) enum Mode {
    Opaque,
    Mask,
    Blend,
}

/// How much of the material comes from textures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) enum Textured {
    No,
    /// The base colour alone.
    Color,
    /// Metallic, roughness or emission too.
    Full,
}

/// Parts of one class can be drawn together. The order is the order of drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct Class {
    pub(crate) mode: Mode,
    pub(crate) textured: Textured,
    pub(crate) double_sided: bool,
    /// No normals: faces are flat.
    pub(crate) flat: bool,
    /// Colours differ between vertices.
    pub(crate) colors: bool,
    pub(crate) unlit: bool,
    pub(crate) emissive: bool,
    /// Index into the texture sets.
    pub(crate) set: u32,
}

/// The textures of a material: base colour, metallic-roughness, emission.
pub(crate) type TextureSet = [Option<TextureRef>; 3];

/// Texture sets in use; the first has none.
#[derive(Debug)]
pub(crate) struct Sets {
    pub(crate) list: Vec<TextureSet>,
    index: HashMap<TextureSet, u32>,
}

impl Sets {
    pub(crate) fn new() -> Self {
        let mut sets = Self { list: Vec::new(), index: HashMap::new() };
        sets.index_of([None; 3]);
        sets
    }

    fn index_of(&mut self, set: TextureSet) -> u32 {
        *self.index.entry(set).or_insert_with(|| {
            self.list.push(set);
            (self.list.len() - 1) as u32
        })
    }
}

/// The class of a primitive. Its material must exist.
pub(crate) fn class_of(data: &SceneData, primitive: &Primitive, sets: &mut Sets) -> Class {
    let material = &data.materials[primitive.material as usize];
    let set = if primitive.uvs.is_empty() { [None; 3] } else { textures(material) };
    let textured = match set {
        [None, None, None] => Textured::No,
        [_, None, None] => Textured::Color,
        _ => Textured::Full,
    };
    Class {
        mode: match material.alpha {
            AlphaMode::Opaque => Mode::Opaque,
            AlphaMode::Mask(_) => Mode::Mask,
            AlphaMode::Blend => Mode::Blend,
        },
        textured,
        double_sided: material.double_sided,
        flat: primitive.normals.is_empty() && !material.unlit,
        colors: !primitive.colors.is_empty(),
        unlit: material.unlit,
        emissive: material.emissive.iter().any(|&x| x > 0.0) && !material.unlit,
        set: sets.index_of(set),
    }
}

fn textures(material: &Material) -> TextureSet {
    if material.unlit {
        return [material.base_color_texture, None, None];
    }
    // A texture that multiplies a black emission is not looked at.
    let emits = material.emissive.iter().any(|&x| x > 0.0);
    let emissive = if emits { material.emissive_texture } else { None };
    [material.base_color_texture, material.metallic_roughness_texture, emissive]
}
