use super::*;
use crate::bake::{BakeOptions, Silent, build};
use crate::gltf::Document;
use serde_json::json;
use std::path::Path;
use svs_render::View;

fn plant() -> Document {
    Document::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/plant.glb")).expect("the sample")
}

/// Shells inside one another, baked.
fn shells() -> Document {
    let sample = crate::generate::shells(&crate::generate::ShellOptions { depth: 4, hole: false });
    let mut doc = Document::from_parts(sample.json, Some(sample.bin)).expect("a document");
    let options = BakeOptions { rays: Some(200_000), verify: false, ..BakeOptions::default() };
    build(&mut doc, &options, &Silent).expect("a bake");
    doc
}

fn outside(stage: &Stage) -> View {
    let surroundings = stage.surroundings();
    let eye =
        surroundings.sphere.center + DVec3::new(0.6, 0.4, 0.7).normalize() * surroundings.sphere.radius * 3.0;
    View::looking_along(eye, surroundings.sphere.center - eye, 1.0, 0.01)
}

fn cull(stage: &mut Stage, view: &View, method: Method) -> Vec<u32> {
    let settings = stage.recommended();
    let mut drawn = stage.cull(view, 640, 480, method, &settings, &svs_runtime::Budget::Unlimited).to_vec();
    drawn.sort_unstable();
    drawn
}

#[test]
fn methods_draw_less_and_less() {
    let mut stage = Stage::open(&shells()).expect("a stage");
    assert!(stage.is_baked() && stage.notice().is_none());
    let view = outside(&stage);
    let all = cull(&mut stage, &view, Method::Nothing);
    assert_eq!(all.len(), stage.scene.objects.len());
    assert_eq!(cull(&mut stage, &view, Method::Frustum), all);
    let seen = cull(&mut stage, &view, Method::Visibility);
    assert!(!seen.is_empty() && seen.len() < all.len(), "{seen:?} of {}", all.len());
    let behind = View { forward: -view.forward, ..view };
    assert_eq!(cull(&mut stage, &behind, Method::Nothing), all);
    assert!(cull(&mut stage, &behind, Method::Frustum).is_empty());
}

#[test]
fn answers_and_objects_go_both_ways() {
    for doc in [plant(), shells()] {
        let stage = Stage::open(&doc).expect("a stage");
        assert_eq!(stage.order().len(), stage.scene.objects.len());
        for &object in stage.order() {
            let draw = stage.draw_of(object).expect("an answer");
            assert_eq!(stage.object_of(draw), Some(object));
        }
        assert_eq!(stage.draw_of(u32::MAX), None);
        assert_eq!(stage.object_of(Draw { tree: 9, anchor: 0, object: 0 }), None);
    }
}

#[test]
fn files_without_a_usable_bake_are_culled_by_the_frustum() {
    let mut plain = Stage::open(&plant()).expect("a stage");
    assert!(!plain.is_baked() && plain.notice().is_none());
    let mut stale = shells();
    stale.json["nodes"].as_array_mut().expect("nodes").iter_mut().for_each(|node| {
        node.as_object_mut().expect("a node").remove("mesh");
    });
    stale.json["nodes"][0]["mesh"] = json!(0);
    let stale = Stage::open(&stale).expect("a stage");
    assert!(!stale.is_baked());
    assert!(stale.notice().is_some_and(|notice| notice.contains("another state")), "{:?}", stale.notice());
    let mut broken = shells();
    broken.json["extensions"]["EXT_spherical_visibility"]["version"] = json!("9");
    let broken = Stage::open(&broken).expect("a stage");
    assert!(broken.notice().is_some_and(|notice| notice.contains("cannot be read")));
    let view = outside(&plain);
    assert_eq!(cull(&mut plain, &view, Method::Visibility), cull(&mut plain, &view, Method::Frustum));
    let near = View { eye: plain.surroundings().sphere.center, ..view };
    let part = cull(&mut plain, &near, Method::Frustum);
    assert!(!part.is_empty() && part.len() < plain.scene.objects.len());
}

#[test]
fn hidden_objects_are_drawn_by_no_method() {
    for doc in [plant(), shells()] {
        let mut stage = Stage::open(&doc).expect("a stage");
        let view = outside(&stage);
        let object = cull(&mut stage, &view, Method::Visibility)[0];
        for hidden in [true, false] {
            stage.set_hidden(object, hidden);
            for method in [Method::Nothing, Method::Frustum, Method::Visibility] {
                assert_eq!(cull(&mut stage, &view, method).contains(&object), !hidden, "{method}");
            }
        }
        stage.set_hidden(u32::MAX, true);
    }
}

#[test]
fn an_empty_file_is_a_stage_too() {
    let doc = Document::from_parts(json!({"asset": {"version": "2.0"}}), None).expect("a document");
    let mut stage = Stage::open(&doc).expect("a stage");
    let (min, max) = stage.bounds();
    assert!(min.cmplt(max).all());
    let view = outside(&stage);
    assert!(Method::ALL.iter().all(|&method| cull(&mut stage, &view, method).is_empty()));
    assert_eq!(stage.object_bounds(3), (DVec3::ZERO, DVec3::ZERO));
}

#[test]
fn colours_are_one_per_object() {
    let stage = Stage::open(&shells()).expect("a stage");
    for mode in ColourMode::ALL {
        let tints = stage.tints(mode);
        assert_eq!(tints.len(), stage.scene.objects.len());
        // Nothing was selected: nothing was coarsened either.
        assert_eq!(tints.iter().any(|tint| *tint != tints[0]), mode != ColourMode::Severity, "{mode:?}");
    }
}

#[test]
fn names_of_methods_go_both_ways() {
    for method in Method::ALL {
        assert_eq!(method.to_string().parse(), Ok(method));
    }
    assert!("all".parse::<Method>().is_err());
}

/// A sphere inside which the camera is not, whose mesh has a level, and another object with that mesh which no tree knows.
#[test]
fn objects_in_no_tree_are_simplified_too() {
    let mut doc = shells();
    let json = &mut doc.json;
    let primitive = json["meshes"][0]["primitives"][0].clone();
    let indices = primitive["indices"].as_u64().expect("indices") as usize;
    let mut fewer = json["accessors"][indices].clone();
    fewer["count"] = json!(30);
    let mut level = primitive;
    level["indices"] = json!(json["accessors"].as_array().expect("accessors").len());
    let [mesh, node] = ["meshes", "nodes"].map(|key| json[key].as_array().expect(key).len());
    json["accessors"].as_array_mut().expect("accessors").push(fewer);
    json["meshes"].as_array_mut().expect("meshes").push(json!({"primitives": [level]}));
    json["nodes"]
        .as_array_mut()
        .expect("nodes")
        .push(json!({"mesh": 0, "translation": [40, 0, 0], "scale": [2, 2, 2]}));
    json["scenes"][0]["nodes"].as_array_mut().expect("nodes").push(json!(node));
    json["extensions"]["EXT_spherical_visibility"]["meshLevels"] =
        json!([{"mesh": 0, "levels": [{"mesh": mesh, "error": 0.25}]}]);

    let mut stage = Stage::open(&doc).expect("a stage");
    assert_eq!(stage.notice(), None);
    let loose = stage.scene.objects.iter().position(|object| object.node == node).expect("an object") as u32;
    assert_eq!(stage.draw_of(loose).expect("an answer").tree, svs_runtime::LOOSE);
    let levels = stage.levels_of(loose);
    assert_eq!(levels.len(), 1);
    let view = outside(&stage);
    let settings = stage.recommended();
    let mut select = |tau: f32| {
        let detail = svs_runtime::Detail { tau, metric: svs_runtime::Metric::Sse };
        let budget = svs_runtime::Budget::Unlimited;
        stage.select(&view, 640, 480, Method::Visibility, &settings, &detail, &budget).to_vec()
    };
    // Half a metre, for the object is scaled by 2.
    let (fine, coarse) = (select(0.01), select(1000.0));
    assert!(fine.contains(&loose) && !fine.contains(&levels.start), "{fine:?}");
    assert!(coarse.contains(&levels.start) && !coarse.contains(&loose), "{coarse:?}");
    assert_eq!(stage.extra(levels.start), Some(Extra::Level { object: loose, level: 1 }));
    assert_eq!(stage.objects_of(levels.start), [loose]);
    let outcome = stage.outcome(loose);
    assert!(
        matches!(outcome, Some(svs_runtime::Outcome::Level { level: 1, error }) if error > 0.0),
        "{outcome:?}"
    );
}
