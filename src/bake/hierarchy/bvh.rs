//! Bounding volume hierarchy by a full-sweep surface area heuristic, collapsed to wide nodes.
//!
//! The sweep is Wald, Boulos and Shirley, Ray Tracing Deformable Scenes using Dynamic Bounding Volume Hierarchies,
//! ACM Transactions on Graphics 26(1), 2007; widening by opening the child of largest area is Wald, Benthin and
//! Boulos, Getting Rid of Packets, IEEE Symposium on Interactive Ray Tracing, 2008. Top-down, because locally
//! ordered clustering (`obvhs` 0.4) makes a chain of equal boxes in quadratic time: 40,000 took 70 s.

use super::draft::{Child, Draft};
use crate::bake::tree::Aabb;
use glam::DVec3;
use std::cmp::Ordering;

/// Ranges of at most this many members are not split.
const LEAF_MEMBERS: usize = 8;

/// Most children of a node.
const CHILDREN: usize = 8;

/// Below this many splits ranges are halved, which bounds the time for adversarial sizes.
const MAX_SWEEPS: u32 = 96;

/// Coordinates are rounded to this part of the scene's longest side, so that boxes which should be equally placed
/// are, whatever the unit.
const GRID: f64 = (1u64 << 36) as f64;

/// A split is better only if it is so by this part: else rounding errors would choose among equal ones.
const TOLERANCE: f64 = 1e-9;

/// A node of the binary tree.
struct Binary {
    /// Members, in the order of `Builder::axes`.
    start: usize,
    end: usize,
    area: f64,
    /// Two children, the second right after the first.
    children: Option<usize>,
}

struct Builder {
    /// Boxes in units of the scene's longest side, about the scene's centre.
    boxes: Vec<Aabb>,
    /// Items sorted by their centre along each axis; the three arrays hold the same items in any node's range.
    axes: [Vec<u32>; 3],
    /// Area of the box of a node's items from the i-th on.
    suffix: Vec<f64>,
    is_left: Vec<bool>,
    scratch: Vec<u32>,
}

/// Builds nodes over `items`, whose boxes are usable; returns what hangs on the root.
pub(super) fn build(draft: &mut Draft, items: &[(Aabb, Child)]) -> Vec<Child> {
    if items.is_empty() {
        return Vec::new();
    }
    let mut builder = Builder::new(items);
    let mut nodes = vec![Binary { start: 0, end: items.len(), area: 0.0, children: None }];
    let mut stack = vec![(0, 0)];
    while let Some((node, depth)) = stack.pop() {
        let (start, end) = (nodes[node].start, nodes[node].end);
        if end - start <= LEAF_MEMBERS {
            continue;
        }
        let middle = builder.split(start, end, depth < MAX_SWEEPS);
        let first = nodes.len();
        nodes[node].children = Some(first);
        for (start, end) in [(start, middle), (middle, end)] {
            nodes.push(Binary { start, end, area: builder.area(start, end), children: None });
        }
        stack.extend([(first, depth + 1), (first + 1, depth + 1)]);
    }
    collapse(draft, &nodes, &builder.axes[0], items)
}

/// Makes wide draft nodes of the binary ones; returns what hangs on the root.
fn collapse(draft: &mut Draft, nodes: &[Binary], order: &[u32], items: &[(Aabb, Child)]) -> Vec<Child> {
    let root = draft.add(Vec::new());
    let mut stack = vec![(root, 0)];
    while let Some((target, node)) = stack.pop() {
        let Some(first) = nodes[node].children else {
            for &item in &order[nodes[node].start..nodes[node].end] {
                draft.push(target, items[item as usize].1);
            }
            continue;
        };
        let mut children = vec![first, first + 1];
        while children.len() < CHILDREN {
            // Of equal ones that with the most members, then the first.
            let key = |i: usize| {
                let node = &nodes[children[i]];
                (node.area, node.end - node.start, std::cmp::Reverse(i))
            };
            let largest = (0..children.len())
                .filter(|&i| nodes[children[i]].children.is_some())
                .max_by(|&a, &b| key(a).partial_cmp(&key(b)).unwrap_or(Ordering::Equal));
            let Some(largest) = largest else { break };
            if let Some(first) = nodes[children[largest]].children {
                children.splice(largest..=largest, [first, first + 1]);
            }
        }
        for child in children {
            let below = draft.add(Vec::new());
            draft.push(target, Child::Node(below));
            stack.push((below, child));
        }
    }
    vec![Child::Node(root)]
}

impl Builder {
    fn new(items: &[(Aabb, Child)]) -> Self {
        let all = items.iter().fold(Aabb::EMPTY, |all, (bounds, _)| all.union(bounds));
        let center = all.center();
        let side = (all.max - all.min).max_element();
        let scale = if side > 0.0 { side } else { 1.0 };
        let round = |corner: DVec3| ((corner - center) / scale * GRID).round() / GRID;
        let boxes: Vec<Aabb> =
            items.iter().map(|(item, _)| Aabb { min: round(item.min), max: round(item.max) }).collect();
        let axes = [0, 1, 2].map(|axis| {
            let mut order: Vec<u32> = (0..items.len() as u32).collect();
            let center = |item: u32| boxes[item as usize].min[axis] + boxes[item as usize].max[axis];
            // Stable: equal centres keep document order.
            order.sort_by(|&a, &b| center(a).partial_cmp(&center(b)).unwrap_or(Ordering::Equal));
            order
        });
        let count = items.len();
        Self { boxes, axes, suffix: vec![0.0; count], is_left: vec![false; count], scratch: Vec::new() }
    }

    /// Half the surface of the box of the items in the range.
    fn area(&self, start: usize, end: usize) -> f64 {
        let items = &self.axes[0][start..end];
        half_area(&items.iter().fold(Aabb::EMPTY, |all, &item| all.union(&self.boxes[item as usize])))
    }

    /// Reorders the range so that the items left of the returned place are the left child's.
    fn split(&mut self, start: usize, end: usize, sweep: bool) -> usize {
        let count = end - start;
        let mut best = (f64::INFINITY, 0, count / 2);
        for axis in 0..3 {
            if !sweep {
                break;
            }
            let items = &self.axes[axis][start..end];
            let mut bounds = Aabb::EMPTY;
            for i in (1..count).rev() {
                bounds = bounds.union(&self.boxes[items[i] as usize]);
                self.suffix[i] = half_area(&bounds);
            }
            bounds = Aabb::EMPTY;
            for i in 1..count {
                bounds = bounds.union(&self.boxes[items[i - 1] as usize]);
                let cost = half_area(&bounds) * i as f64 + self.suffix[i] * (count - i) as f64;
                // Equal costs: the more even split, then the first axis. Equal boxes are halved, not peeled.
                let margin = TOLERANCE * best.0.min(f64::MAX);
                let evener = i.abs_diff(count / 2) < best.2.abs_diff(count / 2);
                if cost < best.0 - margin || (cost <= best.0 + margin && evener) {
                    best = (cost.min(best.0), axis, i);
                }
            }
        }
        let (_, axis, left) = best;
        for (i, &item) in self.axes[axis][start..end].iter().enumerate() {
            self.is_left[item as usize] = i < left;
        }
        for order in &mut self.axes {
            let range = &mut order[start..end];
            self.scratch.clear();
            self.scratch.extend(range.iter().copied().filter(|&item| !self.is_left[item as usize]));
            let mut kept = 0;
            for i in 0..count {
                let item = range[i];
                if self.is_left[item as usize] {
                    range[kept] = item;
                    kept += 1;
                }
            }
            range[kept..].copy_from_slice(&self.scratch);
        }
        start + left
    }
}

fn half_area(bounds: &Aabb) -> f64 {
    let size = bounds.max - bounds.min;
    size.x * size.y + size.y * size.z + size.z * size.x
}
