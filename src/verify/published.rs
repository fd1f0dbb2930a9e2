//! The published query: what to draw for a camera, from a [`PublishedBake`].
//!
//! Eikel 2013, section 4.4 (MAX3) and the traversal of section 4: a sphere is used whenever the camera is outside of
//! it, with the direction from its centre to the camera; else its children are visited. Everything is frustum-culled,
//! nodes by their boxes and objects by theirs.

use super::published_bake::PublishedBake;
use super::target::Target;
use super::view::View;

impl PublishedBake {
    /// Writes the members to draw into `drawn`, in no particular order; none comes twice.
    pub fn draw(&self, target: &Target, view: &View, drawn: &mut Vec<u32>) {
        drawn.clear();
        let frustum = view.frustum();
        let nodes = &self.hierarchy.nodes;
        let mut index = 0;
        while let Some(node) = nodes.get(index) {
            let end = index + node.subtree as usize;
            if !frustum.touches(&self.boxes[index]) {
                index = end;
                continue;
            }
            let sphere = &self.spheres[index];
            let towards_viewer = view.eye - sphere.center;
            let first = drawn.len();
            if towards_viewer.length() > sphere.radius {
                let (samples, _) = self.directions.weights_f64(towards_viewer);
                // MAX3: the union of the three samples around the direction.
                let vectors = samples.iter().flat_map(|&s| self.vector(index, usize::from(s)));
                drawn.extend(vectors.map(|&(member, _)| member));
                drawn[first..].sort_unstable();
                index = end;
            } else {
                // Objects that hang on the node itself are leaves.
                let direct_end =
                    if node.subtree > 1 { nodes[index + 1].members.start } else { node.members.end };
                let direct = node.members.start as usize..direct_end as usize;
                drawn.extend_from_slice(&self.hierarchy.order[direct]);
                index += 1;
            }
            // Within the part just added: once each, and only what the frustum touches.
            let mut kept = first;
            for at in first..drawn.len() {
                let member = drawn[at];
                let repeated = kept > first && drawn[kept - 1] == member;
                if !repeated && frustum.touches(&target.boxes[member as usize]) {
                    drawn[kept] = member;
                    kept += 1;
                }
            }
            drawn.truncate(kept);
        }
    }
}
