//! A scene with its baked visibility.

use crate::SceneError;
use crate::bake::Bake;
use crate::cull::Statistics;
use crate::describe::{Description, Graph};
use crate::extras::{Extra, Extras};
use crate::places::Places;
use glam::DAffine3;
use svs_runtime::{CostModel, Detail, Draw, SceneCuller, Settings};

/// A scene with its baked visibility: which objects are drawn for a camera.
///
/// Objects are numbered as in the [`Description`]. What is drawn in place of objects ([`Extra`]) has the numbers after those.
#[derive(Debug)]
pub struct Scene {
    pub(crate) graph: Graph,
    pub(crate) places: Places,
    pub(crate) culler: SceneCuller,
    pub(crate) extras: Extras,
    /// What stands for each object in the culler's answers; `None` for objects in no tree.
    pub(crate) draws: Vec<Option<Draw>>,
    /// Hidden by the user.
    pub(crate) hidden: Vec<bool>,
    /// Moved out of their tree.
    pub(crate) released: Vec<bool>,
    /// From the scene's space to world space.
    pub(crate) root: DAffine3,
    pub(crate) settings: Settings,
    pub(crate) detail: Detail,
    pub(crate) model: CostModel,
    pub(crate) ids: Vec<u32>,
    pub(crate) statistics: Statistics,
    notice: Option<String>,
}

impl Scene {
    /// Finds the objects of the baked trees in the scene. If nothing but the proxies is broken, they are left out, see
    /// [`Self::notice`].
    ///
    /// # Errors
    /// [`SceneError`] if the baked visibility is broken or of another state of the scene.
    pub fn new(description: &Description, bake: &Bake) -> Result<Self, SceneError> {
        let (scene, error) = match Self::with(description, bake, true) {
            Err(error) if bake.has_proxies() => (Self::with(description, bake, false), Some(error)),
            other => (other, None),
        };
        let mut scene = scene?;
        scene.notice = error.map(|error| format!("the proxies cannot be used ({error}); drawn without them"));
        Ok(scene)
    }

    fn with(description: &Description, bake: &Bake, proxies: bool) -> Result<Self, SceneError> {
        let graph = Graph::new(description)?;
        let places = Places::new(bake.decode(proxies)?, description, &graph)?;
        let mut culler = places.culler(description, &graph)?;
        let extras = Extras::new(description, &graph, &places, &mut culler)?;
        let mut draws = vec![None; graph.objects.len()];
        for (draw, object) in places.draws() {
            // A file may name one object in two trees: the first one stands for it.
            draws[object as usize].get_or_insert(draw);
        }
        let qualities = places.visibility.trees().iter().filter_map(|tree| tree.recommended_quality());
        let settings = qualities.reduce(f32::max).map_or_else(Settings::default, Settings::from_quality);
        Ok(Self {
            hidden: vec![false; draws.len()],
            released: vec![false; draws.len()],
            root: DAffine3::IDENTITY,
            settings,
            detail: Detail::default(),
            model: CostModel::new(),
            ids: Vec::new(),
            statistics: Statistics::default(),
            notice: None,
            graph,
            places,
            culler,
            extras,
            draws,
        })
    }

    /// Why the file's proxies are not used.
    pub fn notice(&self) -> Option<&str> {
        self.notice.as_deref()
    }

    /// Quality that the file recommends: the highest of its trees', since all share one slider.
    pub fn recommended_quality(&self) -> Option<f32> {
        let trees = self.places.visibility.trees();
        trees.iter().filter_map(|tree| tree.recommended_quality()).reduce(f32::max)
    }

    /// Number of objects.
    pub fn object_count(&self) -> usize {
        self.draws.len()
    }

    /// A tree decides whether the object is drawn. All others are the application's: draw them as if there were no bake.
    pub fn is_baked(&self, object: u32) -> bool {
        self.draws.get(object as usize).is_some_and(|draw| draw.is_some())
    }

    /// What is drawn in place of objects.
    pub fn extras(&self) -> &[Extra] {
        &self.extras.list
    }

    /// Hides an object or shows it again: what it hid appears. Objects that do not exist are ignored.
    pub fn set_hidden(&mut self, object: u32, hidden: bool) {
        let index = object as usize;
        let Some(slot) = self.hidden.get_mut(index) else { return };
        *slot = hidden;
        if let Some(draw) = self.draws[index] {
            self.culler.set_hidden(draw, hidden || self.released[index]);
        }
    }
}
