//! Lines through the sample plant, one thread. One item is one line, with all its hits.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use glam::DVec3;
use std::path::Path;
use svs::bake::rays::RayScene;
use svs::bake::subject::subjects;
use svs::gltf::Document;
use svs::scene::{ReadOptions, read_scene};

/// Lines are sent in grids of this many by as many.
const GRID: usize = 128;

fn main() {
    divan::main();
}

/// Parallel lines of one direction, as a bake sends them.
#[divan::bench]
fn parallel_lines(bencher: Bencher) {
    lines(bencher, |_| DVec3::new(0.48, -0.6, 0.64));
}

/// A direction for each line: no two follow the same path through the hierarchy.
#[divan::bench]
fn scattered_lines(bencher: Bencher) {
    lines(bencher, |k| {
        let z = 1.0 - (2 * k + 1) as f64 / (GRID * GRID) as f64;
        let (sine, cosine) = (k as f64 * 2.399_963).sin_cos();
        DVec3::new(cosine, sine, 0.0) * (1.0 - z * z).sqrt() + DVec3::Z * z
    });
}

/// Hits of a grid of lines around the middle of the scene, `direction(k)` being that of line `k`.
fn lines(bencher: Bencher, direction: impl Fn(usize) -> DVec3) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/plant.glb");
    let doc = Document::read(&path).expect("the sample");
    let scene = read_scene(&doc, &ReadOptions::default()).expect("a readable scene");
    let subjects = subjects(&scene);
    let subject = subjects.iter().max_by_key(|subject| subject.parts.len()).expect("a plant has a tree");
    let rays = RayScene::new(&scene.meshes, &subject.parts);
    // In the frame of the rays the scene is in the unit ball.
    let step = |k: usize| (k as f64 + 0.5) / GRID as f64 * 2.0 - 1.0;
    let lines: Vec<(DVec3, DVec3)> = (0..GRID * GRID)
        .map(|k| {
            let direction = direction(k);
            let (x, y) = direction.any_orthonormal_pair();
            ((x * step(k % GRID) + y * step(k / GRID)) * 0.7, direction)
        })
        .collect();
    let mut hits = Vec::new();
    let mut crossings = 0;
    for &(point, direction) in &lines {
        rays.line(point, direction, &mut hits);
        crossings += hits.len();
    }
    assert!(crossings > lines.len(), "the lines miss the scene");
    bencher.counter(ItemsCount::new(lines.len())).bench_local(|| {
        let mut total = 0;
        for &(point, direction) in black_box(&lines) {
            rays.line(point, direction, &mut hits);
            total += hits.len();
        }
        total
    });
}
