//! Culls one tree at one place.

use crate::bounds::{Bounds, BoundsError};
use crate::boxes::{Boxes, innermost, parents};
use crate::camera::Camera;
use crate::hits::{Hit, Hits};
use crate::proxies::Proxies;
use crate::query::Settings;
use crate::small::Smallest;
use crate::traverse::{CullStatistics, Hidden, Pass};
use crate::tree::Tree;
use std::sync::Arc;

/// Answers, per camera, which objects of one tree to draw. Memory is allocated by [`Self::new`] and by the first
/// [`Self::set_hidden`], never by [`Self::cull`].
#[derive(Debug)]
pub struct Culler {
    instance: Instance,
    visible: Hits<u32>,
    smallest: Smallest,
    statistics: CullStatistics,
}

/// A tree at one place: shared data, and what is hidden there.
#[derive(Clone, Debug)]
pub(crate) struct Instance {
    pub(crate) tree: Arc<Tree>,
    pub(crate) boxes: Arc<Boxes>,
    hidden: Option<Box<(Hidden, Above)>>,
}

/// The way from an object up to its root.
#[derive(Clone, Debug)]
struct Above {
    node_of_object: Vec<Option<u32>>,
    parents: Vec<Option<u32>>,
    /// The same of the proxies, by place in tree order.
    proxy_of_object: Vec<Option<u32>>,
    proxy_parents: Vec<Option<u32>>,
}

impl Culler {
    /// A culler for `tree`. `bounds` are the boxes of its objects in tree space, in tree order (see
    /// [`Tree::document_index`]).
    ///
    /// # Errors
    /// [`BoundsError`] if there is not one valid box per object.
    pub fn new(tree: &Arc<Tree>, bounds: &[Bounds]) -> Result<Self, BoundsError> {
        let instance = Instance::new(tree, shared_boxes(tree, bounds, 0)?);
        let objects = tree.object_count();
        let visible =
            Hits { list: Vec::with_capacity(objects), small: Vec::with_capacity(objects), too_small: 0.0 };
        let smallest = Smallest::with_capacity(objects);
        Ok(Self { instance, visible, smallest, statistics: CullStatistics::default() })
    }

    /// Objects to draw for a camera in tree space (see [`Camera::to_local`]), as places in tree order, ascending.
    pub fn cull(&mut self, camera: &Camera, settings: &Settings) -> &[u32] {
        self.visible.list.clear();
        self.visible.small.clear();
        self.statistics = self.instance.cull(camera, settings, &mut self.visible);
        std::mem::swap(&mut self.smallest.list, &mut self.visible.small);
        self.smallest.leave_out(&mut self.visible.list, settings.small_pixels(camera));
        self.statistics.drawn = self.visible.list.len();
        &self.visible.list
    }

    /// What the last [`Self::cull`] did.
    pub fn statistics(&self) -> CullStatistics {
        self.statistics
    }

    /// Hides an object or shows it again. While it is hidden it is not drawn, and no sphere around it is trusted: what it
    /// used to hide may now be seen. Objects that do not exist are ignored.
    pub fn set_hidden(&mut self, object: u32, hidden: bool) {
        self.instance.set_hidden(object, hidden);
    }

    /// The tree.
    pub fn tree(&self) -> &Arc<Tree> {
        &self.instance.tree
    }
}

/// Checks the boxes of tree number `index`.
pub(crate) fn shared_boxes(tree: &Tree, bounds: &[Bounds], index: usize) -> Result<Arc<Boxes>, BoundsError> {
    if bounds.len() != tree.object_count() {
        let (found, expected) = (bounds.len(), tree.object_count());
        return Err(BoundsError::Count { tree: index, found, expected });
    }
    match bounds.iter().position(|b| !b.is_valid()) {
        Some(object) => Err(BoundsError::Box { tree: index, object }),
        None => Ok(Arc::new(Boxes::new(tree, bounds))),
    }
}

impl Instance {
    pub(crate) fn new(tree: &Arc<Tree>, boxes: Arc<Boxes>) -> Self {
        Self { tree: Arc::clone(tree), boxes, hidden: None }
    }

    pub(crate) fn cull<T: Hit>(
        &self,
        camera: &Camera,
        settings: &Settings,
        out: &mut Hits<T>,
    ) -> CullStatistics {
        self.pass(camera, settings).run(out)
    }

    pub(crate) fn pass<'a>(&'a self, camera: &'a Camera, settings: &'a Settings) -> Pass<'a> {
        let hidden = self.hidden.as_ref().map(|both| &both.0);
        Pass { tree: &self.tree, boxes: &self.boxes, hidden, camera, settings }
    }

    pub(crate) fn is_hidden(&self, object: u32) -> bool {
        self.hidden.as_ref().is_some_and(|both| both.0.objects[object as usize])
    }

    /// Something below the node is hidden.
    pub(crate) fn is_disturbed(&self, node: usize) -> bool {
        self.hidden.as_ref().is_some_and(|both| both.0.below[node] > 0)
    }

    /// Something a proxy stands for is hidden.
    pub(crate) fn is_proxy_disturbed(&self, node: u32) -> bool {
        self.hidden.as_ref().is_some_and(|both| both.0.below_proxies[node as usize] > 0)
    }

    /// `true` if that changed something.
    pub(crate) fn set_hidden(&mut self, object: u32, hidden: bool) -> bool {
        if object as usize >= self.tree.object_count() || (!hidden && self.hidden.is_none()) {
            return false;
        }
        let state = &mut self.state().0.objects[object as usize];
        if *state == hidden {
            return false;
        }
        *state = hidden;
        self.disturb(object, hidden);
        true
    }

    /// Stops trusting the spheres above an object, or takes that back.
    pub(crate) fn disturb(&mut self, object: u32, disturbed: bool) {
        let (hidden, above) = self.state();
        for (of_object, parents, below) in [
            (&above.node_of_object, &above.parents, &mut hidden.below),
            (&above.proxy_of_object, &above.proxy_parents, &mut hidden.below_proxies),
        ] {
            let mut node = of_object.get(object as usize).copied().flatten();
            while let Some(index) = node {
                let count = &mut below[index as usize];
                *count = if disturbed { *count + 1 } else { count.saturating_sub(1) };
                node = parents[index as usize];
            }
        }
    }

    fn state(&mut self) -> &mut (Hidden, Above) {
        let tree = &self.tree;
        self.hidden.get_or_insert_with(|| {
            let mut proxy_of_object = Vec::new();
            if let Some(proxies) = tree.proxies() {
                proxy_of_object.resize(tree.object_count(), None);
                for (position, proxy) in proxies.innermost().enumerate() {
                    proxy_of_object[proxies.object(position as u32) as usize] = proxy;
                }
            }
            let proxy_parents = tree.proxies().map_or(Vec::new(), Proxies::parents);
            let hidden = Hidden {
                objects: vec![false; tree.object_count()],
                below: vec![0; tree.nodes().len()],
                below_proxies: vec![0; proxy_parents.len()],
            };
            let above = Above {
                node_of_object: innermost(tree),
                parents: parents(tree),
                proxy_of_object,
                proxy_parents,
            };
            Box::new((hidden, above))
        })
    }
}
