//! How alike two surfaces look where they are nearest to each other: a thin plate that vanishes before a wall of another
//! colour is hardly a geometric error, but it shows.

use super::class::Class;
use super::soup::Soup;
use glam::Vec3;

/// Turning a face round counts as much as this part of black against white.
const NORMAL_SHARE: f32 = 0.5;

/// What a triangle looks like.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct TriangleLook {
    /// Roughly as the eye sees it: square roots of linear values.
    color: Vec3,
    /// The face's unit normal.
    normal: Vec3,
    /// Kept material, if any.
    material: Option<u32>,
}

/// Looks of all triangles.
pub(super) fn looks(soup: &Soup) -> Vec<TriangleLook> {
    (0..soup.triangle_count())
        .map(|triangle| {
            let corners = soup.corners(triangle).map(|v| v as usize);
            let (top, material) = match soup.classes[soup.class(triangle)] {
                Class::Plain(plain) => (plain.top(), None),
                Class::Kept { material, .. } => (1.0, Some(material)),
            };
            let color = |v: usize| {
                let [r, g, b, a] = soup.colors[v].map(|c| f32::from(c) / 255.0);
                Vec3::new((r * top).sqrt(), (g * top).sqrt(), (b * top).sqrt()) * a
            };
            let [a, b, c] = corners.map(|v| Vec3::from_array(soup.positions[v]));
            TriangleLook {
                color: corners.map(color).into_iter().sum::<Vec3>() / 3.0,
                normal: (b - a).cross(c - a).normalize_or_zero(),
                material,
            }
        })
        .collect()
}

impl TriangleLook {
    /// 0 for the same, 1 for black against white.
    pub(super) fn difference(&self, other: &TriangleLook) -> f32 {
        if self.material != other.material {
            return 1.0;
        }
        let color = (self.color - other.color).abs().element_sum() / 3.0;
        // A triangle without area has no side.
        let has_side = |look: &Self| look.normal != Vec3::ZERO;
        let normal =
            if has_side(self) && has_side(other) { 0.5 - 0.5 * self.normal.dot(other.normal) } else { 0.0 };
        (color + normal * NORMAL_SHARE).clamp(0.0, 1.0)
    }
}
