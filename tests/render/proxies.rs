//! Files with proxies, opened for drawing: what is chosen, what it stands for, and how it looks.

use crate::handmade::{self, ERRORS, SIDE};
use std::collections::BTreeSet;
use svs::evaluate::metrics::{hole_mask, largest_region, ssim};
use svs::gltf::Document;
use svs::stage::{ColourMode, Extra, Kind, Method, Stage};
use svs_render::{Frame, Gpu, GpuScene, Image, ItemBuffer, NO_ITEM, Offscreen, View};
use svs_runtime::format::EXTENSION_NAME;
use svs_runtime::{Budget, Detail, Metric};

const WIDTH: u32 = 320;
const HEIGHT: u32 = 240;
const OBJECTS: usize = SIDE * SIDE;

fn stage(doc: &Document) -> Stage {
    Stage::open(doc).expect("a stage")
}

/// The whole scene, from some radii away.
fn view(radii: f64) -> View {
    let eye = handmade::eye(radii);
    View::looking_along(eye, -eye, 0.9, 0.05)
}

fn select(stage: &mut Stage, view: &View, tau: f32, budget: &Budget<'_>) -> Vec<u32> {
    let (settings, detail) = (stage.recommended(), Detail { tau, metric: Metric::Sse });
    stage.select(view, WIDTH, HEIGHT, Method::Visibility, &settings, &detail, budget).to_vec()
}

fn triangles(stage: &Stage, drawn: &[u32]) -> u64 {
    let of = |id: u32| {
        let mesh = &stage.data.meshes[stage.data.objects[id as usize].mesh as usize];
        mesh.primitives.iter().map(|primitive| primitive.indices.len() as u64 / 3).sum::<u64>()
    };
    drawn.iter().map(|&id| of(id)).sum()
}

/// Nothing is drawn twice: neither an object, nor something that stands for it.
#[track_caller]
fn assert_disjoint(stage: &Stage, drawn: &[u32]) {
    let mut seen = BTreeSet::new();
    for &id in drawn {
        for object in stage.objects_of(id) {
            assert!(seen.insert(object), "object {object} is drawn twice");
        }
    }
}

#[test]
fn proxies_and_levels_follow_the_objects() {
    let stage = stage(&handmade::document());
    assert!(stage.has_proxies() && stage.notice().is_none(), "{:?}", stage.notice());
    // A level of each object, a root and its halves.
    assert_eq!((stage.order().len(), stage.data.objects.len()), (OBJECTS, 2 * OBJECTS + 3));
    let all: BTreeSet<u32> = stage.upload_order().iter().copied().collect();
    assert_eq!((all.len(), stage.upload_order().len()), (2 * OBJECTS + 3, 2 * OBJECTS + 3));
    let ids = 0..stage.data.objects.len() as u32;
    let proxies: Vec<u32> = ids.clone().filter(|&id| stage.kind_of(id) == Kind::Proxy).collect();
    assert_eq!(proxies.len(), 3);
    let everything: Vec<u32> = (0..OBJECTS as u32).collect();
    assert_eq!(stage.objects_shown(&proxies[..1]), everything);
    assert_eq!(stage.objects_shown(&proxies[1..]), everything);
    assert!(stage.objects_of(proxies[1]).iter().all(|object| !stage.objects_of(proxies[2]).contains(object)));
    let [fine, level, coarse] = handmade::triangles().map(u64::from);
    assert_eq!(triangles(&stage, &proxies[..1]), OBJECTS as u64 * coarse);
    for id in ids.filter(|&id| stage.kind_of(id) == Kind::Level) {
        let Some(Extra::Level { object, level: 1 }) = stage.extra(id) else {
            panic!("{:?}", stage.extra(id))
        };
        assert_eq!((stage.levels_of(object), stage.objects_of(id)), (id..id + 1, vec![object]));
        assert_eq!((triangles(&stage, &[id]), triangles(&stage, &[object])), (level, fine));
    }
    for mode in ColourMode::ALL {
        assert_eq!(stage.tints(mode).len(), stage.data.objects.len(), "{mode:?}");
    }
    assert_eq!((stage.kind_of(u32::MAX), stage.objects_of(u32::MAX).len()), (Kind::Object, 0));
}

#[test]
fn what_is_far_is_drawn_through_proxies_and_what_is_near_as_it_is() {
    let mut stage = stage(&handmade::document());
    let kinds = |stage: &Stage, drawn: &[u32]| {
        [Kind::Object, Kind::Level, Kind::Proxy].map(|kind| stage.count(drawn, kind))
    };
    let far = select(&mut stage, &view(400.0), 1.0, &Budget::Unlimited);
    assert_eq!((kinds(&stage, &far), stage.nodes_shown(&far)), ([0, 0, 1], 1));
    assert_eq!(stage.detail_statistics().proxies, 1);
    // The eye is outside of all spheres, and the error of the level below a pixel, but not that of the proxies.
    let distance = handmade::eye(12.0).length();
    let pixels = f64::from(HEIGHT) * 0.5 / (0.45_f64).tan() / distance;
    let tau = (f64::from(ERRORS[0]) * pixels * 1.5) as f32;
    let middle = select(&mut stage, &view(12.0), tau, &Budget::Unlimited);
    let [objects, levels, proxies] = kinds(&stage, &middle);
    assert!(objects == 0 && levels > 0 && proxies == 0, "{objects} {levels} {proxies}");
    let near = select(&mut stage, &view(3.0), 0.0, &Budget::Unlimited);
    let settings = stage.recommended();
    let culled =
        stage.cull(&view(3.0), WIDTH, HEIGHT, Method::Visibility, &settings, &Budget::Unlimited).to_vec();
    let set = |ids: &[u32]| ids.iter().copied().collect::<BTreeSet<_>>();
    assert_eq!(set(&near), set(&culled));
    assert!(stage.nodes_shown(&near) <= 2);
    for radii in [1.0, 1.5, 3.0, 6.0, 20.0, 100.0] {
        let drawn = select(&mut stage, &view(radii), 2.0, &Budget::Unlimited);
        assert_disjoint(&stage, &drawn);
        let shown = stage.objects_shown(&drawn);
        let culled =
            stage.cull(&view(radii), WIDTH, HEIGHT, Method::Visibility, &settings, &Budget::Unlimited);
        assert!(culled.iter().all(|object| shown.binary_search(object).is_ok()), "{radii}");
    }
}

#[test]
fn a_budget_is_kept_and_nothing_falls_between() {
    let mut stage = stage(&handmade::document());
    let coarsest = u64::from(handmade::triangles()[2]) * OBJECTS as u64;
    for most in [0, 100, coarsest, 2 * coarsest, 10_000_000] {
        let drawn = select(&mut stage, &view(8.0), 0.1, &Budget::Triangles(most));
        assert!(triangles(&stage, &drawn) <= most, "{most}");
        assert_disjoint(&stage, &drawn);
        if most >= coarsest {
            assert_eq!(stage.objects_shown(&drawn).len(), OBJECTS, "{most}");
        }
    }
}

#[test]
fn nothing_stands_for_what_is_hidden() {
    let mut stage = stage(&handmade::document());
    let far = view(400.0);
    stage.set_hidden(5, true);
    let drawn = select(&mut stage, &far, 1.0, &Budget::Unlimited);
    assert!(!stage.objects_shown(&drawn).contains(&5));
    assert_disjoint(&stage, &drawn);
    stage.set_hidden(5, false);
    assert_eq!(select(&mut stage, &far, 1.0, &Budget::Unlimited).len(), 1);
}

#[test]
fn broken_proxies_are_left_out_with_a_notice() {
    let whole = handmade::document();
    let mut plain = stage(&whole);
    type Change = dyn Fn(&mut serde_json::Value);
    let broken: [(&str, &Change); 4] = [
        ("no such mesh", &|json| json["meshes"].as_array_mut().expect("meshes").truncate(2)),
        ("no such accessor", &|json| {
            json["extensions"][EXTENSION_NAME]["trees"][0]["proxies"]["tables"]["PROXY_SPHERE"] = 999.into();
        }),
        ("a wrong type", &|json| {
            json["extensions"][EXTENSION_NAME]["trees"][0]["proxies"]["visible"] = 3.into()
        }),
        ("an empty mesh", &|json| json["meshes"][4]["primitives"][0]["mode"] = 1.into()),
    ];
    for (what, change) in broken {
        let mut json = whole.json.clone();
        change(&mut json);
        let doc = Document::from_parts(json, Some(whole.buffers[0].clone())).expect("a document");
        let mut stage = stage(&doc);
        assert!(stage.is_baked() && !stage.has_proxies(), "{what}");
        assert!(
            stage.notice().is_some_and(|notice| notice.contains("proxies")),
            "{what}: {:?}",
            stage.notice()
        );
        assert_eq!(stage.data.objects.len(), OBJECTS, "{what}");
        let settings = stage.recommended();
        let near = view(3.0);
        let drawn = select(&mut stage, &near, 1.0, &Budget::Unlimited);
        let of = |stage: &mut Stage| {
            stage.cull(&near, WIDTH, HEIGHT, Method::Visibility, &settings, &Budget::Unlimited).to_vec()
        };
        assert_eq!(drawn, of(&mut plain), "{what}");
    }
}

#[test]
fn pictures_with_proxies_look_like_those_without() {
    let mut stage = stage(&handmade::document());
    let gpu = Gpu::headless().expect("a Vulkan driver");
    let scene = GpuScene::upload(&gpu, &stage.data, stage.upload_order()).expect("a scene on the GPU");
    let mut offscreen = Offscreen::new(&gpu, WIDTH, HEIGHT).expect("an image");
    let mut renderer = Offscreen::renderer(&gpu);
    let mut draw = |view: &View, objects: &[u32]| -> (Image, ItemBuffer) {
        let frame = Frame { view: *view, objects, lines: &[] };
        let image = offscreen.image(&gpu, &mut renderer, &scene, &frame).expect("a picture");
        (image, offscreen.items(&gpu, &mut renderer, &scene, &frame).expect("items"))
    };
    for (radii, tau) in [(4.0, 2.0), (8.0, 4.0), (30.0, 1.0)] {
        let view = view(radii);
        let settings = stage.recommended();
        let all = stage.cull(&view, WIDTH, HEIGHT, Method::Frustum, &settings, &Budget::Unlimited).to_vec();
        let drawn = select(&mut stage, &view, tau, &Budget::Unlimited);
        assert!(stage.count(&drawn, Kind::Object) < drawn.len(), "{radii}: nothing is simplified");
        assert!(2 * triangles(&stage, &drawn) < triangles(&stage, &all), "{radii}");
        let (reference, reference_items) = draw(&view, &all);
        let (picture, items) = draw(&view, &drawn);
        assert!(items.nearest.iter().all(|id| *id == NO_ITEM || drawn.contains(id)), "{radii}");
        assert!(
            items.nearest.iter().any(|&id| id != NO_ITEM && stage.kind_of(id) != Kind::Object),
            "{radii}"
        );
        let likeness = ssim(&reference, &picture).expect("pictures of one size");
        assert!(likeness > 0.9 && likeness < 1.0, "{radii}: {likeness}");
        let hole = largest_region(&hole_mask(&reference_items, &items), WIDTH as usize);
        assert!(hole < 64, "{radii}: {hole}");
    }
}
