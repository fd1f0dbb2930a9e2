//! Nodes that the application moves.

use crate::scene::Scene;
use glam::DAffine3;

impl Scene {
    /// Gives a node another matrix. Trees anchored at or below it move along. Objects that move within their tree are
    /// *released*: nothing is known of them any more, nor of what they have hidden, and they are the application's to draw,
    /// see [`Self::is_released`]. Nodes that do not exist are ignored.
    pub fn set_node(&mut self, node: u32, local: DAffine3) {
        let Some(moved) = self.graph.nodes.get_mut(node as usize) else { return };
        if moved.local == local {
            return;
        }
        moved.local = local;
        let (end, first, last) = (moved.end, moved.first_object, moved.end_object);
        for place in node..end {
            let parent = self.graph.nodes[place as usize].parent;
            let above = parent.map_or(DAffine3::IDENTITY, |parent| self.graph.nodes[parent as usize].world);
            let at = &mut self.graph.nodes[place as usize];
            at.world = above * at.local;
        }
        for tree in 0..self.places.anchors.len() {
            for index in 0..self.places.anchors[tree].len() {
                let anchor = &self.places.anchors[tree][index];
                if anchor.node.is_some_and(|at| (node..end).contains(&at)) {
                    let to_world = self.places.to_world(&self.graph, anchor);
                    self.culler.set_anchor(tree as u32, index as u32, to_world);
                }
            }
        }
        for object in first..last {
            if self.moves_within_its_tree(object, node) {
                self.release(object);
            }
        }
    }

    /// The object has moved within its tree, see [`Self::set_node`].
    pub fn is_released(&self, object: u32) -> bool {
        self.released.get(object as usize).copied().unwrap_or(false)
    }

    /// `node`, at or above an object, is below the anchor of the object's tree, or of a tree around that one.
    fn moves_within_its_tree(&self, object: u32, node: u32) -> bool {
        let Some(draw) = self.draws[object as usize] else { return false };
        let anchor = |tree: u32, anchor: u32| self.places.anchors[tree as usize][anchor as usize].node;
        let (mut tree, mut index) = (draw.tree, draw.anchor);
        loop {
            if anchor(tree, index).is_none_or(|at| at < node) {
                return true;
            }
            // At or above this anchor: it moves along, unless another tree holds it as an object.
            let trees = self.places.visibility.trees().iter().enumerate();
            let host = trees.into_iter().find_map(|(host, data)| {
                (0..self.places.anchors[host].len()).find_map(|host_anchor| {
                    let names = data.nested().iter().any(|nested| {
                        nested.tree == tree && data.nested_anchor(nested, host_anchor) == index as usize
                    });
                    names.then_some((host as u32, host_anchor as u32))
                })
            });
            match host {
                Some(outer) => (tree, index) = outer,
                None => return false,
            }
        }
    }

    fn release(&mut self, object: u32) {
        let index = object as usize;
        if !self.released[index]
            && let Some(draw) = self.draws[index]
        {
            self.released[index] = true;
            self.culler.set_hidden(draw, true);
        }
    }
}
