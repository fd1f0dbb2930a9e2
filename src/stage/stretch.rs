//! How much a transform enlarges errors.

use glam::{DAffine3, DMat3, DVec3};

/// The most that a transform stretches any vector: its largest singular value.
pub(super) fn stretch(transform: &DAffine3) -> f64 {
    let m = transform.matrix3;
    let scale = [m.x_axis, m.y_axis, m.z_axis].map(|axis| axis.abs().max_element());
    let scale = scale.into_iter().fold(0.0, f64::max);
    if !scale.is_finite() || scale <= 0.0 {
        return 0.0;
    }
    let m = m * scale.recip();
    scale * largest_eigenvalue(&(m.transpose() * m)).max(0.0).sqrt()
}

/// Of a symmetric matrix, in closed form (Smith, *Eigenvalues of a symmetric 3 x 3 matrix*, CACM 1961).
fn largest_eigenvalue(a: &DMat3) -> f64 {
    let off = DVec3::new(a.y_axis.x, a.z_axis.x, a.z_axis.y).length_squared();
    let diagonal = DVec3::new(a.x_axis.x, a.y_axis.y, a.z_axis.z);
    let mean = diagonal.element_sum() / 3.0;
    let spread = (((diagonal - mean).length_squared() + 2.0 * off) / 6.0).sqrt();
    if spread <= mean.abs() * 1e-15 {
        return diagonal.max_element();
    }
    let b = (*a - DMat3::from_diagonal(DVec3::splat(mean))) * spread.recip();
    let angle = (b.determinant() / 2.0).clamp(-1.0, 1.0).acos() / 3.0;
    mean + 2.0 * spread * angle.cos()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;
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
