//! Properties: attaching and stripping is the identity on random documents, and no bytes make the reader panic.

use super::payload::{self, Table};
use super::{Container, Document};
use crate::gltf::uri;
use proptest::collection::vec;
use proptest::prelude::*;
use serde_json::{Map, Value, json};

/// Any JSON, shallow.
fn anything() -> impl Strategy<Value = Value> {
    let leaf = prop_oneof![
        Just(Value::Null),
        any::<bool>().prop_map(Value::from),
        any::<i64>().prop_map(Value::from),
        any::<f64>().prop_map(Value::from),
        "[a-zäß\"\\\\/\u{7f}\n ]{0,6}".prop_map(Value::from),
        prop::sample::select(vec!["1e+5", "-0.0", "1.50", "12345678901234567890123"])
            .prop_map(|text| serde_json::from_str(text).unwrap()),
    ];
    leaf.prop_recursive(3, 12, 4, |inner| {
        prop_oneof![
            vec(inner.clone(), 0..4).prop_map(Value::from),
            vec(("[a-z]{1,4}", inner), 0..4).prop_map(|items| Value::Object(items.into_iter().collect())),
        ]
    })
}

/// The bytes of the buffers, and how each is declared: plain, as a float, with extras.
fn buffers() -> impl Strategy<Value = Vec<(Vec<u8>, u8)>> {
    vec((vec(any::<u8>(), 0..20), 0..3_u8), 0..4)
}

/// A random document: unknown properties, containers that are missing, empty or filled, in any order.
fn document() -> impl Strategy<Value = Document> {
    let containers = (0..3_u8, 0..3_u8, 0..4_u8, 0..4_u8, 0..2_u8);
    let root = (vec(("x_[a-z]{1,3}", anything()), 0..4), containers, any::<u64>());
    (root, buffers(), any::<bool>(), anything()).prop_map(|((unknown, shape, order), buffers, glb, extra)| {
        let mut items: Vec<(String, Value)> = unknown.into_iter().collect();
        items.push(("asset".into(), json!({"version": "2.0", "extensions": {"VENDOR": extra}})));
        items.extend(root_arrays(shape, &buffers, glb, &extra));
        let length = items.len();
        items.rotate_left(order as usize % length);
        let root: Map<String, Value> = items.into_iter().collect();
        if glb {
            Document::from_parts(Value::Object(root), buffers.first().map(|(bytes, _)| bytes.clone()))
                .unwrap()
        } else {
            Document::from_slice(Value::Object(root).to_string().as_bytes(), None).unwrap()
        }
    })
}

fn root_arrays(
    (accessors, views, used, extensions, required): (u8, u8, u8, u8, u8),
    buffers: &[(Vec<u8>, u8)],
    glb: bool,
    extra: &Value,
) -> Vec<(String, Value)> {
    let mut items = Vec::new();
    let declared: Vec<Value> =
        buffers.iter().enumerate().map(|(i, buffer)| declare(i, buffer, glb)).collect();
    if !buffers.is_empty() || accessors == 1 {
        items.push(("buffers".into(), declared.into()));
    }
    let view = json!({"buffer": 0, "byteLength": buffers.first().map_or(0, |(bytes, _)| bytes.len())});
    let accessor = json!({"componentType": 5121, "count": 1, "type": "SCALAR", "extras": extra});
    // A view of a buffer that does not exist would come to life when the payload's buffer is added.
    let views = if buffers.is_empty() { views.min(1) } else { views };
    for (key, item, shape) in [("bufferViews", view, views), ("accessors", accessor, accessors)] {
        if shape > 0 {
            items.push((key.into(), if shape == 1 { json!([]) } else { json!([item]) }));
        }
    }
    let own = payload::EXTENSION;
    let lists = [json!([]), json!(["VENDOR"]), json!([own, "VENDOR"])];
    if let Some(list) = usize::from(used).checked_sub(1) {
        items.push(("extensionsUsed".into(), lists[list].clone()));
    }
    if extensions > 0 {
        let all = [json!({}), json!({"VENDOR": extra}), json!({"VENDOR": 1, "a": {}})];
        items.push(("extensions".into(), all[usize::from(extensions) - 1].clone()));
    }
    if required > 0 {
        items.push(("extensionsRequired".into(), json!([])));
    }
    items
}

fn declare(index: usize, (bytes, style): &(Vec<u8>, u8), glb: bool) -> Value {
    let length = bytes.len();
    let mut buffer = match style {
        1 => json!({"byteLength": length as f64}),
        2 => json!({"extras": {"mine": [1]}, "byteLength": length, "name": "ö"}),
        _ => json!({"byteLength": length}),
    };
    if !glb || index > 0 {
        buffer["uri"] = uri::encode_data(bytes).into();
    }
    buffer
}

/// Component type, kind, count and bytes of a table.
type OwnedTable = (u32, &'static str, usize, Vec<u8>);

/// Tables of every component type; the extension names them all.
fn payload_of(document: &Document, sizes: &[(u8, Vec<u8>)]) -> (Value, Vec<OwnedTable>) {
    let tables: Vec<_> = sizes
        .iter()
        .map(|(kind, bytes)| {
            let (code, name, size) =
                [(5121, "SCALAR", 1), (5123, "SCALAR", 2), (5125, "SCALAR", 4), (5126, "VEC4", 16)]
                    [usize::from(*kind) % 4];
            let count = bytes.len().div_ceil(size).max(1);
            let mut bytes = bytes.clone();
            bytes.resize(count * size, 0);
            (code, name, count, bytes)
        })
        .collect();
    let base = document.next_accessor();
    let named: Map<String, Value> = (0..tables.len()).map(|i| (format!("T{i}"), json!(base + i))).collect();
    (json!({"version": "1.0", "trees": [{"scene": 0, "tables": named}]}), tables)
}

fn attach(document: &mut Document, sizes: &[(u8, Vec<u8>)]) {
    let (extension, owned) = payload_of(document, sizes);
    let tables: Vec<Table> = owned
        .iter()
        .map(|&(component_type, kind, count, ref bytes)| Table {
            bytes,
            component_type,
            kind,
            count,
            min_max: None,
        })
        .collect();
    let first = document.next_accessor();
    let indices = payload::attach(document, extension, &tables).unwrap();
    assert_eq!(indices, (first..first + tables.len()).collect::<Vec<_>>());
    for (index, table) in indices.into_iter().zip(&tables) {
        assert_eq!(&*document.accessor(index).unwrap().bytes().unwrap(), table.bytes);
        let view = &document.json["bufferViews"]
            [document.json["accessors"][index]["bufferView"].as_u64().unwrap() as usize];
        assert_eq!(view["byteOffset"].as_u64().unwrap() % 4, 0);
        assert_eq!(document.json["accessors"][index]["byteOffset"].as_u64().unwrap() % 4, 0);
    }
}

/// JSON as text (key order and number text count), buffers, container.
fn identity(document: &Document) -> (String, Vec<Vec<u8>>, Container) {
    (document.json.to_string(), document.buffers.clone(), document.container())
}

fn sizes() -> impl Strategy<Value = Vec<(u8, Vec<u8>)>> {
    vec((any::<u8>(), vec(any::<u8>(), 0..20)), 0..4)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn attach_then_strip_is_the_identity(mut document in document(), sizes in sizes()) {
        let before = identity(&document);
        attach(&mut document, &sizes);
        prop_assert!(document.json["extensions"][payload::EXTENSION].is_object());
        prop_assert!(payload::strip(&mut document));
        prop_assert_eq!(identity(&document), before);
        prop_assert!(!payload::strip(&mut document));
    }

    #[test]
    fn it_is_the_identity_across_files_too(document in document(), sizes in sizes()) {
        // As a GLB: a .gltf that has been converted is one as well.
        let plain = document.to_glb().unwrap();
        let mut document = Document::from_glb(&plain).unwrap();
        attach(&mut document, &sizes);
        let built = document.to_glb().unwrap();
        let mut again = Document::from_glb(&built).unwrap();
        prop_assert_eq!(identity(&again), identity(&document));
        prop_assert!(payload::strip(&mut again));
        prop_assert_eq!(again.to_glb().unwrap(), plain);
        attach(&mut again, &sizes);
        prop_assert_eq!(again.to_glb().unwrap(), built, "a second build gives the same bytes");
    }

    #[test]
    fn what_others_append_later_survives_a_strip(mut document in document(), sizes in sizes(), bytes in vec(any::<u8>(), 1..9)) {
        prop_assume!(!sizes.is_empty());
        attach(&mut document, &sizes);
        let (accessor, view) = (document.next_accessor(), document.json["bufferViews"].as_array().unwrap().len());
        let buffer = document.buffers.len();
        let object = |key: &str, document: &mut Document, item| document.json[key].as_array_mut().unwrap().push(item);
        object("buffers", &mut document, json!({"byteLength": bytes.len(), "uri": uri::encode_data(&bytes)}));
        document.buffers.push(bytes.clone());
        document.storage.push(super::BufferStorage::Embedded);
        object("bufferViews", &mut document, json!({"buffer": buffer, "byteLength": bytes.len()}));
        let theirs = json!({"bufferView": view, "componentType": 5121, "count": bytes.len(), "type": "SCALAR"});
        object("accessors", &mut document, theirs);
        prop_assert!(payload::strip(&mut document));
        prop_assert_eq!(&*document.accessor(accessor).unwrap().bytes().unwrap(), &bytes[..]);
        prop_assert!(document.json.pointer("/extensions/EXT_spherical_visibility").is_none());
        prop_assert!(document.to_glb().is_ok());
    }

    #[test]
    fn random_bytes_never_panic(bytes in vec(any::<u8>(), 0..200), glb in any::<bool>()) {
        let mut file = if glb { b"glTF\x02\0\0\0".to_vec() } else { Vec::new() };
        file.extend(bytes);
        use_everything(&file);
    }

    #[test]
    fn mutated_files_never_panic(
        document in document(),
        sizes in sizes(),
        changes in vec((any::<prop::sample::Index>(), any::<u8>()), 0..8),
        text in any::<bool>(),
        cut in any::<prop::sample::Index>(),
    ) {
        let mut document = document;
        attach(&mut document, &sizes);
        let mut file = if text { document.json.to_string().into_bytes() } else { document.to_glb().unwrap() };
        for (at, byte) in changes {
            // Digits for digits: that is what makes sound JSON with wild indices.
            let place = at.index(file.len());
            let place = &mut file[place];
            *place = if place.is_ascii_digit() { b'0' + byte % 10 } else if byte < 32 { byte } else { *place };
        }
        use_everything(&file);
        file.truncate(cut.index(file.len()) + 1);
        use_everything(&file);
    }
}

/// Reads a file and everything in it, strips it, writes it.
fn use_everything(file: &[u8]) {
    let Ok(mut document) = Document::from_slice(file, None) else { return };
    for index in 0..document.next_accessor() + 1 {
        if let Ok(accessor) = document.accessor(index) {
            let bytes = accessor.bytes().map(|bytes| bytes.len());
            let elements = accessor.read_vec4_f32().map(|elements| elements.len());
            let indices = accessor.read_indices_u32().map(|indices| indices.len());
            for count in [elements, indices].into_iter().flatten() {
                assert_eq!(count, accessor.count);
            }
            let size = accessor.kind.element_size(accessor.component_type);
            assert!(bytes.is_none_or(|bytes| bytes == accessor.count * size));
            let _ = accessor.min_max();
        }
    }
    payload::strip(&mut document);
    assert!(document.json.pointer("/extensions/EXT_spherical_visibility").is_none());
    if let Ok(glb) = document.to_glb() {
        Document::from_glb(&glb).unwrap();
    }
}
