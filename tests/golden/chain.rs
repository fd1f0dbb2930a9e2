//! The chain of 512 boxes: from -x every group shows its first box only, from +x its last, from the sides all.
//!
//! That is true of the directions themselves, not of a direction bin, however small: the boxes are equal and in a
//! row, so from any other direction each one peeps out behind the one in front of it. A table baked by sampling
//! whole bins must therefore say that everything is visible everywhere, and the spheres then cull nothing and are
//! pruned. So the chain's golden levels are those of exact parallel views, and the bake has a golden answer of its
//! own.

use crate::baking::{Unpruned, bake, document, options};
use glam::DVec3;
use svs::bake::hierarchy::HierarchyKind;
use svs::generate::{SampleKind, SampleOptions, generate};

const BOXES: u32 = 512;
const DEPTH: u8 = 9;

fn chain() -> Unpruned {
    Unpruned::new(&document(generate(&SampleOptions::new(SampleKind::Boxes))), HierarchyKind::Scene)
}

#[test]
fn groups_are_a_binary_tree() {
    let chain = chain();
    assert_eq!(chain.hierarchy.nodes.len(), 511);
    assert!((0..BOXES).all(|k| chain.ancestry.depth(k) == DEPTH));
}

#[test]
fn from_the_ends_every_group_shows_one_box() {
    let chain = chain();
    // Group sizes are powers of two: the box is first in as many groups above it as its index has zeros at the end.
    let first: Vec<u8> = (0..BOXES).map(|k| (k.trailing_zeros() as u8).min(DEPTH)).collect();
    let last: Vec<u8> = (1..=BOXES).map(|k| (k.trailing_zeros() as u8).min(DEPTH)).collect();
    // Signs of zero are part of the test: the lines' directions are the negated ones.
    for zero in [0.0, -0.0] {
        assert_eq!(chain.levels_from(DVec3::new(-1.0, zero, zero), 400), first);
        assert_eq!(chain.levels_from(DVec3::new(1.0, zero, zero), 400), last);
    }
}

#[test]
fn from_the_sides_every_group_shows_all_boxes() {
    let chain = chain();
    for side in [DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z, DVec3::new(0.0, 1.0, -1.0)] {
        assert_eq!(chain.levels_from(side, 40_000), vec![DEPTH; BOXES as usize], "from {side}");
    }
}

#[test]
fn whole_bins_see_every_box_and_all_spheres_are_pruned() {
    let mut doc =
        document(generate(&SampleOptions { scale: 1.0 / 16.0, ..SampleOptions::new(SampleKind::Boxes) }));
    let (trees, report) = bake(&mut doc, &options(1 << 23));
    println!("{} of {} spheres kept", report.trees[0].nodes_kept, report.trees[0].nodes_before);
    assert_eq!(report.trees[0].nodes_before, 31);
    for tree in &trees {
        for object in 0..tree.object_count() {
            for direction in 0..tree.direction_set().len() {
                assert_eq!(u32::from(tree.level(object, direction)), tree.depth(object));
            }
        }
    }
    assert_eq!(report.trees[0].nodes_kept, 0);
}
