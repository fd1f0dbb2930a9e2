//! A scene of a quarter of a million objects and of triangles that no frame could draw, in full view, within a budget.

use super::{Bench, DEFAULT, Options};
use crate::bench::at;
use crate::table::{count, markdown, short};
use serde_json::{Value, json};

/// The scene and how many of it: 258,150 objects and 269 million triangles.
const GRID: (&str, u32) = ("lego-millennium-falcon", 50);

/// Most triangles of a frame.
const BUDGET: &str = "1000000";

pub(super) fn run(options: &Options, bench: &Bench, failed: &mut Vec<String>) -> (Value, String) {
    let (name, copies) = GRID;
    if !options.wants(name) {
        return (Value::Null, String::new());
    }
    let summary = match measure(options, bench) {
        Ok(summary) => summary,
        Err(error) => {
            failed.push(format!("{copies} x {name}: {error}"));
            return (Value::Null, String::new());
        }
    };
    let methods = summary["methods"].as_array().into_iter().flatten();
    let rows: Vec<Vec<String>> = methods
        .map(|method| {
            vec![
                method["method"].as_str().unwrap_or_default().to_owned(),
                count(at(method, "/triangles/worst")),
                count(at(method, "/draws/median")),
                count(at(method, "/proxies/median")),
                short(at(method, "/cull_us/median") / 1e3),
                short(at(method, "/frame_ms/median")),
                format!("{:.4}", at(method, "/ssim/worst")),
                format!("{:.1}", at(method, "/psnr_y/worst")),
                count(at(method, "/largest_hole/worst")),
            ]
        })
        .collect();
    let mut text = format!(
        "\n{copies} x {name}, whole from outside, 1280x720: {} objects, {} triangles, {} MB on the GPU; at most {} triangles a \
         frame:\n\n",
        count(at(&summary, "/objects")),
        count(at(&summary, "/triangles")),
        count(at(&summary, "/gpu_bytes") / 1e6),
        count(BUDGET.parse().unwrap_or(f64::NAN)),
    );
    text += &markdown(
        &[
            "method",
            "triangles, most",
            "drawn",
            "proxies",
            "choosing, ms",
            "frame, ms",
            "worst SSIM",
            "worst PSNR Y, dB",
            "largest hole, px",
        ],
        &rows,
    );
    (json!(summary), text)
}

fn measure(options: &Options, bench: &Bench) -> Result<Value, String> {
    let (name, copies) = GRID;
    let scene = bench.bake(&bench.grid(name, copies)?, "auto", DEFAULT)?;
    let arguments = [
        "--methods",
        "budget,proxies",
        "--budget",
        BUDGET,
        "--detail",
        "0",
        "--tour",
        "outside",
        "--passes",
        "1",
        "--size",
        "1280x720",
        "--frames",
        options.frames("1"),
    ];
    Ok(bench.evaluate(&scene, "large", &arguments)?.0)
}
