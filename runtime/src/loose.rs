//! Objects in no tree: frustum culling over a hierarchy of boxes, built once.

use crate::bounds::{Bounds, BoundsError};
use crate::camera::{Camera, Containment};
use glam::Vec3;

/// Boxes of loose objects in a binary hierarchy, in depth-first order with skip pointers.
#[derive(Clone, Debug, Default)]
pub(crate) struct Loose {
    nodes: Vec<BoxNode>,
    /// Index of the object at each place.
    order: Vec<u32>,
    /// Place of each object.
    places: Vec<u32>,
    /// By place.
    bounds: Vec<Bounds>,
    triangles: Vec<u32>,
    hidden: Vec<bool>,
}

#[derive(Clone, Copy, Debug)]
struct BoxNode {
    bounds: Bounds,
    /// Nodes of the subtree, itself included.
    subtree: u32,
    first: u32,
    count: u32,
}

/// Objects that are not worth a further split.
const LEAF: usize = 8;

impl Loose {
    pub(crate) fn new(bounds: &[Bounds], triangles: &[u32]) -> Result<Self, BoundsError> {
        if bounds.len() != triangles.len() || bounds.len() >= u32::MAX as usize {
            return Err(BoundsError::LooseCount { boxes: bounds.len(), triangles: triangles.len() });
        }
        if let Some(object) = bounds.iter().position(|b| !b.is_valid()) {
            return Err(BoundsError::LooseBox { object });
        }
        let mut order: Vec<u32> = (0..bounds.len() as u32).collect();
        let mut nodes = Vec::new();
        if !order.is_empty() {
            split(bounds, &mut order, 0, &mut nodes);
        }
        let mut places = vec![0; order.len()];
        order.iter().enumerate().for_each(|(place, &object)| places[object as usize] = place as u32);
        Ok(Self {
            nodes,
            bounds: order.iter().map(|&object| bounds[object as usize]).collect(),
            triangles: order.iter().map(|&object| triangles[object as usize]).collect(),
            hidden: vec![false; order.len()],
            places,
            order,
        })
    }

    /// Hands the places of the objects in the frustum to `draw`, ascending; returns how many objects were looked at.
    pub(crate) fn cull(&self, camera: &Camera, frustum: bool, mut draw: impl FnMut(u32)) -> usize {
        let mut tested = 0;
        let mut inside_end = if frustum { 0 } else { u32::MAX };
        let mut index = 0;
        while let Some(node) = self.nodes.get(index) {
            let end = node.first + node.count;
            if end > inside_end {
                match camera.contains(&node.bounds) {
                    Containment::Outside => {
                        index += node.subtree as usize;
                        continue;
                    }
                    Containment::Inside => inside_end = end,
                    Containment::Intersects => {}
                }
            }
            let inside = end <= inside_end;
            if !inside && node.subtree > 1 {
                index += 1;
                continue;
            }
            tested += node.count as usize;
            for place in node.first..end {
                let at = place as usize;
                if !self.hidden[at] && (inside || camera.sees(&self.bounds[at])) {
                    draw(place);
                }
            }
            index += node.subtree as usize;
        }
        tested
    }

    pub(crate) fn object(&self, place: u32) -> u32 {
        self.order[place as usize]
    }

    pub(crate) fn order(&self) -> &[u32] {
        &self.order
    }

    pub(crate) fn place(&self, object: u32) -> Option<usize> {
        self.places.get(object as usize).map(|&place| place as usize)
    }

    pub(crate) fn bounds(&self, place: usize) -> &Bounds {
        &self.bounds[place]
    }

    pub(crate) fn triangles(&self, place: u32) -> u32 {
        self.triangles[place as usize]
    }

    pub(crate) fn is_hidden(&self, place: usize) -> bool {
        self.hidden[place]
    }

    pub(crate) fn set_hidden(&mut self, object: u32, hidden: bool) {
        if let Some(place) = self.place(object) {
            self.hidden[place] = hidden;
        }
    }
}

/// Splits at the median of the middles along their widest axis, whatever they are: the depth is logarithmic.
fn split(bounds: &[Bounds], order: &mut [u32], first: u32, nodes: &mut Vec<BoxNode>) {
    let mut whole = Bounds::EMPTY;
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for &object in order.iter() {
        let b = &bounds[object as usize];
        whole.extend(b);
        (low, high) = (low.min(middle(b)), high.max(middle(b)));
    }
    let node = nodes.len();
    nodes.push(BoxNode { bounds: whole, subtree: 1, first, count: order.len() as u32 });
    if order.len() <= LEAF {
        return;
    }
    let axis = (high - low).max_position();
    let half = order.len() / 2;
    order.select_nth_unstable_by(half, |&a, &b| {
        let [x, y] = [a, b].map(|object| middle(&bounds[object as usize])[axis]);
        x.total_cmp(&y).then(a.cmp(&b))
    });
    let (left, right) = order.split_at_mut(half);
    split(bounds, left, first, nodes);
    split(bounds, right, first + half as u32, nodes);
    nodes[node].subtree = (nodes.len() - node) as u32;
}

fn middle(bounds: &Bounds) -> Vec3 {
    // Halves first: the sum of two large numbers may not be one.
    bounds.min * 0.5 + bounds.max * 0.5
}
