//! Reports of baked scenes.

use crate::{Row, baked, evaluate, folder, root, small, succeeds};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// What must hold in every report.
#[track_caller]
fn check(summary: &Value, rows: &[Row], report: &Path, frames: usize) {
    let methods = summary["methods"].as_array().expect("methods");
    let paths = summary["paths"].as_array().expect("paths");
    assert_eq!(rows.len(), methods.len() * paths.len() * frames);
    for method in
        methods.iter().chain(paths.iter().flat_map(|path| path["methods"].as_array().expect("methods")))
    {
        for figure in ["frame_ms", "cull_us", "draws", "triangles", "missing_ppm"] {
            let value = |key: &str| {
                method[figure][key].as_f64().unwrap_or_else(|| panic!("{figure} {key}: {method}"))
            };
            let ordered = [value("median"), value("p95"), value("p99"), value("worst")];
            assert!(ordered.is_sorted() && ordered[0] >= 0.0, "{figure}: {method}");
        }
        assert!(method["frame_ms"]["median"].as_f64() > Some(0.0), "{method}");
        for figure in ["ssim", "psnr_y", "psnr_cb", "psnr_cr"] {
            assert!(
                method[figure]["worst"].as_f64() <= method[figure]["median"].as_f64(),
                "{figure}: {method}"
            );
            assert!(method[figure]["worst"].is_f64(), "{figure}: {method}");
        }
        assert!(method["ssim"]["median"].as_f64() <= Some(1.0), "{method}");
    }
    for key in ["cpu", "adapter", "driver", "backend"] {
        assert!(summary["machine"][key].is_string(), "{key}: {}", summary["machine"]);
    }
    assert!(summary["machine"]["cores"].as_u64() > Some(0));
    assert!(summary["objects"].as_u64() > Some(0) && summary["triangles"].as_u64() > Some(0));

    let mut by_frame: BTreeMap<(String, String), BTreeMap<&str, &Row>> = BTreeMap::new();
    for row in rows {
        by_frame.entry(row.key()).or_default().insert(row.text("method"), row);
    }
    for methods in by_frame.values() {
        let (frustum, visibility, exact) = (methods["frustum"], methods["visibility"], methods["exact"]);
        assert!(visibility.number("triangles") <= frustum.number("triangles"), "{methods:?}");
        assert!(exact.number("triangles") <= frustum.number("triangles"), "{methods:?}");
        for complete in [frustum, exact] {
            assert_eq!(
                (complete.number("missing_ppm"), complete.number("missing_objects")),
                (0.0, 0.0),
                "{methods:?}"
            );
        }
        assert_eq!((frustum.number("ssim"), exact.number("overdrawn_objects")), (1.0, 0.0), "{methods:?}");
        assert_eq!(exact.number("draws"), frustum.number("visible_objects"), "{methods:?}");
        for row in methods.values() {
            let drawn_and_seen = row.number("draws") - row.number("overdrawn_objects");
            assert_eq!(
                drawn_and_seen,
                row.number("visible_objects") - row.number("missing_objects"),
                "{row:?}"
            );
            assert!(row.number("frame_ms_least") <= row.number("frame_ms"), "{row:?}");
            assert!(row.number("frame_ms") <= row.number("frame_ms_most"), "{row:?}");
            assert!(row.number("ssim") <= 1.0 && row.number("psnr_y_db") <= 120.0, "{row:?}");
            if !row.text("triangle_budget").is_empty() {
                assert!(row.number("triangles") <= row.number("triangle_budget"), "{row:?}");
            }
        }
    }

    let html = std::fs::read_to_string(report.join("report.html")).expect("a page");
    for text in ["<svg", "Frame time, ms", "Missing pixels, ppm", "SSIM", "visibility", "processor"] {
        assert!(html.contains(text), "{text}");
    }
    // Pictures may hold any three letters.
    let text: String =
        html.split("base64,").map(|part| part.split_once('"').map_or(part, |(_, text)| text)).collect();
    assert!(!text.contains("NaN") && !text.contains("<script") && !text.contains("http://"));
}

#[test]
fn the_plant_outside_and_inside_with_a_budget() {
    let folder = folder();
    let report = folder.path().join("report");
    let scene = baked(&root().join("samples/plant.glb"), &folder);
    let (summary, rows) = evaluate(&scene, &report, &["--frames", "4", "--budget", "25%"]);
    check(&summary, &rows, &report, 4);
    assert_eq!(summary["scene"], "baked.glb");
    assert_eq!(summary["baked"], true);
    let names: Vec<&str> = summary["methods"]
        .as_array()
        .expect("methods")
        .iter()
        .map(|m| m["method"].as_str().expect("a name"))
        .collect();
    assert_eq!(names, ["frustum", "visibility", "exact", "budget", "first-misfit"]);
    assert_eq!([&summary["paths"][0]["name"], &summary["paths"][1]["name"]], ["outside", "inside"]);
    for row in &rows {
        let has_budget = ["budget", "first-misfit"].contains(&row.text("method"));
        assert_eq!(!row.text("triangle_budget").is_empty(), has_budget, "{row:?}");
    }
    let visibility = &summary["paths"][0]["methods"][1];
    // Most of a plant is inside: what is drawn is a fraction, and hardly anything is missing even after so few rays.
    let frustum = &summary["paths"][0]["methods"][0];
    let median = |method: &Value, figure: &str| method[figure]["median"].as_f64().expect("a number");
    assert!(median(visibility, "triangles") * 3.0 < median(frustum, "triangles"), "{visibility}");
    assert!(visibility["ssim"]["worst"].as_f64() > Some(0.9), "{visibility}");
    assert!(visibility["speedup_over_frustum"].as_f64() > Some(1.0), "{visibility}");
}

#[test]
fn a_budget_in_milliseconds_is_learnt() {
    let folder = folder();
    let report = folder.path().join("report");
    let scene = baked(&small(&folder), &folder);
    let (summary, rows) = evaluate(
        &scene,
        &report,
        &[
            "--frames",
            "3",
            "--budget",
            "1000ms",
            "--tour",
            "outside",
            "--methods",
            "nothing,frustum,visibility,exact",
        ],
    );
    check(&summary, &rows, &report, 3);
    let cost = &summary["cost_model"];
    // Two lessons a frame, and two passes.
    assert_eq!(cost["frames_learnt"], 3 * 2 + 3 * 2, "{cost}");
    assert!(cost["relative_error"].as_f64() >= Some(0.0), "{cost}");
    // A second is enough for everything.
    let of = |name: &str| {
        rows.iter()
            .filter(|row| row.text("method") == name)
            .map(|row| row.number("triangles"))
            .collect::<Vec<_>>()
    };
    assert_eq!(of("budget"), of("visibility"));
    assert!(of("nothing").iter().zip(of("frustum")).all(|(all, seen)| *all >= seen));
}

#[test]
fn a_recorded_path_of_a_file_without_a_bake() {
    let folder = folder();
    let (report, path) = (folder.path().join("report"), folder.path().join("my tour.json"));
    let poses = r#"{"version":1,"poses":[{"eye":[30,5,0],"forward":[-1,0,0]},{"eye":[20,5,20],"forward":[-1,0,-1]}]}"#;
    std::fs::write(&path, poses).expect("a file");
    let scene = small(&folder);
    let arguments = ["--frames", "2", "--path", path.to_str().expect("UTF-8")];
    let (summary, rows) = evaluate(&scene, &report, &arguments);
    check(&summary, &rows, &report, 2);
    assert_eq!(summary["paths"][0]["name"], "my tour");
    assert_eq!(summary["baked"], false);
    assert!(summary["notice"].as_str().is_some_and(|notice| notice.contains("svs build")), "{summary}");
    for pair in rows.chunks(3) {
        assert_eq!(pair[0].number("draws"), pair[1].number("draws"), "visibility is frustum culling here");
    }
    // The same again, for people.
    let (stdout, stderr) = succeeds(&[
        "evaluate".as_ref(),
        scene.as_os_str(),
        "-o".as_ref(),
        report.as_os_str(),
        "--frames=1".as_ref(),
        "--passes=1".as_ref(),
        "--size=64x36".as_ref(),
        "--tour=inside".as_ref(),
    ]);
    assert!(stderr.contains("note: ") && stderr.contains("svs build"), "{stderr}");
    for word in ["inside", "visibility", "frame ms", "report.html written"] {
        assert!(stdout.contains(word), "{word}: {stdout}");
    }
}

#[test]
fn an_engine_made_by_others() {
    let scenes = std::env::var_os("SVS_SCENES").map_or_else(|| root().join("../shared/scenes"), Into::into);
    let scene = scenes.join("two-cylinder-engine/2CylinderEngine.glb");
    if !scene.is_file() {
        eprintln!("SKIPPED: there is no {}", scene.display());
        return;
    }
    let folder = folder();
    let report = folder.path().join("report");
    let (summary, rows) = evaluate(&baked(&scene, &folder), &report, &["--frames", "4", "--tour", "outside"]);
    check(&summary, &rows, &report, 4);
    assert!(summary["methods"][1]["ssim"]["worst"].as_f64() > Some(0.9), "{summary}");
}
