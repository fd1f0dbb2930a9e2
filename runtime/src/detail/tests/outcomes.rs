//! What is said of a selection, against the selection.

use super::{camera, scene};
use crate::bounds::Bounds;
use crate::budget::Budget;
use crate::detail::{Detail, Level, Metric, Outcome, Selected, SelectedKind};
use crate::query::Settings;
use crate::scene::{Draw, LOOSE, SceneCuller};
use glam::Vec3;

/// Each object's outcome says what was selected; returns how many objects of each kind there were.
fn check_outcomes(culler: &mut SceneCuller, detail: Detail, budget: &Budget<'_>, counts: &mut [usize; 5]) {
    let camera = camera();
    let selected: Vec<Selected> = culler.select(&camera, &Settings::FRUSTUM, &detail, budget).to_vec();
    let tree = culler.placed[0].instance.tree.clone();
    let proxies = tree.proxies().unwrap();
    let draws = (0..tree.object_count() as u32 + 1).map(|object| Draw { tree: 0, anchor: 0, object });
    for draw in draws.chain([0, 1, 2].map(|object| Draw { tree: LOOSE, anchor: 0, object })) {
        let visible = culler.within.candidates.iter().any(|candidate| candidate.draw == draw);
        let own = selected.iter().find(|s| s.draw == draw && s.kind != SelectedKind::Proxy);
        let outcome = culler.outcome(draw).expect("something was selected");
        let fine = |error: f64| error <= f64::from(detail.tau) || !matches!(budget, Budget::Unlimited);
        let kind = match outcome {
            Outcome::NotVisible => {
                assert!(!visible && own.is_none());
                0
            }
            Outcome::Object => {
                assert_eq!(own.unwrap().kind, SelectedKind::Object);
                1
            }
            Outcome::Level { level, error } => {
                assert!(own.unwrap().kind == SelectedKind::Level(level) && error > 0.0 && fine(error));
                2
            }
            Outcome::Proxy { proxy, objects, error } => {
                assert!(own.is_none() && error > 0.0 && fine(error));
                assert!(selected.iter().any(|s| s.draw == proxy && s.kind == SelectedKind::Proxy));
                let node = &proxies.nodes()[proxy.object as usize];
                assert!(node.objects().contains(&proxies.position(draw.object)));
                assert_eq!(objects, node.object_count);
                3
            }
            Outcome::LeftOut => {
                assert!(visible && own.is_none() && !matches!(budget, Budget::Unlimited));
                4
            }
        };
        counts[kind] += 1;
    }
}

#[test]
fn outcomes_say_what_was_selected() {
    let mut counts = [0; 5];
    for seed in 0..30 {
        let mut culler = scene(seed, 1);
        let near = |x: f32| Bounds { min: Vec3::new(x, 0.0, 0.0), max: Vec3::new(x + 1.0, 1.0, 1.0) };
        culler.set_loose(&[near(0.0), near(3.0)], &[5000, 10]).unwrap();
        culler.set_loose_levels(&[0, 1, 1], &[Level::new(20, 0.01)]).unwrap();
        let draw = Draw { tree: 0, anchor: 0, object: 0 };
        assert_eq!(culler.outcome(draw), None, "nothing was selected yet");
        for tau in [0.0, 4.0, 40.0] {
            let detail = Detail { tau, metric: Metric::Sse };
            culler.cull(&camera(), &Settings::FRUSTUM);
            let all = culler.selection().chosen_triangles;
            for budget in [Budget::Unlimited, Budget::Triangles(all / 10), Budget::Triangles(all / 300)] {
                check_outcomes(&mut culler, detail, &budget, &mut counts);
            }
        }
        assert!(culler.outcome(draw).is_some());
        culler.set_hidden(draw, true);
        assert_eq!(culler.outcome(draw), None, "something has changed");
        check_outcomes(&mut culler, Detail::default(), &Budget::Unlimited, &mut counts);
        assert_eq!(culler.outcome(draw), Some(Outcome::NotVisible));
        culler.cull(&camera(), &Settings::FRUSTUM);
        assert_eq!(culler.outcome(draw), None, "what was drawn last was no selection");
    }
    assert!(counts.iter().all(|&count| count > 20), "{counts:?}");
}
