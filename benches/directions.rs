//! From a direction to its bin, its triangle and its weights. One item is one lookup.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use glam::Vec3;
use svs_runtime::DirectionSet;

const SETS: [&str; 3] = ["dodecahedron", "icosahedron-1", "icosahedron-3"];
const LOOKUPS: usize = 4096;

fn main() {
    divan::main();
}

/// Points of a Fibonacci lattice: spread over the sphere, and neighbours in the list are far apart on it.
fn directions() -> Vec<Vec3> {
    let golden = std::f32::consts::TAU / 1.618_034;
    let point = |k: usize| {
        let z = 1.0 - (2 * k + 1) as f32 / LOOKUPS as f32;
        let (sine, cosine) = (golden * k as f32).sin_cos();
        Vec3::new(cosine, sine, 0.0) * (1.0 - z * z).sqrt() + Vec3::Z * z
    };
    (0..LOOKUPS).map(|k| point(k * 1237 % LOOKUPS)).collect()
}

fn bench<T>(bencher: Bencher, set: &str, lookup: impl Fn(&DirectionSet, Vec3) -> T + Sync) {
    let set = DirectionSet::by_name(set).expect("a known set");
    let directions = directions();
    bencher.counter(ItemsCount::new(LOOKUPS)).bench(|| {
        for &direction in black_box(&directions) {
            black_box(lookup(set, direction));
        }
    });
}

#[divan::bench(args = SETS)]
fn nearest(bencher: Bencher, set: &str) {
    bench(bencher, set, DirectionSet::nearest);
}

#[divan::bench(args = SETS)]
fn triangle(bencher: Bencher, set: &str) {
    bench(bencher, set, DirectionSet::triangle);
}

#[divan::bench(args = SETS)]
fn weights(bencher: Bencher, set: &str) {
    bench(bencher, set, DirectionSet::weights);
}
