//! Numbers at their extremes: large, small, far away, turned, broken.

#[allow(dead_code, reason = "shared with the golden scenes, which use all of it")]
#[path = "../golden/baking.rs"]
mod baking;
#[allow(dead_code, reason = "shared with the golden scenes, which use all of it")]
#[path = "../golden/document.rs"]
mod document;

mod broken;
mod mixed_scale;
mod placement;
mod repeated;
