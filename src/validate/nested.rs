//! Nested trees against the scene: is the inner tree's anchor where the outer tree has it?

use super::ROOT;
use super::places::{Place, PlacedTree};
use super::report::ValidationReport;
use serde::Deserialize;
use serde_json::Value;
use std::collections::HashMap;
use svs_runtime::format::NestedJson;

/// The `nested` entries of a tree; broken ones, which the schema reports, are left out.
pub(super) fn entries(extension: &Value, tree: usize) -> Vec<NestedJson> {
    let entries = extension["trees"][tree]["nested"].as_array().map_or(&[][..], Vec::as_slice);
    entries.iter().filter_map(|entry| NestedJson::deserialize(entry).ok()).collect()
}

/// Checks the places of all nested trees; whether they exist was checked when they were decoded.
pub(super) fn check(extension: &Value, trees: &[Option<PlacedTree>], report: &mut ValidationReport) {
    for (index, outer) in trees.iter().enumerate() {
        let Some(outer) = outer else { continue };
        let entries = entries(extension, index);
        let mut shares: HashMap<u32, usize> = HashMap::new();
        entries.iter().for_each(|entry| *shares.entry(entry.tree).or_default() += 1);
        for (number, entry) in entries.iter().enumerate() {
            let Some(inner) = trees.get(entry.tree as usize).and_then(Option::as_ref) else { continue };
            // Of an outer tree with many anchors, each has its own share of the inner tree's anchors.
            let share = shares[&entry.tree];
            for (copy, outer_place) in outer.places.iter().enumerate() {
                let anchor = copy.saturating_mul(share).saturating_add(entry.anchor as usize);
                let inner_place = inner.places.get(anchor).and_then(Option::as_ref);
                let (Some(outer_place), Some(inner_place)) = (outer_place, inner_place) else { continue };
                if (entry.object as usize) < outer.tree.object_count()
                    && let Some(problem) = misplaced(outer, outer_place, inner_place, entry)
                {
                    let pointer = format!("{ROOT}/trees/{index}/nested/{number}");
                    report.error("NESTED_MISPLACED", pointer, problem);
                    break;
                }
            }
        }
    }
}

fn misplaced(outer: &PlacedTree, outer_place: &Place, inner: &Place, entry: &NestedJson) -> Option<String> {
    let below = outer_place.scene_index == inner.scene_index
        && inner.anchor.is_some_and(|anchor| nodes_below(outer_place).contains(&(anchor as usize)));
    if !below {
        return Some(format!("The anchor at {} is not below {}.", inner.pointer, outer_place.pointer));
    }
    let number = outer.tree.document_index(entry.object as usize);
    let expected = inner.objects.start - outer_place.objects.start;
    if number != expected {
        return Some(format!(
            "Object {} has document number {number}; the first object below the anchor at {} has {expected}.",
            entry.object, inner.pointer
        ));
    }
    // The anchor's own movement counts here: a sphere of the outer tree is around it.
    let moving = outer_place.scene.nodes[nodes_below(outer_place)].iter().zip(nodes_below(outer_place)).any(
        |(node, index)| {
            node.moving
                && inner.anchor.is_some_and(|a| (index..node.subtree_end as usize).contains(&(a as usize)))
        },
    );
    moving.then(|| format!("The anchor at {} moves within the space of the tree around it.", inner.pointer))
}

/// The scene nodes below a place, in [`crate::scene::Scene::nodes`]; an anchor itself is not among them.
fn nodes_below(place: &Place) -> std::ops::Range<usize> {
    match place.anchor {
        Some(anchor) => anchor as usize + 1..place.scene.nodes[anchor as usize].subtree_end as usize,
        None => 0..place.scene.nodes.len(),
    }
}

/// For each object below the place: does an animation move it within the tree's space?
pub(super) fn is_moving_below(place: &Place) -> Vec<bool> {
    let mut moving = vec![false; place.objects.len()];
    let mut next = 0;
    for index in nodes_below(place) {
        let node = &place.scene.nodes[index];
        // What is below a moving node is marked with it.
        if node.moving && index >= next {
            next = node.subtree_end as usize;
            for object in node.objects.clone() {
                moving[(object - place.objects.start) as usize] = true;
            }
        }
    }
    moving
}
