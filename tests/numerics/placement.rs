//! The same scene in other units, elsewhere, and turned.
//!
//! Rays are traced in a frame in which every scene has the size 1 and the place 0, so in another unit or place the
//! same rays meet the same triangles, and only those that graze an edge may change sides by rounding. What is
//! compared is each (object, direction): the level in exact views of the unpruned tree, and, of baked files,
//! whether the object is drawn for a viewer outside.
//!
//! A turned scene meets other rays, because the grids of lines lie along its box. There the exact views are
//! compared, in turned directions and with as many lines per area, and the yardstick is how much the levels of the
//! scene itself change if other lines of the same density are taken.

use crate::baking::{Unpruned, bake, document, options};
use glam::{DMat3, DQuat, DVec3};
use serde_json::{Value, json};
use svs::bake::hierarchy::HierarchyKind;
use svs::bake::sample::levels_from;
use svs::generate::{SampleKind, SampleOptions, generate};
use svs::gltf::Document;
use svs_runtime::DirectionSet;

/// Share of entries that may change with the unit or the place.
const MOST_CHANGED: f64 = 1e-3;

const LINES: usize = 10_000;

fn scenes() -> [(&'static str, SampleOptions); 3] {
    [
        ("cubes", SampleOptions { scale: 0.2, ..SampleOptions::new(SampleKind::Cubes) }),
        ("plant", SampleOptions { scale: 0.1, ..SampleOptions::new(SampleKind::Plant) }),
        ("city", SampleOptions { scale: 0.1, ..SampleOptions::new(SampleKind::City) }),
    ]
}

/// The scene below one more node.
fn placed(options: &SampleOptions, placement: &Value) -> Document {
    let mut sample = generate(options);
    let roots = sample.json["scenes"][0]["nodes"].take();
    let nodes = sample.json["nodes"].as_array_mut().expect("nodes");
    let mut node = placement.clone();
    node["children"] = roots;
    nodes.push(node);
    sample.json["scenes"][0]["nodes"] = json!([nodes.len() - 1]);
    document(sample)
}

fn placements() -> [(&'static str, Value); 5] {
    [
        ("1e-6 times the size", json!({ "scale": [1e-6, 1e-6, 1e-6] })),
        ("1e6 times the size", json!({ "scale": [1e6, 1e6, 1e6] })),
        ("1e7 m away", json!({ "translation": [1e7, -1e7, 1e7] })),
        ("0.3 times the size, 1e5 m away", json!({ "translation": [1e5, 0, 1e5], "scale": [0.3, 0.3, 0.3] })),
        ("1e-6 times the size, 1 m away", json!({ "translation": [1, 0, 0], "scale": [1e-6, 1e-6, 1e-6] })),
    ]
}

/// Levels by direction and member.
fn views(scene: &Unpruned, ancestry_of: &Unpruned, turn: DMat3, lines: usize) -> Vec<u8> {
    use rayon::prelude::*;
    let directions = DirectionSet::by_name("dodecahedron").expect("a set");
    let rays = scene.rays();
    (0..directions.len())
        .into_par_iter()
        .flat_map(|i| levels_from(&rays, &ancestry_of.ancestry, turn * directions.direction_f64(i), lines))
        .collect()
}

fn share_different<T: PartialEq>(a: &[T], b: &[T]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).filter(|(a, b)| a != b).count() as f64 / a.len() as f64
}

#[test]
fn unit_and_place_change_next_to_no_level() {
    for (name, options) in scenes() {
        let base = Unpruned::new(&placed(&options, &json!({})), HierarchyKind::Octree);
        let expected = views(&base, &base, DMat3::IDENTITY, LINES);
        for (what, placement) in placements() {
            let scene = Unpruned::new(&placed(&options, &placement), HierarchyKind::Octree);
            assert_eq!(scene.hierarchy, base.hierarchy, "{name}, {what}");
            let share = share_different(&views(&scene, &base, DMat3::IDENTITY, LINES), &expected);
            println!("{name}, {what}: {:.4} % of {} levels differ", share * 100.0, expected.len());
            assert!(share <= MOST_CHANGED, "{name}, {what}: {share}");
        }
    }
}

/// For each object in document order and each direction: drawn for a viewer far outside.
fn drawn(doc: &mut Document) -> Vec<bool> {
    let (trees, _) = bake(doc, &options(1 << 19));
    let tree = trees.first().expect("a tree");
    let mut drawn = vec![Vec::new(); tree.object_count()];
    for place in 0..tree.object_count() {
        drawn[tree.document_index(place) as usize] = (0..tree.direction_set().len())
            .map(|direction| u32::from(tree.level(place, direction)) >= tree.depth(place))
            .collect();
    }
    drawn.concat()
}

#[test]
fn unit_and_place_change_next_to_nothing_that_is_drawn() {
    for (name, options) in scenes() {
        let expected = drawn(&mut placed(&options, &json!({})));
        for (what, placement) in placements() {
            let share = share_different(&drawn(&mut placed(&options, &placement)), &expected);
            println!("{name}, {what}: {:.4} % of {} entries differ", share * 100.0, expected.len());
            assert!(share <= MOST_CHANGED, "{name}, {what}: {share}");
        }
    }
}

/// Surface of the scene's box, m²: four times its mean shadow, which the lines are spread over.
fn surface(scene: &Unpruned) -> f64 {
    let rays = scene.rays();
    let side = rays.half_size() * rays.radius();
    8.0 * (side.x * side.y + side.y * side.z + side.z * side.x)
}

#[test]
fn turning_changes_no_more_than_other_rays_do() {
    for (name, options) in scenes() {
        let base = Unpruned::new(&placed(&options, &json!({})), HierarchyKind::Octree);
        for lines in [LINES, 4 * LINES] {
            let expected = views(&base, &base, DMat3::IDENTITY, lines);
            let noise = share_different(&views(&base, &base, DMat3::IDENTITY, lines * 19 / 20), &expected);
            let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, -0.5).normalize(), 1.0);
            let placement = json!({ "rotation": turn.to_array(), "translation": [10, -20, 5] });
            let scene = Unpruned::new(&placed(&options, &placement), HierarchyKind::Octree);
            let denser = (lines as f64 * surface(&scene) / surface(&base)) as usize;
            let share = share_different(&views(&scene, &base, DMat3::from_quat(turn), denser), &expected);
            println!(
                "{name}, {lines} lines: turned {:.3} % of {} levels differ, with other lines {:.3} %",
                share * 100.0,
                expected.len(),
                noise * 100.0
            );
            assert!(share <= 1.5 * noise + MOST_CHANGED, "{name}: {share} against {noise}");
        }
    }
}
