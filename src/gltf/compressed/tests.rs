use super::*;
use serde_json::json;

/// A document with one compressed view and an accessor of it.
fn document(name: &str, stream: &[u8], extension: Value, accessor: Value) -> Document {
    let mut stored = json!({"buffer": 0, "byteLength": stream.len()});
    for (key, value) in extension.as_object().unwrap() {
        stored[key] = value.clone();
    }
    let length =
        stored["count"].as_u64().unwrap_or(0).saturating_mul(stored["byteStride"].as_u64().unwrap_or(0));
    let mut accessor = accessor;
    accessor["bufferView"] = 0.into();
    let json = json!({
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": stream.len()}, {"byteLength": length}],
        "bufferViews": [{"buffer": 1, "byteLength": length, "extensions": {name: stored}}],
        "accessors": [accessor],
    });
    Document::from_parts(json, Some(stream.to_vec())).unwrap()
}

fn bytes_of<const N: usize>(elements: &[[u8; N]], version: i32) -> Vec<u8> {
    meshopt::encode_vertex_buffer_level(elements, 2, Some(version)).unwrap()
}

const INDICES: [u32; 12] = [0, 1, 2, 2, 1, 3, 2, 3, 4, 4, 3, 5];

#[test]
fn every_mode_is_decoded() {
    let floats: Vec<[u8; 12]> =
        (0..300u32).map(|k| std::array::from_fn(|c| (k * 3 + c as u32) as u8)).collect();
    for (name, version) in [(NAMES[0], 0), (NAMES[1], 1)] {
        let extension = json!({"byteStride": 12, "count": 300, "mode": "ATTRIBUTES", "filter": "NONE"});
        let accessor = json!({"componentType": 5126, "type": "VEC3", "count": 300});
        let document = document(name, &bytes_of(&floats, version), extension, accessor);
        assert_eq!(document.buffer_view(0).unwrap(), floats.as_flattened());
        assert!(document.has_compressed_views() && document.buffers[1].is_empty());
        assert!(document.buffer_view_range(0).is_err(), "there are no stored bytes");
    }
    for (mode, stream) in [
        ("TRIANGLES", meshopt::encode_index_buffer(&INDICES, 6).unwrap()),
        ("INDICES", meshopt::encode_index_sequence(&INDICES, 6).unwrap()),
    ] {
        for (component, size) in [(5123, 2), (5125, 4)] {
            let extension = json!({"byteStride": size, "count": 12, "mode": mode});
            let accessor = json!({"componentType": component, "type": "SCALAR", "count": 12});
            let document = document(MESHOPT, &stream, extension, accessor);
            let read = document.accessor(0).unwrap().read_indices_u32().unwrap();
            // The codec may turn triangles.
            let sorted = |list: &[u32]| {
                let mut triangles: Vec<[u32; 3]> = list.as_chunks::<3>().0.to_vec();
                triangles.iter_mut().for_each(|t| t.sort_unstable());
                triangles
            };
            assert_eq!(sorted(&read), sorted(&INDICES), "{mode} {size}");
        }
    }
}

#[test]
fn every_stride_has_its_decoder() {
    fn check<const N: usize>() {
        let elements: Vec<[u8; N]> = (0..20).map(|k| std::array::from_fn(|c| (k * 5 + c) as u8)).collect();
        let extension = json!({"byteStride": N, "count": 20, "mode": "ATTRIBUTES"});
        let accessor = json!({"componentType": 5121, "type": "SCALAR", "count": 20 * N});
        let document = document(MESHOPT, &bytes_of(&elements, 0), extension, accessor);
        assert_eq!(document.buffer_view(0).unwrap(), elements.as_flattened(), "{N}");
    }
    check::<4>();
    check::<16>();
    check::<28>();
    check::<132>();
    check::<252>();
    check::<256>();
}

#[test]
fn every_filter_is_undone() {
    let axes = [[1.0_f32, 0.0, 0.0, 1.0], [0.0, -1.0, 0.0, 1.0], [0.6, 0.0, 0.8, 1.0]];
    let read = |stream: Vec<u8>, stride: usize, filter: &str, component: u32, normalized: bool| {
        let extension = json!({"byteStride": stride, "count": 3, "mode": "ATTRIBUTES", "filter": filter});
        let accessor =
            json!({"componentType": component, "type": "VEC4", "count": 3, "normalized": normalized});
        document(NAMES[1], &stream, extension, accessor).accessor(0).unwrap().read_vec4_f64().unwrap()
    };
    let near = |found: Vec<glam::DVec4>, expected: &[[f32; 4]], components: usize| {
        for (found, expected) in found.iter().zip(expected) {
            for c in 0..components {
                assert!((found[c] - f64::from(expected[c])).abs() < 0.02, "{found} {expected:?}");
            }
        }
    };
    let bytes: Vec<[u8; 4]> =
        meshopt::encode_filter_oct::<i8>(&axes, 8).iter().map(|e| e.map(|c| c as u8)).collect();
    near(read(bytes_of(&bytes, 0), 4, "OCTAHEDRAL", 5120, true), &axes, 3);
    let shorts = |elements: Vec<[i16; 4]>| -> Vec<[u8; 8]> {
        elements.iter().map(|e| bytemuck::cast(e.map(i16::to_le))).collect()
    };
    let octahedral = shorts(meshopt::encode_filter_oct::<i16>(&axes, 12));
    near(read(bytes_of(&octahedral, 0), 8, "OCTAHEDRAL", 5122, true), &axes, 3);
    let turns = [[0.0_f32, 0.0, 0.0, 1.0], [0.0, 0.6, 0.0, 0.8], [0.5, 0.5, 0.5, 0.5]];
    near(
        read(bytes_of(&shorts(meshopt::encode_filter_quat(&turns, 12)), 0), 8, "QUATERNION", 5122, true),
        &turns,
        4,
    );
    let values = [[0.5_f32, -3.0, 100.0, 0.0], [1e-3, 7.25, -2.0, 1.0], [0.0, 0.0, 0.125, -9.0]];
    let exponential = meshopt::encode_filter_exp(&values, 20, meshopt::EncodeExpMode::Separate);
    let exponential: Vec<[u8; 16]> = exponential.into_iter().map(bytemuck::cast).collect();
    near(read(bytes_of(&exponential, 0), 16, "EXPONENTIAL", 5126, false), &values, 4);
    let colors = [[1.0_f32, 0.5, 0.0, 1.0], [0.2, 0.4, 0.6, 0.8], [1.0; 4]];
    let encoded = meshopt::encode_filter_color::<u8>(&colors, 8);
    near(read(bytes_of(&encoded, 0), 4, "COLOR", 5121, true), &colors, 4);
}

/// What reading the accessor of a changed document says; the changes are pointers below the extension, or the root.
fn error(changes: &[(&str, Value)]) -> String {
    let stream = meshopt::encode_index_buffer(&INDICES, 6).unwrap();
    let extension = json!({"byteStride": 4, "count": 12, "mode": "TRIANGLES"});
    let accessor = json!({"componentType": 5125, "type": "SCALAR", "count": 12});
    let sound = document(MESHOPT, &stream, extension, accessor);
    assert!(sound.accessor(0).is_ok());
    let mut json = sound.json.clone();
    for (at, value) in changes {
        match at.strip_prefix("./") {
            Some(key) => json["bufferViews"][0]["extensions"][MESHOPT][key] = value.clone(),
            None => *json.pointer_mut(at).unwrap() = value.clone(),
        }
    }
    let changed = Document::from_parts(json, Some(stream)).unwrap();
    let first = changed.accessor(0).expect_err("refused");
    assert_eq!(changed.accessor(0).expect_err("refused"), first, "the same again");
    first.to_string()
}

#[test]
fn what_is_wrong_is_told_where_it_is() {
    let at = "/bufferViews/0/extensions/EXT_meshopt_compression";
    for (changes, expected) in [
        (vec![("./mode", json!("STRIPS"))], format!("{at}/mode: expected ATTRIBUTES")),
        (vec![("./filter", json!("SHARPEN"))], format!("{at}/filter: expected NONE")),
        (vec![("./filter", json!("EXPONENTIAL"))], format!("{at}/filter: expected NONE for indices")),
        (vec![("./byteStride", json!(3))], format!("{at}/byteStride: expected 2 or 4")),
        (vec![("./count", json!(11))], format!("{at}/count: expected a multiple of 3")),
        (vec![("./count", json!(9))], "/bufferViews/0/byteLength: expected count times".to_owned()),
        (vec![("./count", json!(u64::MAX / 3 * 3))], "/bufferViews/0/byteLength".to_owned()),
        (vec![("./buffer", json!(7))], "/buffers/7: there is no such object".to_owned()),
        (vec![("./buffer", json!(1))], "/buffers/1: the buffer has no data".to_owned()),
        (vec![("./byteLength", json!(1_u64 << 40))], format!("{at}: needs")),
        (vec![("./byteLength", json!(5))], "the compressed data are broken".to_owned()),
        (
            vec![("./byteOffset", json!(1)), ("./byteLength", json!(20))],
            "the compressed data are broken".to_owned(),
        ),
        (vec![("./mode", json!("INDICES"))], "the compressed data are broken".to_owned()),
        (vec![("./mode", json!("ATTRIBUTES"))], "the compressed data are broken".to_owned()),
        (vec![("/accessors/0/count", json!(13))], "/accessors/0: needs 52 bytes".to_owned()),
    ] {
        let message = error(&changes);
        assert!(message.contains(&expected), "{changes:?}: {message}");
    }
}

#[test]
fn lengths_that_nothing_justifies_are_refused_before_anything_is_allocated() {
    let huge = json!(3_u64 << 40);
    let length = json!(12_u64 << 40);
    let more = [("./count", huge.clone()), ("/bufferViews/0/byteLength", length.clone())];
    assert!(error(&more).contains("more than the accessors in it need"), "{}", error(&more));
    let more = [&more[..], &[("/accessors/0/count", huge)]].concat();
    assert!(error(&more).contains("more than its compressed bytes can stand for"), "{}", error(&more));
    // Plausible for the stream, and not for the file.
    let more = [
        ("./count", json!(3000)),
        ("/bufferViews/0/byteLength", json!(12_000)),
        ("/accessors/0/count", json!(3000)),
    ];
    assert!(error(&more).contains("more than a file of this size can hold"), "{}", error(&more));
}
