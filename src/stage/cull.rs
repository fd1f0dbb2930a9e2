//! What to draw for a camera.

use super::{Method, Stage, object_of};
use crate::baked::outward;
use svs_render::View;
use svs_runtime::Settings;

impl Stage {
    /// The objects to draw, in the order of [`Stage::order`] as far as the culler keeps to it. `width` and `height` are the
    /// image in pixels. [`Method::Exact`] is the item buffer of the caller: its candidates are those of the frustum.
    pub fn cull(
        &mut self,
        view: &View,
        width: u32,
        height: u32,
        method: Method,
        settings: &Settings,
    ) -> &[u32] {
        let settings = match method {
            Method::Nothing => {
                self.drawn.clear();
                let hidden = &self.hidden;
                self.drawn.extend(self.order.iter().filter(|&&object| !hidden[object as usize]));
                return &self.drawn;
            }
            Method::Frustum | Method::Exact => Settings { max_half_angle: 0.0, ..*settings },
            Method::Visibility => *settings,
        };
        let camera = Self::camera(view, width, height);
        self.drawn.clear();
        let draws = self.culler.cull(&camera, &settings);
        let objects = draws.iter().filter_map(|&draw| object_of(self.baked.as_ref(), &self.loose, draw));
        self.drawn.extend(objects);
        let is_seen = |object: usize| {
            !self.hidden[object] && outward(&self.boxes[object]).is_none_or(|bounds| camera.sees(&bounds))
        };
        self.drawn.extend(self.loose.iter().filter(|&&object| is_seen(object as usize)));
        &self.drawn
    }
}
