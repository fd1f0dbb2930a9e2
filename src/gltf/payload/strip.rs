//! Taking the payload out again.

use super::lod::OwnNodes;
use super::{CONTAINERS, EXTENSION};
use crate::gltf::buffers::BufferStorage;
use crate::gltf::compressed::MESHOPT;
use crate::gltf::document::Document;
use crate::gltf::json;
use serde_json::{Map, Value};
use std::collections::BTreeSet;
use std::ops::Range;

/// Removes the extension and everything that [`super::attach`] added; returns whether there was any.
///
/// After `attach` the document is exactly what it was before. If other tools have appended objects since, or refer to
/// the payload's accessors, the extension goes and its accessors stay, unreferenced: nothing of the file is lost.
///
/// A file that was arranged for streaming is put back into the order of its buffer views first, see [`crate::stream`].
pub fn strip(document: &mut Document) -> bool {
    // What cannot be undone is kept as other tools' changes are.
    let _ = crate::stream::restore(document);
    let Some(Value::Object(extensions)) = document.json.get_mut("extensions") else { return false };
    let Some(extension) = extensions.shift_remove(EXTENSION) else { return false };
    let before = extension.pointer("/extras/before").and_then(Value::as_object).cloned().unwrap_or_default();
    if before.get("declared") != Some(&Value::Bool(true)) {
        remove_name(&mut document.json, "extensionsUsed", EXTENSION);
    }
    // Never ours, but a file that requires what it does not have would open nowhere.
    if remove_name(&mut document.json, "extensionsRequired", EXTENSION)
        && json::array(&document.json, "extensionsRequired").is_empty()
        && let Value::Object(root) = &mut document.json
    {
        root.shift_remove("extensionsRequired");
    }
    let mut touched = vec!["extensionsUsed", "extensions"];
    if let Some(removed) = remove_payload(document, &extension, &before) {
        touched.extend(removed);
        for (list, record) in [("extensionsUsed", "used"), ("extensionsRequired", "required")] {
            for name in before.get(record).and_then(Value::as_array).into_iter().flatten() {
                if remove_name(&mut document.json, list, name.as_str().unwrap_or_default()) {
                    touched.push(list);
                }
            }
        }
    } else if !table_accessors(&extension).is_empty() {
        touched.extend(["buffers", "bufferViews", "accessors"]);
    }
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
            if is_empty && !was_empty(key) && touched.contains(&key) {
                root.shift_remove(key);
            }
        }
    }
    document.views_changed();
    true
}

/// Removes a name from a list; returns whether it was there.
fn remove_name(root: &mut Value, key: &str, name: &str) -> bool {
    let Some(Value::Array(names)) = root.get_mut(key) else { return false };
    let count = names.len();
    names.retain(|known| known != name);
    names.len() < count
}

/// Accessors that the extension's trees name.
fn table_accessors(extension: &Value) -> BTreeSet<usize> {
    json::array(extension, "trees")
        .iter()
        .flat_map(|tree| [tree.get("tables"), tree.pointer("/proxies/tables")])
        .filter_map(|tables| tables?.as_object())
        .flat_map(|tables| tables.values().filter_map(json::index))
        .collect()
}

/// Removes nodes, meshes, materials, accessors, buffer views and bytes if they are still the last ones and nobody else uses them;
/// returns the containers they were in.
fn remove_payload(
    document: &mut Document,
    extension: &Value,
    before: &Map<String, Value>,
) -> Option<Vec<&'static str>> {
    let own = Own::find(document, extension, before)?;
    let region = own.region(document, before)?;
    let last_buffer = region.buffer + 1 + usize::from(region.fallback) == document.buffers.len();
    let objects = json::array(&document.json, "buffers");
    if [objects.len(), document.storage.len()] != [document.buffers.len(); 2]
        || !objects[region.buffer].is_object()
        || (region.old_length.is_none() && !last_buffer)
    {
        return None;
    }
    let mut touched = vec!["buffers", "bufferViews", "accessors"];
    truncate(&mut document.json, "accessors", own.accessors);
    truncate(&mut document.json, "bufferViews", own.views);
    own.nodes.remove(&mut document.json, before);
    for (key, length) in [("meshes", own.meshes), ("materials", own.materials)] {
        if length < json::array(&document.json, key).len() {
            truncate(&mut document.json, key, length);
            touched.push(key);
        }
    }
    if region.fallback {
        document.buffers.pop();
        document.storage.pop();
        truncate(&mut document.json, "buffers", document.buffers.len());
    }
    match region.old_length {
        Some(old) => {
            document.buffers[region.buffer].truncate(old);
            document.json["buffers"][region.buffer]["byteLength"] =
                before.get("byteLength").cloned().unwrap_or_else(|| old.into());
        }
        None => {
            document.buffers.pop();
            document.storage.pop();
            truncate(&mut document.json, "buffers", region.buffer);
        }
    }
    Some(touched)
}

/// Where what is ours begins in each array; it reaches to the end.
struct Own {
    accessors: usize,
    views: usize,
    meshes: usize,
    materials: usize,
    nodes: OwnNodes,
}

/// The bytes of the payload.
struct Region {
    buffer: usize,
    /// Where the buffer ended before; `None` if it did not exist.
    old_length: Option<usize>,
    /// The last buffer is the fallback of compressed views.
    fallback: bool,
}

impl Own {
    /// `None` if there is nothing, or if anything of it is not last, or used by others.
    fn find(document: &Document, extension: &Value, before: &Map<String, Value>) -> Option<Self> {
        let root = &document.json;
        let all_meshes = json::array(root, "meshes");
        let meshes = trailing(&meshes_of(document, extension)?, all_meshes.len())?;
        let names_mesh = |node: &Value| {
            node.get("mesh")
                .and_then(json::index)
                .is_some_and(|mesh| (meshes..all_meshes.len()).contains(&mesh))
        };
        let nodes = OwnNodes::find(root, before, meshes..all_meshes.len())?;
        if json::array(root, "nodes")[..nodes.first].iter().any(names_mesh) {
            return None;
        }
        let mut accessors = table_accessors(extension);
        accessors.extend(all_meshes[meshes..].iter().flat_map(accessors_of_mesh));
        let all_accessors = json::array(root, "accessors");
        let first_accessor = trailing(&accessors, all_accessors.len())?;
        let views: Option<BTreeSet<usize>> = all_accessors[first_accessor..]
            .iter()
            .map(|accessor| accessor.get("bufferView").and_then(json::index))
            .collect();
        let all_views = json::array(root, "bufferViews").len();
        let first_view = trailing(&views?, all_views)?;
        let mentions = |accessor: &Value| (first_view..all_views).any(|view| mentions_view(accessor, view));
        let in_view = |image: &Value| {
            image
                .get("bufferView")
                .and_then(json::index)
                .is_some_and(|view| (first_view..all_views).contains(&view))
        };
        if accessors.is_empty()
            || first_view == all_views
            || all_accessors[..first_accessor].iter().any(mentions)
            || json::array(root, "images").iter().any(in_view)
            || scene_uses_accessors(root, first_accessor..all_accessors.len(), meshes)
        {
            return None;
        }
        let materials = first_own_material(root, meshes);
        Some(Self { accessors: first_accessor, views: first_view, meshes, materials, nodes })
    }

    fn region(&self, document: &Document, before: &Map<String, Value>) -> Option<Region> {
        let views = json::array(&document.json, "bufferViews");
        let is_fallback = |buffer: usize| {
            let last = buffer + 1 == document.buffers.len();
            last && document.buffer_storage(buffer) == Some(&BufferStorage::Absent)
        };
        let mut buffer = None;
        let mut fallback = false;
        let (mut start, mut end) = (usize::MAX, 0);
        for view in &views[self.views..] {
            let view = match view.get("extensions").and_then(|all| all.get(MESHOPT)) {
                None => view,
                Some(stored) if is_fallback(json::index(view.get("buffer")?)?) => {
                    fallback = true;
                    stored
                }
                Some(_) => return None,
            };
            let own = json::index(view.get("buffer")?)?;
            if *buffer.get_or_insert(own) != own {
                return None;
            }
            let offset = view.get("byteOffset").map_or(Some(0), json::index)?;
            start = start.min(offset);
            end = end.max(offset.checked_add(json::index(view.get("byteLength")?)?)?);
        }
        let buffer = buffer?;
        let used_by_others = |buffer| views[..self.views].iter().any(|view| end_in(view, buffer).is_some());
        if fallback && (buffer + 1 == document.buffers.len() || used_by_others(document.buffers.len() - 1)) {
            return None;
        }
        let others = views[..self.views].iter().filter_map(|view| end_in(view, buffer));
        let free_from = others.max().unwrap_or(0);
        let old_length = match before.get("byteLength") {
            Some(stood) => Some(json::index(stood).filter(|&stood| stood <= start && start - stood < 4)?),
            None => (start > 0).then_some(start),
        };
        if end != document.buffers.get(buffer)?.len() || free_from > old_length.unwrap_or(0) {
            return None;
        }
        Some(Region { buffer, old_length, fallback })
    }
}

/// First index of a set that must be the last indices of an array; the array's length for an empty set.
fn trailing(set: &BTreeSet<usize>, length: usize) -> Option<usize> {
    let first = length.checked_sub(set.len())?;
    (set.iter().copied().eq(first..length)).then_some(first)
}

/// Meshes that the extension names as simplified ones. `None` if a table cannot be read.
fn meshes_of(document: &Document, extension: &Value) -> Option<BTreeSet<usize>> {
    let levels = json::array(extension, "meshLevels").iter().flat_map(|entry| json::array(entry, "levels"));
    let mut meshes: BTreeSet<usize> = levels.filter_map(|level| json::index(level.get("mesh")?)).collect();
    for tree in json::array(extension, "trees") {
        if let Some(table) = tree.pointer("/proxies/tables/PROXY_MESH").and_then(json::index) {
            let named = document.accessor(table).ok()?.read_indices_u32().ok()?;
            meshes.extend(named.into_iter().map(|mesh| mesh as usize));
        }
    }
    Some(meshes)
}

/// Accessors of a mesh's vertices and indices.
fn accessors_of_mesh(mesh: &Value) -> impl Iterator<Item = usize> {
    json::array(mesh, "primitives").iter().flat_map(|primitive| {
        let attributes = primitive.get("attributes").and_then(Value::as_object);
        let attributes = attributes.into_iter().flat_map(|all| all.values());
        attributes.chain(primitive.get("indices")).filter_map(json::index)
    })
}

/// The materials at the end of the list that only meshes from `meshes` on use.
fn first_own_material(root: &Value, meshes: usize) -> usize {
    let used_by = |list: &[Value]| -> BTreeSet<usize> {
        let primitives = list.iter().flat_map(|mesh| json::array(mesh, "primitives"));
        let mut used = BTreeSet::new();
        for primitive in primitives {
            used.extend(primitive.get("material").and_then(json::index));
            let variants = primitive.pointer("/extensions/KHR_materials_variants");
            let mappings = variants.map_or(&[][..], |variants| json::array(variants, "mappings"));
            used.extend(mappings.iter().filter_map(|mapping| json::index(mapping.get("material")?)));
        }
        used
    };
    let all = json::array(root, "meshes");
    let (others, own) = (used_by(&all[..meshes]), used_by(&all[meshes..]));
    let mut first = json::array(root, "materials").len();
    while first > 0 && own.contains(&(first - 1)) && !others.contains(&(first - 1)) {
        first -= 1;
    }
    first
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

/// Whether one of the first `meshes` meshes, skins, animations or instances use one of these accessors.
fn scene_uses_accessors(root: &Value, accessors: Range<usize>, meshes: usize) -> bool {
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
    let meshes = json::array(root, "meshes").get(..meshes).unwrap_or_default();
    meshes.iter().any(|mesh| json::array(mesh, "primitives").iter().any(primitive))
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
