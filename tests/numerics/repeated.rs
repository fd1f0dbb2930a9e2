//! The same thing in the same place, many times over: the hierarchies over it must not take quadratic time.

use crate::baking::{bake, options};
use crate::document::{Builder, cuboid};
use glam::DVec3;
use serde_json::json;
use std::time::Instant;

const COUNT: usize = 50_000;

/// Few rays: each one that meets the pile has to report all of it.
const RAYS: u64 = 1 << 10;

#[test]
fn fifty_thousand_objects_in_one_place_bake_in_seconds() {
    // With 12 triangles the copies are merged into one hierarchy, with 48 they are instances.
    for boxes in [1, 4] {
        let mut builder = Builder::new();
        let mut shape = cuboid([0.5; 3]);
        for k in 1..boxes {
            let moved = cuboid([0.5; 3]);
            let first = shape.positions.len() as u32;
            shape.positions.extend(moved.positions.iter().map(|&[x, y, z]| [x + 2.0 * k as f32, y, z]));
            shape.indices.extend(moved.indices.iter().map(|i| first + i));
        }
        let mesh = builder.mesh(&shape, None);
        builder.json["nodes"] = vec![json!({ "mesh": mesh }); COUNT].into();
        builder.json["scenes"][0]["nodes"] = (0..COUNT).collect();
        builder.object(None, mesh, DVec3::Y * 4.0);
        let mut doc = builder.finish();
        let start = Instant::now();
        let (_, report) = bake(&mut doc, &options(RAYS));
        let seconds = start.elapsed().as_secs_f64();
        println!("{COUNT} objects of {} triangles: {seconds:.1} s, {:?}", 12 * boxes, report.stages);
        // 5 to 13 s on two cores, 26 s with eight other programs beside it; quadratic time would be minutes.
        assert!(seconds < 90.0, "{seconds}");
    }
}

#[test]
fn fifty_thousand_equal_triangles_bake_in_seconds() {
    let mut builder = Builder::new();
    let mut shape = cuboid([0.5; 3]);
    shape.indices = shape.indices.iter().copied().cycle().take(3 * COUNT).collect();
    let mesh = builder.mesh(&shape, None);
    for k in 0..3 {
        builder.object(None, mesh, DVec3::Y * 2.0 * f64::from(k));
    }
    let mut doc = builder.finish();
    let start = Instant::now();
    bake(&mut doc, &options(1 << 18));
    let seconds = start.elapsed().as_secs_f64();
    println!("{COUNT} equal triangles: {seconds:.1} s");
    assert!(seconds < 5.0, "{seconds}");
}
