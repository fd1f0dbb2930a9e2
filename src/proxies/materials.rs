//! glTF materials for proxies and simplified meshes.

use super::geometry::Class;
use crate::gltf::Document;
use crate::gltf::payload::Additions;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use svs_render::{AlphaMode, Material, SceneData};

/// The materials that are appended, each once, and the file's own where they will do.
#[derive(Debug)]
pub(super) struct Materials<'a> {
    document: &'a Document,
    data: &'a SceneData,
    /// For each material of `data` its index in the file.
    sources: &'a [Option<usize>],
    first: usize,
    appended: Vec<Value>,
    by_class: BTreeMap<Class, usize>,
    copies: BTreeMap<u32, Option<usize>>,
    unlit: bool,
    strong: bool,
}

impl<'a> Materials<'a> {
    pub(super) fn new(document: &'a Document, data: &'a SceneData, sources: &'a [Option<usize>]) -> Self {
        Self {
            document,
            data,
            sources,
            first: Additions::first_material(document),
            appended: Vec::new(),
            by_class: BTreeMap::new(),
            copies: BTreeMap::new(),
            unlit: false,
            strong: false,
        }
    }

    /// Index of the material that draws a class.
    pub(super) fn of_class(&mut self, class: &Class) -> Option<usize> {
        match class {
            Class::Kept { material, .. } => self.of_original(*material),
            Class::Plain(plain) => {
                if let Some(&index) = self.by_class.get(class) {
                    return Some(index);
                }
                let material = self.write(&plain.material(), None);
                let index = self.append(material);
                self.by_class.insert(*class, index);
                Some(index)
            }
        }
    }

    /// Index of the material that draws what has this material of the scene: its own, unless that asks for vertex
    /// attributes that a simplified mesh does not have. `None`: glTF's default material.
    pub(super) fn of_original(&mut self, material: u32) -> Option<usize> {
        if let Some(&known) = self.copies.get(&material) {
            return known;
        }
        let source = self.sources.get(material as usize).copied().flatten();
        let json = source.and_then(|index| self.document.json.get("materials")?.get(index));
        let index = match (json, self.data.materials.get(material as usize)) {
            (Some(json), Some(_)) if is_self_sufficient(json) => source,
            (json, Some(own)) => {
                if json.is_none() && *own == Material::default() {
                    None
                } else {
                    let copy = self.write(own, json);
                    Some(self.append(copy))
                }
            }
            (_, None) => None,
        };
        self.copies.insert(material, index);
        index
    }

    fn append(&mut self, material: Value) -> usize {
        // Copies of different materials may be the same.
        let known = self.appended.iter().position(|other| *other == material);
        self.first
            + known.unwrap_or_else(|| {
                self.appended.push(material);
                self.appended.len() - 1
            })
    }

    /// The appended materials and the extensions they need.
    pub(super) fn finish(self) -> (Vec<Value>, Vec<(&'static str, bool)>) {
        let mut extensions = Vec::new();
        if self.unlit {
            extensions.push(("KHR_materials_unlit", false));
        }
        if self.strong {
            extensions.push(("KHR_materials_emissive_strength", false));
        }
        (self.appended, extensions)
    }

    /// A material in JSON; textures are those of `source`.
    fn write(&mut self, material: &Material, source: Option<&Value>) -> Value {
        let texture = |pointers: &[&str]| {
            let found = pointers.iter().find_map(|pointer| source?.pointer(pointer)?.get("index"));
            found.map(|index| json!({"index": index}))
        };
        let mut pbr = Map::new();
        if material.base_color != [1.0; 4] {
            pbr.insert("baseColorFactor".into(), numbers(&material.base_color));
        }
        let mut model = |key: &str, is_there: bool, pointers: &[&str]| {
            if let Some(texture) = texture(pointers).filter(|_| is_there) {
                pbr.insert(key.into(), texture);
            }
        };
        model(
            "baseColorTexture",
            material.base_color_texture.is_some(),
            &[
                "/pbrMetallicRoughness/baseColorTexture",
                "/extensions/KHR_materials_pbrSpecularGlossiness/diffuseTexture",
            ],
        );
        model(
            "metallicRoughnessTexture",
            material.metallic_roughness_texture.is_some(),
            &["/pbrMetallicRoughness/metallicRoughnessTexture"],
        );
        for (key, value) in [("metallicFactor", material.metallic), ("roughnessFactor", material.roughness)] {
            if value != 1.0 {
                pbr.insert(key.into(), number(value));
            }
        }
        let mut json = Map::new();
        if !pbr.is_empty() {
            json.insert("pbrMetallicRoughness".into(), Value::Object(pbr));
        }
        let mut extensions = Map::new();
        let brightest = material.emissive.iter().copied().fold(0.0f32, f32::max);
        if brightest > 0.0 {
            let strength = brightest.max(1.0);
            json.insert(
                "emissiveFactor".into(),
                numbers(&material.emissive.map(|c| (c / strength).clamp(0.0, 1.0))),
            );
            if strength > 1.0 {
                self.strong = true;
                extensions.insert(
                    "KHR_materials_emissive_strength".into(),
                    json!({"emissiveStrength": number(strength)}),
                );
            }
            if let Some(texture) =
                texture(&["/emissiveTexture"]).filter(|_| material.emissive_texture.is_some())
            {
                json.insert("emissiveTexture".into(), texture);
            }
        }
        match material.alpha {
            AlphaMode::Opaque => {}
            AlphaMode::Blend => drop(json.insert("alphaMode".into(), "BLEND".into())),
            AlphaMode::Mask(cutoff) => {
                json.insert("alphaMode".into(), "MASK".into());
                json.insert("alphaCutoff".into(), number(cutoff.max(0.0)));
            }
        }
        if material.double_sided {
            json.insert("doubleSided".into(), true.into());
        }
        if material.unlit {
            self.unlit = true;
            extensions.insert("KHR_materials_unlit".into(), json!({}));
        }
        if !extensions.is_empty() {
            json.insert("extensions".into(), Value::Object(extensions));
        }
        Value::Object(json)
    }
}

/// All its textures use `TEXCOORD_0` as it is, and none needs tangents or other sets.
fn is_self_sufficient(material: &Value) -> bool {
    fn is_plain(value: &Value) -> bool {
        match value {
            Value::Object(map) => map.iter().all(|(key, value)| {
                !matches!(key.as_str(), "KHR_texture_transform" | "normalTexture" | "occlusionTexture")
                    && (key != "texCoord" || value.as_u64() == Some(0))
                    && is_plain(value)
            }),
            Value::Array(items) => items.iter().all(is_plain),
            _ => true,
        }
    }
    is_plain(material)
}

/// The shortest text that gives the same float.
fn number(value: f32) -> Value {
    let value = if value.is_finite() { value } else { 0.0 };
    value.to_string().parse::<serde_json::Number>().map_or(Value::Null, Value::Number)
}

fn numbers(values: &[f32]) -> Value {
    Value::Array(values.iter().copied().map(number).collect())
}
