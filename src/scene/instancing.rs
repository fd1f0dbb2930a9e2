//! `EXT_mesh_gpu_instancing`: one transform per instance of a node's mesh.

use super::SceneError;
use super::accessors::open;
use super::json::{extension, index, malformed};
use super::transform::from_trs;
use crate::gltf::Document;
use glam::{DAffine3, DVec3};
use serde_json::Value;

const NAME: &str = "EXT_mesh_gpu_instancing";

/// The instances of a node, relative to it, or `None` if it has no such extension. May hold non-finite
/// numbers. Fails with `too_many` before decoding anything if there are more than `room`.
pub(super) fn read(
    doc: &Document,
    node: &Value,
    pointer: &str,
    room: u64,
    too_many: impl FnOnce() -> SceneError,
) -> Result<Option<Vec<DAffine3>>, SceneError> {
    let Some(extension) = extension(node, NAME) else { return Ok(None) };
    let pointer = format!("{pointer}/extensions/{NAME}/attributes");
    let attributes = extension.get("attributes").and_then(Value::as_object);
    let attributes = attributes.ok_or_else(|| malformed(pointer.clone(), "an object of accessors"))?;

    // Every attribute has one entry per instance, also those that do not place anything (`_ID`).
    let mut count = None;
    let mut accessors = Vec::with_capacity(attributes.len());
    for (name, value) in attributes {
        let place = format!("{pointer}/{name}");
        let accessor = open(doc, index(value, || place.clone())?, &place)?;
        let expected = *count.get_or_insert(accessor.count);
        if accessor.count != expected {
            return Err(SceneError::CountMismatch { pointer: place, count: accessor.count, expected });
        }
        accessors.push((name.as_str(), place, accessor));
    }
    let count = count.unwrap_or(0);
    if count as u64 > room {
        return Err(too_many());
    }

    let mut translations = vec![DVec3::ZERO; count];
    let mut rotations = vec![[0.0, 0.0, 0.0, 1.0]; count];
    let mut scales = vec![DVec3::ONE; count];
    for (name, pointer, accessor) in accessors {
        let failed = |source| SceneError::Accessor { pointer, source };
        match name {
            "TRANSLATION" => translations = accessor.read_vec3_f64().map_err(failed)?,
            "SCALE" => scales = accessor.read_vec3_f64().map_err(failed)?,
            "ROTATION" => {
                let quaternions = accessor.read_vec4_f64().map_err(failed)?;
                rotations = quaternions.into_iter().map(|q| q.to_array()).collect();
            }
            _ => {}
        }
    }
    let parts = translations.into_iter().zip(rotations).zip(scales);
    Ok(Some(parts.map(|((translation, rotation), scale)| from_trs(translation, rotation, scale)).collect()))
}
