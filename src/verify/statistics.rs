//! Figures over the frames of a group.

use serde::{Deserialize, Serialize};

/// How a figure is distributed over frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Distribution {
    /// Sum over frames, divided by their number.
    pub mean: f64,
    /// Middle frame (mean of the two in the middle).
    pub median: f64,
    /// Frame below or at which 95 % of the frames are (nearest rank).
    pub p95: f64,
    /// Largest.
    pub worst: f64,
}

impl Distribution {
    /// Distribution of `values`, which must be finite; of none, all zeros.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let mut sorted: Vec<f64> = values.into_iter().collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let (Some(&worst), count) = (sorted.last(), sorted.len()) else { return Self::default() };
        Self {
            mean: sorted.iter().sum::<f64>() / count as f64,
            median: median(&sorted),
            p95: nearest_rank(&sorted, 95),
            worst,
        }
    }

    /// The two distributions combined figure by figure.
    pub fn zip(&self, other: &Self, combine: impl Fn(f64, f64) -> f64) -> Self {
        Self {
            mean: combine(self.mean, other.mean),
            median: combine(self.median, other.median),
            p95: combine(self.p95, other.p95),
            worst: combine(self.worst, other.worst),
        }
    }
}

/// Middle of ascending values, the mean of the two in the middle; of none, 0.
pub fn median(sorted: &[f64]) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return 0.0 };
    (sorted[last / 2] + sorted[last.div_ceil(2)]) * 0.5
}

/// The first of ascending values at or below which `percent` (1 to 100) of them are; of none, 0.
pub fn nearest_rank(sorted: &[f64], percent: usize) -> f64 {
    let rank = (sorted.len() * percent).div_ceil(100);
    sorted.get(rank.saturating_sub(1)).copied().unwrap_or(0.0)
}

/// Value at `x` on the line through two points of a log-log plot, `x0 < x1`.
///
/// Where a logarithm does not exist (a value is 0), that axis is linear. `x` beyond the points gives the nearer one.
pub fn interpolate_log(x: f64, (x0, y0): (f64, f64), (x1, y1): (f64, f64)) -> f64 {
    let share = if x0 > 0.0 { (x / x0).ln() / (x1 / x0).ln() } else { (x - x0) / (x1 - x0) };
    let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 };
    if y0 > 0.0 && y1 > 0.0 { y0 * (y1 / y0).powf(share) } else { y0 + (y1 - y0) * share }
}

/// `a / b`, where a divisor of 0 counts as 1: what is drawn for nothing is not free.
pub fn ratio(a: u64, b: u64) -> f64 {
    a as f64 / b.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn distribution_of_known_values() {
        let d = Distribution::of((1..=20).rev().map(f64::from));
        assert_eq!(d, Distribution { mean: 10.5, median: 10.5, p95: 19.0, worst: 20.0 });
        let d = Distribution::of([3.0, 100.0, 2.0]);
        assert_eq!(d, Distribution { mean: 35.0, median: 3.0, p95: 100.0, worst: 100.0 });
        assert_eq!(Distribution::of([]), Distribution::default());
        assert_eq!((median(&[]), median(&[4.0]), median(&[1.0, 2.0])), (0.0, 4.0, 1.5));
        let hundred: Vec<f64> = (1..=100).map(f64::from).collect();
        assert_eq!([1, 50, 99, 100].map(|percent| nearest_rank(&hundred, percent)), [1.0, 50.0, 99.0, 100.0]);
        assert_eq!((nearest_rank(&[], 99), nearest_rank(&[7.0], 1)), (0.0, 7.0));
    }

    #[test]
    fn interpolation_is_straight_on_log_paper() {
        assert!((interpolate_log(10.0, (1.0, 400.0), (100.0, 4.0)) - 40.0).abs() < 1e-9);
        assert_eq!(interpolate_log(1.0, (1.0, 400.0), (100.0, 4.0)), 400.0);
        // A zero: linear in the value, still logarithmic in x.
        assert!((interpolate_log(10.0, (1.0, 8.0), (100.0, 0.0)) - 4.0).abs() < 1e-12);
        assert_eq!(interpolate_log(5.0, (5.0, 1.0), (5.0, 2.0)), 1.0);
        assert_eq!((ratio(1, 0), ratio(0, 0), ratio(1, 4)), (1.0, 0.0, 0.25));
    }

    proptest! {
        #[test]
        fn figures_are_ordered(values in prop::collection::vec(0.0_f64..1e6, 1..60)) {
            let d = Distribution::of(values);
            prop_assert!(d.median <= d.p95 && d.p95 <= d.worst && d.mean <= d.worst * (1.0 + 1e-12));
        }

        #[test]
        fn interpolation_stays_between(
            x0 in 0.0_f64..10.0, step in 0.0_f64..10.0, s in 0.0_f64..1.0, y0 in 0.0_f64..10.0, y1 in 0.0_f64..10.0,
        ) {
            let y = interpolate_log(x0 + s * step, (x0, y0), (x0 + step, y1));
            prop_assert!(y >= y0.min(y1) - 1e-9 && y <= y0.max(y1) + 1e-9);
        }
    }
}
