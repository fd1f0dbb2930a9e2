//! Taking the payload out again.

use super::{CONTAINERS, EXTENSION};
use crate::gltf::document::Document;
use crate::gltf::json;
use serde_json::{Map, Value};
use std::collections::BTreeSet;
use std::ops::Range;

/// Removes the extension and everything that [`super::attach`] added; returns whether there was any.
///
/// After `attach` the document is exactly what it was before. If other tools have appended objects since, or refer to
/// the payload's accessors, the extension goes and its accessors stay, unreferenced: nothing of the file is lost.
pub fn strip(document: &mut Document) -> bool {
    let Some(Value::Object(extensions)) = document.json.get_mut("extensions") else { return false };
    let Some(extension) = extensions.shift_remove(EXTENSION) else { return false };
    let before = extension.pointer("/extras/before").and_then(Value::as_object).cloned().unwrap_or_default();
    if before.get("declared") != Some(&Value::Bool(true)) {
        remove_name(&mut document.json, "extensionsUsed");
    }
    // Never ours, but a file that requires what it does not have would open nowhere.
    if remove_name(&mut document.json, "extensionsRequired")
        && json::array(&document.json, "extensionsRequired").is_empty()
        && let Value::Object(root) = &mut document.json
    {
        root.shift_remove("extensionsRequired");
    }
    remove_tables(document, &extension, &before);
    let was_empty = |key: &str| {
        before
            .get("empty")
            .and_then(Value::as_array)
            .is_some_and(|empty| empty.iter().any(|name| name == key))
    };
    if let Value::Object(root) = &mut document.json {
        for key in CONTAINERS {
            let is_empty = match root.get(key) {
                Some(Value::Array(items)) => items.is_empty(),
                Some(Value::Object(items)) => items.is_empty(),
                _ => false,
            };
            if is_empty && !was_empty(key) && touched(key, &extension) {
                root.shift_remove(key);
            }
        }
    }
    true
}

/// Removes the extension's name from a list; returns whether it was there.
fn remove_name(root: &mut Value, key: &str) -> bool {
    let Some(Value::Array(names)) = root.get_mut(key) else { return false };
    let count = names.len();
    names.retain(|name| name != EXTENSION);
    names.len() < count
}

/// Whether `attach` may have created the container: without tables it touches the last two only.
fn touched(key: &str, extension: &Value) -> bool {
    !["buffers", "bufferViews", "accessors"].contains(&key) || !table_accessors(extension).is_empty()
}

/// Accessors that the extension's trees name.
fn table_accessors(extension: &Value) -> BTreeSet<usize> {
    json::array(extension, "trees")
        .iter()
        .filter_map(|tree| tree.get("tables")?.as_object())
        .flat_map(|tables| tables.values().filter_map(json::index))
        .collect()
}

/// Removes accessors, buffer view and bytes if they are still the last ones and nobody else uses them.
fn remove_tables(document: &mut Document, extension: &Value, before: &Map<String, Value>) -> Option<()> {
    let used = table_accessors(extension);
    let accessors = json::array(&document.json, "accessors");
    let first = *used.first()?;
    let view_index = json::array(&document.json, "bufferViews").len().checked_sub(1)?;
    let in_view = |accessor: &Value| accessor.get("bufferView").and_then(json::index) == Some(view_index);
    let ours = accessors.get(first..)?;
    let trailing = used.len() == ours.len() && used.last() == Some(&(accessors.len() - 1));
    let exclusive = ours.iter().all(in_view)
        && !accessors[..first].iter().any(|accessor| mentions_view(accessor, view_index))
        && !json::array(&document.json, "images").iter().any(in_view)
        && !scene_uses_accessors(&document.json, first..accessors.len());
    if !trailing || !exclusive {
        return None;
    }
    let views = json::array(&document.json, "bufferViews");
    let view = views.get(view_index)?;
    let buffer = json::index(view.get("buffer")?)?;
    let start = view.get("byteOffset").map_or(Some(0), json::index)?;
    let length = json::index(view.get("byteLength")?)?;
    let end = start.checked_add(length)?;
    let free_from = views[..view_index].iter().filter_map(|view| end_in(view, buffer)).max().unwrap_or(0);
    let bytes = document.buffers.get(buffer)?.len();

    // Where the buffer ended before; `None` if it did not exist.
    let old_length = match before.get("byteLength") {
        Some(stood) => Some(json::index(stood).filter(|&stood| stood <= start && start - stood < 4)?),
        None => (start > 0).then_some(start),
    };
    let last_buffer = buffer + 1 == document.buffers.len();
    let objects = json::array(&document.json, "buffers");
    if [objects.len(), document.storage.len()] != [document.buffers.len(); 2] || !objects[buffer].is_object()
    {
        return None;
    }
    if end != bytes || free_from > old_length.unwrap_or(0) || (old_length.is_none() && !last_buffer) {
        return None;
    }
    truncate(&mut document.json, "accessors", first);
    truncate(&mut document.json, "bufferViews", view_index);
    match old_length {
        Some(old) => {
            document.buffers[buffer].truncate(old);
            document.json["buffers"][buffer]["byteLength"] =
                before.get("byteLength").cloned().unwrap_or_else(|| old.into());
        }
        None => {
            document.buffers.pop();
            document.storage.pop();
            truncate(&mut document.json, "buffers", buffer);
        }
    }
    Some(())
}

/// Where a view of the given buffer ends, views of extensions included; `None` for views of other buffers.
fn end_in(view: &Value, buffer: usize) -> Option<usize> {
    let end = |object: &Value| {
        let of_buffer = object.get("buffer").and_then(json::index) == Some(buffer);
        let offset = object.get("byteOffset").and_then(json::index).unwrap_or(0);
        // A view of length 0, or without one, still needs its buffer.
        let length = object.get("byteLength").and_then(json::index).unwrap_or(0).max(1);
        of_buffer.then_some(offset.saturating_add(length))
    };
    let extensions = view.get("extensions").and_then(Value::as_object);
    let nested = extensions.into_iter().flat_map(|all| all.values()).filter_map(end);
    end(view).into_iter().chain(nested).max()
}

/// Whether an accessor reads the view, directly or for sparse elements.
fn mentions_view(accessor: &Value, view: usize) -> bool {
    ["/bufferView", "/sparse/indices/bufferView", "/sparse/values/bufferView"]
        .iter()
        .any(|pointer| accessor.pointer(pointer).and_then(json::index) == Some(view))
}

/// Whether meshes, skins, animations or instances use one of these accessors.
fn scene_uses_accessors(root: &Value, accessors: Range<usize>) -> bool {
    let hit = |value: &Value| json::index(value).is_some_and(|index| accessors.contains(&index));
    let any_hit =
        |value: Option<&Value>| value.and_then(Value::as_object).is_some_and(|map| map.values().any(hit));
    let property = |object: &Value, key: &str| object.get(key).is_some_and(hit);
    let primitive = |primitive: &Value| {
        any_hit(primitive.get("attributes"))
            || property(primitive, "indices")
            || json::array(primitive, "targets").iter().any(|target| any_hit(Some(target)))
    };
    let sampler = |sampler: &Value| property(sampler, "input") || property(sampler, "output");
    json::array(root, "meshes").iter().any(|mesh| json::array(mesh, "primitives").iter().any(primitive))
        || json::array(root, "skins").iter().any(|skin| property(skin, "inverseBindMatrices"))
        || json::array(root, "animations")
            .iter()
            .any(|animation| json::array(animation, "samplers").iter().any(sampler))
        || json::array(root, "nodes")
            .iter()
            .any(|node| any_hit(node.pointer("/extensions/EXT_mesh_gpu_instancing/attributes")))
}

fn truncate(root: &mut Value, key: &str, length: usize) {
    if let Some(Value::Array(items)) = root.get_mut(key) {
        items.truncate(length);
    }
}
