//! The specification's text against the code: examples, direction sets, codes.

use super::sample::{Sample, print};
use crate::gltf::Document;
use crate::validate::{ROOT, ValidationReport, tables};
use glam::DVec3;
use serde_json::json;
use std::collections::HashMap;
use svs_runtime::directions::DIRECTION_SETS;
use svs_runtime::{DirectionSet, Visibility};

const README: &str = include_str!("../../../schema/EXT_spherical_visibility/README.md");

/// Cells of the rows of the table below a heading, the table's own two header rows left out.
fn table(after: &str) -> Vec<Vec<&'static str>> {
    let text = &README[README.find(after).unwrap() + after.len()..];
    let rows =
        text.lines().skip_while(|line| !line.starts_with('|')).take_while(|line| line.starts_with('|'));
    rows.skip(2).map(|row| row.trim_matches('|').split('|').map(str::trim).collect()).collect()
}

#[test]
fn the_worked_example() {
    let sample = Sample::example();
    let doc = Document::from_parts(sample.json.clone(), Some(sample.bin.clone())).unwrap();
    let extension = doc.json.pointer(ROOT).unwrap();
    let tables = tables::read(&doc, extension, &mut ValidationReport::default()).unwrap();
    let visibility = Visibility::decode(extension, &tables).unwrap();
    let tree = &visibility.trees()[0];
    for (object, row) in table("Their levels:").iter().enumerate() {
        assert_eq!(tree.depth(object).to_string(), row[1]);
        for direction in 0..6 {
            assert_eq!(tree.level(object, direction).to_string(), row[2 + direction]);
        }
    }
    let areas = [(0, 1, 4.0), (1, 1, 2.0), (2, 1, 1.0), (2, 2, 0.25), (3, 1, 0.5), (3, 2, 0.0625)];
    for (object, height, area) in areas {
        assert_eq!(tree.importance_area(object, height), area);
    }
    for bytes in ["55 05   11 01   92 04", "00 01 02 02", "00   08   10 20   18 30"] {
        assert!(README.contains(bytes), "{bytes}");
    }
}

#[test]
fn the_fingerprint_example() {
    assert_eq!(print(&[(0, 12), (2, 500)]), json!({"triangles": 512, "hash": "0f65b61eb43fe094"}));
    assert!(README.contains(r#""triangles": 512, "hash": "0f65b61eb43fe094""#));
}

fn component(text: &str) -> f64 {
    let golden = (1.0 + 5f64.sqrt()) / 2.0;
    let (sign, text) = text.strip_prefix('−').map_or((1.0, text), |rest| (-1.0, rest));
    sign * match text {
        "φ" => golden,
        "1/φ" => 1.0 / golden,
        number => number.parse().unwrap(),
    }
}

fn vectors(text: &str) -> Vec<DVec3> {
    let vector = |part: &str| {
        let parts: Vec<f64> = part.split(", ").map(component).collect();
        DVec3::from_slice(&parts).normalize()
    };
    text.split('(').skip(1).map(|part| vector(part.split(')').next().unwrap())).collect()
}

type Base = HashMap<&'static str, (Vec<DVec3>, Vec<[usize; 3]>)>;

/// The base sets as the text lists them.
fn base() -> Base {
    let mut sets = Base::new();
    for row in table("are, in this order:") {
        let mut list = vectors(row[1]);
        if row[1].starts_with("the eight of `cube`") {
            list.splice(0..0, sets["cube"].0.clone());
        }
        sets.insert(row[0].trim_matches('`'), (list, Vec::new()));
    }
    for row in table("counter-clockwise seen from outside:") {
        let triangle = |text: &str| -> [usize; 3] {
            let corners: Vec<usize> = text.split(' ').map(|corner| corner.parse().unwrap()).collect();
            corners.try_into().unwrap()
        };
        sets.get_mut(row[0].trim_matches('`')).unwrap().1 = row[1].split(", ").map(triangle).collect();
    }
    sets
}

fn subdivide((vectors, triangles): &mut (Vec<DVec3>, Vec<[usize; 3]>)) {
    let mut midpoints = HashMap::new();
    let mut finer = Vec::new();
    for &[a, b, c] in triangles.iter() {
        let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(from, to)| {
            *midpoints.entry((from.min(to), from.max(to))).or_insert_with(|| {
                vectors.push((vectors[from] + vectors[to]).normalize());
                vectors.len() - 1
            })
        });
        finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    *triangles = finer;
}

#[test]
fn direction_sets() {
    let base = base();
    let listed = table("## Direction Sets");
    assert_eq!(listed.len(), DIRECTION_SETS.len());
    for (row, name) in listed.iter().zip(DIRECTION_SETS) {
        assert_eq!(row[0].trim_matches('`'), name);
        let set = DirectionSet::by_name(name).unwrap();
        assert_eq!(row[1].replace(',', ""), set.len().to_string(), "{name}");
        let (solid, subdivisions) = name.split_once('-').unwrap_or((name, "0"));
        let mut expected = base[solid].clone();
        (0..subdivisions.parse().unwrap()).for_each(|_| subdivide(&mut expected));
        for (index, direction) in expected.0.iter().enumerate() {
            assert!(direction.distance(set.direction_f64(index)) < 1e-12, "{name} {index}");
        }
    }
}

#[test]
fn the_check_values_of_the_direction_sets() {
    let set = DirectionSet::by_name("icosahedron-1").unwrap();
    assert!(set.direction_f64(13).distance(DVec3::new(0.5, -0.3090, 0.8090)) < 1e-4);
    assert_eq!(set.direction_f64(41), DVec3::NEG_X);
}
