//! Whole scenes: anchors, trees inside trees, hiding across them.

mod common;

use common::{Sample, camera, sample, view};
use glam::{DAffine3, DMat4, DQuat, DVec3, Vec3};
use proptest::prelude::*;
use std::sync::Arc;
use svs_runtime::{
    Bounds, BoundsError, Camera, Culler, DecodeError, Draw, Nested, Placement, SceneCuller, Settings, Tree,
    Visibility,
};

fn tree(sample: &Sample, placement: Placement, nested: &[Nested]) -> Tree {
    let nested = nested.to_vec();
    Tree::new(svs_runtime::TreeTables { placement, nested, ..sample.tables.clone() }).unwrap()
}

fn nested(object: u32, tree: u32, anchor: u32) -> Nested {
    Nested { object, tree, anchor }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    /// A tree moves, turns, is mirrored and grows with its anchor, and so do its answers.
    #[test]
    fn anchors_carry_their_answers_along(
        seed: u64, eye: u64, angle in 0.0..6.0_f64, scale in 0.01..100.0_f64, mirror: bool, far in 0.0..1e4_f64,
        quality in 0.0..1.0_f32,
    ) {
        let sample = sample(seed, false);
        let visibility =
            Visibility::new(vec![tree(&sample, Placement::Anchors(vec![4, 9]), &[])]).unwrap();
        let mut scene = SceneCuller::new(&visibility, &[&sample.bounds]).unwrap();
        let mut alone = Culler::new(&visibility.trees()[0], &sample.bounds).unwrap();
        let flip = if mirror { -scale } else { scale };
        let to_world = DAffine3::from_scale_rotation_translation(
            DVec3::new(scale, scale, flip),
            DQuat::from_axis_angle(DVec3::new(0.48, 0.6, 0.64), angle),
            DVec3::new(far, -far, 2.0 * far),
        );
        scene.set_anchor(0, 1, to_world);
        scene.set_shown(0, 0, false);
        let settings = Settings::from_quality(quality);
        let mut random = common::Random(eye);
        let (from, at) = (random.point(15.0), random.point(5.0));
        // The same camera in the world and in tree space; a mirrored view needs a mirrored view matrix.
        let local_view = view(from, at);
        let fov = 1.0_f64;
        let local = Camera::perspective(local_view, fov, 1280.0, 720.0, 0.05);
        let world_view = DMat4::from_scale(DVec3::splat(scale)) * local_view * DMat4::from(to_world.inverse());
        let world = Camera::perspective(world_view, fov, 1280.0, 720.0, 0.05 * scale);
        let expected = alone.cull(&local, &settings).to_vec();
        let found: Vec<u32> = scene.cull(&world, &settings).iter().map(|draw| draw.object).collect();
        prop_assert_eq!(found, expected);
        prop_assert!(scene.cull(&world, &settings).iter().all(|draw| draw.anchor == 1));
    }
}

#[test]
fn nested_trees_are_drawn_where_their_object_is_seen() {
    let (outer, inner) = (sample(11, false), sample(12, false));
    let last = outer.bounds.len() as u32 - 1;
    let entries = [nested(last, 1, 1), nested(0, 1, 0)];
    let visibility = Visibility::new(vec![
        tree(&outer, Placement::Scene(0), &entries),
        tree(&inner, Placement::Anchors(vec![5, 6, 7]), &[]),
    ])
    .unwrap();
    let mut scene = SceneCuller::new(&visibility, &[outer.bounds.clone(), inner.bounds.clone()]).unwrap();
    // Anchor 2 hangs on no object: it is always a candidate.
    scene.set_shown(1, 2, false);
    let mut outer_alone = Culler::new(&visibility.trees()[0], &outer.bounds).unwrap();
    let mut inner_alone = Culler::new(&visibility.trees()[1], &inner.bounds).unwrap();
    let (mut with, mut without) = (0, 0);
    for seed in 0..100 {
        let camera = camera(seed);
        let settings = Settings::default();
        let mut expected = Vec::new();
        let places = outer_alone.cull(&camera, &settings).to_vec();
        for object in places {
            match [(last, 1), (0, 0)].iter().find(|(place, _)| *place == object) {
                None => expected.push(Draw { tree: 0, anchor: 0, object }),
                Some(&(_, anchor)) => {
                    with += 1;
                    let below = inner_alone.cull(&camera, &settings);
                    expected.extend(below.iter().map(|&object| Draw { tree: 1, anchor, object }));
                }
            }
        }
        without += usize::from(!expected.iter().any(|draw| draw.tree == 1));
        expected.sort_unstable();
        let mut found = scene.cull(&camera, &settings).to_vec();
        assert_eq!(scene.statistics().drawn, found.len());
        found.sort_unstable();
        assert_eq!(found, expected);
    }
    assert!(with > 10 && without > 10, "both cases must occur: {with} {without}");
}

#[test]
fn hiding_inside_a_nested_tree_reaches_the_spheres_around_it() {
    let (outer, inner) = (sample(11, false), sample(12, false));
    // An object below some sphere.
    let host = (0..outer.bounds.len() as u32)
        .find(|&o| Tree::new(outer.tables.clone()).unwrap().depth(o as usize) >= 2)
        .unwrap();
    let visibility = Visibility::new(vec![
        tree(&outer, Placement::Scene(0), &[nested(host, 1, 0)]),
        tree(&inner, Placement::Anchors(vec![5]), &[]),
    ])
    .unwrap();
    let mut scene = SceneCuller::new(&visibility, &[&outer.bounds, &inner.bounds]).unwrap();
    let mut disturbed = Culler::new(&visibility.trees()[0], &outer.bounds).unwrap();
    disturbed.set_hidden(host, true);
    let settings = Settings { frustum: false, ..Settings::default() };
    let of_outer = |scene: &mut SceneCuller, camera: &Camera| -> Vec<u32> {
        scene.cull(camera, &settings).iter().filter(|d| d.tree == 0).map(|d| d.object).collect()
    };
    let hidden = Draw { tree: 1, anchor: 0, object: 0 };
    for seed in 0..50 {
        let camera = camera(seed);
        let before = scene.cull(&camera, &settings).to_vec();
        scene.set_hidden(hidden, true);
        scene.set_hidden(hidden, true);
        assert_eq!(of_outer(&mut scene, &camera), disturbed.cull(&camera, &settings));
        assert!(!scene.cull(&camera, &settings).contains(&hidden));
        scene.set_hidden(hidden, false);
        assert_eq!(scene.cull(&camera, &settings), before);
    }
    // Nothing happens to what does not exist.
    scene.set_hidden(Draw { tree: 9, anchor: 0, object: 0 }, true);
    scene.set_hidden(Draw { tree: 0, anchor: 1, object: 0 }, true);
    scene.set_anchor(1, 1, DAffine3::IDENTITY);
}

#[test]
fn a_tree_with_many_anchors_hosts_one_guest_at_each() {
    let (outer, inner) = (sample(11, false), sample(12, true));
    let visibility = Visibility::new(vec![
        tree(&outer, Placement::Anchors(vec![1, 2]), &[nested(0, 1, 0), nested(1, 1, 1)]),
        tree(&inner, Placement::Anchors(vec![3, 4, 5, 6]), &[]),
    ])
    .unwrap();
    let mut scene = SceneCuller::new(&visibility, &[&outer.bounds, &inner.bounds]).unwrap();
    scene.set_shown(0, 1, false);
    let settings = Settings { frustum: false, max_half_angle: 0.0, ..Settings::NEAREST_O };
    let draws = scene.cull(&camera(1), &settings);
    let anchors: std::collections::BTreeSet<u32> =
        draws.iter().filter(|d| d.tree == 1).map(|d| d.anchor).collect();
    assert_eq!(anchors.into_iter().collect::<Vec<_>>(), [0, 1]);
}

#[test]
fn impossible_nesting_is_refused() {
    let (a, b) = (sample(11, false), sample(12, false));
    let anchored = || Placement::Anchors(vec![1]);
    let refused = |trees: Vec<Tree>| match Visibility::new(trees) {
        Err(DecodeError::Tree { source, .. }) => source.to_string(),
        other => panic!("{other:?}"),
    };
    let cycle = vec![tree(&a, anchored(), &[nested(0, 1, 0)]), tree(&b, anchored(), &[nested(0, 0, 0)])];
    assert!(refused(cycle).contains("contain each other"));
    let own = vec![tree(&a, anchored(), &[nested(0, 0, 0)])];
    assert!(refused(own).contains("contain each other"));
    let twice =
        vec![tree(&a, Placement::Scene(0), &[nested(0, 1, 0), nested(1, 1, 0)]), tree(&b, anchored(), &[])];
    assert!(refused(twice).contains("another object"));
    let missing = vec![tree(&a, Placement::Scene(0), &[nested(0, 2, 0)])];
    assert!(refused(missing).contains("no such tree"));
    let no_anchor = vec![tree(&a, Placement::Scene(0), &[nested(0, 1, 1)]), tree(&b, anchored(), &[])];
    assert!(refused(no_anchor).contains("no such anchor"));
    let scene = vec![tree(&a, Placement::Scene(0), &[nested(0, 1, 0)]), tree(&b, Placement::Scene(1), &[])];
    assert!(refused(scene).contains("no anchors"));
}

#[test]
fn boxes_are_checked() {
    let sample = sample(1, false);
    let tree = Arc::new(Tree::new(sample.tables).unwrap());
    let fewer = &sample.bounds[1..];
    assert!(matches!(Culler::new(&tree, fewer), Err(BoundsError::Count { .. })));
    for bad in [
        Bounds { min: Vec3::ONE, max: Vec3::ZERO },
        Bounds { min: Vec3::NAN, max: Vec3::ONE },
        Bounds { min: Vec3::NEG_INFINITY, max: Vec3::ONE },
    ] {
        let mut bounds = sample.bounds.clone();
        bounds[2] = bad;
        assert_eq!(Culler::new(&tree, &bounds).unwrap_err(), BoundsError::Box { tree: 0, object: 2 });
    }
}
