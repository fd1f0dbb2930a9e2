//! A target over fixed mutations of its seeds: no nightly compiler needed.

use super::mutate::{Random, mutate, scramble};
use super::seeds::{self, Seeds};
use std::sync::LazyLock;

/// Target and documents; made once.
pub(crate) static SEEDS: LazyLock<Vec<Seeds>> = LazyLock::new(seeds::all);

/// Mutations of each seed.
const ROUNDS: u64 = 400;

/// Runs a target over the mutations of the seeds called `name`; the last input is named if it panics.
pub(crate) fn smoke(name: &str, target: fn(&[u8])) {
    let (_, seeds) = SEEDS.iter().find(|(target, _)| *target == name).expect("a known target");
    for (number, seed) in seeds.iter().enumerate() {
        target(seed);
        for round in 0..ROUNDS {
            let mut random = Random(round);
            let input = match round % 4 {
                0 => scramble(seed, &mut random),
                _ => mutate(seed, &mut random).expect("a seed holds JSON"),
            };
            let panicked = std::panic::catch_unwind(|| target(&input)).is_err();
            assert!(!panicked, "target {name}, seed {number}, round {round}");
        }
    }
}
