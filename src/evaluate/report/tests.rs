//! The report of a made-up evaluation.

use crate::evaluate::machine::Machine;
use crate::evaluate::method::EvaluationMethod;
use crate::evaluate::options::EvaluateOptions;
use crate::evaluate::result::*;
use svs_render::Image;

const NASTY: &str = "<script>alert(\"1\")</script> & 'x', y";

fn frame(frame: usize, method: EvaluationMethod) -> FrameResult {
    let slow = if method == EvaluationMethod::Frustum { 4.0 } else { 1.0 };
    let missing = if method == EvaluationMethod::Visibility { frame } else { 0 };
    let ms = slow * (10.0 + frame as f64);
    FrameResult {
        frame,
        method,
        time: TimeResult {
            cull_us: 12.5,
            frame_ms: ms,
            frame_ms_least: ms * 0.9,
            frame_ms_most: ms * 1.2,
            cpu_ms: 1.0,
            gpu_ms: (method == EvaluationMethod::Frustum).then_some(2.0),
            wall_ms: ms - 0.0125,
        },
        draws: 100 * slow as usize,
        draw_calls: 10,
        triangles: 1000 * slow as u64,
        triangle_budget: None,
        simplified: Simplified { proxies: 4, levels: 2, nodes: 9 },
        quality: QualityResult {
            visible_objects: 50,
            missing_objects: missing,
            missing_ppm: missing as f64 * 2.0,
            overdrawn_objects: 3,
            largest_hole: missing,
            largest_missing: missing,
            ssim: 1.0 - missing as f64 * 1e-4,
            psnr_y: 120.0 - missing as f64,
            psnr_cb: 120.0,
            psnr_cr: 120.0,
        },
    }
}

fn evaluation() -> Evaluation {
    let options = EvaluateOptions::default();
    let frames: Vec<FrameResult> =
        (0..5).flat_map(|at| options.methods.iter().map(move |&method| frame(at, method))).collect();
    let all: Vec<&FrameResult> = frames.iter().collect();
    let methods = MethodSummary::all(&options, &all);
    let image = Image { width: 32, height: 20, rgba: vec![90; 32 * 20 * 4] };
    let worst = WorstFrame {
        method: EvaluationMethod::Visibility,
        frame: 4,
        quality: frame(4, EvaluationMethod::Visibility).quality,
        reference: image.clone(),
        picture: image,
        missing: (0..32 * 20).map(|at| at == 70).collect(),
        largest: vec![MissingObject { object: 7, name: Some(NASTY.to_owned()), pixels: 1 }],
    };
    let path =
        PathEvaluation { name: NASTY.to_owned(), methods: methods.clone(), frames, worst: vec![worst] };
    let text = |text: &str| text.to_owned();
    Evaluation {
        scene: NASTY.to_owned(),
        methods,
        paths: vec![path],
        objects: 123,
        triangles: 4567,
        file_bytes: Some(8901),
        gpu_bytes: 23_456,
        baked: true,
        notice: Some(NASTY.to_owned()),
        settings: Settings {
            width: 32,
            height: 20,
            frames: 5,
            passes: 3,
            quality: None,
            query: text("q"),
            budget: None,
            detail_px: 1.0,
            metric: text("sse"),
            reference: text("frustum"),
            time_source: TimeSource::WallClock,
        },
        machine: Machine {
            cpu: text("cpu"),
            cores: 2,
            system: text("linux"),
            adapter: text(NASTY),
            adapter_kind: text("software"),
            backend: text("vulkan"),
            driver: text("d"),
            version: text("0"),
        },
        cost_model: None,
    }
}

#[test]
fn the_page_is_whole_and_escapes_names() {
    let html = evaluation().html();
    assert!(!html.contains("<script") && !html.contains("NaN"), "{html}");
    assert!(html.contains("&lt;script&gt;alert(&quot;1&quot;)&lt;/script&gt; &amp; &#39;x&#39;, y"));
    assert_eq!(html.matches("data:image/png;base64,").count(), 3);
    for resource in ["http://", "https://", "<link", "url(", "<iframe"] {
        assert!(!html.contains(resource), "{resource}");
    }
    for element in ["svg", "div", "table", "figure", "p", "h2", "tr", "td", "text", "ul", "li"] {
        let begin =
            html.matches(&format!("<{element}>")).count() + html.matches(&format!("<{element} ")).count();
        assert_eq!(begin, html.matches(&format!("</{element}>")).count(), "{element}");
    }
    // Four plots and the legend's three lines.
    assert_eq!(html.matches("<svg").count(), 4 + 3);
}

#[test]
fn the_table_has_a_row_per_frame_and_method() {
    let csv = evaluation().csv();
    let lines: Vec<Vec<String>> = csv.lines().map(fields).collect();
    assert_eq!(lines.len(), 1 + 5 * 3);
    let column = |name: &str| lines[0].iter().position(|field| field == name).expect(name);
    for line in &lines[1..] {
        assert_eq!(line.len(), lines[0].len(), "{line:?}");
        assert_eq!(line[0], NASTY);
        for name in ["frame", "cull_us", "frame_ms", "triangles", "missing_ppm", "ssim", "psnr_cr_db"] {
            assert!(line[column(name)].parse::<f64>().is_ok_and(f64::is_finite), "{name}: {line:?}");
        }
        assert_eq!(line[column("gpu_ms")].is_empty(), line[column("method")] != "frustum");
        assert_eq!(line[column("triangle_budget")], "");
    }
    assert_eq!(lines[2][column("method")], "visibility");
    assert_eq!(lines[14][column("ssim")], "0.9996000");
}

/// Fields of a line, by RFC 4180.
fn fields(line: &str) -> Vec<String> {
    let (mut fields, mut quoted) = (vec![String::new()], false);
    let mut chars = line.chars().peekable();
    while let Some(c) = chars.next() {
        let field = fields.last_mut().expect("a field");
        match c {
            '"' if quoted && chars.next_if_eq(&'"').is_some() => field.push('"'),
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(String::new()),
            c => field.push(c),
        }
    }
    fields
}

#[test]
fn the_summary_has_its_form() {
    let json = evaluation().summary();
    let methods = json["methods"].as_array().expect("methods");
    assert_eq!(methods.len(), 3);
    assert_eq!(json["scene"], NASTY);
    for method in methods.iter().chain(json["paths"][0]["methods"].as_array().expect("methods")) {
        for figure in ["frame_ms", "cull_us", "draws", "triangles", "missing_ppm"] {
            for key in ["median", "p95", "p99", "worst"] {
                assert!(method[figure][key].is_f64(), "{figure} {key}: {method}");
            }
        }
        for figure in ["ssim", "psnr_y", "psnr_cb", "psnr_cr"] {
            assert!(
                method[figure]["median"].is_f64() && method[figure]["worst"].is_f64(),
                "{figure}: {method}"
            );
        }
    }
    assert_eq!(methods[1]["speedup_over_frustum"], 4.0);
    assert_eq!(methods[0]["frame_ms"]["median"], 48.0);
    assert_eq!(methods[0]["gpu_ms"]["worst"], 2.0);
    assert!(methods[1]["gpu_ms"].is_null());
    assert_eq!(methods[1]["ssim"]["worst"], 0.9996);
    assert!(json["paths"][0].get("frames").is_none());
}

#[test]
fn a_report_is_written_whole_or_not_at_all() {
    let evaluation = evaluation();
    let place = tempfile::tempdir().expect("a folder");
    let folder = place.path().join("report");
    let names = |folder: &std::path::Path| {
        let mut names: Vec<String> = std::fs::read_dir(folder)
            .expect("a folder")
            .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    };
    evaluation.write(&folder).expect("a new folder");
    assert_eq!(names(&folder), ["frames.csv", "report.html", "summary.json"]);
    assert_eq!(names(place.path()), ["report"]);
    std::fs::write(folder.join("mine.txt"), "mine").expect("a file");
    std::fs::write(folder.join("frames.csv"), "old").expect("a file");
    evaluation.write(&folder).expect("an old folder");
    assert_eq!(names(&folder), ["frames.csv", "mine.txt", "report.html", "summary.json"]);
    assert_eq!(std::fs::read_to_string(folder.join("frames.csv")).expect("a file"), evaluation.csv());

    let nowhere = place.path().join("no/where");
    let error = evaluation.write(&nowhere).expect_err("no folder above").to_string();
    assert!(error.contains("cannot write") && error.contains("where"), "{error}");
    let file = folder.join("mine.txt");
    assert!(evaluation.write(&file).is_err());
    assert_eq!(std::fs::read_to_string(file).expect("a file"), "mine");
}
