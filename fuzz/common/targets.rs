//! One function per target. None may panic, hang, overflow the stack or use much more memory than its input.

use super::input;
use glam::{DAffine3, DMat4, DVec3, Vec3};
use serde_json::{Value, json};
use svs::camera_path::CameraPath;
use svs::gltf::{AccessorError, Document, DocumentTables, payload};
use svs::scene::{ReadOptions, read_scene};
use svs_runtime::format::Extension;
use svs_runtime::{
    Bounds, Budget, Camera, Detail, Draw, Query, SceneCuller, SelectedKind, Settings, Visibility,
};

/// Reads a GLB and writes it again: nothing may change. Adds a payload and takes it out: nothing may change.
pub(crate) fn glb(data: &[u8]) {
    let Ok(document) = Document::from_glb(data) else { return };
    let Ok(written) = document.to_glb() else { return };
    let again = Document::from_glb(&written).expect("what was written can be read");
    assert_same(&document, &again);

    let mut other = document.clone();
    payload::strip(&mut other);
    let before = other.clone();
    let next = before.next_accessor();
    let extension = json!({"version": "1.0", "trees": [{"tables": {"LEVEL_ROW": next}}]});
    let table =
        payload::Table { bytes: &[1, 2, 3], component_type: 5121, kind: "SCALAR", count: 3, min_max: None };
    if payload::attach(&mut other, extension, &[table]).is_ok() {
        assert!(payload::strip(&mut other), "what was attached is there");
        // Whoever uses the accessor, the view or the bytes before they exist may keep them.
        if !mentions(&before.json, next) && views_fit(&before) {
            assert_same(&before, &other);
        }
    }
}

/// Whether all views are inside their buffers. Those of compressed data name a second buffer.
fn views_fit(document: &Document) -> bool {
    let views = document.json.get("bufferViews").and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
    let fits = |(index, view): (usize, &Value)| {
        view.get("extensions").is_none() && document.buffer_view(index).is_ok_and(|bytes| !bytes.is_empty())
    };
    views.iter().enumerate().all(fits)
}

/// Whether anything outside of accessors, views and buffers may mean accessor `next`, or anything a view that is not there.
fn mentions(json: &Value, next: usize) -> bool {
    let views = json.get("bufferViews").and_then(Value::as_array).map_or(0, Vec::len);
    let mut pending: Vec<(&str, bool, &Value)> = vec![("", true, json)];
    while let Some((key, may_name, value)) = pending.pop() {
        match value {
            Value::Array(items) => pending.extend(items.iter().map(|item| (key, may_name, item))),
            Value::Object(members) => pending.extend(members.iter().map(|(key, value)| {
                let storage = ["accessors", "bufferViews", "buffers"].contains(&key.as_str());
                (key.as_str(), may_name && !storage, value)
            })),
            _ => {
                let number = value.as_f64();
                let view_ahead = key == "bufferView" && number.is_some_and(|number| number >= views as f64);
                if view_ahead || (may_name && number == Some(next as f64)) {
                    return true;
                }
            }
        }
    }
    false
}

fn assert_same(a: &Document, b: &Document) {
    // As text: the order of keys and the text of numbers count.
    assert_eq!(a.json.to_string(), b.json.to_string());
    assert_eq!(a.buffers, b.buffers);
}

/// Reads every accessor in every way.
pub(crate) fn accessors(data: &[u8]) {
    let Some(document) = input::document(data) else { return };
    for index in 0..document.next_accessor().min(1_000) {
        let Ok(accessor) = document.accessor(index) else { continue };
        let expect = |result: Result<usize, AccessorError>| {
            if let Ok(count) = result {
                assert_eq!(count, accessor.count);
            }
        };
        expect(accessor.read_vec3_f64().map(|values| values.len()));
        expect(accessor.read_vec4_f64().map(|values| values.len()));
        expect(accessor.read_vec4_f32().map(|values| values.len()));
        expect(accessor.read_vec2_f32().map(|values| values.len()));
        expect(accessor.read_scalars_f64().map(|values| values.len()));
        expect(accessor.read_indices_u32().map(|values| values.len()));
        if let Some(bytes) = accessor.bytes() {
            let size = accessor.kind.element_size(accessor.component_type);
            assert_eq!(bytes.len(), accessor.count * size);
        }
        accessor.min_max();
    }
}

/// Reads the scene: what comes out is finite, and indices in it lead somewhere.
pub(crate) fn scene(data: &[u8]) {
    let Some(document) = input::document(data) else { return };
    let Ok(scene) = read_scene(&document, &ReadOptions::default()) else { return };
    for object in &scene.objects {
        assert!((object.mesh as usize) < scene.meshes.len());
        assert!((object.scene_node as usize) < scene.nodes.len());
    }
    for mesh in &scene.meshes {
        assert!(mesh.positions.iter().all(|at| at.is_finite()), "a vertex that is not finite");
        let corners = mesh.triangles.as_flattened();
        assert!(corners.iter().all(|&corner| (corner as usize) < mesh.positions.len()));
        assert!(mesh.surfaces.iter().all(|surface| surface.triangles.end as usize <= mesh.triangles.len()));
    }
    for (index, node) in scene.nodes.iter().enumerate() {
        assert!(node.parent.is_none_or(|parent| (parent as usize) < index));
        assert!(node.subtree_end as usize > index && node.subtree_end as usize <= scene.nodes.len());
        assert!(node.objects.end as usize <= scene.objects.len());
    }
}

/// Checks the document's bake.
pub(crate) fn validate(data: &[u8]) {
    let Some(document) = input::document(data) else { return };
    let report = svs::validate::validate(&document);
    // What is valid can be decoded.
    if !report.has_errors()
        && let Some(json) = document.json.pointer("/extensions/EXT_spherical_visibility")
    {
        let extension: Extension = serde_json::from_value(json.clone()).expect("a valid extension");
        let tables = DocumentTables::of_extension(&document, &extension);
        Visibility::decode(json, &tables).expect("a valid extension");
    }
}

/// Decodes the document's bake as a loader would, and culls with it.
pub(crate) fn extension(data: &[u8]) {
    let Some(document) = input::document(data) else { return };
    let Some(json) = document.json.pointer("/extensions/EXT_spherical_visibility") else { return };
    let Ok(extension) = serde_json::from_value::<Extension>(json.clone()) else { return };
    let tables = DocumentTables::of_extension(&document, &extension);
    let Ok(visibility) = Visibility::decode(json, &tables) else { return };
    let objects: usize = visibility.trees().iter().map(|tree| tree.object_count()).sum();
    let placed: usize = visibility
        .trees()
        .iter()
        .map(|tree| tree.object_count().saturating_mul(tree.placement().count()))
        .sum();
    // A loader has as many boxes as objects, so it has noticed by now.
    if objects > 10_000 || placed > 100_000 {
        return;
    }
    cull(&visibility, document.json.get("extras").unwrap_or(&Value::Null));
}

/// Culls from places that `extras` may name.
fn cull(visibility: &Visibility, extras: &Value) {
    let number = |k: usize| extras.get(k).and_then(Value::as_f64);
    let unit = |k: usize| {
        let at = Vec3::new(k as f32, (k % 7) as f32, (k % 3) as f32) - 2.0;
        Bounds { min: at, max: at + 1.0 }
    };
    let bounds: Vec<Vec<Bounds>> =
        visibility.trees().iter().map(|tree| (0..tree.object_count()).map(unit).collect()).collect();
    let mut culler = SceneCuller::new(visibility, &bounds).expect("there is a valid box for each object");
    let anchored = DAffine3::from_scale(DVec3::new(-1.0, number(3).unwrap_or(1.0), 2.0));
    culler.set_anchor(0, 0, anchored);
    for eye in [DVec3::ZERO, DVec3::new(30.0, 2.0, -0.0)] {
        let eye =
            DVec3::new(number(0).unwrap_or(eye.x), number(1).unwrap_or(eye.y), number(2).unwrap_or(eye.z));
        let view = DMat4::from_translation(-eye);
        let camera =
            Camera::perspective(view, number(4).unwrap_or(1.0), 1280.0, 720.0, number(5).unwrap_or(0.1));
        for query in [
            Query::SphereNearest,
            Query::SphereMax3,
            Query::SphereWeighted3,
            Query::SphereMaxAll,
            Query::Object,
        ] {
            for quality in [0.2, 0.6, 0.95] {
                for frustum in [false, true] {
                    let settings = Settings { query, frustum, ..Settings::from_quality(quality) };
                    for draw in culler.cull(&camera, &settings) {
                        let tree = &visibility.trees()[draw.tree as usize];
                        assert!((draw.object as usize) < tree.object_count());
                        assert!((draw.anchor as usize) < tree.placement().count());
                    }
                    assert_eq!(culler.statistics().drawn, culler.cull(&camera, &settings).len());
                    for budget in [Budget::Unlimited, Budget::Triangles(4)] {
                        select(visibility, &mut culler, &camera, &settings, &budget);
                    }
                }
            }
        }
        culler.set_hidden(Draw { tree: 0, anchor: 0, object: 1 }, true);
    }
}

/// Selects with large errors: all that is drawn must be there to be drawn, within the budget.
fn select(
    visibility: &Visibility,
    culler: &mut SceneCuller,
    camera: &Camera,
    settings: &Settings,
    budget: &Budget<'_>,
) {
    for (tree, decoded) in visibility.trees().iter().enumerate() {
        let proxies = decoded.proxies().map_or(0, |proxies| proxies.nodes().len());
        culler.set_triangles(tree as u32, &vec![3; decoded.object_count()]).expect("a count for each object");
        culler.set_proxy_triangles(tree as u32, &vec![2; proxies]).expect("a count for each proxy");
    }
    let detail = Detail { tau: 100.0, ..Detail::default() };
    for selected in culler.select(camera, settings, &detail, budget) {
        let tree = &visibility.trees()[selected.draw.tree as usize];
        let proxies = tree.proxies().map_or(0, |proxies| proxies.nodes().len());
        let most = if selected.kind == SelectedKind::Proxy { proxies } else { tree.object_count() };
        assert!((selected.draw.object as usize) < most);
        assert!((selected.draw.anchor as usize) < tree.placement().count());
        assert!((0.0..=1.0).contains(&selected.ratio));
    }
    let statistics = culler.detail_statistics();
    assert!(statistics.triangles <= statistics.candidate_triangles);
    assert!(!matches!(budget, Budget::Triangles(most) if statistics.triangles > *most));
}

/// Reads a camera path, flies it and writes it: what is written reads as the same.
pub(crate) fn camera_path(data: &[u8]) {
    let (text, _) = input::split(data);
    let Ok(json) = serde_json::from_slice::<Value>(text) else { return };
    let Ok(path) = CameraPath::from_json(&json) else { return };
    let poses = path.steps(17);
    assert!(!poses.is_empty());
    assert!(poses.iter().all(|pose| pose.eye.is_finite() && (pose.forward.length() - 1.0).abs() < 1e-6));
    let again = CameraPath::from_json(&path.to_json()).expect("what was written can be read");
    assert_eq!(again.poses.len(), path.poses.len());
}
