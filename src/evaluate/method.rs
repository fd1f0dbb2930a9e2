//! Ways to decide what a frame draws.

use super::options::OptionError;
use std::fmt;
use std::str::FromStr;
use svs_runtime::Metric;

/// What decides which objects a frame draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum EvaluationMethod {
    /// Everything is drawn.
    Nothing,
    /// Hierarchical frustum culling: the reference.
    Frustum,
    /// Spherical visibility at the chosen quality.
    Visibility,
    /// What the item buffer of the reference shows, and nothing else. Finding it is not part of its time.
    Exact,
    /// Spherical visibility within a budget.
    Budget,
    /// Spherical visibility within the same budget by the rule of Eikel's dissertation (2013): in order of visible pixels
    /// per triangle up to the first object that does not fit.
    FirstMisfit,
    /// Spherical visibility, simplified levels and proxies by [`super::EvaluateOptions::detail`], within the budget if there is one.
    Proxies,
    /// The same with the screen-space error alone, whatever is visible of it.
    ProxiesSse,
    /// The same with an error that counts in proportion to the visible share.
    ProxiesLinear,
    /// Proxies without visibility: frustum culling and the screen-space error.
    ProxiesFrustum,
}

impl EvaluationMethod {
    /// All of them.
    pub const ALL: [Self; 10] = [
        Self::Nothing,
        Self::Frustum,
        Self::Visibility,
        Self::Exact,
        Self::Budget,
        Self::FirstMisfit,
        Self::Proxies,
        Self::ProxiesSse,
        Self::ProxiesLinear,
        Self::ProxiesFrustum,
    ];

    /// As on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Nothing => "nothing",
            Self::Frustum => "frustum",
            Self::Visibility => "visibility",
            Self::Exact => "exact",
            Self::Budget => "budget",
            Self::FirstMisfit => "first-misfit",
            Self::Proxies => "proxies",
            Self::ProxiesSse => "proxies-sse",
            Self::ProxiesLinear => "proxies-linear",
            Self::ProxiesFrustum => "proxies-frustum",
        }
    }

    /// It draws proxies: its metric, or `None` for that of the options.
    pub fn draws_proxies(self) -> Option<Option<Metric>> {
        match self {
            Self::Proxies => Some(None),
            Self::ProxiesSse | Self::ProxiesFrustum => Some(Some(Metric::Sse)),
            Self::ProxiesLinear => Some(Some(Metric::Linear)),
            _ => None,
        }
    }

    /// What it draws depends on the frames before.
    pub(super) fn has_memory(self) -> bool {
        self == Self::Budget || self.draws_proxies().is_some()
    }

    /// It needs [`super::EvaluateOptions::budget`].
    pub fn is_budgeted(self) -> bool {
        matches!(self, Self::Budget | Self::FirstMisfit)
    }
}

impl fmt::Display for EvaluationMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for EvaluationMethod {
    type Err = OptionError;

    fn from_str(text: &str) -> Result<Self, OptionError> {
        let found = Self::ALL.into_iter().find(|method| method.name() == text);
        found.ok_or_else(|| OptionError::Method(text.to_owned()))
    }
}
