//! Materials: glTF's metallic-roughness model, and what of other models can be said in it.

use super::textures::Textures;
use crate::gltf::Document;
use crate::scene::json::{extension, number_or};
use crate::scene::materials::{UvTransform, transmits, uv_mapping};
use crate::scene::notes::Notes;
use serde_json::Value;
use std::collections::BTreeMap;
use svs_render::{AlphaMode, Image, Material, TextureRef};

/// How much of a wholly transmitting surface still covers what is behind it.
const GLASS: f32 = 0.25;

/// The materials in use, and the images they use.
#[derive(Debug, Default)]
pub(super) struct Materials {
    pub(super) materials: Vec<Material>,
    pub(super) images: Vec<Image>,
    /// For each image its index in the file.
    pub(super) image_sources: Vec<usize>,
    /// Place in `materials` by index in the file (`None`: the default material).
    places: BTreeMap<Option<usize>, u32>,
    /// For each material, the texture coordinates of its textures.
    mappings: Vec<Option<Mapping>>,
}

/// n of TEXCOORD_n, and what is done to them.
pub(super) type Mapping = (usize, UvTransform);

/// Where materials have textures, for people.
const SLOTS: [&str; 3] = ["base colour", "metallic and roughness", "emissive"];

impl Materials {
    /// Reads the materials `used`; their images may come `later`.
    pub(super) fn read(
        doc: &Document,
        used: impl Iterator<Item = Option<usize>>,
        later: bool,
        notes: &mut Notes,
    ) -> Materials {
        let mut out = Materials::default();
        let mut sources: BTreeMap<Option<usize>, &Value> = BTreeMap::new();
        for material in used {
            let json = material.and_then(|index| doc.json.get("materials")?.get(index));
            sources.insert(material, json.unwrap_or(&Value::Null));
        }
        let infos = sources.values().flat_map(|json| slots(json)).flatten();
        let (textures, images, image_sources) = Textures::read(doc, infos, later, notes);
        (out.images, out.image_sources) = (images, image_sources);
        for (index, json) in sources {
            out.places.insert(index, out.materials.len() as u32);
            let mut material = material(json);
            out.mappings.push(put_textures(&mut material, json, &textures, index, notes));
            out.materials.push(material);
        }
        out
    }

    /// Place of a material in use.
    pub(super) fn index(&self, material: Option<usize>) -> u32 {
        self.places.get(&material).copied().unwrap_or(0)
    }

    /// For each material its index in the file.
    pub(super) fn sources(&self) -> Vec<Option<usize>> {
        let mut sources = vec![None; self.materials.len()];
        for (&source, &place) in &self.places {
            sources[place as usize] = source;
        }
        sources
    }

    /// Texture coordinates that a material wants; `None` if it has no textures.
    pub(super) fn mapping(&self, material: Option<usize>) -> Option<Mapping> {
        self.mappings.get(self.index(material) as usize).copied().flatten()
    }
}

/// The base colour's model: metallic-roughness, or what `KHR_materials_pbrSpecularGlossiness` has in its place.
fn model(json: &Value) -> (&Value, bool) {
    match (json.get("pbrMetallicRoughness"), extension(json, "KHR_materials_pbrSpecularGlossiness")) {
        (Some(pbr), _) => (pbr, false),
        (None, Some(specular)) => (specular, true),
        (None, None) => (&Value::Null, false),
    }
}

/// The `textureInfo` of each of [`SLOTS`].
fn slots(json: &Value) -> [Option<&Value>; 3] {
    let (model, is_specular) = model(json);
    let base = model.get(if is_specular { "diffuseTexture" } else { "baseColorTexture" });
    [base, model.get("metallicRoughnessTexture").filter(|_| !is_specular), json.get("emissiveTexture")]
}

fn material(json: &Value) -> Material {
    let (model, is_specular) = model(json);
    let base = factors::<4>(model, if is_specular { "diffuseFactor" } else { "baseColorFactor" }, [1.0; 4]);
    let factor = |key: &str| number_or(model, key, 1.0).clamp(0.0, 1.0) as f32;
    let strength = extension(json, "KHR_materials_emissive_strength");
    let strength = strength.map_or(1.0, |e| number_or(e, "emissiveStrength", 1.0).clamp(0.0, 1e6) as f32);
    let mut material = Material {
        base_color: base,
        metallic: if is_specular { 0.0 } else { factor("metallicFactor") },
        roughness: if is_specular { 1.0 - factor("glossinessFactor") } else { factor("roughnessFactor") },
        emissive: factors::<3>(json, "emissiveFactor", [0.0; 3]).map(|factor| factor * strength),
        alpha: alpha(json),
        double_sided: json.get("doubleSided") == Some(&Value::Bool(true)),
        unlit: extension(json, "KHR_materials_unlit").is_some(),
        ..Material::default()
    };
    if transmits(json, false) {
        let transmission = extension(json, "KHR_materials_transmission");
        let share = transmission.map_or(1.0, |e| number_or(e, "transmissionFactor", 0.0)).clamp(0.0, 1.0);
        let covers = if material.alpha == AlphaMode::Blend { material.base_color[3] } else { 1.0 };
        material.base_color[3] = covers * (1.0 + (GLASS - 1.0) * share as f32);
        material.alpha = AlphaMode::Blend;
    }
    material
}

/// An unknown mode counts as blending, as it does for the bake.
fn alpha(json: &Value) -> AlphaMode {
    match json.get("alphaMode").map(Value::as_str) {
        None | Some(Some("OPAQUE")) => AlphaMode::Opaque,
        Some(Some("MASK")) => AlphaMode::Mask(number_or(json, "alphaCutoff", 0.5) as f32),
        _ => AlphaMode::Blend,
    }
}

/// `N` factors of 0 to 1; `default` where there are none.
fn factors<const N: usize>(parent: &Value, key: &str, default: [f32; N]) -> [f32; N] {
    let values = parent.get(key).and_then(Value::as_array).filter(|values| values.len() == N);
    let Some(values) = values else { return default };
    std::array::from_fn(|index| {
        let factor = values[index].as_f64().filter(|factor| factor.is_finite());
        factor.map_or(default[index], |factor| factor.clamp(0.0, 1.0) as f32)
    })
}

/// Gives a material its textures; returns the texture coordinates of the first, which the others must share.
fn put_textures(
    material: &mut Material,
    json: &Value,
    textures: &Textures,
    index: Option<usize>,
    notes: &mut Notes,
) -> Option<Mapping> {
    let mut mapping: Option<Mapping> = None;
    let mut found = [None; SLOTS.len()];
    for (slot, info) in slots(json).into_iter().enumerate() {
        let Some(info) = info else { continue };
        let Some((texture, own)) = textures.of(info).zip(uv_mapping(info, "").ok()) else { continue };
        if *mapping.get_or_insert(own) == own {
            found[slot] = Some(texture);
        } else {
            let message =
                format!("{} textures lie otherwise than their material's first one: left out", SLOTS[slot]);
            notes.add("TEXTURE_MAPPING", &message, || format!("/materials/{}", index.unwrap_or_default()));
        }
    }
    let [base, metallic, emissive]: [Option<TextureRef>; 3] = found;
    material.base_color_texture = base;
    material.metallic_roughness_texture = metallic;
    material.emissive_texture = emissive;
    mapping
}
