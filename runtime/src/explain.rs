//! Why an object is drawn or not, and which spheres answer.

use crate::ask::{Answer, Thresholds};
use crate::camera::Camera;
use crate::cull::Instance;
use crate::estimate::{is_around, visible_pixels};
use crate::hits::{Hits, Measured};
use crate::query::Settings;
use crate::scene::{Draw, LOOSE, Placed, SceneCuller, walk};
use crate::small::{LeftOut, Smallest};
use glam::DVec3;

/// Why culling draws an object or not, before any budget. Whether a budget then left it out shows in what
/// [`SceneCuller::cull_within`] returns; what [`SceneCuller::select`] draws in its place tells [`SceneCuller::outcome`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Reason {
    /// There is no such tree, anchor or object.
    Unknown,
    /// Its anchor is left out, see [`SceneCuller::set_shown`].
    NotShown,
    /// The object that stands for its tree in another tree is not drawn: explain that one.
    HostNotDrawn {
        /// That object.
        host: Draw,
    },
    /// It was hidden, see [`SceneCuller::set_hidden`].
    UserHidden,
    /// Its box is outside the frustum.
    OutsideFrustum,
    /// The sphere that answers for it does not see it from here.
    NotVisible {
        /// Node of the sphere.
        node: u32,
        /// The node's height above the object: 1 for its parent.
        height: u32,
        /// Ancestors, from its parent on, that see it in the bins asked. Less than `height`.
        level: u32,
    },
    /// The sphere that answers sees it, but its estimated visible pixels are below the least size to draw: that of the settings,
    /// or the one below which small objects may be left out (see [`Settings::small_share`]).
    TooSmall {
        /// Estimated visible pixels.
        pixels: f64,
        /// Node of the sphere.
        node: u32,
    },
    /// Drawn: the sphere that answers for it sees it from here, or the object is around the eye.
    Sphere {
        /// Node of the sphere.
        node: u32,
        /// The node's height above the object: 1 for its parent.
        height: u32,
        /// Ancestors that see it in the bins asked.
        level: u32,
        /// Estimated visible pixels.
        pixels: f64,
    },
    /// Drawn by the frustum alone: the eye is inside all spheres around it, or too near to them.
    Frustum {
        /// Spheres around it: 0 for loose objects and where nothing was baked.
        spheres: u32,
        /// Something in one of these spheres is hidden, so that it is not trusted.
        disturbed: bool,
    },
}

impl Reason {
    /// Whether the object is drawn, if the budget allows.
    pub fn is_drawn(&self) -> bool {
        matches!(self, Self::Sphere { .. } | Self::Frustum { .. })
    }
}

/// A sphere that answers for the objects in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereInUse {
    /// Centre in world space, metres.
    pub center: DVec3,
    /// Radius, metres; under non-uniform scale that of the longest axis.
    pub radius: f64,
    /// Index of the tree.
    pub tree: u32,
    /// Index of the anchor.
    pub anchor: u32,
    /// Index of the node.
    pub node: u32,
}

impl SceneCuller {
    /// Why [`Self::cull`] draws an object or not for this camera. Linear in the siblings on its way down the tree; for a small
    /// object, whose lot depends on all others, as slow as [`Self::cull`], and it allocates.
    pub fn explain(&self, object: Draw, camera: &Camera, settings: &Settings) -> Reason {
        if object.tree == LOOSE {
            return match self.loose.place(object.object).filter(|_| object.anchor == 0) {
                None => Reason::Unknown,
                Some(place) if self.loose.is_hidden(place) => Reason::UserHidden,
                Some(place) if settings.frustum && !camera.sees(self.loose.bounds(place)) => {
                    Reason::OutsideFrustum
                }
                Some(_) => Reason::Frustum { spheres: 0, disturbed: false },
            };
        }
        let Some(index) = self.find(object.tree, object.anchor) else { return Reason::Unknown };
        let placed = &self.placed[index];
        if object.object as usize >= placed.instance.tree.object_count() {
            return Reason::Unknown;
        }
        if !placed.shown {
            return Reason::NotShown;
        }
        // Trees nest without cycles, and not deeper than there are trees.
        let mut entry = placed;
        while let Some((host, place)) = entry.host {
            entry = &self.placed[host];
            let drawn = entry.shown
                && entry
                    .instance
                    .explain(place, &camera.to_local(&entry.to_world), settings, |_| false)
                    .is_drawn();
            if !drawn {
                let host = Draw { tree: entry.tree, anchor: entry.anchor, object: place };
                return Reason::HostNotDrawn { host };
            }
        }
        let left_out = |pixels| self.left_out(camera, settings).has(pixels);
        placed.instance.explain(object.object, &camera.to_local(&placed.to_world), settings, left_out)
    }

    /// Which small objects are left out.
    fn left_out(&self, camera: &Camera, settings: &Settings) -> LeftOut {
        let (mut pending, mut hits) = (Vec::new(), Hits::<u32>::default());
        let (mut drawn, mut smallest) = (Vec::new(), Smallest::default());
        let draw = |_: &Placed, _: &Camera, place, small: Option<f32>| {
            if let Some(pixels) = small {
                smallest.push(drawn.len(), pixels);
            }
            drawn.push(place);
        };
        walk(&self.placed, &mut pending, &mut hits, camera, settings, |_, _| (), draw);
        smallest.leave_out(&mut drawn, settings.small_pixels(camera))
    }

    /// The spheres that answer for this camera, appended to `out`. For showing them: it allocates.
    pub fn spheres_in_use(&self, camera: &Camera, settings: &Settings, out: &mut Vec<SphereInUse>) {
        let (mut pending, mut hits) = (Vec::new(), Hits::<u32>::default());
        let enter = |placed: &Placed, local: &Camera| {
            let to_world = &placed.to_world;
            let axes = to_world.matrix3;
            let lengths = [axes.x_axis, axes.y_axis, axes.z_axis].map(DVec3::length);
            let scale = lengths.into_iter().fold(0.0, f64::max);
            for node in placed.instance.spheres_in_use(local, settings) {
                let sphere = &placed.instance.tree.nodes()[node as usize];
                out.push(SphereInUse {
                    center: to_world.transform_point3(sphere.center.as_dvec3()),
                    radius: f64::from(sphere.radius) * scale,
                    tree: placed.tree,
                    anchor: placed.anchor,
                    node,
                });
            }
        };
        walk(&self.placed, &mut pending, &mut hits, camera, settings, enter, |_, _, _, _| ());
    }
}

impl Instance {
    /// Why the object, which exists, is drawn or not. `left_out` tells whether a small one
    /// of so many pixels is left out.
    fn explain(
        &self,
        place: u32,
        camera: &Camera,
        settings: &Settings,
        left_out: impl Fn(f32) -> bool,
    ) -> Reason {
        let bounds = &self.boxes.objects[place as usize];
        if self.is_hidden(place) {
            return Reason::UserHidden;
        }
        if settings.frustum && !camera.sees(bounds) {
            return Reason::OutsideFrustum;
        }
        let pass = self.pass(camera, settings);
        let (nodes, max_sine) = (self.tree.nodes(), pass.max_sine());
        let (mut spheres, mut disturbed) = (0, false);
        let mut index = 0;
        while let Some(node) = nodes.get(index) {
            if !node.objects().contains(&place) {
                index += node.subtree as usize;
            } else if pass.is_usable(index, node, max_sine) {
                return self.explain_below(index, place, camera, settings, left_out);
            } else {
                (spheres, disturbed) = (spheres + 1, disturbed || self.is_disturbed(index));
                index += 1;
            }
        }
        Reason::Frustum { spheres, disturbed }
    }

    /// Why a usable node sees the object, which is in the frustum, or not.
    fn explain_below(
        &self,
        index: usize,
        place: u32,
        camera: &Camera,
        settings: &Settings,
        left_out: impl Fn(f32) -> bool,
    ) -> Reason {
        let tree = &self.tree;
        let (node, object) = (&tree.nodes()[index], &tree.objects[place as usize]);
        let bounds = &self.boxes.objects[place as usize];
        let pass = self.pass(camera, settings);
        let (node_index, height) = (index as u32, object.depth - node.depth);
        let middle = (bounds.min.as_dvec3() + bounds.max.as_dvec3()) * 0.5;
        let to_eye = camera.eye() - middle;
        let bins = pass.sphere_bins(node);
        let thresholds = pass.thresholds();
        let asked = pass.bins_asked(to_eye, bins.as_ref());
        let level = asked.into_iter().map(|bin| u32::from(tree.row_level(object, bin))).max().unwrap_or(0);
        if u32::from(object.max_level) < height {
            return Reason::NotVisible { node: node_index, height, level };
        }
        let distance_squared = to_eye.length_squared();
        let pixels = f64::from(visible_pixels(self, camera, Measured { place, height }).expected);
        let drawn = Reason::Sphere { node: node_index, height, level, pixels };
        let answer = |thresholds: &Thresholds| {
            pass.answer(object, height, to_eye, distance_squared, bins.as_ref(), thresholds)
        };
        let too_small = Reason::TooSmall { pixels, node: node_index };
        match answer(&thresholds) {
            _ if is_around(bounds, distance_squared) => drawn,
            Answer::Seen => drawn,
            Answer::Small(size) if left_out(size as f32) => too_small,
            Answer::Small(_) => drawn,
            Answer::NotSeen if answer(&thresholds.without_sizes()) == Answer::Seen => too_small,
            Answer::NotSeen => Reason::NotVisible { node: node_index, height, level },
        }
    }

    /// Nodes whose spheres answer, in depth-first order, as a pass finds them.
    fn spheres_in_use<'a>(
        &'a self,
        camera: &'a Camera,
        settings: &'a Settings,
    ) -> impl Iterator<Item = u32> + 'a {
        let pass = self.pass(camera, settings);
        let (nodes, max_sine) = (self.tree.nodes(), pass.max_sine());
        let mut index = 0;
        std::iter::from_fn(move || {
            while let Some(node) = nodes.get(index) {
                let at = index;
                let outside = || settings.frustum && !camera.sees(&self.boxes.nodes[at]);
                if node.object_count == 0 || outside() {
                    index += node.subtree as usize;
                } else if pass.is_usable(at, node, max_sine) {
                    index += node.subtree as usize;
                    return Some(at as u32);
                } else {
                    index += 1;
                }
            }
            None
        })
    }
}
