//! Which directions are asked, and how small an object may be: the settings of a query.

use crate::camera::Camera;
use std::f32::consts::FRAC_PI_2;

/// Which direction bins decide whether a usable sphere sees an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Query {
    /// The bin nearest to the direction from the sphere's centre to the eye (Eikel 2013, NEAREST).
    SphereNearest,
    /// Any of the three bins of the triangle which that direction meets (Eikel 2013, MAX3: his choice).
    SphereMax3,
    /// The barycentric mean over those three (Eikel 2013, WEIGHTED3): an object's estimated pixels count as often as the
    /// weights of the bins that see it.
    SphereWeighted3,
    /// Any bin of the sphere.
    SphereMaxAll,
    /// Each object's own direction, from the centre of its box to the eye, through the stages of [`Tau`].
    Object,
}

/// Smallest estimated size, in visible pixels, for an object to be drawn, per stage.
///
/// For [`Query::Object`] an object is drawn if the bin of its direction sees it and it has `nearest` pixels; or a bin of
/// the direction's triangle sees it and it has `triangle` pixels; or a neighbour of its bin sees it and it has `ring`
/// pixels. `f32::INFINITY` switches a stage off. Values of `triangle` and `ring` below `nearest` count as `nearest`.
/// The sphere queries use `nearest` only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tau {
    /// For the bin itself, pixels, at least 0.
    pub nearest: f32,
    /// For the triangle around the direction, pixels.
    pub triangle: f32,
    /// For the neighbours of the bin, pixels.
    pub ring: f32,
}

/// How to query: what is drawn against what may be missed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Directions asked.
    pub query: Query,
    /// Sizes from which on an object is always drawn.
    pub tau: Tau,
    /// Share of the image, 0 to 1, that objects below `tau.nearest` may cover together: the smallest are left out as long as
    /// their estimated visible pixels stay within it in sum, and the rest is drawn. `f32::INFINITY`: all of them go;
    /// less than 0 and NaN count as 0.
    pub small_share: f32,
    /// A sphere is used only if the eye is outside it and it subtends at most this half-angle, radians, 0 to π/2.
    /// π/2: whenever the eye is outside.
    pub max_half_angle: f32,
    /// Test boxes against the frustum. `false` gives the objects visible all around.
    pub frustum: bool,
}

/// Quality of [`Settings::default`]: each object's own bin, the bins around for objects of at least 153 estimated visible
/// pixels, and of the objects below 2.5 pixels the smallest left out, up to a thousandth of the image.
pub const DEFAULT_QUALITY: f32 = 0.5;

/// Where a stage of the quality ladder begins, pixels.
const LADDER_START: f32 = 256.0;
/// Octaves a stage goes down (to a quarter of a pixel) before it ends at 0.
const LADDER_OCTAVES: f32 = 10.0;
/// Octaves that the share of small objects falls from quality 0 to 1.
const SHARE_OCTAVES: f32 = 20.0;
/// Half-angle at quality 1, radians.
const SMALLEST_HALF_ANGLE: f32 = FRAC_PI_2 / 3.0;

impl Settings {
    const fn object(triangle: f32, ring: f32) -> Self {
        Self {
            query: Query::Object,
            tau: Tau { nearest: 0.0, triangle, ring },
            small_share: f32::INFINITY,
            max_half_angle: FRAC_PI_2,
            frustum: true,
        }
    }

    /// Each object's own bin, whatever its size.
    pub const NEAREST_O: Self = Self::object(f32::INFINITY, f32::INFINITY);

    /// The three bins around each object's direction.
    pub const MAX3_O: Self = Self::object(0.0, f32::INFINITY);

    /// Each object's bin, the three around its direction, and the bin's neighbours.
    pub const RING_O: Self = Self::object(0.0, 0.0);

    /// No spheres at all: plain hierarchical frustum culling.
    pub const FRUSTUM: Self = Self { max_half_angle: 0.0, ..Self::NEAREST_O };

    /// As published: MAX3 with the sphere's direction, every sphere used that does not hold the eye.
    pub const PUBLISHED: Self = Self { query: Query::SphereMax3, ..Self::object(0.0, 0.0) };

    /// Pixels that small objects may cover together, see [`Self::small_share`].
    pub(crate) fn small_pixels(&self, camera: &Camera) -> f64 {
        match self.small_share {
            f32::INFINITY => f64::INFINITY,
            share if share > 0.0 => f64::from(share) * camera.image_area(),
            _ => 0.0,
        }
    }

    /// One slider from fewest triangles (0) to fewest missing pixels (1). What a lower quality draws, a higher one draws
    /// too. Values outside are clamped, NaN counts as [`DEFAULT_QUALITY`].
    ///
    /// - 0 to 0.75: each object's own bin; the size from which on all are drawn goes from 256 pixels to 0 (2.5 pixels at
    ///   0.5), and the share of the image that smaller ones may cover together from 1 to 2⁻¹⁵ (a thousandth at 0.5);
    /// - from 0.48 on, to 0.75: so does the size for the triangle around the direction (153 pixels at 0.5, 12 at 0.6);
    /// - to 0.9: so does that of the bin's neighbours;
    /// - to 1: spheres are used up to a half-angle that goes from 90 to 30 degrees.
    pub fn from_quality(quality: f32) -> Self {
        let quality = if quality.is_nan() { DEFAULT_QUALITY } else { quality.clamp(0.0, 1.0) };
        let stage = |from: f32, to: f32| ((quality - from) / (to - from)).clamp(0.0, 1.0);
        let later_stage = |from, to| if quality > from { ladder(stage(from, to)) } else { f32::INFINITY };
        Self {
            tau: Tau {
                nearest: ladder(stage(0.0, 0.75)),
                triangle: later_stage(0.48, 0.75),
                ring: later_stage(0.75, 0.9),
            },
            small_share: (SHARE_OCTAVES * -quality).exp2(),
            max_half_angle: FRAC_PI_2 + (SMALLEST_HALF_ANGLE - FRAC_PI_2) * stage(0.9, 1.0),
            ..Self::NEAREST_O
        }
    }
}

/// From 256 pixels at 0, geometrically, to 0 at 1.
fn ladder(x: f32) -> f32 {
    if x < 1.0 { LADDER_START * (-LADDER_OCTAVES * x).exp2() } else { 0.0 }
}

impl Default for Settings {
    fn default() -> Self {
        Self::from_quality(DEFAULT_QUALITY)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ladder_meets_the_named_settings() {
        assert_eq!(Settings::from_quality(0.6).tau.nearest, 1.0);
        let any_share = |quality| Settings { small_share: f32::INFINITY, ..Settings::from_quality(quality) };
        assert_eq!(any_share(0.75), Settings::MAX3_O);
        assert_eq!(any_share(0.9), Settings::RING_O);
        assert_eq!(Settings::default().small_share, 1.0 / 1024.0);
        assert!((Settings::default().tau.triangle - 153.2).abs() < 0.1);
        assert_eq!(Settings::from_quality(0.0).tau.nearest, 256.0);
        assert!((Settings::from_quality(1.0).max_half_angle.to_degrees() - 30.0).abs() < 1e-3);
        assert_eq!(Settings::from_quality(f32::NAN), Settings::default());
        assert_eq!(Settings::from_quality(-3.0), Settings::from_quality(0.0));
        assert_eq!(Settings::from_quality(f32::INFINITY), Settings::from_quality(1.0));
    }

    #[test]
    fn every_threshold_falls_along_the_ladder() {
        let steps: Vec<Settings> = (0..=1000).map(|i| Settings::from_quality(i as f32 / 1000.0)).collect();
        for pair in steps.windows(2) {
            assert!(pair[1].tau.nearest <= pair[0].tau.nearest);
            assert!(pair[1].tau.triangle <= pair[0].tau.triangle);
            assert!(pair[1].tau.ring <= pair[0].tau.ring);
            assert!(pair[1].small_share <= pair[0].small_share);
            assert!(pair[1].max_half_angle <= pair[0].max_half_angle);
        }
    }
}
