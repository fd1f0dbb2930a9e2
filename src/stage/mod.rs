//! A file opened for drawing: its scene, its looks, and what to draw of it for a camera.
//!
//! Files without baked visibility, or with one that is broken or of another state of the scene, are opened too: they are
//! culled by the frustum alone, and [`Stage::notice`] says why.
//!
//! Proxies and simplified levels of meshes are further objects of [`Stage::data`], after those of the scene: what draws
//! needs no change for them. [`Stage::select`] chooses among all; [`Stage::cull`] knows the scene's own objects alone.

mod colours;
mod cull;
#[cfg(feature = "render")]
mod exact;
mod extras;
mod method;
mod metric;
mod open;
pub mod overlay;
mod select;
#[cfg(all(test, feature = "render"))]
mod tests;

pub use colours::{ColourMode, UnknownColourMode, heat, object_colour, palette};
#[cfg(feature = "render")]
pub use exact::visible_objects;
pub use extras::Extra;
pub use method::{Method, UnknownMethod};
pub use metric::{SIGMOID, UnknownMetric, metric_name, parse_metric};
pub use open::StageError;
pub use select::Kind;

use crate::baked::Baked;
use crate::scene::{Note, Scene};
#[cfg(feature = "bake")]
use crate::verify::Surroundings;
use crate::volume::Aabb;
#[cfg(feature = "bake")]
use crate::volume::Sphere;
use extras::Extras;
use glam::DVec3;
use svs_render::{SceneData, View};
use svs_runtime::{Camera, Draw, LOOSE, SceneCuller, Settings, Tree};

/// A file opened for drawing. Objects have the same index in [`Stage::scene`], in [`Stage::data`] and everywhere else;
/// proxies and levels have those after them.
#[derive(Debug)]
pub struct Stage {
    /// The scene as the bake reads it.
    pub scene: Scene,
    /// Its looks.
    pub data: SceneData,
    /// Name of each object's node.
    pub names: Vec<Option<String>>,
    /// Counted notes on what was left out of the looks.
    pub notes: Vec<Note>,
    baked: Option<Baked>,
    notice: Option<String>,
    culler: SceneCuller,
    settings: Settings,
    /// Proxies and levels, if there are any.
    extras: Option<Extras>,
    /// Objects in the order in which the culler answers, then levels and proxies.
    order: Vec<u32>,
    /// How many of them are objects of the scene.
    own: usize,
    /// What stands for each object in the culler's answers; `None` for those that are never drawn.
    draws: Vec<Option<Draw>>,
    /// Drawable objects in no tree.
    loose: Vec<u32>,
    boxes: Vec<Aabb>,
    bounds: Aabb,
    triangles: Vec<u32>,
    hidden: Vec<bool>,
    drawn: Vec<u32>,
    /// Of what was drawn last, where it was selected: the share of its error that counted.
    ratios: Vec<f32>,
}

impl Stage {
    /// The file has baked visibility that can be used.
    pub fn is_baked(&self) -> bool {
        self.baked.is_some()
    }

    /// Why baked visibility is there but not used, for people.
    pub fn notice(&self) -> Option<&str> {
        self.notice.as_deref()
    }

    /// All drawable objects in the order in which culling answers.
    pub fn order(&self) -> &[u32] {
        &self.order[..self.own]
    }

    /// [`Stage::order`], then levels and proxies, neighbours beside each other: what to upload the scene with.
    pub fn upload_order(&self) -> &[u32] {
        &self.order
    }

    /// The trees of the baked visibility; empty without.
    pub fn trees(&self) -> &[std::sync::Arc<Tree>] {
        self.baked.as_ref().map_or(&[], Baked::trees)
    }

    /// Box of everything that is drawn, world space; a unit cube around the origin if that is nothing.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        (self.bounds.min, self.bounds.max)
    }

    /// Radius in metres of a sphere around [`Stage::bounds`].
    pub fn radius(&self) -> f64 {
        (self.bounds.max - self.bounds.min).length() * 0.5
    }

    /// Box of an object, world space; a point where it stands if it has no geometry or does not exist.
    pub fn object_bounds(&self, object: u32) -> (DVec3, DVec3) {
        let at = self.scene.objects.get(object as usize).map_or(DVec3::ZERO, |o| o.to_world.translation);
        match self.boxes.get(object as usize).filter(|bounds| !bounds.is_empty()) {
            Some(bounds) => (bounds.min, bounds.max),
            None => (at, at),
        }
    }

    /// What generated cameras are placed around.
    #[cfg(feature = "bake")]
    pub fn surroundings(&self) -> Surroundings<'_> {
        let Aabb { min, max } = self.bounds;
        let sphere = Sphere { center: self.bounds.center(), radius: (max - min).length() * 0.5 };
        Surroundings { sphere, bounds: self.bounds, objects: &self.boxes }
    }

    /// Triangles of each object.
    pub fn triangles(&self) -> &[u32] {
        &self.triangles
    }

    /// Settings that the file recommends, else the default ones.
    pub fn recommended(&self) -> Settings {
        self.settings
    }

    /// Quality of [`Stage::recommended`], 0 to 1.
    pub fn recommended_quality(&self) -> f32 {
        self.baked.as_ref().and_then(Baked::recommended).unwrap_or(svs_runtime::DEFAULT_QUALITY)
    }

    /// The runtime's culler.
    pub fn culler(&mut self) -> &mut SceneCuller {
        &mut self.culler
    }

    /// What stands for an object in the culler's answers; `None` if it is never drawn.
    pub fn draw_of(&self, object: u32) -> Option<Draw> {
        self.draws.get(object as usize).copied().flatten()
    }

    /// The object that an answer of the culler stands for.
    pub fn object_of(&self, draw: Draw) -> Option<u32> {
        object_of(self.baked.as_ref(), &self.loose, draw)
    }

    /// Hides an object, or shows it again.
    pub fn set_hidden(&mut self, object: u32, hidden: bool) {
        if let (Some(draw), Some(slot)) = (self.draw_of(object), self.hidden.get_mut(object as usize)) {
            *slot = hidden;
            self.culler.set_hidden(draw, hidden);
        }
    }

    /// The runtime's camera for a view of this size in pixels.
    pub fn camera(view: &View, width: u32, height: u32) -> Camera {
        let (width, height) = (f64::from(width), f64::from(height));
        Camera::perspective(view.view_matrix(), view.vertical_fov, width, height, view.near)
    }
}

/// Not a method, so that the culler's answer may stay borrowed meanwhile.
fn object_of(baked: Option<&Baked>, loose: &[u32], draw: Draw) -> Option<u32> {
    if draw.tree == LOOSE {
        return loose.get(draw.object as usize).copied();
    }
    baked?.object_of(draw)
}
