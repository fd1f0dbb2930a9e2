//! Boxes: of decoded positions, and as a loader takes them from an accessor's `min` and `max`.

use glam::DVec3;

/// Axis-aligned box; empty while `min > max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Box3 {
    pub(super) min: DVec3,
    pub(super) max: DVec3,
}

impl Box3 {
    pub(super) const EMPTY: Box3 = Box3 { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    /// Box of the finite points among `points`.
    pub(super) fn of(points: impl IntoIterator<Item = DVec3>) -> Box3 {
        let finite = points.into_iter().filter(|point| point.is_finite());
        finite.fold(Box3::EMPTY, |b, p| Box3 { min: b.min.min(p), max: b.max.max(p) })
    }

    pub(super) fn is_empty(&self) -> bool {
        self.min.x > self.max.x
    }

    pub(super) fn union(self, other: Box3) -> Box3 {
        Box3 { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    pub(super) fn center(&self) -> DVec3 {
        // Halves first: the sum of two huge coordinates must not overflow.
        self.min * 0.5 + self.max * 0.5
    }

    /// Whether this box, as a file states it, may stand for data whose box is `data`: finite and holding it.
    /// Exporters round the decimal text, so faces may lie inside by 1e-5 of the box's size or a few f32 steps.
    pub(super) fn may_stand_for(&self, data: &Box3) -> bool {
        if !self.min.is_finite() || !self.max.is_finite() || self.is_empty() {
            return false;
        }
        let magnitude = data.min.abs().max(data.max.abs());
        let slack = (data.max - data.min) * 1.0e-5 + magnitude * (4.0 * f64::from(f32::EPSILON));
        self.min.cmple(data.min + slack).all() && self.max.cmpge(data.max - slack).all()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stated_boxes_must_hold_the_data() {
        let data = Box3::of([DVec3::ZERO, DVec3::NAN, DVec3::new(1.0, 2.0, 3.0)]);
        assert_eq!(data.max, DVec3::new(1.0, 2.0, 3.0));
        assert!(data.may_stand_for(&data));
        let rounded = Box3 { min: DVec3::splat(5e-6), max: data.max };
        assert!(rounded.may_stand_for(&data));
        let larger = Box3 { min: DVec3::splat(-9.0), max: DVec3::splat(9.0) };
        assert!(larger.may_stand_for(&data));
        let smaller = Box3 { min: DVec3::ZERO, max: DVec3::ONE };
        assert!(!smaller.may_stand_for(&data));
        let broken = Box3 { min: DVec3::NAN, max: data.max };
        assert!(!broken.may_stand_for(&data));
        assert!(!Box3::EMPTY.may_stand_for(&data));
    }

    #[test]
    fn centre_of_a_huge_box_is_finite() {
        let huge = Box3 { min: DVec3::splat(f64::MAX * 0.9), max: DVec3::splat(f64::MAX) };
        assert!(huge.center().is_finite());
    }
}
