//! Shells within shells: closed, the level of everything inside is exactly its own group.

use crate::baking::{Unpruned, bake, document, options, rows};
use glam::DVec3;
use svs::bake::hierarchy::HierarchyKind;
use svs::generate::{ShellOptions, shells};
use svs_runtime::DirectionSet;

const DEPTH: usize = 3;

/// Exact levels: shell k is seen from outside its own group, and from no other; the box beside it from none.
fn closed() -> [u8; 2 * DEPTH] {
    [1, 0, 1, 0, 1, 0]
}

#[test]
fn closed_shells_show_nothing() {
    let mut doc = document(shells(&ShellOptions { depth: DEPTH, hole: false }));
    let (trees, report) = bake(&mut doc, &options(1 << 21));
    assert_eq!((trees.len(), report.trees[0].nodes_kept), (1, DEPTH));
    for (object, (row, level)) in rows(&trees[0]).into_iter().zip(closed()).enumerate() {
        assert!(row.iter().all(|&l| l == level), "object {object}: {row:?}");
    }
}

#[test]
fn closed_shells_show_nothing_in_exact_views() {
    let doc = document(shells(&ShellOptions { depth: DEPTH, hole: false }));
    let scene = Unpruned::new(&doc, HierarchyKind::Scene);
    let directions = DirectionSet::by_name("icosahedron-2").expect("a set");
    for i in 0..directions.len() {
        assert_eq!(scene.levels_from(directions.direction_f64(i), 5_000), closed());
    }
}

/// The outermost shell is 18 m wide, its hole 2 m; the next shell is 6 m wide, so a sight line through the hole
/// reaches it exactly if on its way in of 6 m it leaves the axis by less than 4 m to the side in y and in z.
fn hole_shows_next_shell(direction: DVec3, most: f64) -> bool {
    let aside = direction.y.abs().max(direction.z.abs());
    direction.x > 0.0 && aside * 6.0 < most * direction.x
}

#[test]
fn through_a_hole_the_next_shell_is_seen_from_the_side_of_the_hole_only() {
    let doc = document(shells(&ShellOptions { depth: DEPTH, hole: true }));
    let scene = Unpruned::new(&doc, HierarchyKind::Scene);
    let directions = DirectionSet::by_name("icosahedron-3").expect("a set");
    let (mut seen, mut unseen) = (0, 0);
    for i in 0..directions.len() {
        let direction = directions.direction_f64(i);
        let levels = scene.levels_from(direction, 5_000);
        // Shell 0 is the outermost; what is in shell 1 stays hidden.
        assert_eq!((levels[0], &levels[3..]), (1, &closed()[3..]), "from {direction}");
        if hole_shows_next_shell(direction, 3.6) {
            assert_eq!(levels[2], 2, "shell 1 from {direction}");
            seen += 1;
        } else if !hole_shows_next_shell(direction, 4.0) {
            assert_eq!(levels[2], 1, "shell 1 from {direction}");
            unseen += 1;
        }
        assert!(levels[1] == 0 || direction.x > 0.0, "the box in shell 0 from {direction}");
    }
    assert!(seen > 40 && unseen > 500, "{seen} {unseen}");
    // Seven metres across on the way in: over the next shell, onto the box beside it.
    assert_eq!(scene.levels_from(DVec3::new(1.0, -0.6, 0.0), 20_000)[1], 1);
}

#[test]
fn through_a_hole_bins_of_other_sides_see_nothing() {
    let mut doc = document(shells(&ShellOptions { depth: DEPTH, hole: true }));
    let (trees, _) = bake(&mut doc, &options(1 << 22));
    let tree = &trees[0];
    let directions = tree.direction_set();
    // Objects in document order, with the bin of +x.
    let rows = rows(tree);
    let front = directions.nearest_f64(DVec3::X);
    assert_eq!((rows[2][front], rows[2].iter().max()), (2, Some(&2)));
    for i in 0..directions.len() {
        // The hole shows something within 56 degrees; cells of 42 directions reach 21 degrees.
        if directions.direction_f64(i).x < 0.2 {
            let levels: Vec<u8> = rows.iter().map(|row| row[i]).collect();
            assert_eq!(levels, closed(), "direction {i}");
        }
    }
}
