//! Where a camera can be inside the scene.

use crate::bake::rays::RayScene;
use glam::DVec3;

/// Camera points of a scene: those with a free sphere around them.
pub(super) struct Regions<'a> {
    scene: &'a RayScene<'a>,
    /// Radius of the free sphere, in the scene's radii.
    clearance: f64,
    directions: Vec<DVec3>,
    half_extent: DVec3,
}

impl<'a> Regions<'a> {
    /// `clearance` in the scene's radii.
    pub(super) fn new(scene: &'a RayScene<'a>, clearance: f64) -> Self {
        let step = |digit: u32| f64::from(digit % 3) - 1.0;
        let directions = (0..27u32)
            .map(|code| DVec3::new(step(code), step(code / 3), step(code / 9)))
            .filter(|direction| *direction != DVec3::ZERO)
            .map(DVec3::normalize)
            .collect();
        // Cameras right before the outermost surfaces are of interest too.
        let half_extent = scene.half_size() * 1.1 + DVec3::splat(2.0 * clearance);
        Self { scene, clearance, directions, half_extent }
    }

    /// Radius of the free sphere, in the scene's radii.
    pub(super) fn clearance(&self) -> f64 {
        self.clearance
    }

    /// Whether a camera can be at a point (unit frame): no opaque surface is met within the clearance in any of 26
    /// directions (along the axes and their diagonals). What passes between them lets more points pass than a
    /// sphere would, so more stays.
    pub(super) fn is_clear(&self, point: DVec3) -> bool {
        let limit = self.clearance as f32;
        if (point.abs() - self.scene.half_size()).max_element() > self.clearance {
            return true;
        }
        self.directions.iter().all(|&direction| {
            let mut is_free = true;
            self.scene.visit(point, direction, limit, |crossing| {
                is_free &= !crossing.opaque;
                if is_free { limit } else { -1.0 }
            });
            is_free
        })
    }

    /// Candidate `index`: points that fill the scene's box and its surroundings ever more evenly (Roberts: R3, the
    /// additive recurrence of the root of x^4 = x + 1).
    pub(super) fn candidate(&self, index: u64) -> DVec3 {
        const STEP: DVec3 =
            DVec3::new(0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_2);
        let unit = (STEP * (index as f64) + DVec3::splat(0.5)).fract();
        (unit * 2.0 - DVec3::ONE) * self.half_extent
    }
}
