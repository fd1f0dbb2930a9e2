//! Boxes around what is drawn together.

use glam::DVec3;

/// An axis-aligned box in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Extent {
    low: DVec3,
    high: DVec3,
}

impl Extent {
    pub(crate) const EMPTY: Self = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };

    pub(crate) fn extend(&mut self, point: DVec3) {
        self.low = self.low.min(point);
        self.high = self.high.max(point);
    }

    /// Squared distance from `eye`, 0 inside; of an empty box infinite.
    pub(crate) fn distance_squared(&self, eye: DVec3) -> f64 {
        let outside = (self.low - eye).max(eye - self.high).max(DVec3::ZERO);
        outside.length_squared()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distance_is_that_of_the_nearest_point() {
        let mut extent = Extent::EMPTY;
        assert_eq!(extent.distance_squared(DVec3::ZERO), f64::INFINITY);
        extent.extend(DVec3::ONE);
        extent.extend(DVec3::new(3.0, 2.0, 5.0));
        assert_eq!(extent.distance_squared(DVec3::new(2.0, 1.5, 4.0)), 0.0);
        assert_eq!(extent.distance_squared(DVec3::new(2.0, 0.0, 8.0)), 10.0);
    }
}
