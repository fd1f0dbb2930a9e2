//! Elementary functions with the same bits on every machine.
//!
//! `f64::sin` and its like go to the platform's library and may differ in the last bit. These use only
//! `+ - * /`, which IEEE 754 rounds correctly everywhere (and Rust never fuses), so the samples' bytes do not
//! depend on the machine that makes them. `f64::sqrt` and `f64::round` are exact too and used as they are.

use std::f64::consts::{FRAC_PI_2, LN_2};

/// `[cos, sin]` of the angle `step / steps` of a full turn. `steps` must not be 0.
///
/// The reduction to half a quadrant is done in integers, so opposite steps give exactly opposite values.
pub(super) fn circle(step: u32, steps: u32) -> [f64; 2] {
    let (quarter, rest) = (4 * step / steps, 4 * step % steps);
    let mirrored = 2 * rest > steps;
    let part = if mirrored { steps - rest } else { rest };
    let [cos, sin] = taylor(f64::from(part) / f64::from(steps) * FRAC_PI_2);
    let [cos, sin] = if mirrored { [sin, cos] } else { [cos, sin] };
    match quarter % 4 {
        0 => [cos, sin],
        1 => [-sin, cos],
        2 => [-cos, -sin],
        _ => [sin, -cos],
    }
}

/// `[cos, sin]` for `x` in 0..=pi/4 radians, to about 1e-16.
fn taylor(x: f64) -> [f64; 2] {
    let square = x * x;
    let (mut cos, mut sin) = (1.0, 1.0);
    for k in (1..=8).rev() {
        let n = f64::from(2 * k);
        cos = 1.0 - square / (n * (n - 1.0)) * cos;
        sin = 1.0 - square / (n * (n + 1.0)) * sin;
    }
    [cos, x * sin]
}

/// Natural logarithm of a positive, finite, normal number.
pub(super) fn ln(x: f64) -> f64 {
    let exponent = ((x.to_bits() >> 52) & 0x7ff) as i64 - 1023;
    let mantissa = f64::from_bits((x.to_bits() & 0x000f_ffff_ffff_ffff) | (1023u64 << 52));
    // ln m = 2 artanh((m - 1) / (m + 1)), and |argument| <= 1/3.
    let z = (mantissa - 1.0) / (mantissa + 1.0);
    let square = z * z;
    let series = (0..17).rev().fold(0.0, |sum, k| sum * square + 1.0 / f64::from(2 * k + 1));
    exponent as f64 * LN_2 + 2.0 * z * series
}

/// Cube root of a positive number by Newton's method, to about 1e-15 for arguments in 1e-9..1e9.
pub(super) fn cbrt(x: f64) -> f64 {
    (0..60).fold(x.max(1.0), |root, _| (2.0 * root + x / (root * root)) / 3.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn circle_agrees_with_the_library() {
        for steps in 1..200 {
            for step in 0..steps {
                let angle = f64::from(step) / f64::from(steps) * std::f64::consts::TAU;
                let [cos, sin] = circle(step, steps);
                assert!((cos - angle.cos()).abs() < 2e-15 && (sin - angle.sin()).abs() < 2e-15);
            }
        }
    }

    #[test]
    fn opposite_steps_are_exactly_opposite() {
        for step in 0..24 {
            let ([a, b], [c, d]) = (circle(step, 48), circle(step + 24, 48));
            assert_eq!((a, b), (-c, -d));
        }
    }

    #[test]
    fn logarithm_and_cube_root_agree_with_the_library() {
        for k in 1..2000 {
            let x = f64::from(k) * f64::from(k) * 1.7e-4;
            assert!((ln(x) - x.ln()).abs() < 1e-14 * (1.0 + x.ln().abs()), "ln {x}");
            assert!((cbrt(x) - x.cbrt()).abs() < 1e-14 * x.cbrt().max(1.0), "cbrt {x}");
        }
    }
}
