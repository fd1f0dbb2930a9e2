//! Culling within a budget.

use crate::bounds::{Bounds, BoundsError};
use crate::budget::{Budget, Capacity, Selection};
use crate::camera::Camera;
use crate::estimate::{Estimate, visible_pixels};
use crate::hits::{Hits, Measured};
use crate::loose::Loose;
use crate::query::Settings;
use crate::scene::{Draw, LOOSE, Placed, SceneCuller, walk};
use crate::select::Selector;
use crate::small::Smallest;
use glam::DVec3;
use std::cell::Cell;

/// State of culling within a budget.
#[derive(Debug)]
pub(crate) struct Within {
    /// Per tree, per object; empty where they are not known.
    triangles: Vec<Vec<u32>>,
    pub(crate) hits: Hits<Measured>,
    smallest: Smallest,
    pub(crate) candidates: Vec<Candidate>,
    pub(crate) selector: Selector,
    /// What was chosen in the last frame, ascending.
    chosen: Vec<Key>,
    /// Where the eye was then, in world space.
    pub(crate) eye: DVec3,
    pub(crate) hysteresis: f64,
    /// `None` if the last frame had no budget and dropped nothing for its size: it is then counted when asked for.
    pub(crate) selection: Option<Selection>,
}

/// Something that culling answered.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate {
    pub(crate) draw: Draw,
    pub(crate) key: Key,
    pub(crate) estimate: Estimate,
    /// The eye has hardly moved against it since the last frame.
    pub(crate) still: bool,
    pub(crate) triangles: u32,
}

/// Rank of the tree at its anchor (loose objects come last) and place in it: ascending as things are drawn.
pub(crate) type Key = (u32, u32);

/// How much more an object counts that was drawn in the last frame.
const HYSTERESIS: f64 = 1.25;

/// The eye has hardly moved against something `to_eye` away since the last frame: by `way`, squared.
pub(crate) fn is_still(to_eye: DVec3, way: f64) -> bool {
    way < MOST_PARALLAX_SQUARED * to_eye.length_squared() || way == 0.0
}

/// Squared parallax of an object between two frames (the way of the eye over its distance) from which on it counts no
/// more than others: about 6 degrees. The eye has jumped then, and there is nothing to hold on to.
const MOST_PARALLAX_SQUARED: f64 = 0.01;

/// The range of [`SceneCuller::set_hysteresis`].
const MOST_HYSTERESIS: f64 = 16.0;

impl Within {
    /// `trees` has one entry per tree.
    pub(crate) fn new(trees: &[usize]) -> Self {
        Self {
            triangles: vec![Vec::new(); trees.len()],
            hits: Hits::default(),
            smallest: Smallest::default(),
            candidates: Vec::new(),
            selector: Selector::default(),
            chosen: Vec::new(),
            eye: DVec3::ZERO,
            hysteresis: HYSTERESIS,
            selection: None,
        }
    }

    /// A frame without a budget has been drawn.
    pub(crate) fn forget(&mut self) {
        self.chosen.clear();
        self.selection = None;
    }

    /// Another pass has chosen: what was chosen here is not what was drawn last.
    pub(crate) fn replace(&mut self, selection: Selection) {
        self.chosen.clear();
        self.selection = Some(selection);
    }

    fn triangles_of(&self, tree: u32, object: u32) -> u32 {
        self.triangles.get(tree as usize).and_then(|counts| counts.get(object as usize)).copied().unwrap_or(1)
    }
}

impl SceneCuller {
    /// Triangles of each object of a tree, in tree order. Until they are known, each object counts as one triangle.
    ///
    /// # Errors
    /// [`BoundsError`] if there is no such tree or there is not one count per object.
    pub fn set_triangles(&mut self, tree: u32, triangles: &[u32]) -> Result<(), BoundsError> {
        self.detail.ask_again();
        let index = tree as usize;
        let placed = self.find(tree, 0).ok_or(BoundsError::NoTree { tree: index })?;
        let (found, expected) = (triangles.len(), self.placed[placed].instance.tree.object_count());
        if found != expected {
            return Err(BoundsError::Triangles { tree: index, found, expected });
        }
        self.within.triangles[index] = triangles.to_vec();
        Ok(())
    }

    /// Objects in no tree (skinned or moving ones, or all those of a file without a bake) by their world-space boxes and
    /// triangle counts, in place of those given before. They are culled by the frustum alone, with a hierarchy that is
    /// built here, and budgets hold for them too. They are drawn as `Draw { tree: LOOSE, anchor: 0, object: index }`.
    ///
    /// Takes `O(n log n)` time and allocates: meant for loading, or for a few moving objects per frame.
    ///
    /// # Errors
    /// [`BoundsError`] if a box is not valid or there is not one triangle count per box; the culler is then unchanged.
    pub fn set_loose(&mut self, bounds: &[Bounds], triangles: &[u32]) -> Result<(), BoundsError> {
        self.loose = Loose::new(bounds, triangles)?;
        self.within.forget();
        self.detail.forget_loose();
        self.draws.clear();
        Ok(())
    }

    /// Loose objects in the order in which they are drawn: neighbours in space are near each other.
    pub fn loose_order(&self) -> &[u32] {
        self.loose.order()
    }

    /// How much more an object counts for the budget if it was drawn in the last frame, so that little moves of the camera
    /// do not make objects come and go (where the eye moved more than a tenth of the distance to the object, it counts as
    /// any other): 1.25 unless set, clamped to 1 (each frame by itself) to 16, NaN counts as 1.
    pub fn set_hysteresis(&mut self, factor: f64) {
        self.detail.ask_again();
        self.within.hysteresis = if factor.is_nan() { 1.0 } else { factor.clamp(1.0, MOST_HYSTERESIS) };
    }

    /// What to draw within a budget: [`Self::cull`], and of that what shows most for what it costs. What is drawn never
    /// costs more than the budget. Allocates nothing once warm.
    ///
    /// An object's visible pixels are estimated as the least of those that were seen of it, the pixels of its box and those
    /// of the image (see [`Camera::pixels_per_radian`]), less where few bins around its direction see it, and are its value;
    /// one around the eye is worth the image. Objects are taken by value per triangle, or
    /// per millisecond, and one that does not fit does not keep smaller ones out. What was drawn in the last frame counts
    /// more, see [`Self::set_hysteresis`].
    pub fn cull_within(&mut self, camera: &Camera, settings: &Settings, budget: &Budget<'_>) -> &[Draw] {
        let (capacity, published) = match *budget {
            // Nothing is dropped for its size: there is nothing to estimate.
            Budget::Unlimited if sizes_are_free(settings) => return self.cull(camera, settings),
            Budget::Unlimited => (None, false),
            Budget::Triangles(most) => (Some(Capacity::Triangles(most)), false),
            Budget::Milliseconds(most, model) => (Some(Capacity::Milliseconds(most, model)), false),
            Budget::StopAtFirstMisfit(most) => (Some(Capacity::Triangles(most)), true),
        };
        self.detail.forget();
        self.collect(camera, settings, |_, _, _| ());
        let within = &mut self.within;
        let mut selection = Selection {
            candidates: within.candidates.len(),
            candidate_triangles: within.candidates.iter().map(|c| u64::from(c.triangles)).sum(),
            dropped_pixels: within.hits.too_small,
            ..Selection::default()
        };
        if let Some(capacity) = &capacity {
            let mut before = within.chosen.iter().peekable();
            let kept = !published && within.hysteresis > 1.0 && !within.chosen.is_empty();
            let steady = kept && within.candidates.iter().any(|candidate| candidate.still);
            within.selector.clear(steady);
            for candidate in &within.candidates {
                while before.next_if(|key| **key < candidate.key).is_some() {}
                let again =
                    steady && candidate.still && before.peek().is_some_and(|key| **key == candidate.key);
                let factor = if again { within.hysteresis } else { 1.0 };
                let estimate = candidate.estimate;
                let value =
                    if published { f64::from(estimate.most) } else { f64::from(estimate.expected) * factor };
                within.selector.push(value, candidate.triangles, again, capacity);
            }
            if published {
                within.selector.choose_until_misfit(capacity);
            } else {
                within.selector.choose(capacity);
            }
        }
        within.chosen.clear();
        self.draws.clear();
        let is_chosen = |index| capacity.is_none() || within.selector.is_chosen(index);
        for (index, candidate) in within.candidates.iter().enumerate() {
            if is_chosen(index) {
                self.draws.push(candidate.draw);
                selection.chosen += 1;
                selection.chosen_triangles += u64::from(candidate.triangles);
                if capacity.is_some() {
                    within.chosen.push(candidate.key);
                }
            } else {
                selection.dropped_pixels += f64::from(candidate.estimate.expected);
            }
        }
        within.selection = Some(selection);
        self.statistics.drawn = self.draws.len();
        &self.draws
    }

    /// Of what the last [`Self::cull_within`] or [`Self::cull`] chose, and how much. After [`Self::cull`], what was dropped
    /// for its size is not known and counts nothing.
    pub fn selection(&self) -> Selection {
        self.within.selection.unwrap_or_else(|| {
            let triangles = |draw: &Draw| match (draw.tree, self.loose.place(draw.object)) {
                (LOOSE, Some(place)) => self.loose.triangles(place as u32),
                _ => self.within.triangles_of(draw.tree, draw.object),
            };
            let sum = self.draws.iter().map(|draw| u64::from(triangles(draw))).sum();
            let count = self.draws.len();
            Selection {
                candidates: count,
                candidate_triangles: sum,
                chosen: count,
                chosen_triangles: sum,
                dropped_pixels: 0.0,
            }
        })
    }

    /// All that culling answers, with estimates. `enter` gets each tree that is walked, at its place, with the camera in its
    /// space and how far the eye has moved there since the last frame, squared.
    pub(crate) fn collect(
        &mut self,
        camera: &Camera,
        settings: &Settings,
        mut entered: impl FnMut(&Placed, &Camera, f64),
    ) {
        let mut candidates = std::mem::take(&mut self.within.candidates);
        let mut hits = std::mem::take(&mut self.within.hits);
        let mut smallest = std::mem::take(&mut self.within.smallest);
        candidates.clear();
        let within = &self.within;
        let (eye, before) = (camera.eye(), within.eye);
        // Of the eye since the last frame, squared, in the space of the tree that is asked.
        let way = Cell::new(0.0);
        let enter = |placed: &Placed, local: &Camera| {
            way.set((placed.to_world.inverse().transform_point3(before) - local.eye()).length_squared());
            entered(placed, local, way.get());
        };
        let is_still = |bounds: &Bounds, eye: DVec3, way: f64| {
            let middle = (bounds.min.as_dvec3() + bounds.max.as_dvec3()) * 0.5;
            self::is_still(eye - middle, way)
        };
        let draw = |placed: &Placed, local: &Camera, hit: Measured, small: Option<f32>| {
            if let Some(pixels) = small {
                smallest.push(candidates.len(), pixels);
            }
            candidates.push(Candidate {
                draw: Draw { tree: placed.tree, anchor: placed.anchor, object: hit.place },
                key: (placed.rank, hit.place),
                estimate: visible_pixels(&placed.instance, local, hit),
                still: is_still(&placed.instance.boxes.objects[hit.place as usize], local.eye(), way.get()),
                triangles: within.triangles_of(placed.tree, hit.place),
            });
        };
        let (placed, pending) = (&self.placed, &mut self.pending);
        self.statistics = walk(placed, pending, &mut hits, camera, settings, enter, draw);
        hits.too_small += smallest.leave_out(&mut candidates, settings.small_pixels(camera)).pixels;
        let loose = &self.loose;
        self.statistics.objects_tested += loose.cull(camera, settings.frustum, |place| {
            candidates.push(Candidate {
                draw: Draw { tree: LOOSE, anchor: 0, object: loose.object(place) },
                key: (LOOSE, place),
                estimate: Estimate::of_box(loose.bounds(place as usize), camera),
                still: is_still(loose.bounds(place as usize), eye, (before - eye).length_squared()),
                triangles: loose.triangles(place),
            });
        });
        (self.within.candidates, self.within.hits, self.within.smallest) = (candidates, hits, smallest);
        self.within.eye = eye;
    }
}

/// No object is too small to be drawn.
fn sizes_are_free(settings: &Settings) -> bool {
    let tau = settings.tau;
    let free = |stage: f32| stage <= 0.0 || stage == f32::INFINITY;
    tau.nearest <= 0.0 && free(tau.triangle) && free(tau.ring)
}
