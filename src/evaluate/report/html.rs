//! `report.html`: one file, no scripts, no other resources.

use super::simplified;
use super::style::{CSS, look};
use super::svg::{Plot, Scale, Series, escape};
use super::worst;
use crate::evaluate::method::EvaluationMethod;
use crate::evaluate::metrics::MAX_PSNR;
use crate::evaluate::result::{Evaluation, FrameResult, MethodSummary, PathEvaluation};
use std::fmt::Write as _;

pub(super) fn page(evaluation: &Evaluation) -> String {
    let title = escape(&evaluation.scene);
    let mut html = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n\
         <title>{title}: evaluation</title>\n<style>\n{CSS}</style></head><body>\n<h1>{title}</h1>\n"
    );
    html += "<p>What spherical visibility gains on camera paths, and what it costs in the picture.</p>\n";
    if let Some(notice) = &evaluation.notice {
        let _ = writeln!(html, "<p class=\"note\">{}</p>", escape(notice));
    }
    html += &findings(evaluation);
    html += "<h2>All paths</h2>\n";
    html += &table(&evaluation.methods);
    html += &simplified::table(&evaluation.methods);
    let methods = methods(&evaluation.methods);
    for path in &evaluation.paths {
        let _ = writeln!(html, "<h2>Path “{}”</h2>", escape(&path.name));
        if evaluation.paths.len() > 1 {
            html += &table(&path.methods);
            html += &simplified::table(&path.methods);
        }
        html += &legend(&methods);
        html += &plots(path, &methods);
        if path.worst.is_empty() {
            html += "<p>No picture differs from the reference.</p>\n";
        }
        for frame in &path.worst {
            html += &worst::section(frame);
        }
    }
    html += "<h2>Measured how</h2>\n";
    html += &facts(evaluation);
    html += &explanation(evaluation);
    html += "</body></html>\n";
    html
}

/// One sentence per path and method that is not a reference.
fn findings(evaluation: &Evaluation) -> String {
    let mut html = String::from("<ul>\n");
    for path in &evaluation.paths {
        for method in &path.methods {
            // What exact would gain is in the tables: it is no method that one could use.
            let is_usable = !["frustum", "exact"].contains(&method.method.as_str());
            let Some(speedup) = method.speedup_over_frustum.filter(|_| is_usable) else { continue };
            let share = path.methods.iter().find(|m| m.method == "frustum").map(|frustum| {
                let share = method.triangles.median / frustum.triangles.median.max(1.0) * 100.0;
                format!(" and {} % of the triangles", three(share))
            });
            let _ = writeln!(
                html,
                "<li>{}, <b>{}</b>: {} ms a frame (median), <b>{} × frustum culling’s speed</b>{}; worst SSIM {:.6}, \
                 missing pixels {} ppm median, {} ppm worst.</li>",
                escape(&path.name),
                escape(&method.method),
                three(method.frame_ms.median),
                three(speedup),
                share.unwrap_or_default(),
                method.ssim.worst,
                three(method.missing_ppm.median),
                three(method.missing_ppm.worst),
            );
        }
    }
    html + "</ul>\n"
}

fn methods(summaries: &[MethodSummary]) -> Vec<EvaluationMethod> {
    summaries.iter().filter_map(|summary| summary.method.parse().ok()).collect()
}

fn table(methods: &[MethodSummary]) -> String {
    let mut html = String::from(
        "<div class=\"wide\"><table><thead><tr><th rowspan=\"2\">method</th><th colspan=\"4\">frame, ms</th>\
         <th rowspan=\"2\">× frustum’s<br>speed</th><th rowspan=\"2\">culling,<br>µs</th><th rowspan=\"2\">objects<br>drawn</th>\
         <th rowspan=\"2\">draw<br>calls</th><th rowspan=\"2\">triangles</th><th colspan=\"2\">missing, ppm</th>\
         <th colspan=\"2\">SSIM</th><th colspan=\"2\">PSNR Y, dB</th></tr>\n<tr><th>median</th><th>p95</th><th>p99</th>\
         <th>worst</th><th>median</th><th>worst</th><th>median</th><th>worst</th><th>median</th>\
         <th>worst</th></tr></thead><tbody>\n",
    );
    for method in methods {
        let mut cells = vec![escape(&method.method)];
        let frame = &method.frame_ms;
        cells.extend([frame.median, frame.p95, frame.p99, frame.worst].map(three));
        cells.push(method.speedup_over_frustum.map_or_else(|| "–".to_owned(), three));
        cells.push(three(method.cull_us.median));
        cells.extend([method.draws, method.draw_calls, method.triangles].map(|f| grouped(f.median)));
        cells.extend([method.missing_ppm.median, method.missing_ppm.worst].map(three));
        cells.extend([method.ssim.median, method.ssim.worst].map(|value| format!("{value:.6}")));
        cells.extend([method.psnr_y.median, method.psnr_y.worst].map(decibels));
        let cells: Vec<String> = cells.into_iter().map(|cell| format!("<td>{cell}</td>")).collect();
        let _ = writeln!(html, "<tr>{}</tr>", cells.concat());
    }
    html + "</tbody></table></div>\n<p class=\"quiet\">Culling, objects, draw calls and triangles are medians.</p>\n"
}

fn legend(methods: &[EvaluationMethod]) -> String {
    let mut html = String::from("<div class=\"legend\">");
    for &method in methods {
        let look = look(method);
        let _ = write!(
            html,
            "<span><svg viewBox=\"0 0 38 12\" aria-hidden=\"true\"><line x1=\"0\" y1=\"6\" x2=\"38\" y2=\"6\" stroke=\"{}\" \
             stroke-width=\"3\" stroke-dasharray=\"{}\"/></svg>{}</span>",
            look.color,
            if look.dashes.is_empty() { "none" } else { look.dashes },
            method,
        );
    }
    html + "</div>\n"
}

fn plots(path: &PathEvaluation, methods: &[EvaluationMethod]) -> String {
    let plot = |title: &str, methods: &[EvaluationMethod], scale: Scale, of: &dyn Fn(&FrameResult) -> f64| {
        let line = |&method: &EvaluationMethod| Series {
            name: method.name().to_owned(),
            look: look(method),
            values: path.frames_of(method).map(of).collect(),
        };
        Plot { title: title.to_owned(), series: methods.iter().map(line).collect(), scale }
    };
    let time = |frame: &FrameResult| frame.time.frame_ms;
    let triangles = |frame: &FrameResult| frame.triangles as f64;
    let missing = |frame: &FrameResult| frame.quality.missing_ppm;
    let likeness = |frame: &FrameResult| frame.quality.ssim;
    // A budget leaves out so much that nothing else could be read off the same axis.
    let has_budget = path.frames.iter().any(|frame| frame.triangle_budget.is_some());
    let is_limited =
        |method: &EvaluationMethod| method.is_budgeted() || (has_budget && method.draws_proxies().is_some());
    let (budgeted, free): (Vec<_>, Vec<_>) = methods.iter().copied().partition(is_limited);
    let mut plots = vec![
        plot("Frame time, ms", methods, wide(path, &time), &time),
        plot("Triangles drawn", methods, wide(path, &triangles), &triangles),
    ];
    for (methods, note) in [(free, ""), (budgeted, ", within the budget")] {
        if !methods.is_empty() {
            plots.push(plot(&format!("Missing pixels, ppm{note}"), &methods, Scale::FromZero, &missing));
            plots.push(plot(&format!("SSIM, 1 is equal{note}"), &methods, Scale::UpTo(1.0), &likeness));
        }
    }
    let mut html = String::from("<div class=\"plots\">\n");
    for plot in plots {
        let _ = writeln!(html, "<div>{}</div>", plot.svg());
    }
    html + "</div>\n"
}

/// A logarithmic axis where a linear one would press some method flat.
fn wide(path: &PathEvaluation, of: &dyn Fn(&FrameResult) -> f64) -> Scale {
    let values = || path.frames.iter().map(of).filter(|value| *value > 0.0);
    let (least, most) = (values().fold(f64::INFINITY, f64::min), values().fold(0.0, f64::max));
    if most > least * MOST_LINEAR { Scale::Logarithmic } else { Scale::FromZero }
}

/// Largest over smallest value that a linear axis still shows.
const MOST_LINEAR: f64 = 30.0;

fn facts(evaluation: &Evaluation) -> String {
    let (machine, settings) = (&evaluation.machine, &evaluation.settings);
    let size =
        evaluation.file_bytes.map_or_else(String::new, |bytes| format!(", {} bytes", grouped(bytes as f64)));
    let mut rows = vec![
        (
            "scene",
            format!(
                "{}{size}; {} objects, {} triangles, {} bytes on the GPU; {}",
                evaluation.scene,
                grouped(evaluation.objects as f64),
                grouped(evaluation.triangles as f64),
                grouped(evaluation.gpu_bytes as f64),
                if evaluation.baked { "baked" } else { "no baked visibility in use" },
            ),
        ),
        (
            "pictures",
            format!(
                "{} × {} pixels, {} frames a path, each timed {} times with each method",
                settings.width, settings.height, settings.frames, settings.passes
            ),
        ),
        (
            "quality",
            match settings.quality {
                Some(quality) => format!("{quality} ({})", settings.query),
                None => format!("as the file recommends, else the default ({})", settings.query),
            },
        ),
        ("frame time", settings.time_source.text().to_owned()),
        ("processor", format!("{}, {} threads, {}", machine.cpu, machine.cores, machine.system)),
        (
            "graphics",
            format!(
                "{} ({}), {}, driver {}",
                machine.adapter, machine.adapter_kind, machine.backend, machine.driver
            ),
        ),
        ("program", format!("svs {}", machine.version)),
    ];
    if evaluation.methods.iter().any(|method| method.method.starts_with("proxies")) {
        rows.push(("detail", format!("{} px, metric {}", settings.detail_px, settings.metric)));
    }
    if settings.reference != EvaluationMethod::Frustum.name() {
        rows.push(("pictures are compared with", settings.reference.clone()));
    }
    if let Some(budget) = &settings.budget {
        rows.push(("budget", budget.clone()));
    }
    if let Some(cost) = &evaluation.cost_model {
        rows.push((
            "cost model",
            format!(
                "median error of its predictions {} % after {} frames; {} % of the frames took longer than {} ms",
                three(cost.relative_error * 100.0),
                cost.frames_learnt,
                three(cost.share_over_budget * 100.0),
                cost.budget_ms,
            ),
        ));
    }
    let spread = evaluation.methods.iter().map(|method| {
        format!(
            "{} {} % (median), {} % (worst)",
            method.method,
            three(method.frame_ms_spread.median * 100.0),
            three(method.frame_ms_spread.worst * 100.0)
        )
    });
    rows.push(("spread of passes", spread.collect::<Vec<_>>().join("; ")));
    let mut html = String::from("<div class=\"wide\"><table class=\"facts\">\n");
    for (name, value) in rows {
        let _ = writeln!(html, "<tr><th scope=\"row\">{name}</th><td>{}</td></tr>", escape(&value));
    }
    html + "</table></div>\n"
}

fn explanation(evaluation: &Evaluation) -> String {
    let mut html = format!(
        "<p>All methods draw with the same renderer into the same offscreen picture; there is no display to wait for. In each \
         pass each frame is drawn with one method after the other, beginning with another one each time, after a warm-up \
         that is not counted. The time of a frame is the median over the passes; medians, percentiles (nearest rank) \
         and worst are over frames; nothing is smoothed or left out. Frame time = culling + drawing on the CPU + \
         the GPU’s time, one after the other; here by the {}.</p>\n\
         <p>The reference is the picture with frustum culling. An object is missing if at least one pixel of the reference’s \
         item buffer (nearest opaque and nearest transparent object) shows it and the method does not draw it; missing ppm are \
         the pixels that show missing objects, per million pixels. SSIM: Wang et al. 2004 on BT.709 luma, 11 × 11 Gaussian \
         window, mean over an image pyramid down to 11 pixels. PSNR: Y’CbCr of BT.709; equal pictures count as \
         {MAX_PSNR} dB. Pictures of a draw list equal to the reference’s are not drawn a second time.</p>\n",
        evaluation.settings.time_source.text(),
    );
    let has = |method: EvaluationMethod| evaluation.methods.iter().any(|m| m.method == method.name());
    if has(EvaluationMethod::Exact) {
        html += "<p><b>exact</b> draws the objects in the item buffer and nothing else. Finding them is not part of its time: \
                 it is what perfect occlusion culling could reach at no cost.</p>\n";
    }
    if has(EvaluationMethod::Budget) {
        html += "<p><b>budget</b> is visibility with the runtime’s choice within the budget.</p>\n";
    }
    if evaluation.methods.iter().any(|m| m.method.starts_with("proxies")) {
        html += "<p><b>proxies</b> is visibility with simplified objects and proxies of groups, where their error stays below \
                 the detail in pixels, or the budget asks for it; <b>proxies-sse</b> and <b>proxies-linear</b> are the same with \
                 another metric, and <b>proxies-frustum</b> without visibility. An object is not missing if something that \
                 stands for it is drawn. HLOD nodes are the proxies drawn and the innermost proxy nodes of which objects \
                 are drawn themselves. The largest hole is the largest region of pixels (neighbours share an edge) where \
                 the reference shows an object and the picture shows nothing; the largest missing is the largest region that \
                 shows missing objects in the reference.</p>\n";
    }
    if has(EvaluationMethod::FirstMisfit) {
        html += "<p><b>first-misfit</b> is the rule of Eikel’s dissertation (2013) on the same candidates and values: most \
                 visible pixels per triangle first, up to the first object that does not fit.</p>\n";
    }
    html
}

/// Three digits that count.
fn three(value: f64) -> String {
    let size = value.abs();
    if size >= 99.95 {
        grouped(value)
    } else if size >= 9.995 {
        format!("{value:.1}")
    } else if size >= 0.0995 || size == 0.0 {
        format!("{value:.2}")
    } else {
        format!("{value:.2e}")
    }
}

pub(super) fn decibels(value: f64) -> String {
    if value >= MAX_PSNR { "equal".to_owned() } else { format!("{value:.1}") }
}

/// A whole number with narrow no-break spaces between thousands.
pub(super) fn grouped(value: f64) -> String {
    let digits = (value.max(0.0).round() as u64).to_string();
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}
