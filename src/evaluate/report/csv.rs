//! `frames.csv`: every frame with every method, comma-separated (RFC 4180), numbers with a point, units in the names.

use crate::evaluate::result::{Evaluation, FrameResult};
use std::borrow::Cow;
use std::fmt::Write as _;

const COLUMNS: [&str; 29] = [
    "path",
    "frame",
    "method",
    "cull_us",
    "frame_ms",
    "frame_ms_least",
    "frame_ms_most",
    "cpu_ms",
    "gpu_ms",
    "wall_ms",
    "draws",
    "draw_calls",
    "triangles",
    "triangle_budget",
    "proxies",
    "levels",
    "hlod_nodes",
    "visible_objects",
    "missing_objects",
    "missing_ppm",
    "overdrawn_objects",
    "largest_hole_px",
    "largest_missing_px",
    "ssim",
    "psnr_y_db",
    "psnr_cb_db",
    "psnr_cr_db",
    "width",
    "height",
];

pub(super) fn table(evaluation: &Evaluation) -> String {
    let mut text = COLUMNS.join(",");
    text.push('\n');
    for path in &evaluation.paths {
        for frame in &path.frames {
            let size = (evaluation.settings.width, evaluation.settings.height);
            row(&mut text, &path.name, frame, size);
        }
    }
    text
}

fn row(text: &mut String, path: &str, frame: &FrameResult, (width, height): (u32, u32)) {
    let FrameResult { time, quality, .. } = frame;
    let optional = |value: Option<String>| value.unwrap_or_default();
    // Writing to a string cannot fail.
    let _ = writeln!(
        text,
        "{},{},{},{:.1},{:.4},{:.4},{:.4},{:.4},{},{:.4},{},{},{},{},{},{},{},{},{},{:.2},{},{},{},{:.7},{:.3},{:.3},{:.3},{width},{height}",
        field(path),
        frame.frame,
        frame.method,
        time.cull_us,
        time.frame_ms,
        time.frame_ms_least,
        time.frame_ms_most,
        time.cpu_ms,
        optional(time.gpu_ms.map(|ms| format!("{ms:.4}"))),
        time.wall_ms,
        frame.draws,
        frame.draw_calls,
        frame.triangles,
        optional(frame.triangle_budget.map(|most| most.to_string())),
        frame.simplified.proxies,
        frame.simplified.levels,
        frame.simplified.nodes,
        quality.visible_objects,
        quality.missing_objects,
        quality.missing_ppm,
        quality.overdrawn_objects,
        quality.largest_hole,
        quality.largest_missing,
        quality.ssim,
        quality.psnr_y,
        quality.psnr_cb,
        quality.psnr_cr,
    );
}

/// A text as one field.
fn field(text: &str) -> Cow<'_, str> {
    if text.contains([',', '"', '\n', '\r']) {
        Cow::Owned(format!("\"{}\"", text.replace('"', "\"\"")))
    } else {
        Cow::Borrowed(text)
    }
}
