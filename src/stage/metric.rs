//! Names of the metrics of error.

use svs_runtime::Metric;

/// A text that names no metric.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{name:?} is no metric: use sse, linear, sigmoid, or sigmoid:S,T with S (0 linear to 1) and T (turning point) from 0 to 1"
)]
pub struct UnknownMetric {
    /// What was asked for.
    pub name: String,
}

/// `sse`, `linear`, `sigmoid` (the default's values) or `sigmoid:S,T`.
///
/// # Errors
/// [`UnknownMetric`]
pub fn parse_metric(text: &str) -> Result<Metric, UnknownMetric> {
    let wrong = || UnknownMetric { name: text.to_owned() };
    match text {
        "sse" => Ok(Metric::Sse),
        "linear" => Ok(Metric::Linear),
        "sigmoid" => Ok(SIGMOID),
        _ => {
            let numbers = text.strip_prefix("sigmoid:").and_then(|numbers| numbers.split_once(','));
            let share = |text: &str| text.trim().parse::<f32>().ok().filter(|x| (0.0..=1.0).contains(x));
            let shares = numbers.and_then(|(s, t)| Some((share(s)?, share(t)?)));
            shares.map(|(s, t)| Metric::Sigmoid { s, t }).ok_or_else(wrong)
        }
    }
}

/// The thesis' values for middle depth complexity (Charalambos, *HLOD Refinement Driven by Hardware Occlusion Queries*,
/// 2007).
pub const SIGMOID: Metric = Metric::Sigmoid { s: 0.7, t: 0.15 };

/// What [`parse_metric`] reads.
pub fn metric_name(metric: &Metric) -> String {
    match metric {
        Metric::Sse => "sse".to_owned(),
        Metric::Linear => "linear".to_owned(),
        Metric::Sigmoid { s, t } => format!("sigmoid:{s},{t}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_go_both_ways() {
        for metric in [Metric::Sse, Metric::Linear, SIGMOID, Metric::Sigmoid { s: 0.9, t: 0.05 }] {
            assert_eq!(parse_metric(&metric_name(&metric)), Ok(metric));
        }
        assert_eq!(parse_metric("sigmoid"), Ok(Metric::default()));
        for wrong in ["", "SSE", "sigmoid:", "sigmoid:1", "sigmoid:2,0", "sigmoid:nan,0.5", "linear:1,1"] {
            assert!(parse_metric(wrong).is_err(), "{wrong}");
        }
    }
}
