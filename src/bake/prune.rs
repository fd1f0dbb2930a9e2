//! Model only what a scene requires: keep the spheres that cull, drop the rest.
//!
//! A node is kept if, seen from outside, it draws at least a share `x` fewer triangles than the kept nodes and
//! objects below it would. Most spheres of a hierarchy never pay; what is dropped costs neither bytes nor time.

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

/// Which nodes to keep: those that show at most `1 - share` of what would be drawn without them.
/// `share` is in 0..=1; with 0 every node is kept that does not make things worse.
pub fn nodes_worth_keeping(
    hierarchy: &Hierarchy,
    members: &[Member],
    visible: &[f64],
    share: f64,
) -> Vec<bool> {
    let mut drawn_below = vec![0.0; hierarchy.nodes.len()];
    for (place, parent) in hierarchy.parents_of_members().into_iter().enumerate() {
        if let Some(parent) = parent {
            drawn_below[parent as usize] += f64::from(members[hierarchy.order[place] as usize].triangles);
        }
    }
    let mut keep = vec![false; hierarchy.nodes.len()];
    // Depth-first order backwards: children before parents.
    for (index, node) in hierarchy.nodes.iter().enumerate().rev() {
        let without = drawn_below[index];
        keep[index] = visible[index] < without && visible[index] <= without * (1.0 - share);
        if let Some(parent) = node.parent {
            drawn_below[parent as usize] += if keep[index] { visible[index] } else { without };
        }
    }
    keep
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
    let parents: Vec<Option<u32>> =
        hierarchy.nodes.iter().map(|n| kept_above(n.parent)).collect();
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
