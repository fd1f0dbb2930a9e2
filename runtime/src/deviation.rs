//! How much of what something stands for it shows wrong: by area, where the geometric error is the largest distance.

/// Of a proxy, or a simplified mesh, against what it stands for: means over places that are spread by area. Where it is
/// coarse only here and there, they are much less than the geometric error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviation {
    /// Mean distance, metres.
    pub mean: f32,
    /// Root mean square of the distances, metres: at least the mean, at most the geometric error.
    pub rms: f32,
    /// Share that has other colours or faces elsewhere, 0 to 1.
    pub wrong: f32,
}

impl Deviation {
    /// As far off as the geometric error everywhere, and no other looks: what is taken where nothing is known.
    pub fn of_error(error: f32) -> Self {
        Self { mean: error, rms: error, wrong: 0.0 }
    }

    /// Where lengths are `factor` times as long, at least 0.
    pub fn stretched(&self, factor: f64) -> Self {
        let length = |length: f32| (f64::from(length) * factor).min(f64::from(f32::MAX)) as f32;
        Self { mean: length(self.mean), rms: length(self.rms), wrong: self.wrong }
    }

    /// Finite, in order, and within the geometric error in metres: what a file must have.
    pub fn is_valid(&self, error: f32) -> bool {
        let in_order = self.mean >= 0.0 && self.mean <= self.rms && self.rms <= error;
        in_order && error.is_finite() && (0.0..=1.0).contains(&self.wrong)
    }

    /// Share of its visible pixels that it shows wrong, where a metre is `scale` pixels, 0 to 1.
    ///
    /// The distances are taken to be 0 on one part of the surface and equal on the other: the mean and the root mean square
    /// say how large that part is, and how far off.
    pub(crate) fn loss(&self, scale: f64) -> f64 {
        let (mean, rms, wrong) = (f64::from(self.mean), f64::from(self.rms), f64::from(self.wrong));
        let off = if mean > 0.0 {
            let part = (mean / rms) * (mean / rms);
            part * loss(rms / mean * rms * scale)
        } else {
            0.0
        };
        1.0 - (1.0 - off) * (1.0 - wrong)
    }
}

/// Pixels of visible error that are half as bad as nothing that is right.
const HALF_LOSS: f64 = 8.0;

/// How much of what is visible of a thing is lost by a visible error in pixels: 0 without an error, rising towards 1.
fn loss(error: f64) -> f64 {
    1.0 - HALF_LOSS / (HALF_LOSS + error)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_part_that_is_off_counts_as_that_part() {
        let everywhere = Deviation { mean: 2.0, rms: 2.0, wrong: 0.0 };
        assert_eq!(everywhere, Deviation::of_error(2.0));
        assert!((everywhere.loss(4.0) - 0.5).abs() < 1e-12);
        // A hundredth of it, 8 m: the mean is 0.08 m, the root mean square 0.8 m.
        let spike = Deviation { mean: 0.08, rms: 0.8, wrong: 0.0 };
        assert!((spike.loss(1.0) - 0.005).abs() < 1e-7, "{}", spike.loss(1.0));
        assert!(spike.loss(1e12) < 0.011);
        let painted = Deviation { wrong: 0.5, ..everywhere };
        assert!((painted.loss(4.0) - 0.75).abs() < 1e-12);
        assert_eq!(Deviation::default().loss(f64::INFINITY), 0.0);
    }

    #[test]
    fn what_is_out_of_order_is_not_valid() {
        let good = Deviation { mean: 0.5, rms: 1.0, wrong: 0.25 };
        assert!(good.is_valid(1.0) && Deviation::default().is_valid(0.0));
        for bad in [
            Deviation { mean: -0.1, ..good },
            Deviation { mean: 1.5, ..good },
            Deviation { mean: f32::NAN, ..good },
            Deviation { rms: f32::NAN, ..good },
            Deviation { rms: 1.5, ..good },
            Deviation { wrong: 1.5, ..good },
            Deviation { wrong: f32::NAN, ..good },
        ] {
            assert!(!bad.is_valid(1.0), "{bad:?}");
        }
        assert!(!good.is_valid(f32::INFINITY));
    }
}
