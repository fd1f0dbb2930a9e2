//! What to draw for a camera.

use super::{Method, Stage, object_of};
use svs_render::View;
use svs_runtime::{Budget, Settings};

impl Stage {
    /// The objects to draw, in the order of [`Stage::order`]. `width` and `height` are the image in pixels.
    ///
    /// `settings` hold for [`Method::Visibility`], `budget` for all methods but [`Method::Nothing`]. [`Method::Exact`] is
    /// the item buffer of the caller: its candidates are those of the frustum.
    pub fn cull(
        &mut self,
        view: &View,
        width: u32,
        height: u32,
        method: Method,
        settings: &Settings,
        budget: &Budget<'_>,
    ) -> &[u32] {
        self.drawn.clear();
        self.ratios.clear();
        let settings = match method {
            Method::Nothing => {
                let hidden = &self.hidden;
                self.drawn.extend(self.order[..self.own].iter().filter(|&&object| !hidden[object as usize]));
                return &self.drawn;
            }
            Method::Frustum | Method::Exact => &Settings::FRUSTUM,
            Method::Visibility => settings,
        };
        let draws = self.culler.cull_within(&Self::camera(view, width, height), settings, budget);
        let objects = draws.iter().filter_map(|&draw| object_of(self.baked.as_ref(), &self.loose, draw));
        self.drawn.extend(objects);
        &self.drawn
    }
}
