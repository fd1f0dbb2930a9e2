//! One frame.

use crate::scene::Scene;
use glam::{DAffine3, DMat4, DVec3};
use svs_runtime::{Budget, Camera, Detail, Metric, Settings};

/// What may be drawn in one frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Limit {
    /// Everything visible.
    #[default]
    None,
    /// So many triangles.
    Triangles(u64),
    /// What takes so many milliseconds, as learnt from [`Scene::record`].
    Milliseconds(f64),
}

/// What the last [`Scene::cull`] did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Visible objects.
    pub candidates: usize,
    /// Their triangles.
    pub candidate_triangles: u64,
    /// Things drawn.
    pub drawn: usize,
    /// Of these, proxies.
    pub proxies: usize,
    /// Of these, simplified levels of objects.
    pub levels: usize,
    /// Triangles drawn.
    pub triangles: u64,
    /// Estimated pixels of what was left out for its size or for the limit.
    pub dropped_pixels: f64,
    /// Spheres that answered for the objects in them.
    pub spheres_used: usize,
    /// Objects looked at one by one.
    pub objects_tested: usize,
}

impl Scene {
    /// Quality 0 (draws least) to 1 (misses least), see [`Settings::from_quality`].
    pub fn set_quality(&mut self, quality: f32) {
        self.settings = Settings::from_quality(quality);
    }

    /// Plain frustum culling, for comparison.
    pub fn set_frustum_only(&mut self) {
        self.settings = Settings::FRUSTUM;
    }

    /// Largest visible error of proxies and levels in pixels (0: originals only), and whether the share of it counts that is
    /// visible.
    pub fn set_detail(&mut self, tau: f32, by_visibility: bool) {
        let metric = if by_visibility { Metric::default() } else { Metric::Sse };
        self.detail = Detail { tau, metric };
    }

    /// Where the scene is in the world.
    pub fn set_root(&mut self, to_world: DAffine3) {
        self.root = to_world;
    }

    /// What to draw for a camera in world space: numbers of objects and of what is drawn in place of them.
    ///
    /// `view_projection` may have any depth convention; `pixels_per_radian` is
    /// `height / (2 tan(vertical_fov / 2))` in pixels.
    pub fn cull(
        &mut self,
        view_projection: DMat4,
        eye: DVec3,
        pixels_per_radian: f64,
        limit: Limit,
    ) -> &[u32] {
        let camera =
            Camera::from_view_projection(view_projection, eye, pixels_per_radian).to_local(&self.root);
        let budget = match limit {
            Limit::None => Budget::Unlimited,
            Limit::Triangles(most) => Budget::Triangles(most),
            Limit::Milliseconds(most) => Budget::Milliseconds(most, &self.model),
        };
        self.ids.clear();
        for selected in self.culler.select(&camera, &self.settings, &self.detail, &budget) {
            self.ids.extend(self.extras.id(selected, &self.places));
        }
        let (detail, selection) = (self.culler.detail_statistics(), self.culler.selection());
        let culled = self.culler.statistics();
        self.statistics = Statistics {
            candidates: selection.candidates,
            candidate_triangles: selection.candidate_triangles,
            drawn: self.ids.len(),
            proxies: detail.proxies,
            levels: detail.levels,
            triangles: selection.chosen_triangles,
            dropped_pixels: selection.dropped_pixels,
            spheres_used: culled.spheres_used,
            objects_tested: culled.objects_tested,
        };
        &self.ids
    }

    /// What the last [`Self::cull`] did.
    pub fn statistics(&self) -> Statistics {
        self.statistics
    }

    /// Tells how many milliseconds it took to draw what the last [`Self::cull`] answered, for [`Limit::Milliseconds`].
    pub fn record(&mut self, milliseconds: f64) {
        self.model.record(self.statistics.triangles, self.statistics.drawn as u64, milliseconds);
    }
}
