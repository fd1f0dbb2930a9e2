//! Model only what a scene requires: keep the spheres that cull, drop the rest.
//!
//! Most spheres of a hierarchy never pay; what is dropped costs neither bytes nor time.

use super::sample::{Ancestry, Levels};
use super::tree::{Hierarchy, HierarchyNode, Member};
use rayon::prelude::*;

/// Triangles that each node shows from outside its sphere, averaged over the directions.
pub fn visible_triangles(
    hierarchy: &Hierarchy,
    ancestry: &Ancestry,
    levels: &Levels,
    members: &[Member],
) -> Vec<f64> {
    let directions = levels.directions().max(1) as f64;
    let mut visible = vec![0.0; hierarchy.nodes.len()];
    for member in 0..members.len() as u32 {
        let triangles = f64::from(members[member as usize].triangles);
        let row = levels.row(member);
        for (above, node) in ancestry.ancestors(member).enumerate() {
            let seeing = row.iter().filter(|&&level| usize::from(level) > above).count();
            if seeing == 0 {
                break;
            }
            visible[node as usize] += triangles * seeing as f64 / directions;
        }
    }
    visible
}

/// Chooses the nodes to keep, at most `limit` above any member.
///
/// Minimises the triangles drawn, summed over viewpoints: one at every member and as many outside everything. A
/// kept node serves the viewpoints that are outside it but inside the next kept node above it; it shows them
/// `visible[node]` triangles, where otherwise they would see what the kept nodes and members below show. To be
/// kept a node must save at least `share` of that.
///
/// Exact, by dynamic programming from the leaves: the best cost of a subtree depends only on the next kept node
/// above it and on how many more may be kept. Time and memory grow with nodes x depth x limit.
pub fn nodes_worth_keeping(
    hierarchy: &Hierarchy,
    members: &[Member],
    visible: &[f64],
    share: f64,
    limit: u32,
) -> Vec<bool> {
    let nodes = &hierarchy.nodes;
    let states = limit as usize + 1;
    let everywhere = 2.0 * members.len() as f64;
    let direct = direct_triangles(hierarchy, members);
    let mut depth = vec![0usize; nodes.len()];
    for (index, node) in nodes.iter().enumerate() {
        depth[index] = node.parent.map_or(0, |p| depth[p as usize] + 1);
    }
    // Viewpoints inside a node, and in each context of it: context 0 is "nothing kept above", context i the
    // ancestor at depth i - 1.
    let inside = |node: usize| nodes[node].members.len() as f64;
    let mut path: Vec<usize> = Vec::new();

    // Cost of the children by (context, allowance); one context more than the node itself has: the node.
    let mut below: Vec<Vec<f64>> = depth.iter().map(|&d| vec![0.0; (d + 2) * states]).collect();
    let mut keeps: Vec<Vec<bool>> = vec![Vec::new(); nodes.len()];
    for index in (0..nodes.len()).rev() {
        // Ancestors of this node, from the root down.
        path.clear();
        let mut above = nodes[index].parent;
        while let Some(node) = above {
            path.push(node as usize);
            above = nodes[node as usize].parent;
        }
        path.reverse();
        let sums = std::mem::take(&mut below[index]);
        let itself = depth[index] + 1;
        let mut costs = vec![0.0; itself * states];
        let mut decisions = vec![false; itself * states];
        for context in 0..itself {
            let viewpoints = if context == 0 { everywhere } else { inside(path[context - 1]) };
            for allowance in 0..states {
                let place = context * states + allowance;
                let without = sums[place] + direct[index] * viewpoints;
                let mut best = without;
                if allowance > 0 && share < 1.0 {
                    let with = visible[index] / (1.0 - share) * (viewpoints - inside(index))
                        + sums[itself * states + allowance - 1]
                        + direct[index] * inside(index);
                    if with < without {
                        best = with;
                        decisions[place] = true;
                    }
                }
                costs[place] = best;
            }
        }
        keeps[index] = decisions;
        if let Some(parent) = nodes[index].parent {
            for (sum, cost) in below[parent as usize].iter_mut().zip(costs) {
                *sum += cost;
            }
        }
    }

    // From the roots down: what was decided for the context that came about.
    let mut states_below: Vec<(usize, usize)> = Vec::with_capacity(nodes.len());
    let mut keep = Vec::with_capacity(nodes.len());
    for (index, node) in nodes.iter().enumerate() {
        let (context, allowance) = node.parent.map_or((0, states - 1), |p| states_below[p as usize]);
        let kept = keeps[index][context * states + allowance];
        keep.push(kept);
        states_below.push(if kept { (depth[index] + 1, allowance - 1) } else { (context, allowance) });
    }
    keep
}

/// Triangles of the members that hang on each node itself.
fn direct_triangles(hierarchy: &Hierarchy, members: &[Member]) -> Vec<f64> {
    let mut direct = vec![0.0; hierarchy.nodes.len()];
    for (place, parent) in hierarchy.parents_of_members().into_iter().enumerate() {
        if let Some(parent) = parent {
            direct[parent as usize] += f64::from(members[hierarchy.order[place] as usize].triangles);
        }
    }
    direct
}

/// Nodes to keep so that none has `limit` or more ancestors: the deeper ones give way to those above them.
pub fn nodes_within_depth(hierarchy: &Hierarchy, limit: u32) -> Vec<bool> {
    let mut depths = vec![0u32; hierarchy.nodes.len()];
    for (index, node) in hierarchy.nodes.iter().enumerate() {
        depths[index] = node.parent.map_or(0, |p| depths[p as usize] + 1);
    }
    depths.into_iter().map(|depth| depth < limit).collect()
}

/// The hierarchy with only the kept nodes; what hung on a dropped node hangs on the next kept one above.
pub fn without_dropped(hierarchy: &Hierarchy, keep: &[bool]) -> Hierarchy {
    let kept_above = |mut node: Option<u32>| {
        while let Some(index) = node {
            if keep[index as usize] {
                break;
            }
            node = hierarchy.nodes[index as usize].parent;
        }
        node
    };
    let parents: Vec<Option<u32>> = hierarchy.nodes.iter().map(|n| kept_above(n.parent)).collect();
    let member_parents: Vec<Option<u32>> =
        hierarchy.parents_of_members().into_iter().map(kept_above).collect();

    // Direct members by node; `NONE` collects those above all kept nodes.
    let top = hierarchy.nodes.len();
    let slot = |parent: Option<u32>| parent.map_or(top, |p| p as usize);
    let mut direct: Vec<Vec<u32>> = vec![Vec::new(); top + 1];
    for (place, parent) in member_parents.iter().enumerate() {
        direct[slot(*parent)].push(hierarchy.order[place]);
    }
    let mut children: Vec<Vec<u32>> = vec![Vec::new(); top + 1];
    for (index, parent) in parents.iter().enumerate().filter(|(i, _)| keep[*i]) {
        children[slot(*parent)].push(index as u32);
    }

    let mut result = Hierarchy { nodes: Vec::new(), order: std::mem::take(&mut direct[top]) };
    enum Step {
        Enter(u32, Option<u32>),
        Leave(u32),
    }
    let mut steps: Vec<Step> = children[top].iter().rev().map(|&c| Step::Enter(c, None)).collect();
    while let Some(step) = steps.pop() {
        match step {
            Step::Enter(old, parent) => {
                let new = result.nodes.len() as u32;
                let first = result.order.len() as u32;
                result.nodes.push(HierarchyNode { parent, subtree: 0, members: first..first });
                result.order.append(&mut direct[old as usize]);
                steps.push(Step::Leave(new));
                steps.extend(children[old as usize].iter().rev().map(|&c| Step::Enter(c, Some(new))));
            }
            Step::Leave(new) => {
                let node_count = result.nodes.len() as u32;
                let node = &mut result.nodes[new as usize];
                node.subtree = node_count - new;
                node.members.end = result.order.len() as u32;
            }
        }
    }
    result
}

/// Levels counted in kept nodes only: a level of n becomes the number of kept nodes among the n lowest
/// ancestors.
pub fn levels_of_kept(ancestry: &Ancestry, keep: &[bool], levels: &mut Levels) {
    let members = ancestry.members() as u32;
    let kept_among: Vec<Vec<u8>> = (0..members)
        .into_par_iter()
        .map(|member| {
            let mut kept = 0;
            let mut counts = vec![0];
            for node in ancestry.ancestors(member) {
                kept += u8::from(keep[node as usize]);
                counts.push(kept);
            }
            counts
        })
        .collect();
    levels.remap(|member, level| kept_among[member as usize][usize::from(level)]);
}
