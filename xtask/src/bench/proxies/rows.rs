//! Rows of `frames.csv`, and figures over them.

use std::collections::BTreeMap;

/// One frame with one method.
#[derive(Clone, Debug)]
pub(super) struct Row(BTreeMap<String, String>);

impl Row {
    pub(super) fn is_of(&self, method: &str) -> bool {
        self.0.get("method").is_some_and(|name| name == method)
    }

    /// NaN if there is none.
    pub(super) fn number(&self, column: &str) -> f64 {
        self.0.get(column).and_then(|text| text.parse().ok()).unwrap_or(f64::NAN)
    }
}

/// Without quoted fields: paths have plain names here.
pub(super) fn read(csv: &str) -> Vec<Row> {
    let mut lines = csv.lines();
    let columns: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let row = |line: &str| {
        Row(columns
            .iter()
            .zip(line.split(','))
            .map(|(&name, value)| (name.to_owned(), value.to_owned()))
            .collect())
    };
    lines.map(row).collect()
}

/// Values of a column for one method, in order.
pub(super) fn column(rows: &[Row], method: &str, column: &str) -> Vec<f64> {
    rows.iter().filter(|row| row.is_of(method)).map(|row| row.number(column)).collect()
}

pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Standard deviation of a sample.
pub(super) fn deviation(values: &[f64]) -> f64 {
    let mean = mean(values);
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (squares / (values.len().max(2) - 1) as f64).sqrt()
}

/// `count` different places below `length` in a random order that is always the same (SplitMix64).
pub(super) fn random_places(length: usize, count: usize) -> Vec<usize> {
    let mut state = 2007_u64;
    let mut next = || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    };
    let mut places: Vec<(u64, usize)> = (0..length).map(|place| (next(), place)).collect();
    places.sort_unstable();
    places.into_iter().take(count).map(|(_, place)| place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_and_figures() {
        let rows = read("path,method,x\na,one,1\na,two,9\na,one,3\n");
        assert_eq!(column(&rows, "one", "x"), [1.0, 3.0]);
        assert!(column(&rows, "one", "y").iter().all(|x| x.is_nan()));
        assert_eq!(mean(&[1.0, 3.0]), 2.0);
        assert!((deviation(&[1.0, 3.0]) - 2.0_f64.sqrt()).abs() < 1e-12);
        assert_eq!(deviation(&[5.0]), 0.0);
    }

    #[test]
    fn places_are_different_and_always_the_same() {
        let places = random_places(60, 20);
        assert_eq!(places, random_places(60, 20));
        assert_eq!(places.iter().collect::<std::collections::BTreeSet<_>>().len(), 20);
        assert_eq!(random_places(3, 20).len(), 3);
        assert!(!places.is_sorted());
    }
}
