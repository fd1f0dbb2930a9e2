//! Reports of a file with proxies.

use crate::{Row, evaluate, folder, handmade, succeeds};
use std::path::PathBuf;
use tempfile::TempDir;

fn balls(folder: &TempDir) -> PathBuf {
    let path = folder.path().join("balls.glb");
    handmade::document().write(&path).expect("a file");
    path
}

fn of<'a>(rows: &'a [Row], method: &'a str) -> impl Iterator<Item = &'a Row> {
    rows.iter().filter(move |row| row.text("method") == method)
}

#[test]
fn proxies_are_measured_beside_the_rest() {
    let folder = folder();
    let report = folder.path().join("report");
    let scene = balls(&folder);
    let more = ["--frames", "3", "--tour", "outside", "--proxies", "on", "--detail", "4", "--metric", "sse"];
    let (summary, rows) = evaluate(&scene, &report, &more);
    assert_eq!(summary["notice"], serde_json::Value::Null);
    assert_eq!(
        (&summary["settings"]["detail_px"], &summary["settings"]["metric"]),
        (&4.0.into(), &"sse".into())
    );
    for (row, frustum) in of(&rows, "proxies").zip(of(&rows, "frustum")) {
        assert!(row.number("proxies") + row.number("levels") > 0.0, "{row:?}");
        assert!((1.0..=3.0).contains(&row.number("hlod_nodes")), "{row:?}");
        assert!(row.number("triangles") < frustum.number("triangles"), "{row:?}");
        assert_eq!((row.number("missing_objects"), row.number("largest_missing_px")), (0.0, 0.0), "{row:?}");
        assert!(row.number("largest_hole_px") < 64.0 && row.number("ssim") > 0.8, "{row:?}");
    }
    for method in ["frustum", "exact"] {
        assert!(
            of(&rows, method).all(|row| row.number("proxies") == 0.0 && row.number("largest_hole_px") == 0.0)
        );
    }
    assert!(summary["methods"][3]["nodes"]["median"].as_f64() > Some(0.0));
    let page = std::fs::read_to_string(report.join("report.html")).expect("a page");
    assert!(page.contains("HLOD") && page.contains("largest hole"));
}

#[test]
fn budgets_hold_for_proxies_and_pictures_may_have_another_reference() {
    let folder = folder();
    let report = folder.path().join("report");
    let scene = balls(&folder);
    let methods = "budget,proxies,proxies-sse,proxies-linear,proxies-frustum";
    let more = ["--frames", "2", "--tour", "outside", "--budget", "4000", "--methods", methods];
    let (_, rows) = evaluate(&scene, &report, &[&more[..], &["--reference", "proxies-sse"]].concat());
    assert!(of(&rows, "proxies-sse").all(|row| row.number("ssim") == 1.0));
    // Dropping objects, something has to be missing; less is where there are simplified ones.
    let missing = of(&rows, "budget").map(|row| row.number("missing_ppm")).fold(f64::INFINITY, f64::min);
    assert!(missing > 0.0);
    for row in rows.iter().filter(|row| row.text("method").starts_with("proxies")) {
        assert!(row.number("triangles") <= 4000.0 && row.number("triangle_budget") == 4000.0, "{row:?}");
        assert!(row.number("missing_ppm") < missing, "{row:?}: {missing}");
    }
}

#[test]
fn a_file_without_proxies_says_so() {
    let folder = folder();
    let report = folder.path().join("report");
    let scene = crate::small(&folder);
    let more = ["--frames", "1", "--tour", "outside", "--methods", "proxies"];
    let (summary, _) = evaluate(&scene, &report, &more);
    assert!(
        summary["notice"].as_str().is_some_and(|notice| notice.contains("no proxies")),
        "{}",
        summary["notice"]
    );
    let (_, stderr) = succeeds(&[
        "evaluate".as_ref(),
        scene.as_os_str(),
        "-o".as_ref(),
        report.as_os_str(),
        "--methods".as_ref(),
        "proxies".as_ref(),
        "--frames".as_ref(),
        "1".as_ref(),
        "--tour".as_ref(),
        "inspection".as_ref(),
        "--size".as_ref(),
        "64x48".as_ref(),
    ]);
    assert!(stderr.contains("note:"), "{stderr}");
}
