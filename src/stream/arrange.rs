//! Puts the bytes of a GLB into the order in which a viewer wants them.

use super::StreamError;
use super::index::{self, pack};
use crate::baked::Baked;
use crate::gltf::{BufferStorage, Container, Document, json};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::ops::Range;
use svs_runtime::format::{EXTENSION_NAME, Extension};

/// Shorter JSON is not worth a compressed copy.
const LONG: usize = 128 << 10;
/// Room for the digits that change when the copy's own length is written into the JSON.
const SLACK: usize = 64;

/// What [`arrange`] did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Arranged {
    /// Pieces of the BIN chunk that were put into order.
    pub pieces: usize,
    /// Bytes of the compressed copy of the JSON; 0 if the JSON is short.
    pub index_bytes: usize,
}

/// Bytes that stay together, because buffer views overlap there.
struct Piece {
    range: Range<usize>,
    /// Buffer views in it.
    views: Vec<usize>,
}

/// Puts the BIN chunk into the order of streaming: the compressed JSON, the tables of the extension, proxies from coarse to
/// fine, then meshes by their baked importance per byte, images with the first mesh that shows them, and the rest.
///
/// Only `byteOffset` of buffer views changes, and the length of the buffer. [`restore`] undoes it.
///
/// # Errors
/// [`StreamError::Arrange`] if the document is no GLB, or has data that buffer views alone do not locate.
pub fn arrange(document: &mut Document) -> Result<Arranged, StreamError> {
    restore(document)?;
    require(document)?;
    let ranks = ranks(document);
    let pieces = order(document, |views| {
        views.iter().filter_map(|view| ranks.get(view)).min().copied().unwrap_or(u64::MAX)
    })?;
    let index_bytes = prepend_index(document)?;
    Ok(Arranged { pieces, index_bytes })
}

/// Puts the BIN chunk into the order of the buffer views and takes the compressed JSON out, if there is one: the order in
/// which [`crate::gltf::payload`] writes. Says whether there was one.
///
/// # Errors
/// [`StreamError::Arrange`] if the document changed so that it cannot be undone.
pub fn restore(document: &mut Document) -> Result<bool, StreamError> {
    let views = json::array(&document.json, "bufferViews");
    let is_index = |view: &Value| view.get("name").and_then(Value::as_str) == Some(index::NAME);
    let Some(at) = views.iter().position(is_index) else { return Ok(false) };
    require(document)?;
    let range = document.buffer_view_range(at)?.1;
    if at + 1 != views.len() || range.start != 0 || index::Header::read(&document.buffers[0]).is_none() {
        return Err(StreamError::Arrange {
            problem: "another tool has changed it since it was arranged; build it from its source again",
        });
    }
    document.buffers[0].drain(range.clone());
    if let Some(Value::Array(views)) = document.json.get_mut("bufferViews") {
        views.pop();
        for view in views.iter_mut() {
            let offset = view.get("byteOffset").and_then(json::index).unwrap_or(0);
            view["byteOffset"] = offset.saturating_sub(range.len()).into();
        }
    }
    set_length(document);
    order(document, |views| views.first().map_or(u64::MAX, |&view| view as u64))?;
    Ok(true)
}

fn set_length(document: &mut Document) {
    document.json["buffers"][0]["byteLength"] = document.buffers[0].len().into();
}

fn require(document: &Document) -> Result<(), StreamError> {
    let problem = if document.container() != Container::Glb
        || document.buffer_storage(0) != Some(&BufferStorage::Bin)
    {
        "only a .glb with its data in the file itself can be; name the output .glb"
    } else if json::array(&document.json, "bufferViews").iter().any(|view| view.get("extensions").is_some()) {
        "its buffer views have extensions (compressed data); decompress it first"
    } else {
        return Ok(());
    };
    Err(StreamError::Arrange { problem })
}

/// The pieces of buffer 0.
fn pieces(document: &Document) -> Result<Vec<Piece>, StreamError> {
    let bytes = &document.buffers[0];
    let mut views = Vec::new();
    for view in 0..json::array(&document.json, "bufferViews").len() {
        let (buffer, range) = document.buffer_view_range(view)?;
        if buffer == 0 {
            views.push((range, view));
        }
    }
    views.sort_by_key(|(range, view)| (range.start, range.end, *view));
    let mut pieces: Vec<Piece> = Vec::new();
    for (range, view) in views {
        // Bytes between that nobody names stay with what is before them, unless they are padding.
        let end = pieces.last().map_or(0, |piece| piece.range.end);
        let gap = bytes.get(end..range.start).unwrap_or_default();
        if range.start > end && (gap.len() > 3 || gap.iter().any(|&byte| byte != 0)) {
            match pieces.last_mut() {
                Some(piece) => piece.range.end = range.start,
                None => pieces.push(Piece { range: 0..range.start, views: Vec::new() }),
            }
        }
        match pieces.last_mut() {
            Some(piece) if range.start < piece.range.end => {
                piece.range.end = piece.range.end.max(range.end);
                piece.views.push(view);
            }
            _ => pieces.push(Piece { range, views: vec![view] }),
        }
    }
    let end = pieces.last().map_or(0, |piece| piece.range.end);
    let tail = &bytes[end..];
    if tail.len() > 3 || tail.iter().any(|&byte| byte != 0) {
        pieces.push(Piece { range: end..bytes.len(), views: Vec::new() });
    }
    Ok(pieces)
}

/// Sorts the pieces by `rank`, those of equal rank as they were. Returns how many there are.
fn order(document: &mut Document, rank: impl Fn(&[usize]) -> u64) -> Result<usize, StreamError> {
    let mut pieces = pieces(document)?;
    for piece in &mut pieces {
        piece.views.sort_unstable();
    }
    pieces.sort_by_cached_key(|piece| rank(&piece.views));
    let old = &document.buffers[0];
    let mut new = Vec::with_capacity(old.len() + pieces.len() * 4);
    let mut moved = BTreeMap::new();
    for piece in &pieces {
        // Alignment of what is inside counts from the buffer's begin.
        while new.len() % 4 != piece.range.start % 4 {
            new.push(0);
        }
        for &view in &piece.views {
            let start = document.buffer_view_range(view)?.1.start;
            moved.insert(view, new.len() + start - piece.range.start);
        }
        new.extend_from_slice(&old[piece.range.clone()]);
    }
    document.buffers[0] = new;
    set_offsets(document, &moved);
    set_length(document);
    Ok(pieces.len())
}

fn set_offsets(document: &mut Document, offsets: &BTreeMap<usize, usize>) {
    for (&view, &offset) in offsets {
        let view = &mut document.json["bufferViews"][view];
        // An absent offset is 0.
        if offset != 0 || view.get("byteOffset").is_some() {
            view["byteOffset"] = offset.into();
        }
    }
}

/// Puts the compressed JSON before everything else; returns its bytes.
fn prepend_index(document: &mut Document) -> Result<usize, StreamError> {
    let failed = || StreamError::Arrange { problem: "its JSON cannot be written" };
    let text = |document: &Document| serde_json::to_vec(&document.json).map_err(|_| failed());
    if text(document)?.len() < LONG {
        return Ok(0);
    }
    let offsets: BTreeMap<usize, usize> = (0..json::array(&document.json, "bufferViews").len())
        .map(|view| Ok((view, document.buffer_view_range(view)?)))
        .filter(|found| !matches!(found, Ok((_, (buffer, _))) if *buffer != 0))
        .map(|found: Result<_, StreamError>| found.map(|(view, (_, range))| (view, range.start)))
        .collect::<Result<_, _>>()?;
    let bytes = document.buffers[0].len();
    if let Some(views) = document.json.get_mut("bufferViews").and_then(Value::as_array_mut) {
        views.push(json!({"name": index::NAME, "buffer": 0, "byteOffset": 0, "byteLength": 0}));
    }
    let own = json::array(&document.json, "bufferViews").len().saturating_sub(1);
    // The copy holds its own length and all offsets, which depend on it: guessed, and guessed again if it was too little.
    let mut room = pack(&text(document)?).map_err(|_| failed())?.len();
    loop {
        room = (room + SLACK).next_multiple_of(4);
        set_offsets(document, &offsets.iter().map(|(&view, &offset)| (view, offset + room)).collect());
        document.json["bufferViews"][own]["byteLength"] = room.into();
        document.json["buffers"][0]["byteLength"] = (bytes + room).into();
        let mut packed = pack(&text(document)?).map_err(|_| failed())?;
        if packed.len() <= room {
            packed.resize(room, 0);
            packed.append(&mut document.buffers[0]);
            document.buffers[0] = packed;
            return Ok(room);
        }
        room = packed.len();
    }
}

/// When the bytes of each buffer view are wanted: smaller is earlier.
fn ranks(document: &Document) -> BTreeMap<usize, u64> {
    let root = &document.json;
    let view_of = |accessor: usize| {
        json::array(root, "accessors").get(accessor).and_then(|a| json::index(a.get("bufferView")?))
    };
    let mut ranks: BTreeMap<usize, u64> = BTreeMap::new();
    let mut put = |view: Option<usize>, rank: u64| {
        if let Some(view) = view {
            let old = ranks.entry(view).or_insert(rank);
            *old = rank.min(*old);
        }
    };
    let extension = root.get("extensions").and_then(|all| all.get(EXTENSION_NAME));
    let extension = extension.and_then(|json| <Extension as serde::Deserialize>::deserialize(json).ok());
    for accessor in extension.iter().flat_map(|e| e.trees.iter().flat_map(|tree| tree.accessors())) {
        put(view_of(accessor as usize), 0);
    }
    let (mut next, Ok((scene, baked))) = (1, Baked::read(document, true)) else { return ranks };
    let mut proxies: Vec<(u32, u32)> = (baked.trees().iter())
        .filter_map(|tree| tree.proxies())
        .flat_map(|proxies| proxies.nodes().iter().map(|node| (node.depth, node.mesh)))
        .collect();
    proxies.sort_unstable();
    let meshes =
        proxies.into_iter().map(|(_, mesh)| mesh as usize).chain(by_importance(document, &scene, &baked));
    let meshes: Vec<usize> = meshes.collect();
    for mesh in meshes {
        let Some(mesh) = json::array(root, "meshes").get(mesh) else { continue };
        for primitive in json::array(mesh, "primitives") {
            let attributes = primitive.get("attributes").and_then(Value::as_object);
            let attributes = attributes.into_iter().flat_map(|all| all.values());
            for accessor in attributes.chain(primitive.get("indices")).filter_map(json::index) {
                put(view_of(accessor), next);
            }
            for view in images_of(root, primitive) {
                put(Some(view), next);
            }
        }
        next += 1;
    }
    ranks
}

/// glTF meshes of the scene: those first of which most can be seen per byte.
fn by_importance(document: &Document, scene: &crate::scene::Scene, baked: &Baked) -> Vec<usize> {
    let mesh_of = |object: u32| {
        let node = scene.objects.get(object as usize)?.node;
        json::array(&document.json, "nodes").get(node).and_then(|node| json::index(node.get("mesh")?))
    };
    let mut worth: BTreeMap<usize, f64> = BTreeMap::new();
    for (draw, object) in baked.draws() {
        let tree = &baked.trees()[draw.tree as usize];
        let place = draw.object as usize;
        let (level, depth) = (u32::from(tree.max_level(place)), tree.depth(place));
        // Seen from outside the whole tree, or only from within some group of it.
        let share = if level >= depth { 1.0 } else { 1e-3 * f64::from(level + 1) / f64::from(depth + 1) };
        let area = f64::from(tree.importance_area(place, level.max(1)));
        if let Some(mesh) = mesh_of(object) {
            *worth.entry(mesh).or_default() += area * share;
        }
    }
    let mut meshes: Vec<(usize, f64)> = Vec::new();
    let mut seen = std::collections::BTreeSet::new();
    for (place, object) in scene.objects.iter().enumerate() {
        let Some(mesh) = mesh_of(place as u32).filter(|&mesh| seen.insert(mesh)) else { continue };
        let bytes = scene.meshes[object.mesh as usize].bytes.max(64) as f64;
        // What is in no tree may be anywhere: before what is hidden.
        meshes.push((mesh, worth.get(&mesh).copied().unwrap_or(1.0) / bytes));
    }
    meshes.sort_by(|a, b| b.1.total_cmp(&a.1));
    meshes.into_iter().map(|(mesh, _)| mesh).collect()
}

/// Buffer views of the images that a primitive's material names anywhere.
fn images_of(root: &Value, primitive: &Value) -> Vec<usize> {
    let material = primitive.get("material").and_then(json::index);
    let Some(material) = material.and_then(|m| json::array(root, "materials").get(m)) else {
        return Vec::new();
    };
    let mut pending = vec![material];
    let mut views = Vec::new();
    while let Some(value) = pending.pop() {
        let Some(object) = value.as_object() else { continue };
        for (key, value) in object {
            if key.ends_with("Texture") {
                let texture = value.get("index").and_then(json::index);
                let texture = texture.and_then(|texture| json::array(root, "textures").get(texture));
                let image = texture.and_then(|texture| json::index(texture.get("source")?));
                let image = image.and_then(|image| json::array(root, "images").get(image));
                views.extend(image.and_then(|image| json::index(image.get("bufferView")?)));
            }
            pending.push(value);
        }
    }
    views
}
