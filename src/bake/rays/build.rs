//! Building binary hierarchies in time that does not blow up, whatever the boxes.
//!
//! `obvhs` clusters bottom-up (Meister, Bittner: Parallel Locally-Ordered Clustering, 2018): in each round those
//! neighbours merge that choose each other. Among boxes that are equal, concentric or stacked from one corner all
//! choose the same one, so each round merges one pair: 10,000 such boxes take 3 s, 50,000 over a minute, and the
//! tree is as deep as there are boxes. So every run of neighbours is tried by itself first, and boxes with such a
//! run in them are split top-down instead.

use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::ploc::PlocBuilder;
use rayon::prelude::*;
use std::time::Duration;

/// Boxes per trial. Among so few even the worst case takes milliseconds.
const TRIAL: usize = 512;

/// Rounds of clustering that no well-behaved trial comes near (usual are 20 to 40); `obvhs` reports no fewer.
const MOST_ROUNDS: usize = obvhs::bvh2::DEFAULT_MAX_STACK_DEPTH;

/// Places for a split along each axis.
const BINS: usize = 16;

/// Below this many splits by cost ranges are halved, which bounds the depth.
const MOST_COST_SPLITS: u32 = 48;

/// Builds a hierarchy with `obvhs`, or top-down if the boxes would lead it into quadratic time. The same boxes
/// always give the same hierarchy. `max_depth` of the result is enough for every traversal.
///
/// The flag tells whether it was built top-down.
pub(crate) fn build(boxes: &[Aabb], params: BvhBuildParams) -> (Bvh2, bool) {
    let is_trap = is_trap(boxes, &params);
    let mut bvh = if is_trap {
        top_down(boxes, params.max_prims_per_leaf as usize)
    } else {
        build_bvh2(boxes, params, &mut Duration::default())
    };
    // Reinsertion may have made the tree deeper than clustering left it.
    bvh.max_depth = bvh.max_depth.max(depth(&bvh) + 1);
    (bvh, is_trap)
}

/// Whether clustering makes a chain of some run of spatial neighbours.
fn is_trap(boxes: &[Aabb], params: &BvhBuildParams) -> bool {
    if boxes.len() <= TRIAL {
        return false;
    }
    let all = boxes.iter().fold(Aabb::empty(), |all, b| all.union(b));
    let scale = 2_097_151.0 / all.diagonal().max(Vec3A::splat(f32::MIN_POSITIVE)).as_dvec3();
    let mut order: Vec<(u64, u32)> = boxes
        .par_iter()
        .enumerate()
        .map(|(index, aabb)| {
            let cell = ((aabb.center() - all.min).as_dvec3() * scale).to_array().map(|c| spread(c as u64));
            (cell[0] | cell[1] << 1 | cell[2] << 2, index as u32)
        })
        .collect();
    order.par_sort_unstable();
    order.par_chunks(TRIAL).any(|run| {
        let run: Vec<Aabb> = run.iter().map(|&(_, index)| boxes[index as usize]).collect();
        let indices = (0..run.len() as u32).collect();
        let trial = PlocBuilder::with_capacity(run.len()).build(
            params.ploc_search_distance,
            &run,
            indices,
            params.sort_precision,
            params.search_depth_threshold,
        );
        trial.max_depth > MOST_ROUNDS
    })
}

/// Puts two zero bits between the 21 lowest bits: a third of a Morton code.
fn spread(x: u64) -> u64 {
    let mut x = x & 0x1F_FFFF;
    x = (x | x << 32) & 0x001F_0000_0000_FFFF;
    x = (x | x << 16) & 0x001F_0000_FF00_00FF;
    x = (x | x << 8) & 0x100F_00F0_0F00_F00F;
    x = (x | x << 4) & 0x10C3_0C30_C30C_30C3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

/// Surface area heuristic over bins (Wald: On Fast Construction of SAH-based Bounding Volume Hierarchies, 2007).
fn top_down(boxes: &[Aabb], leaf: usize) -> Bvh2 {
    let mut bvh = Bvh2 { primitive_indices: (0..boxes.len() as u32).collect(), ..Bvh2::default() };
    let order = &mut bvh.primitive_indices;
    bvh.nodes.push(Bvh2Node::new(Aabb::empty(), 0, 0));
    let mut stack = vec![(0usize, 0usize, boxes.len(), 0u32)];
    while let Some((node, start, end, depth)) = stack.pop() {
        let range = &mut order[start..end];
        let bounds = range.iter().fold(Aabb::empty(), |all, &i| all.union(&boxes[i as usize]));
        if range.len() <= leaf.max(1) {
            bvh.nodes[node] = Bvh2Node::new(bounds, range.len() as u32, start as u32);
            continue;
        }
        let middle = start + split(boxes, range, depth < MOST_COST_SPLITS);
        let first = bvh.nodes.len();
        bvh.nodes[node] = Bvh2Node::new(bounds, 0, first as u32);
        bvh.nodes.extend([Bvh2Node::new(Aabb::empty(), 0, 0); 2]);
        stack.extend([(first, start, middle, depth + 1), (first + 1, middle, end, depth + 1)]);
    }
    bvh.children_are_ordered_after_parents = true;
    bvh
}

/// Orders a range so that its first part is the left child's; returns the length of that part.
fn split(boxes: &[Aabb], range: &mut [u32], by_cost: bool) -> usize {
    let center = |index: u32| boxes[index as usize].center();
    let low = range.iter().fold(Vec3A::INFINITY, |low, &i| low.min(center(i)));
    let high = range.iter().fold(Vec3A::NEG_INFINITY, |high, &i| high.max(center(i)));
    let bins_per_length = BINS as f32 / (high - low);
    let bin = |index: u32, axis: usize| {
        (((center(index)[axis] - low[axis]) * bins_per_length[axis]) as usize).min(BINS - 1)
    };
    let mut best: Option<(f32, usize, usize)> = None;
    for axis in (0..3).filter(|&axis| by_cost && bins_per_length[axis].is_finite()) {
        let mut bins = [(Aabb::empty(), 0u32); BINS];
        for &index in range.iter() {
            let (bounds, count) = &mut bins[bin(index, axis)];
            *bounds = bounds.union(&boxes[index as usize]);
            *count += 1;
        }
        // Cost of what is right of each place, then of both sides.
        let mut right = [0.0f32; BINS];
        let mut all = (Aabb::empty(), 0u32);
        for place in (1..BINS).rev() {
            all = (all.0.union(&bins[place].0), all.1 + bins[place].1);
            right[place] = if all.1 == 0 { f32::INFINITY } else { all.0.half_area() * all.1 as f32 };
        }
        let mut all = (Aabb::empty(), 0u32);
        for place in 1..BINS {
            all = (all.0.union(&bins[place - 1].0), all.1 + bins[place - 1].1);
            let cost = all.0.half_area() * all.1 as f32 + right[place];
            if all.1 > 0 && cost < best.map_or(f32::INFINITY, |(cost, ..)| cost) {
                best = Some((cost, axis, place));
            }
        }
    }
    match best {
        Some((_, axis, place)) => {
            let mut left = 0;
            for i in 0..range.len() {
                if bin(range[i], axis) < place {
                    range.swap(left, i);
                    left += 1;
                }
            }
            left
        }
        None => {
            // The centres are all in one place: the smaller boxes to one side.
            let middle = range.len() / 2;
            let size = |i: u32| boxes[i as usize].half_area();
            range.select_nth_unstable_by(middle, |&a, &b| size(a).total_cmp(&size(b)).then(a.cmp(&b)));
            middle
        }
    }
}

fn depth(bvh: &Bvh2) -> usize {
    let mut deepest = 0;
    let mut stack: Vec<(u32, usize)> = bvh.nodes.first().map(|_| (0, 1)).into_iter().collect();
    while let Some((node, depth)) = stack.pop() {
        deepest = deepest.max(depth);
        let node = &bvh.nodes[node as usize];
        if !node.is_leaf() {
            stack.extend([(node.first_index, depth + 1), (node.first_index + 1, depth + 1)]);
        }
    }
    deepest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::sample::random::Random;
    use std::time::Instant;

    fn centred(x: f32, y: f32, z: f32, half: f32) -> Aabb {
        let center = Vec3A::new(x, y, z);
        Aabb::new(center - half, center + half)
    }

    fn last_place(x: f32, random: &mut Random) -> f32 {
        f32::from_bits(x.to_bits() + (random.next() % 2) as u32)
    }

    /// Every primitive is in one leaf, in the boxes of all nodes above it; the stack is deep enough.
    fn assert_is_valid(bvh: &Bvh2, boxes: &[Aabb], leaf: usize) {
        let mut seen = vec![0; boxes.len()];
        let mut stack = vec![(0usize, Aabb::INFINITY, 1)];
        while let Some((index, above, depth)) = stack.pop() {
            assert!(depth <= bvh.max_depth);
            let node = &bvh.nodes[index];
            assert!(above.min.cmple(node.aabb().min).all() && above.max.cmpge(node.aabb().max).all());
            let first = node.first_index as usize;
            if node.is_leaf() {
                assert!(node.prim_count as usize <= leaf);
                for &i in &bvh.primitive_indices[first..first + node.prim_count as usize] {
                    seen[i as usize] += 1;
                    let (outer, inner) = (node.aabb(), &boxes[i as usize]);
                    assert!(outer.min.cmple(inner.min).all() && outer.max.cmpge(inner.max).all());
                }
            } else {
                stack.extend([(first, *node.aabb(), depth + 1), (first + 1, *node.aabb(), depth + 1)]);
            }
        }
        assert!(seen.iter().all(|&count| count == 1));
    }

    #[test]
    fn no_boxes_take_quadratic_time() {
        const COUNT: usize = 50_000;
        let random = &mut Random::new(1, 1);
        let share = |i: usize| (i + 1) as f32 / COUNT as f32;
        let cases: [(&str, Vec<Aabb>); 8] = [
            ("equal", vec![centred(0.3, 0.3, 0.3, 0.1); COUNT]),
            ("of two sizes", (0..COUNT).map(|i| centred(0.3, 0.3, 0.3, 0.1 + (i % 2) as f32)).collect()),
            ("concentric", (0..COUNT).map(|i| centred(0.0, 0.0, 0.0, share(i))).collect()),
            ("from one corner", (0..COUNT).map(|i| Aabb::new(Vec3A::ZERO, Vec3A::splat(share(i)))).collect()),
            (
                "different in the last place of one corner",
                (0..COUNT)
                    .map(|_| Aabb::new(Vec3A::new(last_place(0.2, random), 0.2, 0.2), Vec3A::splat(0.4)))
                    .collect(),
            ),
            (
                "different in the last place of the centre",
                (0..COUNT)
                    .map(|_| {
                        let mut near = || last_place(0.3, random);
                        centred(near(), near(), near(), 0.1)
                    })
                    .collect(),
            ),
            ("in an exact row", (0..COUNT).map(|i| centred(i as f32 / 65536.0, 0.0, 0.0, 1e-6)).collect()),
            (
                "equal among many others",
                (0..COUNT)
                    .map(|i| match i % 2 {
                        0 => centred(0.3, 0.3, 0.3, 0.001),
                        _ => centred(random.unit() as f32, random.unit() as f32, 0.0, 0.01),
                    })
                    .collect(),
            ),
        ];
        for (name, boxes) in cases {
            for params in [BvhBuildParams::fast_build(), BvhBuildParams::medium_build()] {
                let start = Instant::now();
                let (bvh, top_down) = build(&boxes, params);
                let seconds = start.elapsed().as_secs_f64();
                println!("{COUNT} boxes {name}: {seconds:.2} s, top-down: {top_down}, depth {}", depth(&bvh));
                assert!(seconds < 5.0, "{name}: {seconds} s");
                assert!(depth(&bvh) < 2_000, "{name}: {}", depth(&bvh));
                assert_is_valid(&bvh, &boxes, params.max_prims_per_leaf as usize);
            }
        }
    }

    #[test]
    fn usual_boxes_are_left_to_clustering() {
        let random = &mut Random::new(2, 1);
        let boxes: Vec<Aabb> = (0..20_000)
            .map(|_| {
                let mut unit = || random.unit() as f32;
                centred(unit(), unit(), unit(), unit() * 0.02)
            })
            .collect();
        let (bvh, top_down) = build(&boxes, BvhBuildParams::fast_build());
        assert!(!top_down);
        assert_is_valid(&bvh, &boxes, 8);
    }
}
