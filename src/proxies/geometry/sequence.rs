//! Points that fill a cube evenly, however many are taken (Roberts: The Unreasonable Effectiveness of Quasirandom
//! Sequences, 2018): multiples of the powers of the generalised golden ratio.

use glam::DVec3;

/// Point `index` of the sequence in the unit square.
pub(super) fn square(index: usize) -> [f64; 2] {
    const RATIO: f64 = 1.324_717_957_244_746;
    let at = |step: f64| (0.5 + index as f64 * step).fract();
    [at(1.0 / RATIO), at(1.0 / (RATIO * RATIO))]
}

/// Point `index` of the sequence in the unit cube of four dimensions.
pub(super) fn cube4(index: usize) -> [f64; 4] {
    const RATIO: f64 = 1.167_303_978_261_418_7;
    let mut step = 1.0;
    std::array::from_fn(|_| {
        step /= RATIO;
        (0.5 + index as f64 * step).fract()
    })
}

/// The unit vector that belongs to a point of the unit square; areas keep their proportions.
pub(super) fn direction(point: [f64; 2]) -> DVec3 {
    let z = 1.0 - 2.0 * point[0];
    let radius = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = (std::f64::consts::TAU * point[1]).sin_cos();
    DVec3::new(radius * cos, radius * sin, z)
}

/// Weights of a triangle's corners that belong to a point of the unit square; areas keep their proportions.
pub(super) fn weights(point: [f64; 2]) -> [f64; 3] {
    let [mut u, mut v] = point;
    if u + v > 1.0 {
        (u, v) = (1.0 - u, 1.0 - v);
    }
    [1.0 - u - v, u, v]
}
