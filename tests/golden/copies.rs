//! Copies of one subtree, turned, mirrored and scaled: the same levels in their own directions.

use crate::baking::{Unpruned, bake, options, rows};
use crate::document::{Builder, cuboid};
use glam::{DAffine3, DMat3, DQuat, DVec3};
use serde_json::{Value, json};
use svs::bake::hierarchy::HierarchyKind;
use svs_runtime::DirectionSet;

/// Placements whose arithmetic is exact: turned by 120 degrees about (1, 1, 1), which only exchanges the axes;
/// mirrored; eight times as large; all of it.
fn exact() -> Vec<Value> {
    vec![
        json!({}),
        json!({ "translation": [64, 0, 0], "rotation": [0.5, 0.5, 0.5, 0.5] }),
        json!({ "translation": [0, 64, 0], "scale": [-1, 1, 1] }),
        json!({ "translation": [0, 0, 128], "scale": [8, 8, 8] }),
        json!({ "translation": [0, -256, 0], "rotation": [0.5, -0.5, 0.5, 0.5], "scale": [2, 2, -2] }),
    ]
}

/// A closed crate with two boxes in it, a table that hides a box from above, and three boxes in a row. Coordinates
/// are multiples of 1/16.
fn subtree(builder: &mut Builder, parent: Option<usize>, meshes: &[usize; 3]) {
    let [cube, wall, top] = *meshes;
    let group = |builder: &mut Builder, at: [f64; 3]| builder.node(parent, json!({ "translation": at }));
    let closed = group(builder, [0.0, 0.0, 0.0]);
    for (axis, turn) in
        [[0.0, 0.0, 0.0, 1.0], [0.5, 0.5, 0.5, 0.5], [-0.5, -0.5, -0.5, 0.5]].iter().enumerate()
    {
        for side in [-2.0, 2.0] {
            let mut at = [0.0; 3];
            at[axis] = side;
            builder.node(Some(closed), json!({ "mesh": wall, "translation": at, "rotation": turn }));
        }
    }
    builder.object(Some(closed), cube, DVec3::new(0.75, 0.0, 0.0));
    builder.object(Some(closed), cube, DVec3::new(-0.75, 0.25, 0.0));
    let table = group(builder, [6.0, 0.0, 1.0]);
    builder.object(Some(table), top, DVec3::new(0.0, 2.0, 0.0));
    builder.object(Some(table), cube, DVec3::new(0.0, 1.25, 0.0));
    let row = group(builder, [0.0, 6.0, -1.0]);
    for k in 0..3 {
        builder.object(Some(row), cube, DVec3::new(f64::from(k) * 1.25, 0.0, 0.0));
    }
}

fn meshes(builder: &mut Builder) -> [usize; 3] {
    [[0.5, 0.5, 0.5], [0.125, 2.125, 2.125], [2.0, 0.125, 2.0]].map(|half| builder.mesh(&cuboid(half), None))
}

/// One document with a subtree below each placement; `animated` makes each a tree of its own.
fn scene(placements: &[Value], animated: bool) -> svs::gltf::Document {
    let mut builder = Builder::new();
    let meshes = meshes(&mut builder);
    let anchors: Vec<usize> = placements
        .iter()
        .map(|placement| {
            let anchor = builder.node(None, placement.clone());
            subtree(&mut builder, Some(anchor), &meshes);
            anchor
        })
        .collect();
    if animated {
        let bytes: Vec<u8> = [0.0f32, 1.0].iter().flat_map(|x| x.to_le_bytes()).collect();
        let view = builder.view(&bytes);
        let times = builder.push(
            "accessors",
            json!({ "bufferView": view, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [1] }),
        );
        let bytes: Vec<u8> = [0.0f32; 6].iter().flat_map(|x| x.to_le_bytes()).collect();
        let view = builder.view(&bytes);
        let places = builder.push(
            "accessors",
            json!({ "bufferView": view, "componentType": 5126, "count": 2, "type": "VEC3" }),
        );
        let channels: Vec<Value> = anchors
            .iter()
            .map(|node| json!({ "sampler": 0, "target": { "node": node, "path": "translation" } }))
            .collect();
        let sampler = json!({ "input": times, "output": places });
        builder.push("animations", json!({ "samplers": [sampler], "channels": channels }));
    }
    builder.finish()
}

#[test]
fn anchored_copies_have_the_same_tables() {
    let mut doc = scene(&exact(), true);
    let (trees, _) = bake(&mut doc, &options(1 << 21));
    assert_eq!(trees.len(), exact().len());
    let expected = rows(&trees[0]);
    assert!(!trees[0].nodes().is_empty());
    // The boxes in the crate are seen from no node above them or from the crate's own.
    assert!(expected[6..8].iter().flatten().all(|&level| level == 0));
    for tree in &trees[1..] {
        assert_eq!(rows(tree), expected);
        assert_eq!(tree.nodes(), trees[0].nodes());
    }
}

/// The placement of one copy as the reader computes it.
fn placed(placement: &Value) -> DAffine3 {
    let numbers = |name: &str, default: &[f64]| -> Vec<f64> {
        placement[name]
            .as_array()
            .map_or(default.to_vec(), |values| values.iter().filter_map(Value::as_f64).collect())
    };
    let [t, r, s] = [("translation", 3), ("rotation", 4), ("scale", 3)].map(|(name, count)| {
        let default = match name {
            "scale" => vec![1.0; 3],
            "rotation" => vec![0.0, 0.0, 0.0, 1.0],
            _ => vec![0.0; 3],
        };
        let numbers = numbers(name, &default);
        assert_eq!(numbers.len(), count);
        numbers
    });
    DAffine3::from_scale_rotation_translation(
        DVec3::from_slice(&s),
        DQuat::from_slice(&r),
        DVec3::from_slice(&t),
    )
}

#[test]
fn exact_views_of_copies_are_the_same_in_local_directions() {
    let directions = DirectionSet::by_name("icosahedron-1").expect("a set");
    let local = Unpruned::new(&scene(&[json!({})], false), HierarchyKind::Scene);
    let turned = json!({ "translation": [3, -7, 11], "rotation": DQuat::from_rotation_x(0.7).to_array(), "scale": [3, 3, -3] });
    for (placement, differences_allowed) in exact().into_iter().map(|p| (p, 0.0)).chain([(turned, 0.005)]) {
        let copy = Unpruned::new(&scene(std::slice::from_ref(&placement), false), HierarchyKind::Scene);
        let linear: DMat3 = placed(&placement).matrix3;
        let (mut entries, mut different) = (0, 0);
        for i in 0..directions.len() {
            let direction = directions.direction_f64(i);
            let expected = local.levels_from(direction, 20_000);
            let levels = copy.levels_from(linear * direction, 20_000);
            entries += levels.len();
            different += expected.iter().zip(&levels).filter(|(a, b)| a != b).count();
        }
        let share = different as f64 / entries as f64;
        println!("{placement}: {different} of {entries} entries differ");
        assert!(share <= differences_allowed, "{placement}: {share}");
    }
}
