//! Selecting originals, levels and proxies over random scenes.

mod common;
mod hlod;

use common::{Random, camera, camera_at};
use glam::DVec3;
use hlod::{Hlod, covered};
use proptest::prelude::*;
use std::collections::HashSet;
use svs_runtime::{Budget, Camera, CostModel, Detail, Draw, Metric, SelectedKind, Settings};

fn metric(index: usize) -> Metric {
    [Metric::Sse, Metric::Linear, Metric::default()][index % 3]
}

/// Cameras around the scene and, seldom, in one of its objects.
fn eye(hlod: &Hlod, seed: u64) -> svs_runtime::Camera {
    if seed.is_multiple_of(5) {
        camera_at(&hlod.bounds[0][seed as usize % hlod.bounds[0].len()], seed)
    } else {
        camera(seed)
    }
}

fn settings(index: usize) -> Settings {
    [
        Settings::FRUSTUM,
        Settings::NEAREST_O,
        Settings::default(),
        Settings { frustum: false, ..Settings::RING_O },
    ][index % 4]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// Without a budget, everything visible is drawn once: as itself, a level, or an ancestor's proxy.
    #[test]
    fn nothing_falls_between_and_nothing_is_drawn_twice(
        seed in 0_u64..500, view in any::<u64>(), query in 0_usize..4, index in 0_usize..3, tau in 0.0..200.0_f32,
    ) {
        let mut hlod = Hlod::new(seed);
        let (camera, settings) = (eye(&hlod, view), settings(query));
        let visible: HashSet<Draw> = hlod.culler.cull(&camera, &settings).iter().copied().collect();
        let detail = Detail { tau, metric: metric(index) };
        let selected = hlod.culler.select(&camera, &settings, &detail, &Budget::Unlimited).to_vec();
        let covered = covered(&hlod, &selected).map_err(TestCaseError::fail)?;
        for draw in &visible {
            prop_assert!(covered.contains(draw), "{draw:?} falls between");
        }
        // Originals and levels are of visible objects only, and so is something of every proxy.
        for s in &selected {
            if s.kind == SelectedKind::Proxy {
                let below = hlod.below(s.draw);
                prop_assert!(below.iter().any(|draw| visible.contains(draw)));
            } else {
                prop_assert!(visible.contains(&s.draw));
            }
            prop_assert!((0.0..=1.0).contains(&s.ratio));
        }
        // A proxy replaces more triangles than it has.
        let statistics = hlod.culler.detail_statistics();
        prop_assert!(statistics.triangles <= statistics.candidate_triangles);
        prop_assert_eq!(statistics.triangles, hlod.triangles(&selected));
        if tau == 0.0 {
            prop_assert_eq!(covered, visible);
        }
    }

    #[test]
    fn without_an_error_the_visible_set_is_drawn(
        seed in 0_u64..500, view in any::<u64>(), query in 0_usize..4, index in 0_usize..3,
    ) {
        let mut hlod = Hlod::new(seed);
        let (camera, settings) = (eye(&hlod, view), settings(query));
        let visible: HashSet<Draw> = hlod.culler.cull(&camera, &settings).iter().copied().collect();
        for tau in [0.0, -1.0, f32::NAN] {
            let detail = Detail { tau, metric: metric(index) };
            let selected = hlod.culler.select(&camera, &settings, &detail, &Budget::Unlimited);
            prop_assert_eq!(selected.len(), visible.len());
            prop_assert!(selected.iter().all(|s| s.kind == SelectedKind::Object && visible.contains(&s.draw)));
        }
    }

    /// A budget is never exceeded, in triangles and in milliseconds; what is left out does not fit; nothing is drawn twice.
    #[test]
    fn budgets_are_kept(
        seed in 0_u64..500, view in any::<u64>(), query in 0_usize..4, index in 0_usize..3,
        tau in prop_oneof![Just(0.0_f32), 0.0..50.0_f32], share in 0.0..1.2_f64, milliseconds in any::<bool>(),
    ) {
        let mut hlod = Hlod::new(seed);
        let (camera, settings) = (eye(&hlod, view), settings(query));
        let visible: HashSet<Draw> = hlod.culler.cull(&camera, &settings).iter().copied().collect();
        let all = hlod.culler.selection();
        let model = CostModel::new();
        let most = (all.chosen_triangles as f64 * share) as u64;
        let most_ms = model.predict(all.chosen_triangles, all.chosen as u64) * share;
        let budget =
            if milliseconds { Budget::Milliseconds(most_ms, &model) } else { Budget::Triangles(most) };
        let fits = |triangles, draws| {
            if milliseconds { model.predict(triangles, draws) <= most_ms } else { triangles <= most }
        };
        let detail = Detail { tau, metric: metric(index) };
        hlod.culler.set_hysteresis(1.0);
        let selected = hlod.culler.select(&camera, &settings, &detail, &budget).to_vec();
        let covered = covered(&hlod, &selected).map_err(TestCaseError::fail)?;
        let (triangles, draws) = (hlod.triangles(&selected), selected.len() as u64);
        prop_assert!(draws == 0 || fits(triangles, draws), "{triangles} of {most}");
        for draw in visible.difference(&covered) {
            prop_assert!(!fits(triangles + u64::from(hlod.least_triangles(*draw, &camera)), draws + 1), "{draw:?}");
        }
        let selection = hlod.culler.selection();
        prop_assert_eq!(selection.chosen_triangles, triangles);
        prop_assert!(selection.dropped_pixels > 0.0 || visible.is_subset(&covered) || tau > 0.0);
        // The same again: what was drawn in the last frame stays.
        hlod.culler.set_hysteresis(1.25);
        hlod.culler.select(&camera, &settings, &detail, &budget);
        let again = hlod.culler.select(&camera, &settings, &detail, &budget).to_vec();
        prop_assert!(hlod.culler.select(&camera, &settings, &detail, &budget) == &again[..]);
    }

    /// A budget that the cut without one keeps changes nothing.
    #[test]
    fn a_large_budget_is_none(
        seed in 0_u64..500, view in any::<u64>(), query in 0_usize..4, index in 0_usize..3, tau in 0.0..50.0_f32,
    ) {
        let mut hlod = Hlod::new(seed);
        let (camera, settings) = (eye(&hlod, view), settings(query));
        let detail = Detail { tau, metric: metric(index) };
        let unlimited = hlod.culler.select(&camera, &settings, &detail, &Budget::Unlimited).to_vec();
        let most = hlod.culler.detail_statistics().triangles;
        prop_assert!(hlod.culler.select(&camera, &settings, &detail, &Budget::Triangles(most)) == &unlimited[..]);
    }

    /// Where everything is visible and proxies are not larger than what they stand for, a larger error draws no more.
    #[test]
    fn more_error_never_draws_more(
        seed in 0_u64..500, view in any::<u64>(), index in 0_usize..3, taus in prop::array::uniform8(0.0..60.0_f32),
    ) {
        let mut hlod = Hlod::new(seed);
        let camera = eye(&hlod, view);
        let settings = Settings { frustum: false, ..Settings::FRUSTUM };
        let mut taus = taus;
        taus.sort_by(f32::total_cmp);
        let mut before = u64::MAX;
        for tau in taus {
            let detail = Detail { tau, metric: metric(index) };
            hlod.culler.select(&camera, &settings, &detail, &Budget::Unlimited);
            let triangles = hlod.culler.detail_statistics().triangles;
            prop_assert!(triangles <= before, "{triangles} after {before}");
            before = triangles;
        }
    }

    /// However large the error and however small the budget: no proxy around the eye, and none over hidden objects.
    #[test]
    fn no_proxy_around_the_eye_or_over_hidden_objects(
        seed in 0_u64..500, view in any::<u64>(), query in 0_usize..4, share in 0.0..1.0_f64, hide in any::<u64>(),
    ) {
        let mut hlod = Hlod::new(seed);
        let (camera, settings) = (eye(&hlod, view), settings(query));
        let all: Vec<Draw> = hlod.culler.cull(&camera, &settings).to_vec();
        let triangles = hlod.culler.selection().chosen_triangles;
        let mut random = Random(hide);
        let hidden: Vec<Draw> = (0..3).filter(|_| !all.is_empty()).map(|_| all[random.below(all.len())]).collect();
        hidden.iter().for_each(|draw| hlod.culler.set_hidden(*draw, true));
        let detail = Detail { tau: f32::MAX, metric: metric(seed as usize) };
        for budget in [Budget::Unlimited, Budget::Triangles((triangles as f64 * share) as u64)] {
            let selected = hlod.culler.select(&camera, &settings, &detail, &budget).to_vec();
            for s in &selected {
                if s.kind == SelectedKind::Proxy {
                    prop_assert!(hlod.distance(s.draw, &camera) > 0.0);
                    prop_assert!(!hlod.below(s.draw).iter().any(|draw| hidden.contains(draw)));
                } else {
                    prop_assert!(!hidden.contains(&s.draw));
                }
            }
        }
        hidden.iter().for_each(|draw| hlod.culler.set_hidden(*draw, false));
        let shown = hlod.culler.select(&camera, &settings, &detail, &Budget::Unlimited).to_vec();
        let mut fresh = Hlod::new(seed);
        let same = fresh.culler.select(&camera, &settings, &detail, &Budget::Unlimited);
        prop_assert!(shown == same, "{:?}", shown.iter().zip(same).find(|(a, b)| a != b));
    }
}

/// The random scenes have what the tests are about.
#[test]
fn random_scenes_draw_proxies_levels_and_originals() {
    let (mut proxies, mut levels, mut objects, mut guests) = (0, 0, 0, 0);
    for seed in 0..40 {
        let mut hlod = Hlod::new(seed);
        let detail = Detail { tau: 8.0, metric: Metric::default() };
        hlod.culler.select(&camera(seed), &Settings::default(), &detail, &Budget::Unlimited);
        let statistics = hlod.culler.detail_statistics();
        proxies += statistics.proxies;
        levels += statistics.levels;
        objects += statistics.objects;
        guests += usize::from(hlod.has_guests);
    }
    println!("{proxies} proxies, {levels} levels, {objects} objects, {guests} scenes with trees in trees");
    assert!(proxies > 50 && levels > 50 && objects > 50 && guests > 10);
}

/// The figures of the documentation: how much of what is drawn changes from frame to frame where the visible set does not,
/// on a slow flight and with a trembling hand, with and without hysteresis.
#[test]
fn hysteresis_keeps_cuts_from_flickering() {
    let settings = Settings { frustum: false, ..Settings::FRUSTUM };
    let detail = Detail { tau: 0.0, metric: Metric::default() };
    let looking = |eye: DVec3| {
        Camera::perspective(common::view(eye, DVec3::ZERO), 60_f64.to_radians(), 1280.0, 720.0, 0.05)
    };
    let flight = |frame: usize| {
        let angle = frame as f64 * 0.005;
        looking(DVec3::new(angle.cos(), 0.3, angle.sin()) * 25.0)
    };
    let hand = |frame: usize| looking(DVec3::new(25.0, 4.0, 0.0) + Random(frame as u64).point(0.1));
    for (name, path) in [("flight", &flight as &dyn Fn(usize) -> Camera), ("hand", &hand)] {
        let changes = |factor: f64| {
            let mut changes = 0;
            for seed in 0..20 {
                let mut hlod = Hlod::new(seed);
                hlod.culler.set_hysteresis(factor);
                hlod.culler.cull(&path(0), &settings);
                let budget = Budget::Triangles(hlod.culler.selection().chosen_triangles / 5);
                let mut before: Option<HashSet<(Draw, SelectedKind)>> = None;
                for frame in 0..100 {
                    let selected = hlod.culler.select(&path(frame), &settings, &detail, &budget);
                    let drawn: HashSet<_> = selected.iter().map(|s| (s.draw, s.kind)).collect();
                    changes += before.map_or(0, |before| before.symmetric_difference(&drawn).count());
                    before = Some(drawn);
                }
            }
            changes
        };
        let (without, with) = (changes(1.0), changes(1.25));
        println!("{name}: {without} changes without hysteresis, {with} with");
        assert!(without > 50 && with < without, "{name}: {without} {with}");
    }
}
