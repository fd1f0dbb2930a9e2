//! Figures over the frames of a path.

use crate::verify::{median, nearest_rank};
use serde::Serialize;

/// Something of which less is better, over frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Figures {
    /// Middle frame (mean of the two in the middle).
    pub median: f64,
    /// 95 % of the frames are at or below it (nearest rank).
    pub p95: f64,
    /// 99 % of the frames are at or below it (nearest rank).
    pub p99: f64,
    /// Largest.
    pub worst: f64,
}

impl Figures {
    /// Of finite values; of none, all zeros.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let sorted = sorted(values);
        Self {
            median: median(&sorted),
            p95: nearest_rank(&sorted, 95),
            p99: nearest_rank(&sorted, 99),
            worst: nearest_rank(&sorted, 100),
        }
    }
}

/// Something of which more is better, over frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Likeness {
    /// Middle frame (mean of the two in the middle).
    pub median: f64,
    /// Smallest.
    pub worst: f64,
}

impl Likeness {
    /// Of finite values; of none, all zeros.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let sorted = sorted(values);
        Self { median: median(&sorted), worst: sorted.first().copied().unwrap_or(0.0) }
    }
}

fn sorted(values: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let mut sorted: Vec<f64> = values.into_iter().collect();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted
}

/// Middle of values in any order; of none, 0.
pub(super) fn median_of(values: impl IntoIterator<Item = f64>) -> f64 {
    median(&sorted(values))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn figures_of_known_values() {
        let figures = Figures::of((1..=200).rev().map(f64::from));
        assert_eq!(figures, Figures { median: 100.5, p95: 190.0, p99: 198.0, worst: 200.0 });
        assert_eq!(Figures::of([5.0]), Figures { median: 5.0, p95: 5.0, p99: 5.0, worst: 5.0 });
        assert_eq!(Figures::of([]), Figures::default());
        assert_eq!(Likeness::of([0.9, 0.5, 1.0]), Likeness { median: 0.9, worst: 0.5 });
    }

    proptest! {
        #[test]
        fn figures_are_ordered(values in prop::collection::vec(0.0_f64..1e6, 1..300)) {
            let figures = Figures::of(values.iter().copied());
            prop_assert!(figures.median <= figures.p95 && figures.p95 <= figures.p99 && figures.p99 <= figures.worst);
            let likeness = Likeness::of(values);
            prop_assert!(likeness.worst <= likeness.median && likeness.median == figures.median);
        }
    }
}
