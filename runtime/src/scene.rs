//! Culls a whole scene: all trees, at all their anchors, trees inside trees, and the objects in no tree.

use crate::bounds::{Bounds, BoundsError};
use crate::camera::Camera;
use crate::cull::{Instance, shared_boxes};
use crate::decode::Visibility;
use crate::detail::DetailState;
use crate::hits::{Hit, Hits};
use crate::loose::Loose;
use crate::query::Settings;
use crate::small::Smallest;
use crate::traverse::CullStatistics;
use crate::within::Within;
use glam::DAffine3;

/// One object of one tree at one anchor, or a loose object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Draw {
    /// Index of the tree, or [`LOOSE`].
    pub tree: u32,
    /// Index of the anchor, 0 for a tree anchored at a scene and for loose objects.
    pub anchor: u32,
    /// Place of the object in tree order; of a loose object its index in [`SceneCuller::set_loose`].
    pub object: u32,
}

/// The "tree" of objects in no tree, see [`SceneCuller::set_loose`].
pub const LOOSE: u32 = u32::MAX;

/// Answers, per camera, what to draw of a whole scene.
#[derive(Debug)]
pub struct SceneCuller {
    pub(crate) placed: Vec<Placed>,
    /// First entry of each tree in `placed`.
    starts: Vec<usize>,
    pub(crate) loose: Loose,
    pub(crate) draws: Vec<Draw>,
    places: Hits<u32>,
    smallest: Smallest,
    pub(crate) pending: Vec<usize>,
    pub(crate) statistics: CullStatistics,
    pub(crate) within: Within,
    pub(crate) detail: DetailState,
}

/// A tree at one of its anchors.
#[derive(Debug)]
pub(crate) struct Placed {
    /// Its own index among all.
    pub(crate) index: u32,
    pub(crate) tree: u32,
    pub(crate) anchor: u32,
    pub(crate) instance: Instance,
    pub(crate) to_world: DAffine3,
    pub(crate) shown: bool,
    /// When it is walked, among all: what is drawn comes in this order.
    pub(crate) rank: u32,
    /// The object, of another entry of `placed`, that stands for this one.
    pub(crate) host: Option<(usize, u32)>,
    /// Objects that stand for other entries, ascending.
    guests: Vec<(u32, usize)>,
}

impl SceneCuller {
    /// A culler of no trees, for a file without a bake: give it the objects with [`Self::set_loose`].
    pub fn empty() -> Self {
        Self::of(Vec::new(), Vec::new())
    }

    /// A culler for all trees. `bounds[t]` are the boxes of tree `t`'s objects in its tree space, in tree order; the box of
    /// an object that stands for another tree holds that whole tree.
    ///
    /// Every anchor starts at the world's origin and shown, see [`Self::set_anchor`] and [`Self::set_shown`].
    ///
    /// # Errors
    /// [`BoundsError`] if there is not one valid box per object.
    pub fn new<B: AsRef<[Bounds]>>(visibility: &Visibility, bounds: &[B]) -> Result<Self, BoundsError> {
        let trees = visibility.trees();
        if bounds.len() != trees.len() {
            return Err(BoundsError::Trees { found: bounds.len(), expected: trees.len() });
        }
        let (mut placed, mut starts) = (Vec::new(), Vec::new());
        for (index, (tree, bounds)) in trees.iter().zip(bounds).enumerate() {
            let boxes = shared_boxes(tree, bounds.as_ref(), index)?;
            starts.push(placed.len());
            for anchor in 0..tree.placement().count() {
                placed.push(Placed {
                    index: placed.len() as u32,
                    tree: index as u32,
                    anchor: anchor as u32,
                    instance: Instance::new(tree, boxes.clone()),
                    to_world: DAffine3::IDENTITY,
                    shown: true,
                    rank: 0,
                    host: None,
                    guests: Vec::new(),
                });
            }
        }
        for (tree, &start) in trees.iter().zip(&starts) {
            for anchor in 0..tree.placement().count() {
                for nested in tree.nested() {
                    // Decoding has checked that the anchor exists and has no other host.
                    let guest = starts[nested.tree as usize] + tree.nested_anchor(nested, anchor);
                    placed[guest].host = Some((start + anchor, nested.object));
                    placed[start + anchor].guests.push((nested.object, guest));
                }
            }
        }
        Ok(Self::of(placed, starts))
    }

    fn of(mut placed: Vec<Placed>, starts: Vec<usize>) -> Self {
        let within = Within::new(&starts);
        let mut pending = Vec::new();
        push_roots(&placed, &mut pending);
        let mut rank = 0;
        while let Some(index) = pending.pop() {
            placed[index].rank = rank;
            rank += 1;
            pending.extend(placed[index].guests.iter().map(|&(_, guest)| guest));
        }
        Self {
            placed,
            starts,
            loose: Loose::default(),
            draws: Vec::new(),
            places: Hits::default(),
            smallest: Smallest::default(),
            pending,
            statistics: CullStatistics::default(),
            within,
            detail: DetailState::default(),
        }
    }

    /// Where an anchor is: the transform from its tree's space to world space. Anchors that do not exist are ignored.
    pub fn set_anchor(&mut self, tree: u32, anchor: u32, to_world: DAffine3) {
        self.detail.ask_again();
        if let Some(index) = self.find(tree, anchor) {
            self.placed[index].to_world = to_world;
        }
    }

    /// Leaves an anchor out, with all trees inside it, or takes it in again: for trees of a glTF scene that is not the one
    /// shown. This is not for hiding things in the scene shown, see [`Self::set_hidden`].
    pub fn set_shown(&mut self, tree: u32, anchor: u32, shown: bool) {
        self.detail.ask_again();
        if let Some(index) = self.find(tree, anchor) {
            self.placed[index].shown = shown;
        }
    }

    /// Hides an object or shows it again, see [`crate::Culler::set_hidden`]. Spheres of the trees around its tree are not
    /// trusted either while it is hidden. Objects that do not exist are ignored.
    pub fn set_hidden(&mut self, object: Draw, hidden: bool) {
        self.detail.ask_again();
        if object.tree == LOOSE {
            self.loose.set_hidden(object.object, hidden);
            return;
        }
        let Some(index) = self.find(object.tree, object.anchor) else { return };
        if self.placed[index].instance.set_hidden(object.object, hidden) {
            let mut host = self.placed[index].host;
            while let Some((index, object)) = host {
                self.placed[index].instance.disturb(object, hidden);
                host = self.placed[index].host;
            }
        }
    }

    /// What to draw for a camera in world space. Allocates nothing once it has seen the most it will ever draw.
    ///
    /// The order is that of the trees, each followed by those inside it, and loose objects last in
    /// [`Self::loose_order`]: from frame to frame it does not change.
    pub fn cull(&mut self, camera: &Camera, settings: &Settings) -> &[Draw] {
        self.draws.clear();
        self.within.forget();
        self.detail.forget();
        let (draws, smallest) = (&mut self.draws, &mut self.smallest);
        let draw = |placed: &Placed, _: &Camera, object, small: Option<f32>| {
            if let Some(pixels) = small {
                smallest.push(draws.len(), pixels);
            }
            draws.push(Draw { tree: placed.tree, anchor: placed.anchor, object });
        };
        let (pending, places) = (&mut self.pending, &mut self.places);
        self.statistics = walk(&self.placed, pending, places, camera, settings, |_, _| (), draw);
        self.smallest.leave_out(&mut self.draws, settings.small_pixels(camera));
        let (draws, loose) = (&mut self.draws, &self.loose);
        self.statistics.objects_tested += loose.cull(camera, settings.frustum, |place| {
            draws.push(Draw { tree: LOOSE, anchor: 0, object: loose.object(place) });
        });
        self.statistics.drawn = self.draws.len();
        &self.draws
    }

    /// What the last [`Self::cull`] or [`Self::cull_within`] did, over all trees. With a budget, `drawn` is what was
    /// chosen.
    pub fn statistics(&self) -> CullStatistics {
        self.statistics
    }

    pub(crate) fn find(&self, tree: u32, anchor: u32) -> Option<usize> {
        let start = *self.starts.get(tree as usize)?;
        let end = self.starts.get(tree as usize + 1).copied().unwrap_or(self.placed.len());
        Some(start + anchor as usize).filter(|&index| index < end)
    }
}

/// Entries that hang in no other tree, the first on top.
pub(crate) fn push_roots(placed: &[Placed], pending: &mut Vec<usize>) {
    pending.clear();
    pending.extend((0..placed.len()).rev().filter(|&index| placed[index].host.is_none()));
}

/// Culls all entries that are shown and whose host is drawn; `enter` gets each of them, `draw` what is drawn of it, with the
/// camera in its tree's space and its pixels if it is small. An object that stands for another tree is never too small.
pub(crate) fn walk<T: Hit>(
    placed: &[Placed],
    pending: &mut Vec<usize>,
    hits: &mut Hits<T>,
    camera: &Camera,
    settings: &Settings,
    mut enter: impl FnMut(&Placed, &Camera),
    mut draw: impl FnMut(&Placed, &Camera, T, Option<f32>),
) -> CullStatistics {
    let mut statistics = CullStatistics::default();
    hits.too_small = 0.0;
    push_roots(placed, pending);
    while let Some(index) = pending.pop() {
        let entry = &placed[index];
        if !entry.shown {
            continue;
        }
        hits.list.clear();
        hits.small.clear();
        let local = camera.to_local(&entry.to_world);
        enter(entry, &local);
        statistics += entry.instance.cull(&local, settings, hits);
        let mut guests = entry.guests.iter().peekable();
        let mut small = hits.small.iter().peekable();
        for (at, &hit) in hits.list.iter().enumerate() {
            let pixels = small.next_if(|small| small.at as usize == at).map(|small| small.pixels);
            while guests.next_if(|guest| guest.0 < hit.place()).is_some() {}
            match guests.next_if(|guest| guest.0 == hit.place()) {
                Some(&(_, guest)) => pending.push(guest),
                None => draw(entry, &local, hit, pixels),
            }
        }
    }
    statistics
}
