//! What to draw of what is visible, and how coarse: originals, simplified levels, proxies, or nothing.

mod cut;
mod forms;
mod frame;
mod history;
mod hull;
mod metric;
pub(crate) mod mu;
mod outcome;
mod tables;
mod view;
mod within;

use crate::budget::{Budget, Capacity, Load, Price, Selection};
use crate::camera::Camera;
use crate::query::Settings;
use crate::scene::{Draw, SceneCuller};
use cut::Drawn;
use forms::Source;
use frame::{Entry, Frame};
use history::History;
use tables::Tables;
use view::Scene;
use within::{Search, Within};

pub use metric::Metric;
pub use outcome::Outcome;
pub use tables::Level;

/// How coarse things may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detail {
    /// Largest visible error of what is drawn in place of an original, in pixels. 0, less and NaN: originals only, unless a
    /// budget leaves no room for them.
    pub tau: f32,
    /// How much of its error something partly visible shows.
    pub metric: Metric,
}

impl Default for Detail {
    /// One pixel.
    fn default() -> Self {
        Self { tau: 1.0, metric: Metric::default() }
    }
}

/// Something to draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Selected {
    /// Tree and anchor; of an object or a level of it its place in tree order (of a loose object its index), of a proxy its
    /// index in [`crate::Proxies::nodes`].
    pub draw: Draw,
    /// Which of its versions.
    pub kind: SelectedKind,
    /// P(mu), 0 to 1: the share of its geometric error that counts, see [`Metric`]; 1: it counts in full.
    pub ratio: f32,
}

/// What is drawn of something.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum SelectedKind {
    /// The original.
    Object,
    /// A simplified version of the object, from 1.
    Level(u8),
    /// A mesh for a group of objects.
    Proxy,
}

/// What the last [`SceneCuller::select`] did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DetailStatistics {
    /// Proxies looked at (again and again, where a budget made that necessary).
    pub nodes_visited: usize,
    /// Proxies drawn.
    pub proxies: usize,
    /// Originals drawn.
    pub objects: usize,
    /// Simplified objects drawn.
    pub levels: usize,
    /// Triangles drawn.
    pub triangles: u64,
    /// Objects that culling answered.
    pub candidates: usize,
    /// Their triangles.
    pub candidate_triangles: u64,
}

/// State of selecting.
#[derive(Debug, Default)]
pub(crate) struct DetailState {
    tables: Tables,
    frame: Frame,
    /// The frame before, if it was selected within a budget.
    before: Frame,
    search: Search,
    selected: Vec<Selected>,
    statistics: DetailStatistics,
    /// What `selected` answers, while nothing has changed.
    asked: Option<Asked>,
}

/// A question of [`SceneCuller::select`].
#[derive(Debug, PartialEq)]
struct Asked {
    camera: Camera,
    settings: Settings,
    detail: Detail,
    budget: Option<Price>,
}

impl DetailState {
    /// Something has changed: the same question may have another answer.
    pub(crate) fn ask_again(&mut self) {
        self.asked = None;
    }

    /// Other loose objects have come.
    pub(crate) fn forget_loose(&mut self) {
        self.tables.forget_loose();
        self.forget();
    }

    /// A frame was drawn otherwise.
    pub(crate) fn forget(&mut self) {
        self.frame.layout.clear();
        self.ask_again();
    }
}

impl SceneCuller {
    /// What to draw for a camera in world space: of all that [`Self::cull`] answers the originals, or simplified levels of
    /// them ([`Self::set_levels`], [`Self::set_loose_levels`]) or proxies of whole groups where their visible error is at most `detail.tau` pixels, and
    /// never more than the budget allows. Allocates nothing once it has seen the most it will ever draw.
    ///
    /// The visible error is the geometric error as it appears in the middle of the image at the nearest point of the
    /// proxy's sphere (of the object's box), in pixels, times `detail.metric` of the share of its pixels that is visible.
    /// A proxy is not drawn while the eye is inside its sphere, while something it stands for is hidden
    /// ([`Self::set_hidden`]), or where what is visible of that has no more triangles than the proxy.
    ///
    /// Without a budget, the first proxy from the top that is fine enough is drawn, and each object on none of them at its
    /// coarsest level that is fine enough. With one, and if that does not fit, what shows most of what is visible is drawn:
    /// the best of all cuts at the price at which the budget is nearly used up, filled up with what still fits, or what
    /// [`Self::cull_within`] would choose, if that shows more. A simplified thing shows its pixels times the square of the
    /// share of them that it shows right, see [`crate::Deviation`]. Nothing is finer than `detail.tau` asks for. What was
    /// drawn in the last frame counts more, see [`Self::set_hysteresis`].
    /// [`Budget::StopAtFirstMisfit`] is taken for [`Budget::Triangles`].
    ///
    /// While nothing changes, neither does the answer: what is drawn under a budget depends on the frame before, and a camera at
    /// rest must not show that.
    ///
    /// The order is that of [`Self::cull`], but within a tree that of its proxies.
    pub fn select(
        &mut self,
        camera: &Camera,
        settings: &Settings,
        detail: &Detail,
        budget: &Budget<'_>,
    ) -> &[Selected] {
        let capacity = match *budget {
            Budget::Unlimited => None,
            Budget::Triangles(most) | Budget::StopAtFirstMisfit(most) => Some(Capacity::Triangles(most)),
            Budget::Milliseconds(most, model) => Some(Capacity::Milliseconds(most, model)),
        };
        let budget = capacity.map(|capacity| capacity.price());
        let asked = Asked { camera: *camera, settings: *settings, detail: *detail, budget };
        if self.detail.asked.as_ref() == Some(&asked) {
            return &self.detail.selected;
        }
        let mut state = std::mem::take(&mut self.detail);
        state.asked = Some(asked);
        std::mem::swap(&mut state.frame, &mut state.before);
        let before_eye = self.within.eye;
        state.frame.layout.clear();
        let entries = &mut state.frame.layout.entries;
        self.collect(camera, settings, |placed, local, way| {
            entries.push(Entry::new(placed.index, *local, way))
        });
        let way = (camera.eye() - before_eye).length_squared();
        state.frame.layout.lay_out(&self.placed, &self.within.candidates, camera, way);
        let scene = Scene {
            placed: &self.placed,
            loose: &self.loose,
            tables: &state.tables,
            candidates: &self.within.candidates,
            detail: *detail,
            clip: settings.frustum,
        };
        let Frame { layout, states } = &mut state.frame;
        states.reset(layout);
        let mut output = Output::new(&scene, &mut state.selected);
        let pending = state.search.pending();
        let mut visited =
            cut::unlimited(&scene, layout, states, pending, |entry, drawn| output.draw(entry, &drawn));
        if let Some(capacity) = capacity.filter(|capacity| !capacity.fits(output.load)) {
            states.reset(layout);
            let source = Source {
                scene: &scene,
                layout,
                history: History { frame: &state.before, factor: self.within.hysteresis },
            };
            let mut within = Within { source, states, capacity };
            visited += within.run(&mut state.search, &mut self.within.selector);
            output.clear();
            cut::chosen(&scene, layout, states, |entry, drawn| output.draw(entry, &drawn));
        }
        state.statistics = DetailStatistics {
            nodes_visited: visited,
            candidates: scene.candidates.len(),
            candidate_triangles: scene.candidates.iter().map(|c| u64::from(c.triangles)).sum(),
            ..output.statistics
        };
        let dropped = cut::dropped_pixels(&scene, layout, states);
        let (statistics, chosen) = (state.statistics, state.selected.len());
        self.within.replace(Selection {
            candidates: statistics.candidates,
            candidate_triangles: statistics.candidate_triangles,
            chosen,
            chosen_triangles: statistics.triangles,
            dropped_pixels: self.within.hits.too_small + dropped,
        });
        self.statistics.drawn = chosen;
        self.draws.clear();
        self.detail = state;
        &self.detail.selected
    }

    /// What the last [`Self::select`] did.
    pub fn detail_statistics(&self) -> DetailStatistics {
        self.detail.statistics
    }
}

/// What is drawn, and what it costs.
struct Output<'a> {
    scene: &'a Scene<'a>,
    out: &'a mut Vec<Selected>,
    load: Load,
    statistics: DetailStatistics,
}

impl<'a> Output<'a> {
    fn new(scene: &'a Scene<'a>, out: &'a mut Vec<Selected>) -> Self {
        let mut output = Self { scene, out, load: Load::default(), statistics: DetailStatistics::default() };
        output.clear();
        output
    }

    fn clear(&mut self) {
        self.out.clear();
        (self.load, self.statistics) = Default::default();
    }

    fn draw(&mut self, entry: &Entry, drawn: &Drawn<'_>) {
        let (selected, triangles, counter) = match *drawn {
            Drawn::Proxy(node, view) => {
                let placed = &self.scene.placed[entry.placed as usize];
                let draw = Draw { tree: placed.tree, anchor: placed.anchor, object: node };
                let selected = Selected { draw, kind: SelectedKind::Proxy, ratio: view.ratio as f32 };
                (selected, view.triangles, &mut self.statistics.proxies)
            }
            Drawn::Object(candidate, level, object) => {
                let draw = self.scene.candidates[candidate as usize].draw;
                let (kind, counter) = match level {
                    0 => (SelectedKind::Object, &mut self.statistics.objects),
                    _ => (SelectedKind::Level(level), &mut self.statistics.levels),
                };
                let selected = Selected { draw, kind, ratio: object.ratio as f32 };
                (selected, self.scene.level_triangles(object, level), counter)
            }
        };
        self.out.push(selected);
        *counter += 1;
        self.load = self.load.plus(triangles);
        self.statistics.triangles = self.load.triangles;
    }
}

#[cfg(test)]
mod tests;

#[cfg(test)]
mod specification;
