//! Budgets, loose objects and explanations on random scenes.

mod common;

use common::{Random, camera, camera_at, sample};
use glam::DVec3;
use proptest::prelude::*;
use std::collections::HashSet;
use svs_runtime::{
    Bounds, BoundsError, Budget, Camera, CostModel, Draw, LOOSE, Nested, Placement, Query, Reason,
    SceneCuller, Settings, Tau, Tree, Visibility,
};

/// Two trees, one of them twice inside the other, and loose objects; every third triangle count is extreme.
fn scene(seed: u64) -> SceneCuller {
    let (outer, inner, others) =
        (sample(seed, false), sample(seed ^ 1, seed.is_multiple_of(3)), sample(seed ^ 2, true));
    let mut random = Random(seed);
    let mut tables = [outer.tables, inner.tables];
    let last = tables[0].object_count - 1;
    tables[0].nested = vec![Nested { object: last, tree: 1, anchor: 1 }];
    if last > 0 {
        tables[0].nested.push(Nested { object: 0, tree: 1, anchor: 0 });
    }
    tables[1].placement = Placement::Anchors(vec![3, 4]);
    let bounds = [outer.bounds, inner.bounds];
    let visibility = Visibility::new(tables.map(|t| Tree::new(t).unwrap()).into()).unwrap();
    let mut culler = SceneCuller::new(&visibility, &bounds).unwrap();
    let mut counts = |n: usize| -> Vec<u32> {
        (0..n).map(|_| [0, 1, 12, 500, 20_000, u32::MAX][random.below(6)]).collect()
    };
    for (tree, bounds) in bounds.iter().enumerate() {
        culler.set_triangles(tree as u32, &counts(bounds.len())).unwrap();
    }
    culler.set_loose(&others.bounds, &counts(others.bounds.len())).unwrap();
    culler
}

fn settings() -> impl Strategy<Value = Settings> {
    let query = prop_oneof![
        3 => Just(Query::Object),
        1 => Just(Query::SphereNearest),
        1 => Just(Query::SphereMax3),
        1 => Just(Query::SphereWeighted3),
        1 => Just(Query::SphereMaxAll),
    ];
    (query, 0.0_f32..=1.0, any::<bool>()).prop_map(|(query, quality, frustum)| Settings {
        query,
        frustum,
        ..Settings::from_quality(quality)
    })
}

fn is_subsequence(few: &[Draw], many: &[Draw]) -> bool {
    let mut many = many.iter();
    few.iter().all(|draw| many.any(|other| other == draw))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn never_above_the_budget(
        seed: u64, eye: u64, settings in settings(),
        triangles in prop_oneof![Just(0), Just(u64::MAX), 0..100_000_u64, any::<u64>()],
        ms in prop_oneof![Just(f64::NAN), Just(-1.0), Just(f64::INFINITY), 0.0..1000.0_f64],
        frames in prop::collection::vec((any::<u64>(), any::<u64>(), any::<f64>()), 0..20),
    ) {
        let mut culler = scene(seed);
        let mut model = CostModel::new();
        frames.iter().for_each(|&(triangles, draws, ms)| model.record(triangles, draws, ms));
        // Near ones, so that hysteresis has something to hold on to, and the last far away.
        for frame in [0, 0, 1] {
            let camera = camera(eye ^ frame);
            let all = culler.cull(&camera, &settings).to_vec();
            for budget in [
                Budget::Triangles(triangles),
                Budget::StopAtFirstMisfit(triangles),
                Budget::Milliseconds(ms, &model),
                Budget::Unlimited,
            ] {
                let draws = culler.cull_within(&camera, &settings, &budget).to_vec();
                let selection = culler.selection();
                prop_assert!(is_subsequence(&draws, &all));
                prop_assert_eq!((selection.candidates, selection.chosen), (all.len(), draws.len()));
                prop_assert!(selection.dropped_pixels >= 0.0 && selection.dropped_pixels.is_finite());
                match budget {
                    Budget::Triangles(most) | Budget::StopAtFirstMisfit(most) => {
                        prop_assert!(selection.chosen_triangles <= most);
                        if selection.candidate_triangles <= most {
                            prop_assert_eq!(draws, all.clone());
                        }
                    }
                    Budget::Milliseconds(most, model) => {
                        let cost = model.predict(selection.chosen_triangles, selection.chosen as u64);
                        prop_assert!(cost <= most || draws.is_empty(), "{} {}", cost, most);
                    }
                    _ => prop_assert_eq!(draws, all.clone()),
                }
            }
        }
    }

    #[test]
    fn explanations_agree_with_culling(seed: u64, eye: u64, at: Option<u16>, settings in settings(), hide: [u16; 2]) {
        let mut culler = scene(seed);
        let boxes = sample(seed, false).bounds;
        let camera = at.map_or_else(|| camera(eye), |o| camera_at(&boxes[usize::from(o) % boxes.len()], eye));
        culler.set_hidden(Draw { tree: 0, anchor: 0, object: u32::from(hide[0]) % boxes.len() as u32 }, true);
        culler.set_hidden(Draw { tree: LOOSE, anchor: 0, object: u32::from(hide[1]) % 20 }, true);
        let drawn = culler.cull(&camera, &settings).to_vec();
        for (tree, anchors) in [(0, 1), (1, 2), (LOOSE, 1)] {
            for anchor in 0..anchors {
                for object in 0..200 {
                    let draw = Draw { tree, anchor, object };
                    let reason = culler.explain(draw, &camera, &settings);
                    let host = tree == 0 && (object == 0 || object == boxes.len() as u32 - 1);
                    prop_assert!(host || reason.is_drawn() == drawn.contains(&draw), "{:?} {:?}", draw, reason);
                    if let Reason::NotVisible { height, level, .. } = reason {
                        prop_assert!(level < height);
                    }
                    if let Reason::Sphere { pixels, .. } = reason {
                        prop_assert!(pixels <= camera.image_area());
                    }
                }
            }
        }
        let mut spheres = Vec::new();
        culler.spheres_in_use(&camera, &settings, &mut spheres);
        prop_assert_eq!(spheres.len(), culler.statistics().spheres_used);
    }

    #[test]
    fn loose_objects_are_frustum_culled(seed: u64, eye: u64, frustum: bool, count in 0..200_usize) {
        let mut random = Random(seed);
        let boxes: Vec<Bounds> = (0..count).map(|_| {
            let middle = random.point(20.0).as_vec3();
            let half = random.point(1.0).as_vec3().abs();
            Bounds { min: middle - half, max: middle + half }
        }).collect();
        let mut culler = SceneCuller::empty();
        culler.set_loose(&boxes, &vec![1; count]).unwrap();
        let camera = camera(eye);
        let settings = Settings { frustum, ..Settings::default() };
        let mut found: Vec<usize> =
            culler.cull(&camera, &settings).iter().map(|draw| draw.object as usize).collect();
        let order: Vec<usize> = culler.loose_order().iter().map(|&o| o as usize).collect();
        let expected = |k: &usize| !frustum || camera.sees(&boxes[*k]);
        prop_assert_eq!(&found, &order.into_iter().filter(expected).collect::<Vec<_>>());
        found.sort_unstable();
        prop_assert_eq!(found, (0..count).filter(expected).collect::<Vec<_>>());
    }
}

#[test]
fn wrong_counts_are_refused() {
    let mut culler = scene(1);
    assert_eq!(culler.set_triangles(2, &[]), Err(BoundsError::NoTree { tree: 2 }));
    assert!(matches!(culler.set_triangles(0, &[]), Err(BoundsError::Triangles { tree: 0, found: 0, .. })));
    let unit = Bounds { min: glam::Vec3::ZERO, max: glam::Vec3::ONE };
    let nan = Bounds { min: glam::Vec3::NAN, ..unit };
    assert_eq!(culler.set_loose(&[unit], &[]), Err(BoundsError::LooseCount { boxes: 1, triangles: 0 }));
    assert_eq!(culler.set_loose(&[unit, nan], &[1, 1]), Err(BoundsError::LooseBox { object: 1 }));
    for unknown in [(0, 1, 0), (5, 0, 0), (0, 0, 9999), (LOOSE, 0, 9999), (LOOSE, 1, 0)] {
        let draw = Draw { tree: unknown.0, anchor: unknown.1, object: unknown.2 };
        assert_eq!(culler.explain(draw, &camera(1), &Settings::default()), Reason::Unknown);
    }
}

/// What is dropped for its size is counted, and grows with the least size.
#[test]
fn small_things_that_are_dropped_are_counted() {
    let mut culler = scene(5);
    let mut some = false;
    for seed in 0..50 {
        let camera: Camera = camera(seed);
        let mut before = 0.0;
        for nearest in [0.0, 1.0, 4.0, 16.0, 64.0, 256.0, f32::INFINITY] {
            let tau = Tau { nearest, ..Settings::NEAREST_O.tau };
            culler.cull_within(&camera, &Settings { tau, ..Settings::NEAREST_O }, &Budget::Unlimited);
            let dropped = culler.selection().dropped_pixels;
            assert!(dropped >= before && (nearest > 0.0 || dropped == 0.0));
            before = dropped;
        }
        some |= before > 0.0;
    }
    assert!(some);
}

/// Boxes of many sizes in a ball, with triangle counts of many sizes.
fn cloud(count: usize) -> SceneCuller {
    let mut random = Random(99);
    let (mut boxes, mut triangles) = (Vec::new(), Vec::new());
    for _ in 0..count {
        let middle = random.point(10.0).as_vec3();
        let half = glam::Vec3::splat((0.02 * 50_f64.powf(random.unit())) as f32);
        boxes.push(Bounds { min: middle - half, max: middle + half });
        triangles.push((2.0 * 1e4_f64.powf(random.unit())) as u32);
    }
    let mut culler = SceneCuller::empty();
    culler.set_loose(&boxes, &triangles).unwrap();
    culler
}

fn looking(eye: DVec3, at: DVec3) -> Camera {
    Camera::perspective(common::view(eye, at), 60_f64.to_radians(), 1280.0, 720.0, 0.05)
}

/// How often objects that stay in the frustum come or go from frame to frame, and the pixels dropped, in sum.
fn toggles(culler: &mut SceneCuller, path: impl Fn(usize) -> Camera, budget: u64) -> (usize, f64) {
    let (mut count, mut dropped) = (0, 0.0);
    let mut before: Option<(HashSet<Draw>, HashSet<Draw>)> = None;
    for frame in 0..300 {
        let camera = path(frame);
        let chosen: HashSet<Draw> = culler
            .cull_within(&camera, &Settings::default(), &Budget::Triangles(budget))
            .iter()
            .copied()
            .collect();
        dropped += culler.selection().dropped_pixels;
        let loose = culler.loose_order().iter().map(|&object| Draw { tree: LOOSE, anchor: 0, object });
        // Asked without disturbing what was chosen.
        let in_frustum: HashSet<Draw> =
            loose.filter(|d| culler.explain(*d, &camera, &Settings::default()).is_drawn()).collect();
        if let Some((chosen_before, in_frustum_before)) = &before {
            let both = in_frustum.intersection(in_frustum_before);
            count += both.filter(|d| chosen.contains(*d) != chosen_before.contains(*d)).count();
        }
        before = Some((chosen, in_frustum));
    }
    (count, dropped)
}

/// The figures of the documentation: a slow flight and a trembling hand, with and without hysteresis.
#[test]
fn hysteresis_keeps_objects_from_flickering() {
    let mut culler = cloud(2000);
    let flight = |frame: usize| {
        let angle = frame as f64 * 0.002;
        looking(DVec3::new(angle.cos(), 0.3, angle.sin()) * 14.0, DVec3::ZERO)
    };
    let hand = |frame: usize| {
        let jitter = Random(frame as u64).point(0.05);
        looking(DVec3::new(14.0, 4.0, 0.0) + jitter, DVec3::ZERO)
    };
    for (name, path) in [("flight", &flight as &dyn Fn(usize) -> Camera), ("hand", &hand)] {
        let mut measure = |factor: f64| {
            culler.set_hysteresis(factor);
            culler.cull(&path(0), &Settings::default());
            toggles(&mut culler, path, 200_000)
        };
        let ((without, least_dropped), (with, dropped)) = (measure(1.0), measure(1.25));
        println!(
            "{name}: {without} toggles without hysteresis, {with} with; dropped pixels {:.4} times as many",
            dropped / least_dropped
        );
        assert!(without > 50 && with * 3 <= without, "{name}: {without} {with}");
        assert!(dropped <= least_dropped * 1.05);
    }
}

/// A budget in milliseconds, on a machine that is four times as slow as the model's prior.
#[test]
fn milliseconds_are_kept_on_average() {
    let mut culler = cloud(2000);
    let (mut model, mut random) = (CostModel::new(), Random(4));
    let budget = 15.0;
    let (mut sum, mut count) = (0.0, 0);
    for frame in 0..200 {
        let angle = frame as f64 * 0.03;
        let camera = looking(DVec3::new(angle.cos(), 0.3, angle.sin()) * 13.0, DVec3::ZERO);
        culler.cull_within(&camera, &Settings::default(), &Budget::Milliseconds(budget, &model));
        let selection = culler.selection();
        let (triangles, draws) = (selection.chosen_triangles, selection.chosen as u64);
        assert!(
            model.predict(triangles, draws) <= budget && draws > 0 && selection.chosen < selection.candidates
        );
        let noise = 0.9 + 0.2 * random.unit();
        let ms = (3.0 + 40.0 * triangles as f64 * 1e-6 + 5.0 * draws as f64 * 1e-3) * noise;
        model.record(triangles, draws, ms);
        if frame >= 20 {
            (sum, count) = (sum + ms, count + 1);
        }
    }
    let mean = sum / f64::from(count);
    println!("mean {mean:.3} ms of {budget}, error {:.4}", model.error());
    assert!((mean - budget).abs() < 0.05 * budget, "{mean}");
}
