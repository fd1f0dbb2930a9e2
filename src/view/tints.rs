//! Colours that stand for something, per object.

use super::state::Colours;
use crate::stage::{ColourMode, Stage};

/// As the material is.
pub(crate) const NONE: [u8; 4] = [0, 0, 0, 0];
/// Skipped by culling: red, with some shading left.
pub(crate) const SKIPPED: [u8; 4] = [225, 40, 40, 190];
/// Selected.
pub(crate) const SELECTED: [u8; 4] = [255, 150, 30, 170];

/// A tint for each object; empty where materials are shown.
pub(crate) fn base(stage: &Stage, colours: Colours) -> Vec<[u8; 4]> {
    match colours {
        Colours::Material => Vec::new(),
        Colours::Object => stage.tints(ColourMode::Object),
        Colours::Level => stage.tints(ColourMode::Level),
        Colours::Importance => stage.tints(ColourMode::Importance),
        Colours::Proxies => stage.tints(ColourMode::Proxies),
        Colours::Severity => stage.tints(ColourMode::Severity),
    }
}
