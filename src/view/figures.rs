//! Live figures and their recent past, for the graphs.

use serde::Serialize;

/// Frames a graph shows.
pub(crate) const HISTORY: usize = 240;

/// Figures of one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub(crate) struct FrameFigures {
    /// From the begin of batching until the GPU has drawn the scene, milliseconds.
    pub(crate) frame_ms: f64,
    /// What culling took, microseconds.
    pub(crate) cull_us: f64,
    /// Objects that culling lets through.
    pub(crate) objects: usize,
    /// Draw calls.
    pub(crate) draws: usize,
    /// Triangles of these objects.
    pub(crate) triangles: u64,
    /// Proxies among them.
    pub(crate) proxies: usize,
    /// Simplified objects among them.
    pub(crate) simplified: usize,
    /// HLOD nodes that are drawn, see [`crate::stage::Stage::nodes_shown`].
    pub(crate) nodes: usize,
    /// Estimated pixels of what was left out for its size or the budget, per million pixels of the image.
    pub(crate) estimated_missing_ppm: f64,
}

/// What a graph can show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Figure {
    /// [`FrameFigures::frame_ms`].
    Frame,
    /// [`FrameFigures::cull_us`].
    Cull,
    /// [`FrameFigures::draws`].
    Draws,
    /// [`FrameFigures::triangles`].
    Triangles,
    /// [`FrameFigures::estimated_missing_ppm`].
    Missing,
}

impl Figure {
    /// All of them, in the order of the graphs.
    pub(crate) const ALL: [Figure; 5] =
        [Figure::Frame, Figure::Cull, Figure::Draws, Figure::Triangles, Figure::Missing];

    /// Name and unit.
    pub(crate) fn title(self) -> &'static str {
        match self {
            Figure::Frame => "frame, ms",
            Figure::Cull => "cull, µs",
            Figure::Draws => "draw calls",
            Figure::Triangles => "triangles",
            Figure::Missing => "est. missing, ppm",
        }
    }

    /// Its value.
    pub(crate) fn of(self, figures: &FrameFigures) -> f64 {
        match self {
            Figure::Frame => figures.frame_ms,
            Figure::Cull => figures.cull_us,
            Figure::Draws => figures.draws as f64,
            Figure::Triangles => figures.triangles as f64,
            Figure::Missing => figures.estimated_missing_ppm,
        }
    }
}

/// The last [`HISTORY`] frames, in a ring.
#[derive(Clone, Debug, Default)]
pub(crate) struct History {
    frames: Vec<FrameFigures>,
    /// Where the next frame goes once the ring is full.
    next: usize,
    total: u64,
}

impl History {
    /// Adds a frame and forgets the oldest.
    pub(crate) fn push(&mut self, figures: FrameFigures) {
        if self.frames.len() < HISTORY {
            self.frames.push(figures);
        } else {
            self.frames[self.next] = figures;
            self.next = (self.next + 1) % HISTORY;
        }
        self.total += 1;
    }

    /// The newest frame.
    pub(crate) fn last(&self) -> FrameFigures {
        self.iter().next_back().copied().unwrap_or_default()
    }

    /// From the oldest to the newest.
    pub(crate) fn iter(&self) -> impl DoubleEndedIterator<Item = &FrameFigures> {
        let (newer, older) = self.frames.split_at(self.next);
        older.iter().chain(newer)
    }

    /// Frames ever seen.
    pub(crate) fn total(&self) -> u64 {
        self.total
    }

    /// Median over the frames kept; 0 without frames.
    pub(crate) fn median(&self, figure: Figure) -> f64 {
        let mut values: Vec<f64> = self.frames.iter().map(|frame| figure.of(frame)).collect();
        if values.is_empty() {
            return 0.0;
        }
        let middle = values.len() / 2;
        *values.select_nth_unstable_by(middle, f64::total_cmp).1
    }

    /// Another scene: nothing of before counts.
    pub(crate) fn clear(&mut self) {
        *self = Self::default();
    }
}

/// 1234567 as "1 234 567": long counts are read at a glance.
pub(crate) fn grouped(value: u64) -> String {
    let digits = value.to_string();
    let mut text = String::with_capacity(digits.len() * 4 / 3);
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push('\u{2009}');
        }
        text.push(digit);
    }
    text
}

/// 1234567 as "1.23 M", for axes.
pub(crate) fn short(value: f64) -> String {
    let (scaled, unit) = match value.abs() {
        x if x >= 1e9 => (value / 1e9, " G"),
        x if x >= 1e6 => (value / 1e6, " M"),
        x if x >= 1e4 => (value / 1e3, " k"),
        _ => (value, ""),
    };
    let digits = match scaled.abs() {
        x if x >= 100.0 || x == x.round() => 0,
        x if x >= 10.0 => 1,
        _ => 2,
    };
    format!("{scaled:.digits$}{unit}")
}

/// Distance of the marks of an axis from 0 to `largest`: 1, 2 or 5 times a power of ten, three to seven of them.
pub(crate) fn step(largest: f64) -> f64 {
    let rough = if largest.is_finite() { largest.max(1e-3) / 3.0 } else { 1.0 };
    let power = 10_f64.powf(rough.log10().floor());
    let digit = [5.0, 2.0, 1.0].into_iter().find(|digit| digit * power <= rough).unwrap_or(1.0);
    digit * power
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(frame_ms: f64) -> FrameFigures {
        FrameFigures { frame_ms, ..FrameFigures::default() }
    }

    #[test]
    fn the_ring_keeps_the_newest_in_order() {
        let mut history = History::default();
        assert_eq!((history.last(), history.median(Figure::Frame)), (FrameFigures::default(), 0.0));
        for i in 0..HISTORY * 2 + 17 {
            history.push(frame(i as f64));
            assert_eq!(history.last().frame_ms, i as f64);
        }
        let kept: Vec<f64> = history.iter().map(|figures| figures.frame_ms).collect();
        let expected: Vec<f64> = (HISTORY + 17..HISTORY * 2 + 17).map(|i| i as f64).collect();
        assert_eq!(kept, expected);
        assert_eq!(history.total(), (HISTORY * 2 + 17) as u64);
        assert_eq!(history.median(Figure::Frame), expected[HISTORY / 2]);
    }

    #[test]
    fn an_axis_has_three_to_eight_round_marks() {
        for largest in [0.002, 0.9, 1.0, 1.7, 3.0, 59.0, 106.0, 657.0, 2.47e6] {
            let marks = largest / step(largest);
            assert!((3.0 - 1e-9..7.6).contains(&marks), "{largest}: {marks}");
        }
        assert!((step(657.0) - 200.0).abs() < 1e-9);
        assert!(step(0.0) > 0.0 && step(f64::NAN) > 0.0);
    }

    #[test]
    fn numbers_are_readable() {
        assert_eq!(grouped(0), "0");
        assert_eq!(grouped(999), "999");
        assert_eq!(grouped(1_234_567), "1\u{2009}234\u{2009}567");
        assert_eq!(short(0.0), "0");
        assert_eq!(short(0.25), "0.25");
        assert_eq!(short(2_470_000.0), "2.47 M");
        assert_eq!(short(12_500.0), "12.5 k");
    }
}
