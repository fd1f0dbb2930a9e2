//! What the controls set: plain data, so that the panel, the keys and scripts change the same thing.

use crate::stage::Method;
use serde::{Deserialize, Serialize};
use svs_runtime::{DEFAULT_QUALITY, Detail, Metric, Settings};

/// What colours mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Colours {
    /// The file's materials.
    #[default]
    Material,
    /// One colour per object.
    Object,
    /// From how far outside the object is seen, from any side.
    Level,
    /// The largest size the object has in any direction.
    Importance,
    /// What is a proxy, what is simplified, what is an object as it is.
    Proxies,
    /// How much less the error counts because little is visible.
    Severity,
}

impl Colours {
    /// All of them, in the order of the panel.
    pub(crate) const ALL: [Colours; 6] = [
        Colours::Material,
        Colours::Object,
        Colours::Level,
        Colours::Importance,
        Colours::Proxies,
        Colours::Severity,
    ];

    /// For people.
    pub(crate) fn label(self) -> &'static str {
        match self {
            Colours::Material => "material",
            Colours::Object => "object",
            Colours::Level => "visible level",
            Colours::Importance => "importance",
            Colours::Proxies => "proxies",
            Colours::Severity => "severity",
        }
    }
}

/// What limits a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Limit {
    /// Nothing.
    #[default]
    None,
    /// [`State::triangles`].
    Triangles,
    /// [`State::milliseconds`].
    Milliseconds,
}

/// How much of the error counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum MetricName {
    /// All of it.
    Sse,
    /// In proportion to the visible share.
    Linear,
    /// By [`State::sigmoid_s`] and [`State::sigmoid_t`].
    #[default]
    Sigmoid,
}

/// All settings.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct State {
    /// How it is decided what is drawn.
    #[serde(serialize_with = "as_text")]
    pub(crate) method: Method,
    /// 0 (fewest triangles) to 1 (fewest missing pixels): [`Settings::from_quality`].
    pub(crate) quality: f32,
    /// Spheres that subtend more than this half-angle are not used, degrees, 0 to 90.
    pub(crate) sphere_limit: f32,
    /// Which budget applies.
    pub(crate) limit: Limit,
    /// Triangle budget.
    pub(crate) triangles: u64,
    /// Time budget, milliseconds per frame.
    pub(crate) milliseconds: f64,
    /// Proxies and simplified objects are drawn, where the file has them.
    pub(crate) proxies: bool,
    /// Largest error of what is simplified, pixels, 0 to 1000.
    pub(crate) tau: f32,
    /// How much of it counts.
    pub(crate) metric: MetricName,
    /// From linear (0) to sigmoid (1).
    pub(crate) sigmoid_s: f32,
    /// Visible share at which the sigmoid turns over, 0 to 1.
    pub(crate) sigmoid_t: f32,
    /// What is drawn stays as it is while the camera moves.
    pub(crate) freeze: bool,
    /// While frozen: what is skipped is drawn too, in red.
    pub(crate) skipped: bool,
    /// While frozen: boxes of what is skipped are drawn, to look through.
    pub(crate) skipped_boxes: bool,
    /// Spheres in use are drawn.
    pub(crate) spheres: bool,
    /// What colours mean.
    pub(crate) colours: Colours,
    /// Draw all the time, not only when something changes.
    pub(crate) continuous: bool,
    /// Graphs are open.
    pub(crate) graphs: bool,
    /// The panel is open.
    pub(crate) panel: bool,
    /// The keys are explained.
    pub(crate) help: bool,
    /// The object clicked at.
    pub(crate) selected: Option<u32>,
    /// File that camera paths are written to and played from.
    pub(crate) path_file: String,
}

fn as_text<S: serde::Serializer>(method: &Method, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(method)
}

impl Default for State {
    fn default() -> Self {
        Self {
            method: Method::Visibility,
            quality: DEFAULT_QUALITY,
            sphere_limit: 90.0,
            limit: Limit::None,
            triangles: 1_000_000,
            milliseconds: 16.0,
            proxies: true,
            tau: Detail::default().tau,
            metric: MetricName::Sigmoid,
            sigmoid_s: DEFAULT_SIGMOID.0,
            sigmoid_t: DEFAULT_SIGMOID.1,
            freeze: false,
            skipped: false,
            skipped_boxes: false,
            spheres: false,
            colours: Colours::Material,
            continuous: false,
            graphs: false,
            panel: true,
            help: false,
            selected: None,
            path_file: "camera-path.json".to_owned(),
        }
    }
}

/// As [`crate::stage::SIGMOID`] has them.
const DEFAULT_SIGMOID: (f32, f32) = (0.7, 0.15);

/// Largest error that can be set, pixels.
const MOST_TAU: f32 = 1000.0;

impl State {
    /// How coarse it may be.
    pub(crate) fn detail(&self) -> Detail {
        let metric = match self.metric {
            MetricName::Sse => Metric::Sse,
            MetricName::Linear => Metric::Linear,
            MetricName::Sigmoid => Metric::Sigmoid { s: self.sigmoid_s, t: self.sigmoid_t },
        };
        Detail { tau: self.tau, metric }
    }

    /// Sets the metric, and the numbers of a sigmoid.
    pub(crate) fn set_metric(&mut self, metric: Metric) {
        match metric {
            Metric::Sse => self.metric = MetricName::Sse,
            Metric::Linear => self.metric = MetricName::Linear,
            Metric::Sigmoid { s, t } => {
                (self.metric, self.sigmoid_s, self.sigmoid_t) = (MetricName::Sigmoid, s, t);
            }
        }
    }

    /// How to query: the quality, and the sphere limit where it is stricter.
    pub(crate) fn settings(&self) -> Settings {
        let by_quality = Settings::from_quality(self.quality);
        let limit = if self.sphere_limit.is_finite() { self.sphere_limit.clamp(0.0, 90.0) } else { 90.0 };
        Settings { max_half_angle: by_quality.max_half_angle.min(limit.to_radians()), ..by_quality }
    }

    /// Brings values back into their ranges; scripts may set anything.
    pub(crate) fn check(&mut self) {
        self.quality = if self.quality.is_nan() { DEFAULT_QUALITY } else { self.quality.clamp(0.0, 1.0) };
        self.sphere_limit =
            if self.sphere_limit.is_nan() { 90.0 } else { self.sphere_limit.clamp(0.0, 90.0) };
        self.triangles = self.triangles.max(1);
        let within = |value: f32, most: f32, otherwise: f32| {
            if value.is_nan() { otherwise } else { value.clamp(0.0, most) }
        };
        self.tau = within(self.tau, MOST_TAU, Detail::default().tau);
        self.sigmoid_s = within(self.sigmoid_s, 1.0, DEFAULT_SIGMOID.0);
        self.sigmoid_t = within(self.sigmoid_t, 1.0, DEFAULT_SIGMOID.1);
        self.milliseconds =
            if self.milliseconds.is_nan() { 16.0 } else { self.milliseconds.clamp(0.1, 10_000.0) };
    }

    /// The method after the present one.
    pub(crate) fn next_method(&mut self) {
        let index = Method::ALL.iter().position(|&method| method == self.method).unwrap_or(0);
        self.method = Method::ALL[(index + 1) % Method::ALL.len()];
    }

    /// The colours after the present ones.
    pub(crate) fn next_colours(&mut self) {
        let index = Colours::ALL.iter().position(|&colours| colours == self.colours).unwrap_or(0);
        self.colours = Colours::ALL[(index + 1) % Colours::ALL.len()];
    }

    /// Another scene is shown: what belonged to the old one goes, settings stay.
    pub(crate) fn forget_scene(&mut self) {
        self.selected = None;
        self.freeze = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stricter_of_quality_and_sphere_limit_counts() {
        let mut state = State::default();
        assert_eq!(state.settings(), Settings::default());
        state.sphere_limit = 45.0;
        assert!((state.settings().max_half_angle.to_degrees() - 45.0).abs() < 1e-4);
        state.quality = 1.0;
        assert!((state.settings().max_half_angle.to_degrees() - 30.0).abs() < 1e-4);
        for odd in [f32::NAN, f32::INFINITY, -5.0, 500.0] {
            state.sphere_limit = odd;
            let angle = state.settings().max_half_angle.to_degrees();
            assert!((0.0..=90.001).contains(&angle), "{odd} gives {angle}");
        }
    }

    #[test]
    fn odd_values_are_brought_back() {
        let mut state = State {
            quality: f32::NAN,
            sphere_limit: 400.0,
            triangles: 0,
            milliseconds: f64::NEG_INFINITY,
            tau: f32::INFINITY,
            sigmoid_s: -1.0,
            sigmoid_t: f32::NAN,
            ..State::default()
        };
        state.check();
        assert_eq!((state.tau, state.sigmoid_s, state.sigmoid_t), (1000.0, 0.0, 0.15));
        assert_eq!((state.quality, state.sphere_limit), (DEFAULT_QUALITY, 90.0));
        assert_eq!((state.triangles, state.milliseconds), (1, 0.1));
    }

    #[test]
    fn the_metric_is_what_was_set() {
        let mut state = State::default();
        assert_eq!(state.detail(), Detail::default());
        for metric in [Metric::Sse, Metric::Linear, Metric::Sigmoid { s: 0.9, t: 0.05 }] {
            state.set_metric(metric);
            assert_eq!(state.detail().metric, metric);
        }
    }

    #[test]
    fn methods_and_colours_go_round() {
        let mut state = State::default();
        for _ in Method::ALL {
            state.next_method();
        }
        for _ in Colours::ALL {
            state.next_colours();
        }
        assert_eq!(state, State::default());
        state.next_method();
        assert_eq!(state.method, Method::Exact);
    }
}
