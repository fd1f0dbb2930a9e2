//! The dissertation's test scene (Eikel, Spherical Visibility Sampling, 2013, section 6): 1,000 unit cubes with normally distributed
//! centres, what a bake misses and draws too much at many reference directions.

use crate::baking::{Unpruned, bake, document, options};
use rayon::prelude::*;
use svs::bake::hierarchy::HierarchyKind;
use svs::generate::{SampleKind, SampleOptions, generate};
use svs_runtime::DirectionSet;

/// Directions at which exact views are computed. The dissertation takes 40,962; these are 642.
const REFERENCE: &str = "icosahedron-3";

/// Lines of an exact view: about 30 per cube's silhouette. What they miss of visible cubes counts as drawn in vain.
const LINES: usize = 20_000;

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
    let [visible, missed, wasted, missed_by_three, wasted_by_three] = (0..reference.len())
        .into_par_iter()
        .map(|i| {
            let direction = reference.direction_f64(i);
            let levels = svs::bake::sample::levels_from(&rays, &scene.ancestry, direction, LINES);
            let bin = tree.direction_set().nearest_f64(direction);
            let three = tree.direction_set().triangle(direction.as_vec3());
            let mut counts = [0usize; 5];
            for place in 0..tree.object_count() {
                let member = tree.document_index(place);
                let is_visible = levels[member as usize] == scene.ancestry.depth(member);
                // From far away NEAREST-o asks all objects for the same direction, and the outermost sphere.
                let is_drawn = u32::from(tree.level(place, bin)) >= tree.depth(place);
                counts[0] += usize::from(is_visible);
                counts[1] += usize::from(is_visible && !is_drawn);
                counts[2] += usize::from(is_drawn && !is_visible);
                // MAX3-o: any of the three bins around the direction, too.
                let any = |bin: &u16| u32::from(tree.level(place, usize::from(*bin))) >= tree.depth(place);
                let is_drawn = is_drawn || three.iter().any(any);
                counts[3] += usize::from(is_visible && !is_drawn);
                counts[4] += usize::from(is_drawn && !is_visible);
            }
            counts
        })
        .reduce(|| [0; 5], |a, b| std::array::from_fn(|k| a[k] + b[k]));
    let share = |count: usize| count as f64 / visible as f64;
    println!(
        "{} directions, {} bins, {} rays, {} spheres: {:.1} of 1,000 cubes visible; NEAREST-o misses {:.3} % of these and draws {:.1} % too many, MAX3-o {:.4} % and {:.1} %",
        reference.len(),
        tree.direction_set().len(),
        report.rays,
        tree.nodes().len(),
        visible as f64 / reference.len() as f64,
        share(missed) * 100.0,
        share(wasted) * 100.0,
        share(missed_by_three) * 100.0,
        share(wasted_by_three) * 100.0,
    );
    // Measured: 0.9 % and 44 %, with MAX3-o 0.1 %. Those missed are all but hidden: they take more rays.
    assert!(share(missed) < 0.02, "{}", share(missed));
    assert!(share(wasted) < 0.6, "{}", share(wasted));
    assert!(share(missed_by_three) < 0.25 * share(missed), "{}", share(missed_by_three));
}
