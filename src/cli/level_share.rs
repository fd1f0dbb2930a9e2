//! How much each level of a visibility tree culls.

use std::ops::Range;

/// An inner node: the objects below it (places in tree order) and the nodes of its subtree, itself included.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    pub(crate) objects: Range<usize>,
    pub(crate) subtree: usize,
}

/// All nodes with the same number of ancestors.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct LevelShare {
    /// How many nodes.
    pub(crate) spheres: u64,
    /// Objects below them.
    pub(crate) objects: u64,
    /// Triangles below them.
    pub(crate) triangles: u64,
    /// Mean share, 0 to 1, of these triangles that is not visible from outside the node's sphere, over directions.
    pub(crate) culled: f64,
}

/// What the nodes of each depth cull. Nodes are in depth-first order; `level(object, direction)` is the visible
/// level; `triangles` has one entry per object.
pub(crate) fn by_depth(
    nodes: &[Node],
    directions: usize,
    level: impl Fn(usize, usize) -> u8,
    triangles: &[u64],
) -> Vec<LevelShare> {
    let mut shares: Vec<LevelShare> = Vec::new();
    let mut parents: Vec<Option<usize>> = Vec::with_capacity(nodes.len());
    // Depth-first order: an inner node overwrites what its ancestors wrote.
    let mut innermost: Vec<Option<usize>> = vec![None; triangles.len()];
    let mut open: Vec<(usize, usize)> = Vec::new();
    for (index, node) in nodes.iter().enumerate() {
        while open.last().is_some_and(|&(_, end)| end <= index) {
            open.pop();
        }
        parents.push(open.last().map(|&(parent, _)| parent));
        let depth = open.len();
        open.push((index, index + node.subtree));
        if shares.len() <= depth {
            shares.resize(depth + 1, LevelShare::default());
        }
        shares[depth].spheres += 1;
        innermost[node.objects.clone()].fill(Some(index));
    }

    let mut hidden = vec![0.0; shares.len()];
    let mut below: Vec<u64> = Vec::new();
    for (object, &count) in triangles.iter().enumerate() {
        // below[h]: directions from which the object's level is less than h.
        below.clear();
        below.resize(shares.len() + 2, 0);
        for direction in 0..directions {
            let reached = usize::from(level(object, direction)).min(shares.len());
            below[reached + 1] += 1;
        }
        for height in 1..below.len() {
            below[height] += below[height - 1];
        }
        let ancestors = std::iter::successors(innermost[object], |&node| parents[node]);
        let depth = ancestors.clone().count();
        for height in 1..=depth {
            let share = &mut shares[depth - height];
            share.objects += 1;
            share.triangles += count;
            hidden[depth - height] += count as f64 * below[height] as f64;
        }
    }
    for (share, hidden) in shares.iter_mut().zip(hidden) {
        let all = share.triangles as f64 * directions as f64;
        share.culled = if all > 0.0 { hidden / all } else { 0.0 };
    }
    shares
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A root over an object of its own and two nodes of two objects each, seen from two directions.
    #[test]
    fn shares_of_a_small_tree() {
        let node = |objects: Range<usize>, subtree| Node { objects, subtree };
        let nodes = [node(0..5, 3), node(1..3, 1), node(3..5, 1)];
        let levels = [[1, 0], [2, 2], [1, 0], [2, 1], [0, 0]];
        let shares = by_depth(&nodes, 2, |object, direction| levels[object][direction], &[10, 1, 2, 3, 4]);
        assert_eq!(shares.len(), 2);
        assert_eq!((shares[0].spheres, shares[0].objects, shares[0].triangles), (1, 5, 20));
        assert_eq!((shares[1].spheres, shares[1].objects, shares[1].triangles), (2, 4, 10));
        // Root, height 1 for object 0 and 2 for the others: hidden 1 of 2, 0, 2, 1, 2 directions.
        assert_eq!(shares[0].culled, (10.0 * 1.0 + 2.0 * 2.0 + 3.0 * 1.0 + 4.0 * 2.0) / 40.0);
        // Inner nodes, height 1: hidden 0, 1, 0, 2 directions.
        assert_eq!(shares[1].culled, (2.0 * 1.0 + 4.0 * 2.0) / 20.0);
    }

    #[test]
    fn no_nodes_or_no_triangles_cull_nothing() {
        assert_eq!(by_depth(&[], 4, |_, _| 0, &[7, 7]), []);
        let shares = by_depth(&[Node { objects: 0..1, subtree: 1 }], 4, |_, _| 0, &[0]);
        assert_eq!(shares[0].culled, 0.0);
    }
}
