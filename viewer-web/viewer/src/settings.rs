//! What the controls of the page set.

use svs::stage::Method;
use svs_runtime::{DEFAULT_QUALITY, Detail, Settings};

/// How much may be drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Limit {
    /// All that culling lets through.
    None,
    /// Triangles of a frame.
    Triangles(u64),
    /// Milliseconds of a frame.
    Milliseconds(f64),
}

/// All settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Controls {
    pub(crate) method: Method,
    /// 0 (fewest triangles) to 1 (fewest missing pixels).
    pub(crate) quality: f32,
    pub(crate) limit: Limit,
    /// Proxies and simplified objects are drawn, where the file has them.
    pub(crate) proxies: bool,
    /// Largest error of what is simplified, pixels.
    pub(crate) tau: f32,
    /// What is drawn stays as it is while the camera moves.
    pub(crate) freeze: bool,
    pub(crate) selected: Option<u32>,
}

impl Default for Controls {
    fn default() -> Self {
        Self {
            method: Method::Visibility,
            quality: DEFAULT_QUALITY,
            limit: Limit::None,
            proxies: true,
            tau: 4.0,
            freeze: false,
            selected: None,
        }
    }
}

impl Controls {
    pub(crate) fn settings(&self) -> Settings {
        Settings::from_quality(self.quality)
    }

    pub(crate) fn detail(&self) -> Detail {
        Detail { tau: self.tau, ..Detail::default() }
    }
}
