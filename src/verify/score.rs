//! What a frame should show, and how a method's draws compare with it.

use super::item_buffer::{VisibleSet, visible_set};
use super::target::Target;
use super::view::View;
use crate::bake::rays::RayScene;

/// One camera and what is right for it.
#[derive(Clone, Debug)]
pub struct Frame {
    /// The camera.
    pub view: View,
    /// Exact visible set.
    pub visible: VisibleSet,
    /// Triangles of the exact visible set.
    pub visible_triangles: u64,
    /// Members whose box the frustum touches, ascending.
    pub in_frustum: Vec<u32>,
    /// Their triangles.
    pub frustum_triangles: u64,
}

/// A method's draws in one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Score {
    /// Members of the exact visible set that were not drawn.
    pub missing_objects: u64,
    /// Pixels that show one of them.
    pub missing_pixels: u64,
    /// Members drawn.
    pub drawn_objects: u64,
    /// Their triangles.
    pub drawn_triangles: u64,
}

impl Frame {
    /// Renders the item buffer of `view`.
    pub fn render(target: &Target, rays: &RayScene<'_>, view: View) -> Self {
        let visible = visible_set(rays, &view);
        let frustum = view.frustum();
        let in_frustum: Vec<u32> = (0..target.members.len() as u32)
            .filter(|&m| frustum.touches(&target.boxes[m as usize]))
            .collect();
        Self {
            visible_triangles: visible.iter().map(|&(member, _)| target.triangles(member)).sum(),
            frustum_triangles: in_frustum.iter().map(|&member| target.triangles(member)).sum(),
            view,
            visible,
            in_frustum,
        }
    }

    /// Compares `drawn` (members in any order, repeats allowed) with what is visible.
    pub fn score(&self, target: &Target, drawn: &mut Vec<u32>) -> Score {
        drawn.sort_unstable();
        drawn.dedup();
        let mut score = Score {
            drawn_objects: drawn.len() as u64,
            drawn_triangles: drawn.iter().map(|&member| target.triangles(member)).sum(),
            ..Score::default()
        };
        for &(member, pixels) in &self.visible {
            if drawn.binary_search(&member).is_err() {
                score.missing_objects += 1;
                score.missing_pixels += u64::from(pixels);
            }
        }
        score
    }

    /// Missing pixels per million pixels of the image.
    pub fn missing_ppm(&self, score: &Score) -> f64 {
        score.missing_pixels as f64 / self.view.pixels().max(1) as f64 * 1e6
    }
}
