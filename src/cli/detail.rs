//! Options about proxies, for the commands that draw.

use clap::{Args, ValueEnum};
use svs::stage::parse_metric;
use svs_runtime::{Detail, Metric};

/// How coarse a picture may be.
#[derive(Clone, Debug, Args)]
pub(crate) struct DetailArgs {
    /// Draw simplified where the error is at most this many pixels (tau) [default: 1]
    #[arg(long, value_name = "TAU_PX", value_parser = pixels)]
    pub(crate) detail: Option<f32>,
    /// What the error counts: in full (`sse`), or less where little is visible (`linear`, `sigmoid` or `sigmoid:S,T`)
    /// [default: sigmoid:0.7,0.15]
    #[arg(long, value_name = "sse|linear|sigmoid[:S,T]", value_parser = metric)]
    pub(crate) metric: Option<Metric>,
}

impl DetailArgs {
    /// What was asked for, else the runtime's defaults.
    pub(crate) fn detail(&self) -> Detail {
        let default = Detail::default();
        Detail { tau: self.detail.unwrap_or(default.tau), metric: self.metric.unwrap_or(default.metric) }
    }

    /// Something was asked for.
    pub(crate) fn is_given(&self) -> bool {
        self.detail.is_some() || self.metric.is_some()
    }
}

/// `on` or `off`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Switch {
    On,
    Off,
}

fn pixels(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value),
        _ => Err("a number of pixels, 0 or more, is needed, such as 1 or 0.5".to_owned()),
    }
}

fn metric(text: &str) -> Result<Metric, String> {
    parse_metric(text).map_err(|error| error.to_string())
}
