//! What to draw for a camera where the file has proxies: objects, their simplified levels, and proxies.

use super::{Extra, Method, Stage, object_of};
use std::collections::HashSet;
use svs_render::View;
use svs_runtime::{Budget, Detail, DetailStatistics, Outcome, Settings};

/// What an id of [`Stage::select`] is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kind {
    /// An object of the scene as it is.
    Object,
    /// An object of the scene, simplified.
    Level,
    /// A proxy of several.
    Proxy,
}

impl Stage {
    /// The file has proxies or simplified levels that can be drawn.
    pub fn has_proxies(&self) -> bool {
        self.extras.is_some()
    }

    /// As [`Stage::cull`], and objects are drawn simplified, or through the proxy of a group, where the error stays below
    /// `detail.tau` pixels by `detail.metric`, or where a budget asks for it. In files without proxies, and for
    /// [`Method::Nothing`] and [`Method::Exact`], it is [`Stage::cull`].
    ///
    /// The ids are places in [`Stage::data`]'s objects; see [`Stage::kind_of`] and [`Stage::objects_of`].
    #[expect(clippy::too_many_arguments, reason = "as many as the caller has to decide about")]
    pub fn select(
        &mut self,
        view: &View,
        width: u32,
        height: u32,
        method: Method,
        settings: &Settings,
        detail: &Detail,
        budget: &Budget<'_>,
    ) -> &[u32] {
        let settings = match method {
            Method::Nothing | Method::Exact => {
                return self.cull(view, width, height, method, settings, budget);
            }
            Method::Frustum => &Settings::FRUSTUM,
            Method::Visibility => settings,
        };
        let Some(extras) = &self.extras else {
            return self.cull(view, width, height, method, settings, budget);
        };
        self.drawn.clear();
        self.ratios.clear();
        let camera = Self::camera(view, width, height);
        for selected in self.culler.select(&camera, settings, detail, budget) {
            let object = |draw| object_of(self.baked.as_ref(), &self.loose, draw);
            if let Some(id) = extras.id(selected, object) {
                self.drawn.push(id);
                self.ratios.push(selected.ratio);
            }
        }
        &self.drawn
    }

    /// What the last [`Stage::select`] did; all zeros if it fell back to [`Stage::cull`].
    pub fn detail_statistics(&self) -> DetailStatistics {
        if self.extras.is_some() { self.culler.detail_statistics() } else { DetailStatistics::default() }
    }

    /// What the last [`Stage::select`] made of an object of the scene; `None` if something has changed since, or it fell back to
    /// [`Stage::cull`].
    pub fn outcome(&self, object: u32) -> Option<Outcome> {
        self.culler.outcome(self.draw_of(object)?)
    }

    /// What was drawn last and, after [`Stage::select`], the share P(mu) of its error that counted, 0 to 1.
    pub fn ratios(&self) -> impl Iterator<Item = (u32, f32)> {
        let ratios = self.ratios.iter().copied().chain(std::iter::repeat(1.0));
        self.drawn.iter().copied().zip(ratios)
    }

    /// What an id is.
    pub fn kind_of(&self, id: u32) -> Kind {
        match self.extra(id) {
            None => Kind::Object,
            Some(Extra::Level { .. }) => Kind::Level,
            Some(Extra::Proxy { .. }) => Kind::Proxy,
        }
    }

    /// What an id after the scene's own objects stands for.
    pub fn extra(&self, id: u32) -> Option<Extra> {
        self.extras.as_ref()?.get(id)
    }

    /// The ids of an object's simplified levels.
    pub fn levels_of(&self, object: u32) -> std::ops::Range<u32> {
        self.extras.as_ref().map_or(0..0, |extras| extras.levels_of(object))
    }

    /// The objects of the scene that are seen where an id is drawn.
    pub fn objects_of(&self, id: u32) -> Vec<u32> {
        match self.extra(id) {
            None if (id as usize) < self.scene.objects.len() => vec![id],
            None => Vec::new(),
            Some(Extra::Level { object, .. }) => vec![object],
            Some(Extra::Proxy { tree, anchor, node }) => {
                let Some(baked) = &self.baked else { return Vec::new() };
                let proxies = baked.trees().get(tree as usize).and_then(|tree| tree.proxies());
                let Some((proxies, node)) =
                    proxies.and_then(|all| Some((all, all.nodes().get(node as usize)?)))
                else {
                    return Vec::new();
                };
                let places = node.first_object..node.first_object + node.object_count;
                let places = places.map(|position| proxies.object(position));
                places.flat_map(|place| baked.below(tree as usize, anchor as usize, place)).collect()
            }
        }
    }

    /// Ids of the proxies around an object (or a level of one), the innermost first.
    pub fn proxies_around(&self, id: u32) -> impl Iterator<Item = u32> {
        let object = match self.extra(id) {
            None => Some(id),
            Some(Extra::Level { object, .. }) => Some(object),
            Some(Extra::Proxy { .. }) => None,
        };
        let found = object.and_then(|object| {
            let (extras, draw) = (self.extras.as_ref()?, self.draw_of(object)?);
            let owner = extras.owner(draw)?;
            let nodes = self.trees().get(draw.tree as usize)?.proxies()?.nodes();
            Some((extras, draw, owner, nodes))
        });
        found.into_iter().flat_map(|(extras, draw, owner, nodes)| {
            let is_around = move |&node: &u32| {
                nodes.get(node as usize).is_some_and(|around| node + around.subtree > owner)
            };
            let around = (0..=owner).rev().filter(is_around);
            around.filter_map(move |node| extras.proxy(draw.tree, draw.anchor, node))
        })
    }

    /// One of [`Stage::objects_of`] a proxy.
    pub(super) fn first_object_of(&self, id: u32) -> Option<u32> {
        let (Some(Extra::Proxy { tree, anchor, node }), Some(baked)) = (self.extra(id), &self.baked) else {
            return None;
        };
        let proxies = baked.trees().get(tree as usize)?.proxies()?;
        let node = proxies.nodes().get(node as usize)?;
        baked.below(tree as usize, anchor as usize, proxies.object(node.first_object)).next()
    }

    /// The objects of the scene that are seen where a list of ids is drawn: ascending, each once.
    pub fn objects_shown(&self, drawn: &[u32]) -> Vec<u32> {
        let mut objects: Vec<u32> = Vec::with_capacity(drawn.len());
        let own = self.scene.objects.len();
        for &id in drawn {
            if (id as usize) < own { objects.push(id) } else { objects.extend(self.objects_of(id)) }
        }
        objects.sort_unstable();
        objects.dedup();
        objects
    }

    /// HLOD nodes that a list of ids draws: one for each proxy, and one for each innermost proxy node of which objects are
    /// drawn themselves, simplified or not. Objects in no proxy node are not counted.
    pub fn nodes_shown(&self, drawn: &[u32]) -> usize {
        let Some(extras) = &self.extras else { return 0 };
        let mut nodes = HashSet::new();
        for &id in drawn {
            let object = match extras.get(id) {
                Some(Extra::Proxy { tree, anchor, node }) => {
                    nodes.insert((tree, anchor, node));
                    continue;
                }
                Some(Extra::Level { object, .. }) => object,
                None => id,
            };
            let Some(draw) = self.draw_of(object) else { continue };
            nodes.extend(extras.owner(draw).map(|node| (draw.tree, draw.anchor, node)));
        }
        nodes.len()
    }

    /// How many of a list of ids are of a kind.
    pub fn count(&self, drawn: &[u32], kind: Kind) -> usize {
        drawn.iter().filter(|&&id| self.kind_of(id) == kind).count()
    }
}
