//! The dissertation's test scene (Eikel, Spherical Visibility Sampling, 2013, section 6): 1,000 unit cubes with normally distributed
//! centres, what a bake misses and draws too much at many reference directions.

use crate::baking::{Unpruned, bake, document, options};
use rayon::prelude::*;
use svs::bake::hierarchy::HierarchyKind;
use svs::generate::{SampleKind, SampleOptions, generate};
use svs_runtime::DirectionSet;

/// Directions at which exact views are computed. The dissertation takes 40,962; these are 642.
const REFERENCE: &str = "icosahedron-3";

/// Lines of an exact view: about 100 per cube's silhouette.
const LINES: usize = 40_000;

/// Rays of the bake.
const RAYS: u64 = 1 << 23;

#[test]
fn few_cubes_are_missed_and_few_drawn_in_vain() {
    let mut doc = document(generate(&SampleOptions::new(SampleKind::Cubes)));
    let scene = Unpruned::new(&doc, HierarchyKind::Octree);
    let rays = scene.rays();
    let (trees, report) = bake(&mut doc, &options(RAYS));
    let tree = &trees[0];
    let reference = DirectionSet::by_name(REFERENCE).expect("a set");
    let [visible, missed, wasted] = (0..reference.len())
        .into_par_iter()
        .map(|i| {
            let direction = reference.direction_f64(i);
            let levels = svs::bake::sample::levels_from(&rays, &scene.ancestry, direction, LINES);
            let bin = tree.direction_set().nearest_f64(direction);
            let mut counts = [0usize; 3];
            for place in 0..tree.object_count() {
                let member = tree.document_index(place);
                let is_visible = levels[member as usize] == scene.ancestry.depth(member);
                // From far away NEAREST-o asks all objects for the same direction, and the outermost sphere.
                let is_drawn = u32::from(tree.level(place, bin)) >= tree.depth(place);
                counts[0] += usize::from(is_visible);
                counts[1] += usize::from(is_visible && !is_drawn);
                counts[2] += usize::from(is_drawn && !is_visible);
            }
            counts
        })
        .reduce(|| [0; 3], |a, b| [0, 1, 2].map(|k| a[k] + b[k]));
    let share = |count: usize| count as f64 / visible as f64;
    println!(
        "{} directions, {} bins, {} rays: {:.1} of 1,000 cubes visible, {:.3} % of these missed, {:.1} % too many; {} spheres",
        reference.len(),
        tree.direction_set().len(),
        report.rays,
        visible as f64 / reference.len() as f64,
        share(missed) * 100.0,
        share(wasted) * 100.0,
        tree.nodes().len(),
    );
    assert!(share(missed) < 0.01, "{}", share(missed));
    assert!(share(wasted) < 1.0, "{}", share(wasted));
}
