//! How much a transform enlarges errors.

use glam::DAffine3;

/// Sweeps over all off-diagonal elements: each about squares what is left of them, so that four are enough.
const SWEEPS: usize = 8;

/// The most that a transform stretches any vector: the largest singular value of its linear part. 0 if that is not finite.
///
/// An error in mesh space times this is one in tree space, see [`crate::Level::error`].
pub fn stretch(transform: &DAffine3) -> f64 {
    let m = transform.matrix3;
    let scale = [m.x_axis, m.y_axis, m.z_axis].map(|axis| axis.abs().max_element());
    let scale = scale.into_iter().fold(0.0, f64::max);
    if !m.is_finite() || scale <= 0.0 {
        return 0.0;
    }
    let m = m * scale.recip();
    scale * largest_eigenvalue((m.transpose() * m).to_cols_array_2d()).max(0.0).sqrt()
}

/// Of a symmetric matrix: Jacobi's rotations, which need no function that differs from machine to machine.
fn largest_eigenvalue(mut a: [[f64; 3]; 3]) -> f64 {
    for _ in 0..SWEEPS {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[p][q] == 0.0 {
                continue;
            }
            let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
            let tangent = 1f64.copysign(theta) / (theta.abs() + (theta * theta + 1.0).sqrt());
            let cosine = 1.0 / (tangent * tangent + 1.0).sqrt();
            let sine = tangent * cosine;
            // Both sides: columns, then rows.
            for row in &mut a {
                (row[p], row[q]) = (cosine * row[p] - sine * row[q], sine * row[p] + cosine * row[q]);
            }
            let (one, other) = (a[p], a[q]);
            a[p] = std::array::from_fn(|k| cosine * one[k] - sine * other[k]);
            a[q] = std::array::from_fn(|k| sine * one[k] + cosine * other[k]);
        }
    }
    a[0][0].max(a[1][1]).max(a[2][2])
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DMat3, DQuat, DVec3};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn nothing_is_stretched_more(
            angles in prop::array::uniform6(0.0..6.0_f64), scale in prop::array::uniform3(0.01..50.0_f64),
            mirrored in any::<bool>(),
        ) {
            let turn = |at: usize| DQuat::from_euler(glam::EulerRot::XYZ, angles[at], angles[at + 1], angles[at + 2]);
            let mut scale = DVec3::from_array(scale);
            scale.x *= if mirrored { -1.0 } else { 1.0 };
            let transform = DAffine3::from_quat(turn(0)) * DAffine3::from_scale(scale) * DAffine3::from_quat(turn(3));
            let most = scale.abs().max_element();
            prop_assert!((stretch(&transform) / most - 1.0).abs() < 1e-6, "{} {most}", stretch(&transform));
        }
    }

    #[test]
    fn odd_transforms_have_a_stretch_too() {
        assert_eq!(stretch(&DAffine3::IDENTITY), 1.0);
        assert_eq!(stretch(&DAffine3::from_scale(DVec3::ZERO)), 0.0);
        assert!((stretch(&DAffine3::from_scale(DVec3::splat(1e-200))) / 1e-200 - 1.0).abs() < 1e-9);
        let sheared = DAffine3::from_mat3(DMat3::from_cols(DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Z));
        assert!((stretch(&sheared) - 1.618_033_988_749_895).abs() < 1e-9);
    }
}
