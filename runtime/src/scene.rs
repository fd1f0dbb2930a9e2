//! Culls a whole scene: all trees, at all their anchors, trees inside trees.

use crate::bounds::{Bounds, BoundsError};
use crate::camera::Camera;
use crate::cull::{Instance, shared_boxes};
use crate::decode::Visibility;
use crate::query::Settings;
use crate::traverse::CullStatistics;
use glam::DAffine3;

/// One object of one tree at one anchor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Draw {
    /// Index of the tree.
    pub tree: u32,
    /// Index of the anchor, 0 for a tree anchored at a scene.
    pub anchor: u32,
    /// Place of the object in tree order.
    pub object: u32,
}

/// Answers, per camera, what to draw of a whole scene.
#[derive(Debug)]
pub struct SceneCuller {
    placed: Vec<Placed>,
    /// First entry of each tree in `placed`.
    starts: Vec<usize>,
    draws: Vec<Draw>,
    places: Vec<u32>,
    pending: Vec<usize>,
    statistics: CullStatistics,
}

/// A tree at one of its anchors.
#[derive(Debug)]
struct Placed {
    tree: u32,
    anchor: u32,
    instance: Instance,
    to_world: DAffine3,
    shown: bool,
    /// The object, of another entry of `placed`, that stands for this one.
    host: Option<(usize, u32)>,
    /// Objects that stand for other entries, ascending.
    guests: Vec<(u32, usize)>,
}

impl SceneCuller {
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
                    tree: index as u32,
                    anchor: anchor as u32,
                    instance: Instance::new(tree, boxes.clone()),
                    to_world: DAffine3::IDENTITY,
                    shown: true,
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
        let statistics = CullStatistics::default();
        Ok(Self { placed, starts, draws: Vec::new(), places: Vec::new(), pending: Vec::new(), statistics })
    }

    /// Where an anchor is: the transform from its tree's space to world space. Anchors that do not exist are ignored.
    pub fn set_anchor(&mut self, tree: u32, anchor: u32, to_world: DAffine3) {
        if let Some(index) = self.find(tree, anchor) {
            self.placed[index].to_world = to_world;
        }
    }

    /// Leaves an anchor out, with all trees inside it, or takes it in again: for trees of a glTF scene that is not the one
    /// shown. This is not for hiding things in the scene shown, see [`Self::set_hidden`].
    pub fn set_shown(&mut self, tree: u32, anchor: u32, shown: bool) {
        if let Some(index) = self.find(tree, anchor) {
            self.placed[index].shown = shown;
        }
    }

    /// Hides an object or shows it again, see [`crate::Culler::set_hidden`]. Spheres of the trees around its tree are not
    /// trusted either while it is hidden. Objects that do not exist are ignored.
    pub fn set_hidden(&mut self, object: Draw, hidden: bool) {
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
    pub fn cull(&mut self, camera: &Camera, settings: &Settings) -> &[Draw] {
        self.draws.clear();
        self.pending.clear();
        self.statistics = CullStatistics::default();
        self.pending.extend((0..self.placed.len()).rev().filter(|&i| self.placed[i].host.is_none()));
        while let Some(index) = self.pending.pop() {
            let placed = &self.placed[index];
            if !placed.shown {
                continue;
            }
            self.places.clear();
            let local = camera.to_local(&placed.to_world);
            self.statistics += placed.instance.cull(&local, settings, &mut self.places);
            let mut guests = placed.guests.iter().peekable();
            for &object in &self.places {
                while guests.next_if(|guest| guest.0 < object).is_some() {}
                match guests.next_if(|guest| guest.0 == object) {
                    Some(&(_, guest)) => self.pending.push(guest),
                    None => {
                        self.draws.push(Draw { tree: placed.tree, anchor: placed.anchor, object });
                    }
                }
            }
        }
        self.statistics.drawn = self.draws.len();
        &self.draws
    }

    /// What the last [`Self::cull`] did, over all trees.
    pub fn statistics(&self) -> CullStatistics {
        self.statistics
    }

    fn find(&self, tree: u32, anchor: u32) -> Option<usize> {
        let start = *self.starts.get(tree as usize)?;
        let end = self.starts.get(tree as usize + 1).copied().unwrap_or(self.placed.len());
        Some(start + anchor as usize).filter(|&index| index < end)
    }
}
