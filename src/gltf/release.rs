//! Taking bytes out of the buffers that nobody refers to any more, and appending index lists.
//!
//! Nothing is renumbered: entries of `meshes`, `accessors` and `bufferViews` stay where they are. An accessor whose
//! bytes go becomes three zeros without a buffer view, which glTF allows (a dead mesh is then a point); a buffer view of
//! nothing else shrinks to a few bytes of its buffer.

use super::buffers::BufferStorage;
use super::document::{Container, Document};
use super::{json, uri};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::ops::Range;

/// What [`release`] has done.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Released {
    /// Bytes that are gone from the buffers.
    pub bytes: u64,
    /// Why bytes that nobody seems to use are still there, if so.
    pub kept_because: Option<String>,
}

/// Extensions that refer to no buffer view, and to no accessor but where [`references`] looks. Any other may, in
/// ways not known here.
const HARMLESS: [&str; 38] = [
    "EXT_lights_ies",
    "EXT_lights_image_based",
    "EXT_mesh_gpu_instancing",
    "EXT_spherical_visibility",
    "EXT_texture_avif",
    "EXT_texture_webp",
    "KHR_animation_pointer",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_common",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_materials_volume_scatter",
    "KHR_mesh_quantization",
    "KHR_node_hoverability",
    "KHR_node_selectability",
    "KHR_node_visibility",
    "KHR_texture_basisu",
    "KHR_texture_transform",
    "KHR_techniques_webgl",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "MSFT_lod",
    "MSFT_packing_normalRoughnessMetallic",
    "MSFT_packing_occlusionRoughnessMetallic",
    "MSFT_texture_dds",
    "GODOT_single_root",
];

/// Bytes go in multiples of this only, so that what follows keeps its alignment.
const STEP: usize = 16;

/// Endings of the files that external buffers become when bytes go from them: the source's own are never rewritten.
const ENDINGS: [&str; 4] = [".visible.bin", ".visible-1.bin", ".visible-2.bin", ".visible-3.bin"];

impl Document {
    /// Bytes of the JSON, without white space, and of all buffers.
    pub fn bytes(&self) -> u64 {
        struct Count(u64);
        impl std::io::Write for Count {
            fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
                self.0 += bytes.len() as u64;
                Ok(bytes.len())
            }
            fn flush(&mut self) -> std::io::Result<()> {
                Ok(())
            }
        }
        // Data URIs are the buffers once more.
        let mut count = Count(0);
        let json = serde_json::to_writer(&mut count, &self.json).map_or(0, |()| count.0);
        let uris = json::array(&self.json, "buffers").iter().filter_map(|b| b.get("uri")?.as_str());
        let uris: u64 = uris.filter(|uri| uri::is_data(uri)).map(|uri| uri.len() as u64).sum();
        json - uris.min(json) + self.buffer_bytes()
    }
}

/// Appends index lists, each with its component type (5121, 5123 or 5125, large enough for its numbers) and at least
/// one number, as accessors one after the other; returns the first one's index, `None` if there is no list or
/// nowhere to append.
pub fn append_indices(document: &mut Document, lists: &[(usize, &[u32])]) -> Option<usize> {
    if lists.is_empty() || !document.json.get("accessors").is_some_and(Value::is_array) {
        return None;
    }
    let mut bytes = Vec::new();
    let mut places = Vec::new();
    for (component, list) in lists {
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        places.push(bytes.len());
        for number in *list {
            let word = number.to_le_bytes();
            bytes.extend_from_slice(match component {
                5121 => &word[..1],
                5123 => &word[..2],
                _ => &word,
            });
        }
    }
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    let (buffer, offset) = append_bytes(document, &bytes)?;
    let length = bytes.len();
    let view = push(
        &mut document.json,
        "bufferViews",
        json!({"buffer": buffer, "byteOffset": offset, "byteLength": length, "target": 34963}),
    )?;
    let mut first = None;
    for ((component, list), place) in lists.iter().zip(places) {
        let accessor = json!({
            "bufferView": view, "byteOffset": place, "componentType": component, "count": list.len(), "type": "SCALAR"
        });
        let index = push(&mut document.json, "accessors", accessor)?;
        first.get_or_insert(index);
    }
    first
}

fn push(root: &mut Value, key: &str, item: Value) -> Option<usize> {
    let items = root.as_object_mut()?.entry(key).or_insert_with(|| json!([])).as_array_mut()?;
    items.push(item);
    Some(items.len() - 1)
}

/// Appends to the BIN chunk, or adds a buffer; returns the buffer and the offset, a multiple of 4.
fn append_bytes(document: &mut Document, bytes: &[u8]) -> Option<(usize, usize)> {
    if document.storage.first() == Some(&BufferStorage::Bin) && document.bin_tail.is_empty() {
        let buffer = document.buffers.first_mut()?;
        let start = buffer.len().next_multiple_of(4);
        buffer.resize(start, 0);
        buffer.extend_from_slice(bytes);
        document.json["buffers"][0]["byteLength"] = buffer.len().into();
        return Some((0, start));
    }
    let is_file =
        |storage: &BufferStorage| matches!(storage, BufferStorage::External | BufferStorage::Beside(_));
    let in_file = document.container() == Container::Gltf && document.storage.iter().any(is_file);
    let mut buffer = json!({"byteLength": bytes.len()});
    if !in_file {
        buffer["uri"] = uri::encode_data(bytes).into();
    }
    let index = push(&mut document.json, "buffers", buffer)?;
    let storage = if in_file { BufferStorage::Beside(".indices.bin") } else { BufferStorage::Embedded };
    document.buffers.push(bytes.to_vec());
    document.storage.push(storage);
    Some((index, 0))
}

/// Lets go of the data of meshes that no node draws any more and of `replaced` accessors, as far as nothing else uses
/// it. A file with an extension or a compressed buffer view that may refer to data in ways not known here keeps all
/// of it.
pub fn release(
    document: &mut Document,
    dead_meshes: &BTreeSet<usize>,
    replaced: &BTreeSet<usize>,
) -> Released {
    let before = document.buffer_bytes();
    let kept = |reason: String| Released { bytes: 0, kept_because: Some(reason) };
    if let Some(name) = unknown_extension(&document.json) {
        return kept(format!("the extension {name} may refer to them"));
    }
    let views = json::array(&document.json, "bufferViews");
    if views.iter().any(|view| view.get("extensions").is_some()) {
        return kept("buffer views are compressed".to_owned());
    }
    if document.buffers.len() != json::array(&document.json, "buffers").len() {
        return kept("buffers are missing".to_owned());
    }
    let dead = dead_accessors(&document.json, dead_meshes, replaced);
    let Some(plan) = Plan::new(document, &dead) else {
        return kept("accessors cannot be followed".to_owned());
    };
    let is_external = |buffer: &usize| document.storage[*buffer] == BufferStorage::External;
    let changed: Vec<usize> = (0..document.buffers.len()).filter(|&b| !plan.gaps[b].is_empty()).collect();
    if changed.iter().filter(|buffer| is_external(buffer)).count() > ENDINGS.len() {
        return kept("they are in too many files".to_owned());
    }
    plan.apply(document, &dead);
    let mut endings = ENDINGS.iter();
    for buffer in changed {
        let length = document.buffers[buffer].len();
        document.json["buffers"][buffer]["byteLength"] = length.into();
        match document.storage[buffer] {
            BufferStorage::Embedded => {
                document.json["buffers"][buffer]["uri"] = uri::encode_data(&document.buffers[buffer]).into();
            }
            BufferStorage::External => {
                document.storage[buffer] =
                    BufferStorage::Beside(endings.next().copied().unwrap_or(ENDINGS[0]));
            }
            _ => {}
        }
    }
    Released { bytes: before.saturating_sub(document.buffer_bytes()), kept_because: None }
}

/// An extension that may refer to buffer views or accessors: one that is declared or present and not known to be
/// harmless.
fn unknown_extension(root: &Value) -> Option<String> {
    let harmless = |name: &str| HARMLESS.contains(&name);
    let declared = json::array(root, "extensionsUsed").iter().chain(json::array(root, "extensionsRequired"));
    if let Some(name) = declared.map(|name| name.as_str().unwrap_or("?")).find(|name| !harmless(name)) {
        return Some(name.to_owned());
    }
    // The depth of parsed JSON is bounded, but a stack costs nothing.
    let mut stack = vec![root];
    while let Some(value) = stack.pop() {
        match value {
            Value::Array(items) => stack.extend(items),
            Value::Object(map) => {
                for (key, value) in map {
                    if key == "extensions"
                        && let Some(name) =
                            value.as_object().and_then(|all| all.keys().find(|name| !harmless(name)))
                    {
                        return Some(name.clone());
                    }
                    if key != "extras" {
                        stack.push(value);
                    }
                }
            }
            _ => {}
        }
    }
    None
}

/// Accessors of a primitive's attributes, morph targets included; and its indices.
fn of_primitive(primitive: &Value) -> (Vec<usize>, Option<usize>) {
    let targets = json::array(primitive, "targets").iter();
    let maps = primitive.get("attributes").into_iter().chain(targets).filter_map(Value::as_object);
    let attributes = maps.flat_map(|map| map.values()).filter_map(json::index).collect();
    (attributes, primitive.get("indices").and_then(json::index))
}

/// Accessors that anything but the dead meshes refers to.
fn references(root: &Value, dead_meshes: &BTreeSet<usize>) -> BTreeSet<usize> {
    let mut live = BTreeSet::new();
    let alive = |(mesh, _): &(usize, &Value)| !dead_meshes.contains(mesh);
    for (_, mesh) in json::array(root, "meshes").iter().enumerate().filter(alive) {
        for primitive in json::array(mesh, "primitives") {
            let (attributes, indices) = of_primitive(primitive);
            live.extend(attributes.into_iter().chain(indices));
        }
    }
    let mut add = |value: Option<&Value>| live.extend(value.and_then(json::index));
    json::array(root, "skins").iter().for_each(|skin| add(skin.get("inverseBindMatrices")));
    for sampler in json::array(root, "animations").iter().flat_map(|a| json::array(a, "samplers")) {
        add(sampler.get("input"));
        add(sampler.get("output"));
    }
    for node in json::array(root, "nodes") {
        let instances = node.pointer("/extensions/EXT_mesh_gpu_instancing/attributes");
        let instances = instances.and_then(Value::as_object);
        instances.into_iter().flat_map(|map| map.values()).for_each(|value| add(Some(value)));
    }
    live
}

/// Accessors that can go: nobody else uses them, and no dead primitive would have
/// attributes of two lengths or indices beyond them.
fn dead_accessors(
    root: &Value,
    dead_meshes: &BTreeSet<usize>,
    replaced: &BTreeSet<usize>,
) -> BTreeSet<usize> {
    let mut live = references(root, dead_meshes);
    let meshes = json::array(root, "meshes");
    let primitives = dead_meshes.iter().filter_map(|&mesh| meshes.get(mesh));
    let primitives: Vec<_> =
        primitives.flat_map(|mesh| json::array(mesh, "primitives")).map(of_primitive).collect();
    loop {
        let count = live.len();
        for (attributes, indices) in &primitives {
            // Indices of all vertices need all vertices; zeros for indices need only one.
            if attributes.iter().chain(indices).any(|accessor| live.contains(accessor)) {
                live.extend(attributes);
            }
        }
        if live.len() == count {
            break;
        }
    }
    let all = primitives.iter().flat_map(|(attributes, indices)| attributes.iter().chain(indices));
    all.chain(replaced).copied().filter(|accessor| !live.contains(accessor)).collect()
}

/// The ranges of bytes that go, by buffer: ascending, disjoint, each a multiple of [`STEP`] long.
struct Plan {
    gaps: Vec<Vec<Range<usize>>>,
    /// Bytes of the gaps before each gap.
    sums: Vec<Vec<usize>>,
}

impl Plan {
    /// `None` if a live accessor leaves its buffer view: better not to touch such a file.
    fn new(document: &Document, dead: &BTreeSet<usize>) -> Option<Plan> {
        let root = &document.json;
        let views = json::array(root, "bufferViews");
        let buffers = document.buffers.len();
        let mut dead_ranges: Vec<Vec<Range<usize>>> = vec![Vec::new(); buffers];
        let mut live_ranges: Vec<Vec<Range<usize>>> = vec![Vec::new(); buffers];
        let mut of_accessors = vec![false; views.len()];
        for (index, accessor) in json::array(root, "accessors").iter().enumerate() {
            let parts =
                [Some(accessor), accessor.pointer("/sparse/indices"), accessor.pointer("/sparse/values")];
            for (part, json) in parts.into_iter().enumerate().filter_map(|(part, json)| Some((part, json?))) {
                let Some(view) = json.get("bufferView").and_then(json::index) else { continue };
                *of_accessors.get_mut(view)? = true;
                let (buffer, whole) = place(views, view)?;
                // Sparse parts are few: their views stay or go as a whole.
                let range = if part == 0 { extent(document, index, json, &whole)? } else { whole };
                let ranges = if dead.contains(&index) { &mut dead_ranges } else { &mut live_ranges };
                ranges.get_mut(buffer)?.push(range);
            }
        }
        let images = json::array(root, "images").iter().filter_map(|image| image.get("bufferView"));
        let images: BTreeSet<usize> = images.filter_map(json::index).collect();
        for view in (0..views.len()).filter(|view| images.contains(view) || !of_accessors[*view]) {
            let (buffer, whole) = place(views, view)?;
            live_ranges.get_mut(buffer)?.push(whole);
        }
        let gaps = dead_ranges.into_iter().zip(live_ranges).zip(&document.buffers);
        let gaps: Vec<_> = gaps.map(|((dead, live), bytes)| gaps_of(dead, live, bytes.len())).collect();
        let running = |gaps: &Vec<Range<usize>>| {
            gaps.iter()
                .scan(0, |sum, gap| {
                    let before = *sum;
                    *sum += gap.len();
                    Some(before)
                })
                .collect()
        };
        let sums = gaps.iter().map(running).collect();
        Some(Plan { gaps, sums })
    }

    fn apply(&self, document: &mut Document, dead: &BTreeSet<usize>) {
        let views: Vec<Option<(usize, Range<usize>)>> = {
            let views = json::array(&document.json, "bufferViews");
            (0..views.len()).map(|view| place(views, view)).collect()
        };
        if let Some(Value::Array(accessors)) = document.json.get_mut("accessors") {
            for (index, accessor) in accessors.iter_mut().enumerate() {
                if dead.contains(&index) {
                    make_zeros(accessor);
                } else {
                    self.shift_accessor(accessor, &views);
                    for part in ["/sparse/indices", "/sparse/values"] {
                        if let Some(part) = accessor.pointer_mut(part) {
                            self.shift_accessor(part, &views);
                        }
                    }
                }
            }
        }
        let lengths: Vec<usize> = document.buffers.iter().map(Vec::len).collect();
        if let Some(Value::Array(items)) = document.json.get_mut("bufferViews") {
            for (item, place) in items.iter_mut().zip(&views) {
                let Some((buffer, range)) = place else { continue };
                let (start, end) = (self.moved(*buffer, range.start), self.moved(*buffer, range.end));
                let stride = item.get("byteStride").and_then(json::index).unwrap_or(1);
                if end - start == range.len() || end - start >= stride.max(1) {
                    set(item, "byteOffset", range.start, start);
                    set(item, "byteLength", range.len(), end - start);
                } else {
                    // Nobody reads it: any bytes will do.
                    let left = self.moved(*buffer, lengths[*buffer]);
                    set(item, "byteOffset", range.start, 0);
                    set(item, "byteLength", range.len(), left.min(4));
                    if let Value::Object(item) = item {
                        item.shift_remove("byteStride");
                    }
                }
            }
        }
        for (bytes, gaps) in document.buffers.iter_mut().zip(&self.gaps) {
            let mut to = 0;
            let mut from = 0;
            for gap in gaps {
                bytes.copy_within(from..gap.start, to);
                to += gap.start - from;
                from = gap.end;
            }
            let end = bytes.len();
            bytes.copy_within(from..end, to);
            bytes.truncate(to + end - from);
        }
    }

    /// Where a byte is afterwards; one that goes: where the next one that stays is.
    fn moved(&self, buffer: usize, place: usize) -> usize {
        let (Some(gaps), Some(sums)) = (self.gaps.get(buffer), self.sums.get(buffer)) else { return place };
        match gaps.partition_point(|gap| gap.start < place).checked_sub(1) {
            None => place,
            Some(last) => place - sums[last] - (gaps[last].end.min(place) - gaps[last].start),
        }
    }

    fn shift_accessor(&self, accessor: &mut Value, views: &[Option<(usize, Range<usize>)>]) {
        let Some(view) = accessor.get("bufferView").and_then(json::index) else { return };
        let Some(Some((buffer, range))) = views.get(view) else { return };
        let old = accessor.get("byteOffset").and_then(json::index).unwrap_or(0);
        let new = self.moved(*buffer, range.start + old) - self.moved(*buffer, range.start);
        set(accessor, "byteOffset", old, new);
    }
}

/// Buffer and range of a buffer view.
fn place(views: &[Value], view: usize) -> Option<(usize, Range<usize>)> {
    let view = views.get(view)?;
    let number = |key: &str| view.get(key).map_or(Some(0), json::index);
    let (buffer, start) = (json::index(view.get("buffer")?)?, number("byteOffset")?);
    Some((buffer, start..start.checked_add(number("byteLength")?)?))
}

/// Bytes of an accessor in its buffer, from its first element to the end of its last.
fn extent(document: &Document, index: usize, json: &Value, view: &Range<usize>) -> Option<Range<usize>> {
    let accessor = document.accessor(index).ok()?;
    let stride = accessor.base.map(|base| base.stride)?;
    let element = accessor.kind.element_size(accessor.component_type);
    let start = view.start.checked_add(json.get("byteOffset").map_or(Some(0), json::index)?)?;
    let length = match accessor.count.checked_sub(1) {
        None => 0,
        Some(last) => last.checked_mul(stride)?.checked_add(element)?,
    };
    Some(start..start.checked_add(length)?)
}

/// What is dead and not live, cut to multiples of [`STEP`]; some bytes of the buffer stay in any case.
fn gaps_of(mut dead: Vec<Range<usize>>, mut live: Vec<Range<usize>>, length: usize) -> Vec<Range<usize>> {
    dead.sort_unstable_by_key(|range| (range.start, range.end));
    live.sort_unstable_by_key(|range| (range.start, range.end));
    // Padding between two dead ranges goes with them.
    let mut merged: Vec<Range<usize>> = Vec::new();
    for range in dead.into_iter().filter(|range| !range.is_empty()) {
        match merged.last_mut() {
            Some(last) if range.start <= last.end + 3 => last.end = last.end.max(range.end),
            _ => merged.push(range),
        }
    }
    let mut gaps = Vec::new();
    let mut next_live = 0;
    for range in merged {
        let mut start = range.start;
        let end = range.end.min(length);
        // Live ranges may overlap each other, and one may reach over several dead ones.
        let mut at = next_live;
        while at < live.len() && live[at].start < end {
            if live[at].end > start {
                push_gap(&mut gaps, start..live[at].start.max(start));
                start = live[at].end;
            }
            at += 1;
        }
        push_gap(&mut gaps, start..end.max(start));
        while next_live < live.len() && live[next_live].end <= range.start {
            next_live += 1;
        }
    }
    if gaps.iter().map(|gap: &Range<usize>| gap.len()).sum::<usize>() + STEP > length {
        // glTF has no empty buffers.
        if let Some(last) = gaps.last_mut() {
            last.end -= STEP;
        }
        gaps.retain(|gap| !gap.is_empty());
    }
    gaps
}

/// A buffer view may begin where a gap does: that must be a place for numbers of four bytes.
fn push_gap(gaps: &mut Vec<Range<usize>>, range: Range<usize>) {
    let start = range.start.next_multiple_of(4);
    let length = range.end.saturating_sub(start) / STEP * STEP;
    if length > 0 {
        gaps.push(start..start + length);
    }
}

/// An accessor of three zeros: valid as positions, as indices of one triangle, as anything a primitive has.
fn make_zeros(accessor: &mut Value) {
    let Value::Object(accessor) = accessor else { return };
    for key in ["bufferView", "byteOffset", "sparse"] {
        accessor.shift_remove(key);
    }
    accessor.insert("count".into(), 3.into());
    for key in ["min", "max"] {
        if let Some(Value::Array(bounds)) = accessor.get_mut(key) {
            bounds.fill(0.into());
        }
    }
}

/// Writes a number only if it changes: the text of the others stays as it is.
fn set(object: &mut Value, key: &str, old: usize, new: usize) {
    if old != new {
        object[key] = new.into();
    }
}
