//! Tests of the samples as documents.

use super::*;
use serde_json::Value;
use std::collections::HashSet;
use std::time::Instant;

fn sample(kind: SampleKind, scale: f64, seed: u64) -> Sample {
    generate(&SampleOptions { kind, scale, seed })
}

fn list<'a>(json: &'a Value, name: &str) -> &'a [Value] {
    json[name].as_array().map_or(&[], Vec::as_slice)
}

fn index(value: &Value) -> usize {
    value.as_u64().expect("an index") as usize
}

fn objects(sample: &Sample) -> usize {
    list(&sample.json, "nodes").iter().filter(|node| node.get("mesh").is_some()).count()
}

fn drawn_triangles(sample: &Sample) -> usize {
    let accessors = list(&sample.json, "accessors");
    let meshes: Vec<usize> = list(&sample.json, "meshes")
        .iter()
        .map(|mesh| {
            list(mesh, "primitives")
                .iter()
                .map(|p| index(&accessors[index(&p["indices"])]["count"]) / 3)
                .sum()
        })
        .collect();
    list(&sample.json, "nodes")
        .iter()
        .filter_map(|node| node.get("mesh"))
        .map(|mesh| meshes[index(mesh)])
        .sum()
}

/// Checks every rule of glTF 2.0 that the builder could break.
fn check(sample: &Sample) {
    let json = &sample.json;
    let views = list(json, "bufferViews");
    let accessors = list(json, "accessors");
    assert_eq!(index(&json["buffers"][0]["byteLength"]), sample.bin.len());
    let mut end = 0;
    for view in views {
        assert_eq!(view.get("byteOffset").map_or(0, index), end, "views lie one behind the other");
        end += index(&view["byteLength"]);
    }
    assert_eq!(end, sample.bin.len());

    let mut used = HashSet::new();
    for mesh in list(json, "meshes") {
        for primitive in list(mesh, "primitives") {
            assert!(index(&primitive["material"]) < list(json, "materials").len());
            let position = index(&primitive["attributes"]["POSITION"]);
            let normal = index(&primitive["attributes"]["NORMAL"]);
            let indices = index(&primitive["indices"]);
            used.extend([position, normal, indices]);
            let vertices = index(&accessors[position]["count"]);
            assert_eq!(index(&accessors[normal]["count"]), vertices);
            let indices =
                read(sample, indices).chunks_exact(2).map(|b| usize::from(u16::from_le_bytes([b[0], b[1]])));
            let seen: HashSet<usize> = indices.collect();
            assert_eq!(seen.len(), vertices, "every vertex is used");
            assert!(seen.iter().all(|&i| i < vertices && i < 65_535));
            check_bounds(&accessors[position], read(sample, position));
        }
    }
    assert_eq!(used.len(), accessors.len(), "every accessor is used");
    check_nodes(json);
}

fn read(sample: &Sample, accessor: usize) -> &[u8] {
    let accessor = &sample.json["accessors"][accessor];
    let view = &sample.json["bufferViews"][index(&accessor["bufferView"])];
    let offset = |value: &Value| value.get("byteOffset").map_or(0, index);
    let size = if accessor["type"] == "VEC3" { 12 } else { 2 };
    let length = size * index(&accessor["count"]);
    assert!(length > 0 && offset(accessor) + length <= index(&view["byteLength"]));
    let start = offset(view) + offset(accessor);
    assert_eq!(start % if size == 12 { 4 } else { 2 }, 0);
    &sample.bin[start..start + length]
}

fn check_bounds(accessor: &Value, bytes: &[u8]) {
    for axis in 0..3 {
        let values = bytes.chunks_exact(12).map(|v| {
            let component = &v[4 * axis..4 * axis + 4];
            f64::from(f32::from_le_bytes([component[0], component[1], component[2], component[3]]))
        });
        let [mut min, mut max] = [f64::INFINITY, f64::NEG_INFINITY];
        for value in values {
            assert!(value.is_finite());
            (min, max) = (min.min(value), max.max(value));
        }
        assert_eq!((accessor["min"][axis].as_f64(), accessor["max"][axis].as_f64()), (Some(min), Some(max)));
    }
}

fn check_nodes(json: &Value) {
    let nodes = list(json, "nodes");
    let mut parents = vec![0; nodes.len()];
    let children = nodes.iter().flat_map(|node| list(node, "children"));
    children.chain(list(&json["scenes"][0], "nodes")).for_each(|child| parents[index(child)] += 1);
    assert!(parents.iter().all(|&n| n == 1), "every node is reached exactly once");
    let mut meshes = HashSet::new();
    for node in nodes {
        assert!(node.get("mesh").is_some() || !list(node, "children").is_empty(), "{node} is empty");
        meshes.extend(node.get("mesh").map(index));
        if let Some(rotation) = node.get("rotation").and_then(Value::as_array) {
            let square: f64 = rotation.iter().filter_map(Value::as_f64).map(|x| x * x).sum();
            assert!((square - 1.0).abs() < 1e-15, "{rotation:?}");
        }
        if let Some(scale) = node.get("scale").and_then(Value::as_array) {
            assert!(scale.iter().filter_map(Value::as_f64).all(|s| s > 1e-3), "{node}");
        }
    }
    assert_eq!(meshes.len(), list(json, "meshes").len(), "every mesh is used");
}

#[test]
fn every_kind_is_valid_at_every_size() {
    for kind in SampleKind::ALL {
        for scale in [1e-9, 0.07, 0.4, 1.0, 1.7] {
            check(&sample(kind, scale, 7));
        }
    }
    check(&shells(&ShellOptions { depth: 3, hole: true }));
}

#[test]
fn default_sizes_are_those_of_the_measured_scenes() {
    let plant = sample(SampleKind::Plant, 1.0, 7);
    assert!((4_000..4_800).contains(&objects(&plant)), "{}", objects(&plant));
    assert!((2_300_000..2_600_000).contains(&drawn_triangles(&plant)), "{}", drawn_triangles(&plant));
    let city = sample(SampleKind::City, 1.0, 11);
    assert!((14_000..17_000).contains(&objects(&city)), "{}", objects(&city));
    assert!((2_000_000..2_800_000).contains(&drawn_triangles(&city)), "{}", drawn_triangles(&city));
    assert_eq!(objects(&sample(SampleKind::Cubes, 1.0, 1)), 1000);
    assert_eq!(objects(&sample(SampleKind::Boxes, 1.0, 0)), 512);
    assert_eq!(objects(&sample(SampleKind::Shells, 1.0, 0)), 6);
}

#[test]
fn larger_scales_have_more_objects_about_in_proportion() {
    for kind in [SampleKind::Plant, SampleKind::City, SampleKind::Cubes, SampleKind::Boxes] {
        let counts: Vec<usize> = (1..=16).map(|k| objects(&sample(kind, f64::from(k) / 8.0, 3))).collect();
        assert!(counts.windows(2).all(|pair| pair[0] < pair[1]), "{kind:?} {counts:?}");
        let ratio = counts[15] as f64 / counts[7] as f64;
        assert!((1.8..2.2).contains(&ratio), "{kind:?} {ratio}");
    }
}

#[test]
fn same_options_same_bytes_and_another_seed_other_bytes() {
    for kind in [SampleKind::Plant, SampleKind::City, SampleKind::Cubes] {
        let glb = sample(kind, 0.2, 7).to_glb();
        assert_eq!(glb, sample(kind, 0.2, 7).to_glb());
        assert_ne!(glb, sample(kind, 0.2, 8).to_glb());
    }
}

#[test]
fn the_committed_plant_is_what_the_generator_makes() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/samples/plant.glb");
    let committed = std::fs::read(path).expect("samples/plant.glb");
    assert!(committed.len() < 1_000_000, "{} bytes", committed.len());
    // Not assert_eq: nobody wants a megabyte of numbers in a message.
    assert!(committed == generate(&SampleOptions::new(SampleKind::Plant)).to_glb(), "run `svs sample plant`");
}

/// Seconds of processor time of this thread, so that other tests do not count; wall time where the system does
/// not tell.
fn thread_seconds(since: Instant) -> f64 {
    let schedstat = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = schedstat.and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(|| since.elapsed().as_secs_f64(), |ns| ns * 1e-9)
}

#[test]
fn a_hundred_thousand_objects_take_less_than_two_seconds() {
    let clock = Instant::now();
    let start = thread_seconds(clock);
    let sample = sample(SampleKind::Plant, 25.0, 7);
    let glb = sample.to_glb();
    let seconds = thread_seconds(clock) - start;
    let count = objects(&sample);
    assert!(count > 100_000, "{count}");
    assert!(seconds < 2.0, "{seconds} s for {count} objects, {} bytes", glb.len());
}

#[test]
fn glb_is_framed_as_the_specification_says() {
    let sample = sample(SampleKind::Shells, 1.0, 0);
    let glb = sample.to_glb();
    let word = |at: usize| u32::from_le_bytes([glb[at], glb[at + 1], glb[at + 2], glb[at + 3]]) as usize;
    assert_eq!((&glb[..4], word(4), word(8)), (&b"glTF"[..], 2, glb.len()));
    let json = word(12);
    assert_eq!((&glb[16..20], json % 4), (&b"JSON"[..], 0));
    assert_eq!(serde_json::from_slice::<Value>(&glb[20..20 + json]).ok(), Some(sample.json));
    assert_eq!(&glb[24 + json..28 + json], b"BIN\0");
    assert_eq!(&glb[28 + json..28 + json + sample.bin.len()], &sample.bin[..]);
}

#[test]
fn boxes_are_binary_groups_of_neighbours() {
    let sample = sample(SampleKind::Boxes, 1.0, 0);
    let nodes = list(&sample.json, "nodes");
    assert_eq!(nodes.len(), 512 + 511);
    for node in nodes.iter().filter(|node| node.get("mesh").is_none()) {
        assert_eq!(list(node, "children").len(), 2);
    }
    // Depth-first order: the boxes come by rising x.
    let xs: Vec<f64> = nodes
        .iter()
        .filter(|node| node.get("mesh").is_some())
        .map(|node| node.pointer("/translation/0").and_then(Value::as_f64).unwrap_or(0.0))
        .collect();
    assert!(xs.iter().enumerate().all(|(k, &x)| x == 2.0 * k as f64));
}

#[test]
fn identical_machines_are_identical_subtrees() {
    let sample = sample(SampleKind::Plant, 1.0, 7);
    let nodes = list(&sample.json, "nodes");
    fn subtree(nodes: &[Value], node: usize) -> String {
        let below: String = list(&nodes[node], "children").iter().map(|c| subtree(nodes, index(c))).collect();
        let own = ["mesh", "rotation", "scale", "translation"].map(|key| nodes[node][key].to_string());
        format!("{own:?}[{below}]")
    }
    let is_machine = |node: &Value| node["name"].as_str().is_some_and(|name| name.starts_with("machine "));
    let machines = nodes.iter().filter(|node| is_machine(node));
    let distinct: HashSet<Vec<String>> =
        machines.map(|m| list(m, "children").iter().map(|c| subtree(nodes, index(c))).collect()).collect();
    assert!((2..=8).contains(&distinct.len()), "{}", distinct.len());
}

#[test]
fn out_of_range_scales_are_refused_by_check_and_clamped_by_generate() {
    for scale in [0.0, -1.0, 64.1, f64::NAN, f64::INFINITY] {
        let options = SampleOptions { kind: SampleKind::Shells, scale, seed: 0 };
        assert!(options.check().is_err());
        check(&generate(&options));
    }
    assert_eq!(SampleOptions::new(SampleKind::City).check(), Ok(()));
}
