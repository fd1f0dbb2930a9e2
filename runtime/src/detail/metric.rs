//! How much of its error a thing shows that is only partly visible.
//!
//! J. P. Charalambos, *HLOD Refinement Driven by Hardware Occlusion Queries*, 2007: the screen-space error is multiplied by
//! a ratio P(mu) of the degree of visibility mu. The sigmoid's equation is not printed there; this one keeps all of its
//! stated rules: P(0) = 0, P(t) = t for s = 1, P(1) = 1, below the line under t, above it over t.

/// From the degree of visibility mu (visible pixels over all pixels, 0 to 1) to the share of the error that counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Metric {
    /// 1: the screen-space error itself, whatever is visible.
    Sse,
    /// mu.
    Linear,
    /// `(1 - s) * mu + s * S(mu)` with `S(mu) = t * (mu / t)^3` up to t, and `1 - (1 - t) * ((1 - mu) / (1 - t))^3` above:
    /// scattered pixels count less than by [`Self::Linear`], large windows more.
    Sigmoid {
        /// 0 (linear) to 1; values outside are clamped, NaN counts as 0.
        s: f32,
        /// Where the curve crosses the line, 0 to 1; values outside are clamped, NaN counts as 0.
        t: f32,
    },
}

impl Default for Metric {
    /// The middle of the thesis' three tuned pairs.
    fn default() -> Self {
        Self::Sigmoid { s: 0.7, t: 0.15 }
    }
}

impl Metric {
    /// P(mu), 0 to 1, never falling. Degrees outside 0 to 1 are clamped; NaN counts as 1, so that nothing is coarse for it.
    pub fn ratio(&self, mu: f64) -> f64 {
        let mu = if mu.is_nan() { 1.0 } else { mu.clamp(0.0, 1.0) };
        match *self {
            Self::Sse => 1.0,
            Self::Linear => mu,
            Self::Sigmoid { s, t } => {
                let [s, t] = [s, t].map(|x| if x.is_nan() { 0.0 } else { f64::from(x).clamp(0.0, 1.0) });
                let curve = if mu > t {
                    let rest = (1.0 - mu) / (1.0 - t);
                    1.0 - (1.0 - t) * (rest * rest * rest)
                } else if t > 0.0 {
                    let part = mu / t;
                    t * (part * part * part)
                } else {
                    0.0
                };
                ((1.0 - s) * mu + s * curve).clamp(0.0, 1.0)
            }
        }
    }
}

/// Visible error in pixels of something with a geometric error in metres whose nearest point is `distance` metres away:
/// the ratio times the screen-space error.
pub(crate) fn visible_error(ratio: f64, error: f32, pixels_per_radian: f64, distance: f64) -> f64 {
    // Nothing of nothing, however near.
    if ratio > 0.0 { ratio * (f64::from(error) * pixels_per_radian / distance) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The table of the project's digest of the thesis, k = 3.
    #[test]
    fn the_tuned_pairs() {
        let mus = [0.02, 0.05, 0.10, 0.15, 0.20, 0.30, 0.50, 0.70, 0.90];
        for (s, t, ratios) in [
            (0.6, 0.20, [0.008, 0.022, 0.055, 0.111, 0.200, 0.398, 0.683, 0.855, 0.959]),
            (0.7, 0.15, [0.006, 0.019, 0.061, 0.150, 0.264, 0.458, 0.729, 0.884, 0.969]),
            (0.9, 0.05, [0.005, 0.050, 0.183, 0.303, 0.409, 0.588, 0.825, 0.943, 0.989]),
        ] {
            for (mu, expected) in mus.into_iter().zip(ratios) {
                let ratio = Metric::Sigmoid { s, t }.ratio(mu);
                assert!((ratio - expected).abs() < 6e-4, "s {s} t {t} mu {mu}: {ratio}, not {expected}");
            }
        }
    }

    #[test]
    fn the_ends() {
        for metric in [Metric::Linear, Metric::default(), Metric::Sigmoid { s: 1.0, t: 0.0 }] {
            assert_eq!((metric.ratio(0.0), metric.ratio(1.0)), (0.0, 1.0));
            assert_eq!((metric.ratio(-3.0), metric.ratio(7.0), metric.ratio(f64::NAN)), (0.0, 1.0, 1.0));
        }
        assert_eq!(Metric::Sse.ratio(0.0), 1.0);
        assert_eq!(Metric::Sigmoid { s: f32::NAN, t: f32::NAN }.ratio(0.3), 0.3);
        // t = 1: the curve never rises above the line.
        assert!((Metric::Sigmoid { s: 1.0, t: 1.0 }.ratio(0.5) - 0.125).abs() < 1e-12);
    }

    proptest! {
        #[test]
        fn it_rises_and_crosses_the_line_at_t(
            s in 0.0..=1.0_f32, t in 0.0..=1.0_f32, a in 0.0..=1.0_f64, b in 0.0..=1.0_f64,
        ) {
            let metric = Metric::Sigmoid { s, t };
            let (low, high) = (a.min(b), a.max(b));
            prop_assert!(metric.ratio(low) <= metric.ratio(high) + 1e-12);
            let t = f64::from(t);
            let (ratio, below) = (metric.ratio(a), a <= t);
            prop_assert!(below && ratio <= a + 1e-12 || !below && ratio >= a - 1e-12);
        }
    }
}
