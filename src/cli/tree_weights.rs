//! Triangles behind each object of the visibility trees.

use std::sync::Arc;
use svs::scene::Scene;
use svs_runtime::{Placement, Tree};

/// Triangles drawn for a mesh.
pub(crate) fn triangles_of(scene: &Scene, mesh: u32) -> u64 {
    scene.meshes.get(mesh as usize).map_or(0, |mesh| u64::from(mesh.drawn_triangles))
}

/// Triangles of each object of each tree, in tree order; an object that stands for another tree has all of that
/// tree's. The first anchor speaks for the others; objects that the scene does not have count as nothing.
pub(crate) fn tree_weights(scene: &Scene, trees: &[Arc<Tree>]) -> Vec<Vec<u64>> {
    let mut weights: Vec<Vec<u64>> = trees.iter().map(|tree| own_weights(scene, tree)).collect();
    // Inner trees first. The decoder has refused cycles; a stack of our own keeps deep nesting off the call stack.
    let mut done = vec![false; trees.len()];
    for start in 0..trees.len() {
        let mut stack = vec![(start, false)];
        while let Some((index, inner_done)) = stack.pop() {
            if done[index] {
                continue;
            }
            if !inner_done {
                stack.push((index, true));
                stack.extend(trees[index].nested().iter().map(|nested| (nested.tree as usize, false)));
                continue;
            }
            for nested in trees[index].nested() {
                let inner = weights[nested.tree as usize].iter().fold(0_u64, |sum, &w| sum.saturating_add(w));
                weights[index][nested.object as usize] = inner;
            }
            done[index] = true;
        }
    }
    weights
}

fn own_weights(scene: &Scene, tree: &Tree) -> Vec<u64> {
    let objects = match tree.placement() {
        Placement::Scene(_) => &scene.objects[..],
        Placement::Anchors(anchors) => scene
            .nodes
            .iter()
            .find(|node| anchors.first().is_some_and(|&anchor| node.node == anchor as usize))
            .map_or(&[][..], |node| &scene.objects[node.objects.start as usize..node.objects.end as usize]),
    };
    let weight = |place: usize| {
        let object = objects.get(tree.document_index(place) as usize);
        object.map_or(0, |object| triangles_of(scene, object.mesh))
    };
    (0..tree.object_count()).map(weight).collect()
}
