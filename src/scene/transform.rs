//! Local transforms of nodes and instances, and which world transforms can be baked.

use super::SceneError;
use super::json::numbers;
use glam::{DAffine3, DMat3, DQuat, DVec3};
use serde_json::Value;

/// World coordinates beyond this (metres) are refused: their squares must still fit f32 at run time.
pub(super) const MAX_COORDINATE: f64 = 1.0e18;

/// Code and message of the note on objects beyond [`MAX_COORDINATE`].
pub(super) const OUT_OF_RANGE: (&str, &str) =
    ("OUT_OF_RANGE", "objects reach beyond 1e18 m and are left out of the bake");

/// A matrix whose volume is below this share of the product of its column lengths has lost a dimension:
/// f64 products of up to a few thousand matrices stay well below that.
const DEGENERATE: f64 = 1.0e-12;

/// The local transform of a glTF node (glTF 2.0, 3.5.3); `matrix` wins over translation, rotation and scale.
/// May hold non-finite numbers.
pub(super) fn of_node(node: &Value, pointer: &str) -> Result<DAffine3, SceneError> {
    if let Some(m) = numbers::<16>(node, "matrix", pointer, "16 numbers")? {
        let column = |i: usize| DVec3::new(m[4 * i], m[4 * i + 1], m[4 * i + 2]);
        return Ok(DAffine3 {
            matrix3: DMat3::from_cols(column(0), column(1), column(2)),
            translation: column(3),
        });
    }
    let translation = numbers::<3>(node, "translation", pointer, "3 numbers")?.unwrap_or_default();
    let rotation = numbers::<4>(node, "rotation", pointer, "4 numbers")?.unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let scale = numbers::<3>(node, "scale", pointer, "3 numbers")?.unwrap_or([1.0; 3]);
    Ok(from_trs(translation.into(), rotation, scale.into()))
}

/// Translation * rotation * scale. The quaternion (x, y, z, w) is taken as it is, as renderers take it: one
/// that is not of unit length scales and shears.
pub(super) fn from_trs(translation: DVec3, rotation: [f64; 4], scale: DVec3) -> DAffine3 {
    let [x, y, z, w] = rotation;
    let rotation = DMat3::from_quat(DQuat::from_xyzw(x, y, z, w));
    DAffine3 {
        matrix3: DMat3::from_cols(
            rotation.x_axis * scale.x,
            rotation.y_axis * scale.y,
            rotation.z_axis * scale.z,
        ),
        translation,
    }
}

/// Why a world transform cannot be baked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unusable {
    /// A coefficient is NaN or infinite.
    NotFinite,
    /// A coefficient is beyond [`MAX_COORDINATE`].
    OutOfRange,
    /// Flattens space: no inverse.
    Degenerate,
}

/// Whether a world transform can be baked: finite and with a usable inverse. Mirrors are fine.
pub(super) fn check(world: &DAffine3) -> Result<(), Unusable> {
    if !world.is_finite() {
        return Err(Unusable::NotFinite);
    }
    let m = world.matrix3;
    let columns = [m.x_axis, m.y_axis, m.z_axis, world.translation];
    if columns.iter().any(|column| column.abs().max_element() > MAX_COORDINATE) {
        return Err(Unusable::OutOfRange);
    }
    let lengths = [m.x_axis.length(), m.y_axis.length(), m.z_axis.length()];
    if lengths.contains(&0.0) {
        return Err(Unusable::Degenerate);
    }
    // Unit columns first: the determinant of a tiny but well-shaped matrix must not underflow.
    let unit = DMat3::from_cols(m.x_axis / lengths[0], m.y_axis / lengths[1], m.z_axis / lengths[2]);
    // A NaN determinant is no usable one either.
    if unit.determinant().abs() > DEGENERATE && world.inverse().is_finite() {
        Ok(())
    } else {
        Err(Unusable::Degenerate)
    }
}

/// Whether the box `min..max` stays within the coordinates that can be baked.
pub(super) fn box_in_range(world: &DAffine3, min: DVec3, max: DVec3) -> bool {
    (0..8).all(|corner| {
        let pick = |bit: usize, low: f64, high: f64| if corner >> bit & 1 == 0 { low } else { high };
        let point = DVec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z));
        // Written so that NaN is out of range.
        world.transform_point3(point).abs().max_element() <= MAX_COORDINATE
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn matrix_is_column_major_and_trs_is_translation_rotation_scale() {
        let matrix = json!({"matrix": [1, 2, 3, 0, 4, 5, 6, 0, 7, 8, 10, 0, 11, 12, 13, 1]});
        let a = of_node(&matrix, "").unwrap();
        assert_eq!(a.transform_point3(DVec3::X), DVec3::new(12.0, 14.0, 16.0));
        // 90 degrees about z.
        let h = std::f64::consts::FRAC_1_SQRT_2;
        let trs = json!({"translation": [10, 0, 0], "rotation": [0, 0, h, h], "scale": [2, 3, 4]});
        let b = of_node(&trs, "").unwrap();
        assert!(b.transform_point3(DVec3::X).distance(DVec3::new(10.0, 2.0, 0.0)) < 1e-12);
        assert!(b.transform_point3(DVec3::Y).distance(DVec3::new(7.0, 0.0, 0.0)) < 1e-12);
        assert!(b.transform_point3(DVec3::Z).distance(DVec3::new(10.0, 0.0, 4.0)) < 1e-12);
        assert!(of_node(&json!({"matrix": [1, 2]}), "/nodes/0").is_err());
        assert!(of_node(&json!({"scale": "1"}), "/nodes/0").is_err());
    }

    #[test]
    fn flat_and_non_finite_transforms_are_refused_and_mirrors_are_not() {
        let scaled = |x, y, z| DAffine3::from_scale(DVec3::new(x, y, z));
        assert_eq!(check(&scaled(-1.0, 1.0, 1.0)), Ok(()));
        assert_eq!(check(&scaled(1e-3, 1e-60, 1e-60)), Ok(()));
        assert_eq!(check(&scaled(1.0, 0.0, 1.0)), Err(Unusable::Degenerate));
        assert_eq!(check(&scaled(1e-310, 1e-310, 1e-310)), Err(Unusable::Degenerate));
        assert_eq!(check(&scaled(1.0, 1e200, 1.0)), Err(Unusable::OutOfRange));
        assert_eq!(check(&scaled(1.0, f64::INFINITY, 1.0)), Err(Unusable::NotFinite));
        assert_eq!(check(&scaled(1.0, f64::NAN, 1.0)), Err(Unusable::NotFinite));
        let mut sheared = DAffine3::IDENTITY;
        sheared.matrix3.y_axis = sheared.matrix3.x_axis * 0.1 + DVec3::Y * 1e-15;
        assert_eq!(check(&sheared), Err(Unusable::Degenerate));
    }

    #[test]
    fn far_boxes_are_out_of_range() {
        let unit = (DVec3::splat(-1.0), DVec3::splat(1.0));
        assert!(box_in_range(&DAffine3::from_scale(DVec3::splat(1e17)), unit.0, unit.1));
        assert!(!box_in_range(&DAffine3::from_scale(DVec3::splat(1e19)), unit.0, unit.1));
        assert!(!box_in_range(&DAffine3::from_translation(DVec3::splat(f64::NAN)), unit.0, unit.1));
    }
}
