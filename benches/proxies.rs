//! Making proxies of a synthetic assembly of 180 dented balls. One item is one triangle of the parts.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use glam::{DAffine3, DVec3};
use svs::proxies::geometry::{
    LevelOptions, NodeOptions, Palette, Part, Surface, measure, simplify_mesh_levels, simplify_node,
};
use svs_render::{Material, Mesh, Primitive};

/// Balls along each axis of the assembly, with one layer fewer in the third.
const SIDE: usize = 6;

fn main() {
    divan::main();
}

/// A ball with dents, `rings * rings * 4` triangles.
fn ball(rings: u32) -> Mesh {
    let mut primitive = Primitive::default();
    let around = rings * 2;
    for ring in 0..=rings {
        for step in 0..around {
            let polar = std::f32::consts::PI * ring as f32 / rings as f32;
            let (sin, cos) = (std::f32::consts::TAU * step as f32 / around as f32).sin_cos();
            let radius = 1.0 + 0.1 * (7.0 * polar).sin() * (5.0 * cos).sin();
            let across = radius * polar.sin();
            primitive.positions.push([across * cos, radius * polar.cos(), -across * sin]);
        }
    }
    for ring in 0..rings {
        for step in 0..around {
            let (a, b) = (ring * around + step, ring * around + (step + 1) % around);
            primitive.indices.extend([a, a + around, b, b, a + around, b + around]);
        }
    }
    Mesh { primitives: vec![primitive] }
}

fn assembly(mesh: &Mesh) -> Vec<Part<'_>> {
    let place = |i: usize| DVec3::new((i % SIDE) as f64, (i / SIDE % SIDE) as f64, (i / SIDE / SIDE) as f64);
    (0..SIDE * SIDE * (SIDE - 1))
        .map(|i| Part::Mesh { mesh, to_node: DAffine3::from_translation(place(i) * 1.7) })
        .collect()
}

fn triangles(mesh: &Mesh) -> usize {
    mesh.primitives.iter().map(|p| p.indices.len() / 3).sum()
}

/// All of it: gather, visible only, weld, simplify, measure.
#[divan::bench(args = [6, 12, 24], sample_count = 5)]
fn node(bencher: Bencher, rings: u32) {
    let mesh = ball(rings);
    let parts = assembly(&mesh);
    let palette = Palette::new(&[Material::default()], &[]);
    let count = ItemsCount::new(triangles(&mesh) * parts.len());
    bencher
        .counter(count)
        .bench_local(|| simplify_node(black_box(&parts), &palette, &NodeOptions::default()));
}

/// The same without rays.
#[divan::bench(args = [6, 12, 24], sample_count = 5)]
fn node_without_visibility(bencher: Bencher, rings: u32) {
    let mesh = ball(rings);
    let parts = assembly(&mesh);
    let palette = Palette::new(&[Material::default()], &[]);
    let options = NodeOptions { visible_only: false, ..NodeOptions::default() };
    let count = ItemsCount::new(triangles(&mesh) * parts.len());
    bencher.counter(count).bench_local(|| simplify_node(black_box(&parts), &palette, &options));
}

/// Levels of one mesh.
#[divan::bench(sample_count = 5)]
fn levels(bencher: Bencher) {
    let mesh = ball(96);
    bencher
        .counter(ItemsCount::new(triangles(&mesh)))
        .bench_local(|| simplify_mesh_levels(black_box(&mesh), &LevelOptions::default()));
}

/// Two surfaces compared by 10,000 area samples of each; one item is one triangle of the finer one.
#[divan::bench(sample_count = 5)]
fn measuring(bencher: Bencher) {
    let (fine, coarse) = (ball(96), ball(24));
    let [a, b] = [&fine, &coarse].map(|mesh| &mesh.primitives[0]);
    let [a, b] = [a, b].map(|p| Surface { positions: &p.positions, indices: &p.indices });
    bencher
        .counter(ItemsCount::new(triangles(&fine)))
        .bench_local(|| measure(black_box(a), black_box(b), 10_000));
}
