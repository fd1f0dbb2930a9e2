//! Culling against slow, literal readings of the rules.

mod common;

use common::{camera, camera_at, sample};
use proptest::prelude::*;
use std::f32::consts::FRAC_PI_2;
use std::sync::Arc;
use svs_runtime::{Camera, Culler, Query, Settings, Tau, Tree};

/// The rules as they are written, one object at a time: no skipping, no tables.
fn expected(
    tree: &Tree,
    bounds: &[svs_runtime::Bounds],
    camera: &Camera,
    settings: &Settings,
    hidden: &[u32],
) -> Vec<u32> {
    let set = tree.direction_set();
    let usable = |index: usize| {
        let node = &tree.nodes()[index];
        let distance = (camera.eye() - node.center.as_dvec3()).length();
        let radius = f64::from(node.radius);
        distance > radius
            && (settings.max_half_angle >= FRAC_PI_2
                || (radius / distance).asin() <= f64::from(settings.max_half_angle))
            && !hidden.iter().any(|h| node.objects().contains(h))
    };
    (0..tree.object_count() as u32)
        .filter(|&object| {
            let o = object as usize;
            if hidden.contains(&object) || settings.frustum && !camera.sees(&bounds[o]) {
                return false;
            }
            let above = |&n: &usize| tree.nodes()[n].objects().contains(&object);
            let Some(node) = (0..tree.nodes().len()).filter(above).find(|&n| usable(n)) else { return true };
            let node = &tree.nodes()[node];
            let height = tree.depth(o) - node.depth;
            let sees = |bin: usize| u32::from(tree.level(o, bin)) >= height;
            if !(0..set.len()).any(sees) {
                return false;
            }
            let center = (bounds[o].min.as_dvec3() + bounds[o].max.as_dvec3()) * 0.5;
            let radius = (bounds[o].max.as_dvec3() - bounds[o].min.as_dvec3()).length() * 0.5;
            let to_eye = camera.eye() - center;
            if to_eye.length() <= radius {
                return true;
            }
            let scale = camera.pixels_per_radian() / to_eye.length();
            let pixels = f64::from(tree.importance_area(o, height)) * scale * scale;
            let least = f64::from(settings.tau.nearest);
            let to_sphere = camera.eye() - node.center.as_dvec3();
            let (triangle, weights) = set.weights_f64(to_sphere);
            match settings.query {
                Query::SphereNearest => pixels >= least && sees(set.nearest_f64(to_sphere)),
                Query::SphereMax3 => pixels >= least && triangle.iter().any(|&b| sees(b as usize)),
                Query::SphereMaxAll => pixels >= least,
                Query::SphereWeighted3 => {
                    let weight: f64 =
                        (0..3).filter(|&k| sees(triangle[k] as usize)).map(|k| f64::from(weights[k])).sum();
                    weight > 0.0 && pixels * weight >= least
                }
                _ => {
                    let bin = set.nearest_f64(to_eye);
                    let (triangle, _) = set.weights_f64(to_eye);
                    let tau = settings.tau;
                    sees(bin) && pixels >= least
                        || tau.triangle < f32::INFINITY
                            && pixels >= f64::from(tau.triangle.max(tau.nearest))
                            && triangle.iter().any(|&b| sees(b as usize))
                        || tau.ring < f32::INFINITY
                            && pixels >= f64::from(tau.ring.max(tau.nearest))
                            && set.ring(bin).iter().any(|&b| sees(b as usize))
                }
            }
        })
        .collect()
}

fn settings() -> impl Strategy<Value = Settings> {
    let tau = || prop_oneof![Just(0.0_f32), Just(f32::INFINITY), 0.1_f32..2000.0];
    let query = prop_oneof![
        2 => Just(Query::Object),
        1 => Just(Query::SphereNearest),
        1 => Just(Query::SphereMax3),
        1 => Just(Query::SphereWeighted3),
        1 => Just(Query::SphereMaxAll),
    ];
    (query, tau(), tau(), tau(), prop_oneof![Just(FRAC_PI_2), 0.2_f32..1.5], any::<bool>()).prop_map(
        |(query, nearest, triangle, ring, max_half_angle, frustum)| Settings {
            query,
            tau: Tau { nearest, triangle, ring },
            small_share: f32::INFINITY,
            max_half_angle,
            frustum,
        },
    )
}

fn culler(seed: u64, all_visible: bool) -> (Culler, Vec<svs_runtime::Bounds>) {
    let sample = sample(seed, all_visible);
    let tree = Arc::new(Tree::new(sample.tables).unwrap());
    (Culler::new(&tree, &sample.bounds).unwrap(), sample.bounds)
}

fn is_subset(small: &[u32], large: &[u32]) -> bool {
    small.iter().all(|place| large.binary_search(place).is_ok())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]

    #[test]
    fn culling_follows_the_rules(
        seed: u64, eye: u64, at: Option<u16>, settings in settings(), hide: Option<u16>,
    ) {
        let (mut culler, bounds) = culler(seed, false);
        let hidden: Vec<u32> = hide.map(|h| u32::from(h) % bounds.len() as u32).into_iter().collect();
        hidden.iter().for_each(|&h| culler.set_hidden(h, true));
        let camera = at.map_or_else(
            || camera(eye),
            |object| camera_at(&bounds[usize::from(object) % bounds.len()], eye),
        );
        let tree = Arc::clone(culler.tree());
        let expected = expected(&tree, &bounds, &camera, &settings, &hidden);
        prop_assert_eq!(culler.cull(&camera, &settings), expected);
        prop_assert_eq!(culler.statistics().drawn, culler.cull(&camera, &settings).len());
    }

    #[test]
    fn without_occlusion_it_is_frustum_culling(seed: u64, eye: u64, t in prop_oneof![Just(FRAC_PI_2), 0.0_f32..1.5]) {
        let (mut culler, bounds) = culler(seed, true);
        let camera = camera(eye);
        let settings = Settings { max_half_angle: t, ..Settings::NEAREST_O };
        let visible = |b: &svs_runtime::Bounds| camera.sees(b);
        let expected: Vec<u32> = (0..bounds.len() as u32).filter(|&k| visible(&bounds[k as usize])).collect();
        prop_assert_eq!(culler.cull(&camera, &settings), expected);
    }

    #[test]
    fn unused_spheres_leave_frustum_culling(seed: u64, eye: u64) {
        let (mut culler, bounds) = culler(seed, false);
        let camera = camera(eye);
        let settings = Settings { max_half_angle: 0.0, ..Settings::NEAREST_O };
        let places = 0..bounds.len() as u32;
        let expected: Vec<u32> = places.filter(|&k| camera.sees(&bounds[k as usize])).collect();
        prop_assert_eq!(culler.cull(&camera, &settings), expected);
    }

    /// However small the share of the image that small objects may cover, only small ones are affected, and they are left
    /// out from the smallest on.
    #[test]
    fn a_share_keeps_small_objects(seed: u64, eye: u64, settings in settings(), share in 0.0_f32..0.01) {
        let (mut culler, _) = culler(seed, false);
        let camera = camera(eye);
        let mut cull = |settings: &Settings| culler.cull(&camera, settings).to_vec();
        let least = cull(&settings);
        let some = cull(&Settings { small_share: share, ..settings });
        let more = cull(&Settings { small_share: share * 0.5, ..settings });
        let all = cull(&Settings { small_share: 0.0, ..settings });
        prop_assert!(is_subset(&least, &some) && is_subset(&some, &more) && is_subset(&more, &all));
    }

    #[test]
    fn a_higher_quality_draws_no_less(seed: u64, eye: u64, a in 0.0_f32..=1.0, b in 0.0_f32..=1.0) {
        let (mut culler, _) = culler(seed, false);
        let camera = camera(eye);
        let low = culler.cull(&camera, &Settings::from_quality(a.min(b))).to_vec();
        let high = culler.cull(&camera, &Settings::from_quality(a.max(b)));
        prop_assert!(is_subset(&low, high));
    }

    #[test]
    fn more_bins_draw_no_less(seed: u64, eye: u64) {
        let (mut culler, _) = culler(seed, false);
        let camera = camera(eye);
        let draws = |culler: &mut Culler, settings: &Settings| culler.cull(&camera, settings).to_vec();
        let nearest = draws(&mut culler, &Settings::NEAREST_O);
        let triangle = draws(&mut culler, &Settings::MAX3_O);
        let ring = draws(&mut culler, &Settings::RING_O);
        prop_assert!(is_subset(&nearest, &triangle) && is_subset(&triangle, &ring));
        let published = draws(&mut culler, &Settings::PUBLISHED);
        let all = draws(&mut culler, &Settings { query: Query::SphereMaxAll, ..Settings::PUBLISHED });
        prop_assert!(is_subset(&published, &all) && is_subset(&ring, &all));
    }

    #[test]
    fn showing_again_undoes_hiding(seed: u64, eye: u64, objects in prop::collection::vec(any::<u16>(), 0..6)) {
        let (mut culler, bounds) = culler(seed, false);
        let camera = camera(eye);
        let before = culler.cull(&camera, &Settings::default()).to_vec();
        let objects: Vec<u32> = objects.iter().map(|&o| u32::from(o) % bounds.len() as u32).collect();
        for hidden in [true, true, false, false] {
            objects.iter().for_each(|&o| culler.set_hidden(o, hidden));
        }
        culler.set_hidden(u32::MAX, true);
        prop_assert_eq!(culler.cull(&camera, &Settings::default()), before);
    }
}

/// The result's memory is reserved up front and never moves.
#[test]
fn culling_does_not_allocate() {
    let (mut culler, _) = culler(7, false);
    let first = culler.cull(&camera(0), &Settings::from_quality(0.0)).as_ptr();
    for seed in 0..200 {
        let settings = Settings { frustum: seed % 2 == 0, ..Settings::from_quality(seed as f32 / 200.0) };
        assert_eq!(culler.cull(&camera(seed), &settings).as_ptr(), first);
    }
}

/// An eye that is not a number is outside of no sphere: everything is drawn.
#[test]
fn a_broken_camera_draws_everything() {
    let (mut culler, bounds) = culler(3, false);
    let broken = Camera::perspective(glam::DMat4::NAN, f64::NAN, 0.0, -1.0, f64::INFINITY);
    assert_eq!(culler.cull(&broken, &Settings::default()).len(), bounds.len());
}
