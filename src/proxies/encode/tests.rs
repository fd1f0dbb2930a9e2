use super::*;

/// The accessors of a primitive, read back as a loader does.
fn read_back(additions: Additions) -> crate::gltf::Document {
    let mut document = crate::gltf::Document::from_parts(json!({"asset": {"version": "2.0"}}), None).unwrap();
    crate::gltf::payload::attach_with(&mut document, json!({}), &[], additions).unwrap();
    crate::gltf::Document::from_glb(&document.to_glb().unwrap()).unwrap()
}

#[test]
fn compressed_meshes_are_read_back_within_their_steps() {
    // A bumpy sheet, far from the origin, with texture coordinates beyond the texture, and a vertex that nothing uses.
    let side = 40_u32;
    let at =
        |k: u32| [1000.0 + (k % side) as f32 * 0.25, (k * 7 % 13) as f32 * 0.01, (k / side) as f32 * 0.25];
    let positions: Vec<[f32; 3]> = (0..=side * side).map(at).collect();
    let normals: Vec<[f32; 3]> =
        (0..=side * side).map(|k| [(k % 5) as f32 - 2.0, 3.0, (k % 3) as f32 - 1.0]).collect();
    let colors: Vec<[u8; 4]> = (0..=side * side).map(|k| [(k % 251) as u8, 7, 99, 255]).collect();
    let uvs: Vec<[f32; 2]> = positions.iter().map(|p| [p[0] - 1003.0, p[2] * 0.3]).collect();
    let quads = (0..side * (side - 1)).filter(|k| k % side + 1 < side);
    let indices: Vec<u32> = quads.flat_map(|k| [k, k + 1, k + side, k + side, k + 1, k + side + 1]).collect();
    let whole = Triangles {
        positions: &positions,
        normals: &normals,
        colors: &colors,
        uvs: &uvs,
        indices: &indices,
        material: None,
    };
    let small = Triangles { indices: &indices[..60], uvs: &[], ..whole };
    let mut encoder = Encoder::new(ProxyFormat::Meshopt, 0, 0);
    encoder.mesh([whole, small, small].into_iter());
    let additions = encoder.finish();
    assert_eq!(additions.extensions, [("KHR_mesh_quantization", true), (MESHOPT, true)]);
    let bytes = additions.bytes();
    assert!(bytes < 60_000, "{bytes}");
    let document = read_back(additions);
    assert_eq!(document.json["buffers"][1]["extensions"][MESHOPT], json!({"fallback": true}));

    // A vertex is known by its place: colours tell which it was.
    let step = side as f64 * 0.25 / 65536.0;
    for (primitive, original) in [whole, small, small].iter().enumerate() {
        let json = &document.json["meshes"][0]["primitives"][primitive];
        let accessor = |name: &str| {
            let index = json.pointer(name).and_then(Value::as_u64).expect(name) as usize;
            document.accessor(index).expect("readable")
        };
        let positions = accessor("/attributes/POSITION");
        let found = positions.read_vec3_f64().unwrap();
        let [min, max] = [0, 1].map(|end| {
            let values = found.iter().copied();
            let corner = values.reduce(|a, b| if end == 0 { a.min(b) } else { a.max(b) }).unwrap();
            corner.to_array().to_vec()
        });
        assert_eq!(positions.min_max(), Some((min, max)), "the bounds are exact");
        let normals = accessor("/attributes/NORMAL").read_vec3_f64().unwrap();
        let colors = accessor("/attributes/COLOR_0").read_vec4_f64().unwrap();
        let uvs = json
            .pointer("/attributes/TEXCOORD_0")
            .map(|_| accessor("/attributes/TEXCOORD_0").read_vec2_f32().unwrap());
        let own = accessor("/indices").read_indices_u32().unwrap();
        let used: std::collections::BTreeSet<u32> = original.indices.iter().copied().collect();
        assert_eq!(found.len(), used.len(), "what nothing uses is left out");
        let nearest: Vec<u32> = found
            .iter()
            .map(|p| {
                let near = |v: &u32| original.positions[*v as usize].map(f64::from);
                *used
                    .iter()
                    .min_by(|a, b| {
                        let distance = |v| p.distance_squared(near(v).into());
                        distance(a).total_cmp(&distance(b))
                    })
                    .unwrap()
            })
            .collect();
        for (k, &v) in nearest.iter().enumerate() {
            let v = v as usize;
            let off = found[k] - glam::DVec3::from_array(original.positions[v].map(f64::from));
            assert!(off.abs().max_element() <= step / 2.0, "{off}");
            let normal = glam::DVec3::from_array(original.normals[v].map(f64::from)).normalize();
            assert!(normals[k].normalize().distance(normal) < 0.02, "{} {normal}", normals[k]);
            assert_eq!((colors[k].x * 255.0).round() as u8, original.colors[v][0]);
            if let Some(uvs) = &uvs {
                let off = uvs[k] - glam::Vec2::from_array(original.uvs[v]);
                assert!(off.abs().max_element() <= 0.5 / 65536.0, "{off}");
            }
        }
        // The same triangles, each turned about as it may be.
        let turned = |t: &[u32]| {
            let first = (0..3).min_by_key(|&k| t[k]).unwrap();
            [t[first], t[(first + 1) % 3], t[(first + 2) % 3]]
        };
        let mut read: Vec<_> =
            own.chunks_exact(3).map(|t| turned(&[0, 1, 2].map(|k| nearest[t[k] as usize]))).collect();
        let mut expected: Vec<_> = original.indices.chunks_exact(3).map(turned).collect();
        read.sort_unstable();
        expected.sort_unstable();
        assert!(read == expected, "primitive {primitive}");
    }
    let own_views = document.json["bufferViews"].as_array().unwrap().iter();
    let modes: Vec<_> = own_views.map(|view| view["extensions"][MESHOPT]["mode"].as_str().unwrap()).collect();
    assert_eq!(modes, ["ATTRIBUTES", "ATTRIBUTES", "ATTRIBUTES", "ATTRIBUTES", "TRIANGLES", "TRIANGLES"]);
}

#[test]
fn flat_and_tiny_meshes_compress() {
    for scale in [0.0, 1e-30, 1e30] {
        let positions = [[0.0; 3], [scale, 0.0, 0.0], [0.0, -scale, 0.0]];
        let triangles = Triangles {
            positions: &positions,
            normals: &[],
            colors: &[],
            uvs: &[[0.0; 2]; 3],
            indices: &[0, 1, 2],
            material: None,
        };
        let mut encoder = Encoder::new(ProxyFormat::Meshopt, 0, 0);
        encoder.mesh([triangles].into_iter());
        let document = read_back(encoder.finish());
        let found = document.accessor(0).unwrap().read_vec3_f64().unwrap();
        for (found, expected) in found.iter().zip(positions) {
            let expected = glam::DVec3::from_array(expected.map(f64::from));
            assert!(found.distance(expected) <= f64::from(scale) / 65536.0, "{found} {expected}");
        }
    }
}

fn triangle(format: ProxyFormat) -> Additions {
    let mut encoder = Encoder::new(format, 10, 3);
    let triangles = Triangles {
        positions: &[[0.0, 0.5, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, -2.0]],
        normals: &[[0.0, 0.0, 2.0], [0.0; 3], [1.0, 0.0, 0.0]],
        colors: &[[255; 4]; 3],
        uvs: &[[0.0, 1.0], [0.5, 0.5], [1.0, 1.0]],
        indices: &[0, 1, 2],
        material: Some(4),
    };
    let empty = Triangles { indices: &[], ..triangles };
    assert_eq!(encoder.mesh([empty].into_iter()), None);
    assert_eq!(encoder.mesh([triangles, empty].into_iter()), Some(3));
    encoder.finish()
}

#[test]
fn floats() {
    let additions = triangle(ProxyFormat::Float);
    assert_eq!(
        additions.meshes,
        [
            json!({"primitives": [{"attributes": {"POSITION": 10, "NORMAL": 11, "TEXCOORD_0": 12}, "indices": 13, "material": 4}]})
        ]
    );
    assert_eq!(additions.accessors[0]["max"], json!([1.0, 1.0, 0.0]));
    assert_eq!(additions.views.len(), 4, "white vertices need no colours");
    assert_eq!(additions.accessors[3]["bufferView"], 3);
    assert_eq!(additions.views[1].bytes[8..16], [0, 0, 0x80, 0x3F, 0, 0, 0, 0]);
    assert!(additions.extensions.is_empty());
}

#[test]
fn bytes_and_shorts() {
    let additions = triangle(ProxyFormat::Quantized);
    assert_eq!(additions.views[1].bytes, [0, 0, 127, 0, 0, 127, 0, 0, 127, 0, 0, 0]);
    assert_eq!(additions.views[2].bytes[..4], [0, 0, 255, 255]);
    assert_eq!(additions.extensions, [("KHR_mesh_quantization", true)]);
}
