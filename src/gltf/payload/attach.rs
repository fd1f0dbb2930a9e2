//! Adding the payload.

use super::{Additions, CONTAINERS, Compression, EXTENSION, Table, lod};
use crate::gltf::buffers::BufferStorage;
use crate::gltf::compressed::MESHOPT;
use crate::gltf::document::{Container, Document};
use crate::gltf::error::AttachError;
use crate::gltf::kinds::{AccessorKind, ComponentType};
use crate::gltf::{json, uri};
use serde_json::{Map, Number, Value, json};

/// [`attach_with`] without additions.
///
/// # Errors
/// As [`attach_with`].
pub fn attach(
    document: &mut Document,
    extension: Value,
    tables: &[Table],
) -> Result<Vec<usize>, AttachError> {
    attach_with(document, extension, tables, Additions::default())
}

/// Adds `additions`, `tables` and the root extension to the document; returns the indices of the tables' accessors.
///
/// Table `i` becomes accessor `document.next_accessor() + additions.accessors.len() + i`, so `extension` can be built before
/// the call. [`super::strip`] finds the tables through the integers in `trees[].tables` and `trees[].proxies.tables` of the
/// extension, and the meshes through `meshLevels` and the tables `PROXY_MESH`: name everything there.
///
/// # Errors
/// [`AttachError`] if there is a bake already, or a table or the JSON is not as it must be. The document is unchanged
/// then.
pub fn attach_with(
    document: &mut Document,
    extension: Value,
    tables: &[Table],
    additions: Additions,
) -> Result<Vec<usize>, AttachError> {
    check_root(document)?;
    let Value::Object(mut extension) = extension else {
        return Err(AttachError::Malformed {
            pointer: format!("/extensions/{EXTENSION}"),
            expected: "an object",
        });
    };
    if extension.get("extras").is_some_and(|extras| !extras.is_object()) {
        let pointer = format!("/extensions/{EXTENSION}/extras");
        return Err(AttachError::Malformed { pointer, expected: "an object" });
    }
    let bounds =
        tables.iter().enumerate().map(|(i, table)| check_table(i, table)).collect::<Result<Vec<_>, _>>()?;

    let mut before = Map::new();
    record_empty_containers(&document.json, tables.is_empty(), &additions, &mut before);
    let first = document.next_accessor() + additions.accessors.len();
    let first_view = json::array(&document.json, "bufferViews").len();
    let first_table_view = first_view + additions.views.len();
    let (table_bytes, table_offsets) = pack(tables.iter().map(|table| table.bytes));
    let blocks = additions.views.iter().map(|view| view.bytes.as_slice());
    let (bytes, offsets) = pack(blocks.chain((!tables.is_empty()).then_some(table_bytes.as_slice())));
    if !bytes.is_empty() {
        let (buffer, start) = append_bytes(document, &bytes, &mut before);
        let mut fallback = Fallback { buffer: document.buffers.len(), length: 0 };
        for (view, offset) in additions.views.iter().zip(&offsets) {
            let place =
                json!({"buffer": buffer, "byteOffset": start + offset, "byteLength": view.bytes.len()});
            let mut new = match &view.compression {
                None => place,
                Some(compression) => fallback.view(compression, place),
            };
            if let Some(stride) = view.stride {
                new["byteStride"] = stride.into();
            }
            if let Some(target) = view.target {
                new["target"] = target.into();
            }
            push(&mut document.json, "bufferViews", new);
        }
        fallback.attach(document);
        if let (false, Some(offset)) = (tables.is_empty(), offsets.last()) {
            let new =
                json!({"buffer": buffer, "byteOffset": start + offset, "byteLength": table_bytes.len()});
            push(&mut document.json, "bufferViews", new);
        }
    }
    add_objects(document, additions, first_view, &mut before);
    for ((table, offset), bounds) in tables.iter().zip(table_offsets).zip(bounds) {
        push(&mut document.json, "accessors", accessor(first_table_view, offset, table, bounds));
    }
    if json::array(&document.json, "extensionsUsed").iter().any(|name| name == EXTENSION) {
        before.insert("declared".into(), true.into());
    } else {
        push(&mut document.json, "extensionsUsed", EXTENSION.into());
    }
    if !before.is_empty() {
        let extras = extension.entry("extras").or_insert_with(|| json!({}));
        extras["before"] = Value::Object(before);
    }
    document.json["extensions"][EXTENSION] = Value::Object(extension);
    document.views_changed();
    Ok((first..first + tables.len()).collect())
}

/// Appends accessors, materials, meshes, nodes and names of extensions.
fn add_objects(
    document: &mut Document,
    additions: Additions,
    first_view: usize,
    before: &mut Map<String, Value>,
) {
    for mut accessor in additions.accessors {
        if let Some(view) = accessor.get("bufferView").and_then(json::index) {
            accessor["bufferView"] = (first_view + view).into();
        }
        push(&mut document.json, "accessors", accessor);
    }
    for (key, items) in [("materials", additions.materials), ("meshes", additions.meshes)] {
        for item in items {
            push(&mut document.json, key, item);
        }
    }
    lod::add(&mut document.json, additions.nodes, additions.levels, before);
    for (list, record, only_required) in
        [("extensionsUsed", "used", false), ("extensionsRequired", "required", true)]
    {
        let mut added = Vec::new();
        for &(name, required) in &additions.extensions {
            let is_named = json::array(&document.json, list).iter().any(|known| known == name);
            if (required || !only_required) && !is_named {
                push(&mut document.json, list, name.into());
                added.push(Value::from(name));
            }
        }
        if !added.is_empty() {
            before.insert(record.into(), added.into());
        }
    }
}

fn check_root(document: &Document) -> Result<(), AttachError> {
    let malformed =
        |pointer: &str, expected| AttachError::Malformed { pointer: pointer.to_owned(), expected };
    let root = document.json.as_object().ok_or_else(|| malformed("", "an object"))?;
    if let Some(extensions) = root.get("extensions") {
        let extensions = extensions.as_object().ok_or_else(|| malformed("/extensions", "an object"))?;
        if extensions.contains_key(EXTENSION) {
            return Err(AttachError::AlreadyAttached);
        }
    }
    for key in &CONTAINERS[..7] {
        if root.get(*key).is_some_and(|value| !value.is_array()) {
            return Err(malformed(&format!("/{key}"), "an array"));
        }
    }
    if json::array(&document.json, "buffers").len() != document.buffers.len() {
        return Err(malformed("/buffers", "one entry for each buffer in memory"));
    }
    if document.json.pointer("/buffers/0").is_some_and(|buffer| !buffer.is_object()) {
        return Err(malformed("/buffers/0", "an object"));
    }
    Ok(())
}

type Bounds = Option<(Vec<Value>, Vec<Value>)>;

/// Checks one table and converts its bounds to JSON.
fn check_table(index: usize, table: &Table) -> Result<Bounds, AttachError> {
    let problem = |problem: String| AttachError::Table { table: index, problem };
    let component = ComponentType::from_code(table.component_type as usize)
        .ok_or_else(|| problem(format!("component type {} does not exist", table.component_type)))?;
    let kind = AccessorKind::from_name(table.kind)
        .filter(|kind| kind.shape().0 == 1)
        .ok_or_else(|| problem(format!("kind {} is not SCALAR or a vector", table.kind)))?;
    if table.count == 0 {
        return Err(problem("it is empty, and glTF has no empty accessors".to_owned()));
    }
    let needed = table.count.checked_mul(kind.element_size(component));
    if needed != Some(table.bytes.len()) {
        return Err(problem(format!("{} elements do not take {} bytes", table.count, table.bytes.len())));
    }
    let Some((min, max)) = &table.min_max else { return Ok(None) };
    let convert = |values: &[f32]| {
        if values.len() != kind.components() {
            return Err(problem(format!("{} bounds for {} components", values.len(), kind.components())));
        }
        let number = |&value: &f32| {
            // Integers without a fraction; floats with all digits of their double, which is what validators compare.
            let number = match component {
                ComponentType::F32 => Number::from_f64(f64::from(value)),
                _ => Some(Number::from(value as i64)),
            };
            number.map(Value::Number).ok_or_else(|| problem("a bound is not finite".to_owned()))
        };
        values.iter().map(number).collect::<Result<Vec<_>, _>>()
    };
    Ok(Some((convert(min)?, convert(max)?)))
}

/// All blocks in one, each on a multiple of 4 bytes; and where each begins.
fn pack<'a>(blocks: impl Iterator<Item = &'a [u8]>) -> (Vec<u8>, Vec<usize>) {
    let mut bytes = Vec::new();
    let offsets = blocks
        .map(|block| {
            bytes.resize(bytes.len().next_multiple_of(4), 0);
            let offset = bytes.len();
            bytes.extend_from_slice(block);
            offset
        })
        .collect();
    (bytes, offsets)
}

/// Stores the payload; returns the buffer and the payload's offset in it.
///
/// The offset is a multiple of 4: glTF wants both `accessor.byteOffset` and its sum with `bufferView.byteOffset`
/// aligned, so the alignment cannot be made up for in the accessor. It is 0 only in a buffer that is new: `strip`
/// relies on it.
fn append_bytes(document: &mut Document, bytes: &[u8], before: &mut Map<String, Value>) -> (usize, usize) {
    let glb = document.container() == Container::Glb;
    if glb && document.storage.first() == Some(&BufferStorage::Bin) && document.bin_tail.is_empty() {
        let buffer = &mut document.buffers[0];
        let old = buffer.len();
        if old > 0 {
            let start = old.next_multiple_of(4);
            buffer.resize(start, 0);
            buffer.extend_from_slice(bytes);
            let length = &mut document.json["buffers"][0]["byteLength"];
            let stood = std::mem::replace(length, buffer.len().into());
            if stood != start {
                before.insert("byteLength".into(), stood);
            }
            return (0, start);
        }
    }
    let storage = if glb && document.buffers.is_empty() && document.loose_bin.is_none() {
        BufferStorage::Bin
    } else if !glb && document.storage.iter().any(is_file) {
        BufferStorage::Beside(".svs.bin")
    } else {
        BufferStorage::Embedded
    };
    let mut buffer = json!({"byteLength": bytes.len()});
    if storage == BufferStorage::Embedded {
        buffer["uri"] = uri::encode_data(bytes).into();
    }
    push(&mut document.json, "buffers", buffer);
    document.buffers.push(bytes.to_vec());
    document.storage.push(storage);
    (document.buffers.len() - 1, 0)
}

/// The buffer that compressed views name beside the one with their bytes: it has a length, and nothing in it.
struct Fallback {
    buffer: usize,
    length: usize,
}

impl Fallback {
    /// A view in it, whose compressed bytes are at `place`.
    fn view(&mut self, compression: &Compression, mut place: Value) -> Value {
        let Compression { mode, filter, stride, count } = *compression;
        place["byteStride"] = stride.into();
        place["mode"] = mode.into();
        if let Some(filter) = filter {
            place["filter"] = filter.into();
        }
        place["count"] = count.into();
        let offset = self.length.next_multiple_of(4);
        self.length = offset + stride * count;
        json!({"buffer": self.buffer, "byteOffset": offset, "byteLength": stride * count, "extensions": {MESHOPT: place}})
    }

    /// Appends it, if there are views in it.
    fn attach(self, document: &mut Document) {
        if self.length > 0 {
            let buffer = json!({"byteLength": self.length, "extensions": {MESHOPT: {"fallback": true}}});
            push(&mut document.json, "buffers", buffer);
            document.buffers.push(Vec::new());
            document.storage.push(BufferStorage::Absent);
        }
    }
}

fn is_file(storage: &BufferStorage) -> bool {
    matches!(storage, BufferStorage::External | BufferStorage::Beside(_))
}

fn accessor(view: usize, offset: usize, table: &Table, bounds: Bounds) -> Value {
    let mut accessor = json!({"bufferView": view, "byteOffset": offset, "componentType": table.component_type,
        "count": table.count, "type": table.kind});
    if let Some((min, max)) = bounds {
        accessor["min"] = Value::Array(min);
        accessor["max"] = Value::Array(max);
    }
    accessor
}

/// Remembers containers that exist but are empty: stripping would take them for its own.
fn record_empty_containers(
    root: &Value,
    no_tables: bool,
    additions: &Additions,
    before: &mut Map<String, Value>,
) {
    let is_empty = |key: &str| match root.get(key) {
        Some(Value::Array(items)) => items.is_empty(),
        Some(Value::Object(items)) => items.is_empty(),
        _ => false,
    };
    let is_touched = |key: &str| match key {
        "buffers" | "bufferViews" | "accessors" => !no_tables || !additions.is_empty(),
        "materials" => !additions.materials.is_empty(),
        "meshes" => !additions.meshes.is_empty(),
        "extensionsRequired" => additions.extensions.iter().any(|(_, required)| *required),
        _ => true,
    };
    let empty: Vec<Value> =
        CONTAINERS.iter().filter(|key| is_touched(key) && is_empty(key)).map(|&key| key.into()).collect();
    if !empty.is_empty() {
        before.insert("empty".into(), empty.into());
    }
}

/// Appends to a root array, which is created if need be.
fn push(root: &mut Value, key: &str, item: Value) {
    match &mut root[key] {
        Value::Array(items) => items.push(item),
        // `check_root` has seen to it that it is an array if it exists; indexing made it null otherwise.
        missing => *missing = Value::Array(vec![item]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gltf::payload::strip;

    fn table<'a>(bytes: &'a [u8], component_type: u32, kind: &'static str, count: usize) -> Table<'a> {
        Table { bytes, component_type, kind, count, min_max: None }
    }

    fn extension(tables: &[usize]) -> Value {
        let tables: Map<String, Value> = tables.iter().map(|i| (format!("T{i}"), (*i).into())).collect();
        json!({"trees": [{"tables": tables}]})
    }

    fn glb(json: &Value, bin: &[u8]) -> Document {
        Document::from_parts(json.clone(), Some(bin.to_vec())).unwrap()
    }

    #[test]
    fn an_odd_buffer_is_padded_and_restored() {
        let json = json!({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 5}]});
        let mut document = glb(&json, &[1, 2, 3, 4, 5]);
        let mut float = table(&[0, 0, 0x80, 0x3F], 5126, "SCALAR", 1);
        float.min_max = Some((vec![0.1], vec![1.0]));
        let indices = attach(&mut document, extension(&[0, 1]), &[table(&[7; 3], 5121, "SCALAR", 3), float]);
        assert_eq!(indices, Ok(vec![0, 1]));
        assert_eq!(document.buffers[0], [1, 2, 3, 4, 5, 0, 0, 0, 7, 7, 7, 0, 0, 0, 0x80, 0x3F]);
        assert_eq!(document.json["bufferViews"], json!([{"buffer": 0, "byteOffset": 8, "byteLength": 8}]));
        assert_eq!(document.json["accessors"][1]["byteOffset"], 4);
        assert_eq!(document.json["accessors"][1]["min"].to_string(), "[0.10000000149011612]");
        assert_eq!(document.json["extensionsUsed"], json!([EXTENSION]));
        let record = &document.json["extensions"][EXTENSION]["extras"]["before"];
        assert_eq!(*record, json!({"byteLength": 5}));
        assert!(strip(&mut document));
        assert_eq!(document.json, json);
        assert_eq!(document.buffers, [[1, 2, 3, 4, 5]]);
    }

    #[test]
    fn nothing_is_recorded_in_the_common_case() {
        let json = json!({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 4}]});
        let mut document = glb(&json, &[1, 2, 3, 4]);
        attach(&mut document, extension(&[0]), &[table(&[7], 5121, "SCALAR", 1)]).unwrap();
        assert_eq!(document.json["extensions"][EXTENSION], extension(&[0]));
    }

    #[test]
    fn a_failed_attach_changes_nothing() {
        let json = json!({"asset": {"version": "2.0"}, "extensions": {}});
        let mut document = Document::from_parts(json.clone(), None).unwrap();
        let mut wrong_bounds = table(&[1], 5121, "SCALAR", 1);
        wrong_bounds.min_max = Some((vec![0.0, 1.0], vec![1.0]));
        let mut infinite = table(&[0; 4], 5126, "SCALAR", 1);
        infinite.min_max = Some((vec![f32::NAN], vec![1.0]));
        for bad in [
            table(&[1, 2], 5121, "SCALAR", 1),
            table(&[], 5121, "SCALAR", 0),
            table(&[1], 5124, "SCALAR", 1),
            table(&[0; 8], 5121, "MAT2", 1),
            table(&[], 5126, "VEC4", usize::MAX),
            wrong_bounds,
            infinite,
        ] {
            let result = attach(&mut document, extension(&[0]), &[bad]);
            assert!(matches!(result, Err(AttachError::Table { table: 0, .. })), "{result:?}");
        }
        assert!(attach(&mut document, json!([]), &[]).is_err());
        assert!(attach(&mut document, json!({"extras": 1}), &[]).is_err());
        assert_eq!(document.json, json);
        attach(&mut document, json!({}), &[]).unwrap();
        assert_eq!(attach(&mut document, json!({}), &[]), Err(AttachError::AlreadyAttached));
        assert!(strip(&mut document));
        assert_eq!(document.json, json, "the empty object is restored");
    }

    #[test]
    fn a_table_that_a_mesh_uses_stays() {
        let mut document = Document::from_parts(json!({"asset": {"version": "2.0"}}), None).unwrap();
        attach(&mut document, extension(&[0]), &[table(&[7], 5121, "SCALAR", 1)]).unwrap();
        document.json["meshes"] = json!([{"primitives": [{"attributes": {}, "indices": 0}]}]);
        assert!(strip(&mut document));
        assert_eq!(document.accessor(0).unwrap().read_indices_u32().unwrap(), [7]);
    }
}
