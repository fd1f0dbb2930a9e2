use super::*;
use glam::DVec3;
use proptest::prelude::*;
use std::ops::Range;

const KINDS: [HierarchyKind; 3] = [HierarchyKind::Scene, HierarchyKind::Octree, HierarchyKind::Bvh];

fn member(center: DVec3, half: DVec3) -> Member {
    Member { bounds: Aabb { min: center - half, max: center + half }, triangles: 12, parts: 0..0 }
}

fn empty_member() -> Member {
    Member { bounds: Aabb::EMPTY, triangles: 0, parts: 0..0 }
}

/// Numbers in [0, 1), the same every time (splitmix64).
fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (state ^ state >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ z >> 31) >> 11) as f64 / (1u64 << 53) as f64
    }
}

fn random_members(count: usize, seed: u64) -> Vec<Member> {
    let mut random = random(seed);
    let mut point = move || DVec3::new(random(), random(), random());
    (0..count).map(|_| member(point() * 100.0, DVec3::splat(point().x.powi(4) * 5.0) + point())).collect()
}

/// A regular grid of unit boxes that touch, as tiled instances are.
fn grid(side: usize) -> Vec<Member> {
    let boxes = (0..side * side * side).map(|i| [i % side, i / side % side, i / side / side]);
    boxes.map(|cell| member(DVec3::from(cell.map(|i| i as f64)), DVec3::splat(0.5))).collect()
}

fn transformed(members: &[Member], scale: f64, offset: DVec3) -> Vec<Member> {
    let mut members = members.to_vec();
    for member in &mut members {
        member.bounds.min = member.bounds.min * scale + offset;
        member.bounds.max = member.bounds.max * scale + offset;
    }
    members
}

/// Panics where the hierarchy breaks a rule that others rely on.
fn check(hierarchy: &Hierarchy, count: usize) {
    let mut order = hierarchy.order.clone();
    order.sort_unstable();
    assert!(order.iter().copied().eq(0..count as u32), "order is a permutation");
    let nodes = &hierarchy.nodes;
    assert_eq!(nodes.iter().filter(|node| node.parent.is_none()).count(), usize::from(count > 0), "one root");
    let mut depths = vec![0; nodes.len()];
    for (index, node) in nodes.iter().enumerate() {
        let end = index + node.subtree as usize;
        assert!(node.subtree >= 1 && end <= nodes.len());
        match node.parent {
            None => assert_eq!((index, end, node.members.clone()), (0, nodes.len(), 0..count as u32)),
            Some(parent) => {
                depths[index] = depths[parent as usize] + 1;
                assert!(node.members.len() >= 2, "nodes have at least two members");
            }
        }
        // Direct members first, then the children one after the other to the end.
        let mut children = 0;
        let mut place = nodes.get(index + 1).filter(|_| node.subtree > 1).map(|child| child.members.start);
        let direct = place.unwrap_or(node.members.end) - node.members.start;
        let mut child = index + 1;
        while child < end {
            assert_eq!(nodes[child].parent, Some(index as u32));
            assert_eq!(Some(nodes[child].members.start), place);
            place = Some(nodes[child].members.end);
            child += nodes[child].subtree as usize;
            children += 1;
        }
        assert_eq!(child, end);
        assert_eq!(place.unwrap_or(node.members.end), node.members.end);
        assert!(direct + children >= 2 || count == 1, "no chains");
        assert!(depths[index] < MAX_DEPTH);
    }
}

/// Groups from numbers: each opens a group below the current one, or closes some, and takes a few members.
fn random_groups(steps: &[(u8, u8)], members: u32) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    let mut open: Vec<usize> = Vec::new();
    let mut place = 0;
    for &(close, take) in steps {
        for _ in 0..close.min(open.len() as u8) {
            if let Some(group) = open.pop() {
                groups[group].members.end = place;
            }
        }
        groups.push(Group { parent: open.last().map(|&group| group as u32), members: place..place });
        open.push(groups.len() - 1);
        place = (place + u32::from(take)).min(members);
    }
    for group in open {
        groups[group].members.end = place;
    }
    groups
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn hierarchies_keep_the_rules(
        boxes in prop::collection::vec((prop::array::uniform3(-4i32..4), -12..4i32, 0u8..12), 0..300),
        steps in prop::collection::vec((0u8..4, 0u8..9), 0..60),
        exponent in -60..60i32,
    ) {
        let unit = 10f64.powi(exponent / 2);
        let members: Vec<Member> = boxes
            .iter()
            .map(|&(center, size, special)| match special {
                0 => empty_member(),
                1 => member(DVec3::splat(f64::NAN), DVec3::ONE),
                2 => member(DVec3::splat(1e300), DVec3::splat(1e300)),
                // A cluster very far away compared with its size.
                3 => member(DVec3::splat(1e9) + DVec3::from(center.map(f64::from)) * unit, DVec3::splat(unit)),
                _ => member(DVec3::from(center.map(f64::from)) * unit, DVec3::splat(unit * 2f64.powi(size))),
            })
            .collect();
        let groups = random_groups(&steps, members.len() as u32);
        for kind in KINDS {
            check(&build(kind, &members, &groups), members.len());
        }
    }

    #[test]
    fn the_unit_and_the_place_of_a_scene_do_not_matter(seed in 0u64..1000, count in 2usize..400) {
        let members = random_members(count, seed);
        for kind in KINDS {
            let expected = build(kind, &members, &[]);
            for scale in [1e-6, 1e6] {
                prop_assert_eq!(&build(kind, &transformed(&members, scale, DVec3::ZERO), &[]), &expected);
            }
            let far = DVec3::new(1e7, -1e7, 1e7);
            prop_assert_eq!(&build(kind, &transformed(&members, 1.0, far), &[]), &expected);
        }
    }
}

#[test]
fn a_grid_is_split_alike_at_every_scale_and_place() {
    // Every size and centre is on a limit of the octree, every split ties in the bounding volume hierarchy.
    let members = grid(16);
    for kind in KINDS {
        let expected = build(kind, &members, &[]);
        check(&expected, members.len());
        for (scale, offset) in [(1e-6, 0.0), (1e6, 0.0), (1.0, 1e7), (0.3, 0.1)] {
            let moved = transformed(&members, scale, DVec3::new(offset, 0.0, -offset));
            assert_eq!(build(kind, &moved, &[]), expected, "{kind:?} {scale} {offset}");
        }
    }
    let octree = build(HierarchyKind::Octree, &members, &[]);
    assert_eq!(octree.nodes.len(), 1 + 8 + 64 + 512, "the octree of a 16 x 16 x 16 grid");
}

#[test]
fn equal_boxes_end() {
    let members = vec![member(DVec3::new(3.0, 4.0, 5.0), DVec3::ONE); 20_000];
    for (kind, depth) in [(HierarchyKind::Scene, 1), (HierarchyKind::Octree, 1), (HierarchyKind::Bvh, 5)] {
        let hierarchy = build(kind, &members, &[]);
        check(&hierarchy, members.len());
        assert!(hierarchy.depths_of_members().into_iter().max() <= Some(depth));
    }
    // Points, too.
    let members = vec![member(DVec3::ONE, DVec3::ZERO); 1000];
    for kind in KINDS {
        check(&build(kind, &members, &[]), members.len());
    }
}

#[test]
fn geometric_sizes_end() {
    // Each box half (or nine tenths) of the one before, all at one corner: the worst case for both.
    for ratio in [0.5f64, 0.9, 0.99] {
        let sizes = (0..3000).map(|i| ratio.powi(i)).take_while(|&size| size > 1e-200);
        let members: Vec<Member> = sizes.map(|size| member(DVec3::splat(size), DVec3::splat(size))).collect();
        for kind in KINDS {
            check(&build(kind, &members, &[]), members.len());
        }
    }
}

#[test]
fn a_far_outlier_does_not_hide_a_cluster() {
    let mut members = random_members(1000, 5);
    members.push(member(DVec3::splat(1e9), DVec3::ONE));
    for kind in [HierarchyKind::Octree, HierarchyKind::Bvh] {
        let hierarchy = build(kind, &members, &[]);
        check(&hierarchy, members.len());
        let largest = hierarchy.nodes.iter().enumerate().map(|(index, node)| {
            let first_child = hierarchy.nodes.get(index + 1).filter(|_| node.subtree > 1);
            first_child.map_or(node.members.end, |child| child.members.start) - node.members.start
        });
        assert!(largest.max() <= Some(100), "{kind:?}: no node holds most of the cluster directly");
    }
}

#[test]
fn members_without_a_box_hang_on_the_root() {
    let mut members = grid(4);
    members.insert(7, empty_member());
    members.push(empty_member());
    for kind in KINDS {
        let hierarchy = build(kind, &members, &[]);
        check(&hierarchy, members.len());
        let parents = hierarchy.parents_of_members();
        for (place, &member) in hierarchy.order.iter().enumerate() {
            if [7, 65].contains(&member) {
                assert_eq!(parents[place], Some(0));
            }
        }
    }
}

#[test]
fn nothing_and_one_member() {
    for kind in KINDS {
        assert_eq!(build(kind, &[], &[]), Hierarchy::default());
        for only in [empty_member(), member(DVec3::ONE, DVec3::ONE)] {
            let hierarchy = build(kind, &[only], &[]);
            check(&hierarchy, 1);
            assert_eq!(hierarchy.nodes.len(), 1);
        }
    }
}

#[test]
fn groups_are_kept() {
    // 0: [a b], 1: [c d e] in 2: [c .. f], 3: [g] alone, all in one group that says nothing.
    let group = |parent, members| Group { parent, members };
    let groups = [
        group(None, 0..7),
        group(Some(0), 0..7),
        group(Some(1), 0..2),
        group(Some(1), 2..6),
        group(Some(3), 2..5),
        group(Some(1), 6..7),
    ];
    let members = random_members(7, 1);
    let hierarchy = build(HierarchyKind::Scene, &members, &groups);
    check(&hierarchy, 7);
    assert_eq!(hierarchy.order, [6, 0, 1, 5, 2, 3, 4], "those that hang on a node itself come first");
    let nodes: Vec<_> = hierarchy.nodes.iter().map(|node| (node.parent, node.members.clone())).collect();
    assert_eq!(nodes, [(None, 0..7), (Some(0), 1..3), (Some(0), 3..7), (Some(2), 4..7)]);
}

#[test]
fn flat_groups_are_subdivided() {
    let members = grid(8);
    let all = Group { parent: None, members: 0..512 };
    // 64 groups of eight, and 512 members in one group.
    let rows = (0..64).map(|row| Group { parent: Some(0), members: row * 8..row * 8 + 8 });
    let grouped: Vec<Group> = std::iter::once(all.clone()).chain(rows).collect();
    let hierarchy = build(HierarchyKind::Scene, &members, &grouped);
    check(&hierarchy, 512);
    assert_eq!(hierarchy.nodes.len(), 65, "64 children are not too many");
    let flat = build(HierarchyKind::Scene, &members, &[all]);
    assert_eq!(flat, build(HierarchyKind::Octree, &members, &[]));
}

#[test]
fn nesting_ends_at_the_deepest_storable_level() {
    let count = 10_000u32;
    let members: Vec<Member> =
        (0..count).map(|i| member(DVec3::X * f64::from(i), DVec3::splat(0.5))).collect();
    let groups: Vec<Group> =
        (0..count).map(|i| Group { parent: i.checked_sub(1), members: i..count }).collect();
    let hierarchy = build(HierarchyKind::Scene, &members, &groups);
    check(&hierarchy, members.len());
    assert_eq!(hierarchy.nodes.len(), MAX_DEPTH as usize);
    assert_eq!(hierarchy.depths_of_members().into_iter().max(), Some(MAX_DEPTH));
}

#[test]
fn broken_groups_are_survived() {
    let members = random_members(20, 3);
    let groups = [
        Group { parent: Some(5), members: 0..1000 },
        Group { parent: Some(1), members: Range { start: 5, end: 2 } },
        Group { parent: Some(99), members: 3..9 },
    ];
    check(&build(HierarchyKind::Scene, &members, &groups), 20);
}
