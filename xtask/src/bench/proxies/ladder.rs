//! What a picture is worth within ever smaller budgets: by dropping objects, with proxies but without visibility, and with
//! both.

use super::rows::{Row, column};
use super::{Bench, DEFAULT, Options};
use crate::bench::{at, folder, save};
use crate::table::{count, markdown, median};
use serde_json::{Value, json};

const SCENES: [&str; 6] = [
    "lego-millennium-falcon",
    "lhcb-detector",
    "atlas-detector",
    "medical-clinic",
    "linz-city",
    "black-forest",
];

/// Percent of the scene's triangles.
const SHARES: [u32; 6] = [50, 25, 10, 5, 2, 1];

/// The ways, and the methods of `svs evaluate` behind them.
const WAYS: [(&str, &str); 3] =
    [("budget", "dropping"), ("proxies-frustum", "proxies alone"), ("proxies", "proxies and visibility")];

/// What a way reaches: medians over the frames but for the hole.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Outcome {
    ssim: f64,
    psnr: f64,
    /// Largest of all frames, pixels.
    hole: f64,
}

impl Outcome {
    fn of(rows: &[Row], method: &str) -> Self {
        let of = |name: &str| column(rows, method, name);
        Self {
            ssim: median(of("ssim").into_iter()),
            psnr: median(of("psnr_y_db").into_iter()),
            hole: of("largest_hole_px").into_iter().fold(0.0, f64::max),
        }
    }
}

pub(super) fn run(options: &Options, bench: &Bench, failed: &mut Vec<String>) -> (Value, String) {
    let (mut results, mut rows) = (Vec::new(), Vec::new());
    for scene in SCENES.iter().filter(|scene| options.wants(scene)) {
        match measure(options, bench, scene) {
            Ok(steps) => {
                rows.extend(steps.iter().map(|(share, ways)| row(scene, *share, ways)));
                results.extend(steps.iter().map(|(share, ways)| to_json(scene, *share, ways)));
            }
            Err(error) => failed.push(format!("{scene}: {error}")),
        }
        // A long part: an interrupted run loses nothing.
        if let Ok(folder) = folder("proxies") {
            let _ = save(&folder.join("ladder.json"), &json!(results));
        }
    }
    let mut text = String::from(
        "\nBudgets in percent of the scene's triangles; medians over the frames, cameras outside and inside; the largest hole of \
         all frames in pixels:\n\n",
    );
    let mut head = vec!["scene, budget".to_owned()];
    for figure in ["SSIM", "PSNR Y, dB", "largest hole, px"] {
        head.extend(WAYS.iter().map(|(_, way)| format!("{figure}: {way}")));
    }
    head.push("best".to_owned());
    text += &markdown(&head.iter().map(String::as_str).collect::<Vec<_>>(), &rows);
    let best = rows.iter().filter(|row| row.last().is_some_and(|last| last == "yes")).count();
    text += &format!("\nProxies and visibility are best (SSIM and PSNR) in {best} of {} rows.\n", rows.len());
    (json!(results), text)
}

type Step = (u32, [Outcome; 3]);

fn measure(options: &Options, bench: &Bench, name: &str) -> Result<Vec<Step>, String> {
    let scene = bench.public(name)?;
    let (visible, all) = (bench.bake(scene, "auto", DEFAULT)?, bench.bake(scene, "all", DEFAULT)?);
    let mut steps = Vec::new();
    let mut triangles = None;
    for share in SHARES {
        let full = match triangles {
            Some(full) => full,
            None => {
                let look = ["--frames", "1", "--passes", "1", "--size", "16x16", "--methods", "visibility"];
                let (summary, _) = bench.evaluate(&visible, &format!("ladder-{name}"), &look)?;
                *triangles.insert(at(&summary, "/triangles"))
            }
        };
        let budget = ((full * f64::from(share) / 100.0) as u64).to_string();
        let fly = |file, methods: &str| {
            let arguments = [
                "--methods",
                methods,
                "--budget",
                &budget,
                // The budget alone decides: nothing is coarser, or left out for its size, if it need not be.
                "--detail",
                "0",
                "--quality",
                "0.75",
                "--passes",
                "1",
                "--size",
                "1280x720",
                "--frames",
                options.frames("4"),
            ];
            bench.evaluate(file, &format!("ladder-{name}-{share}-{methods}"), &arguments)
        };
        let (_, mut rows) = fly(&visible, "budget,proxies")?;
        rows.extend(fly(&all, "proxies-frustum")?.1);
        steps.push((share, WAYS.map(|(method, _)| Outcome::of(&rows, method))));
    }
    Ok(steps)
}

/// The last way is at least as good as the others, up to what the table shows.
fn is_best(ways: &[Outcome; 3]) -> bool {
    let [.., best] = ways;
    ways.iter().all(|way| way.ssim <= best.ssim + 5e-5 && way.psnr <= best.psnr + 0.05)
}

fn row(scene: &str, share: u32, ways: &[Outcome; 3]) -> Vec<String> {
    let mut row = vec![format!("{scene}, {share} %")];
    row.extend(ways.iter().map(|way| format!("{:.4}", way.ssim)));
    row.extend(ways.iter().map(|way| format!("{:.1}", way.psnr)));
    row.extend(ways.iter().map(|way| count(way.hole)));
    row.push(if is_best(ways) { "yes" } else { "no" }.to_owned());
    row
}

fn to_json(scene: &str, share: u32, ways: &[Outcome; 3]) -> Value {
    let way = |(way, (method, _)): (&Outcome, &(&str, &str))| json!({"method": method, "ssim": way.ssim, "psnr_y_db": way.psnr, "largest_hole_px": way.hole});
    let ways: Vec<Value> = ways.iter().zip(&WAYS).map(way).collect();
    json!({"scene": scene, "percent": share, "ways": ways})
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_way_is_best_in_both_figures() {
        let way = |ssim, psnr| Outcome { ssim, psnr, hole: 12.0 };
        assert!(is_best(&[way(0.9, 30.0), way(0.95, 29.0), way(0.96, 31.0)]));
        assert!(!is_best(&[way(0.9, 33.0), way(0.95, 29.0), way(0.96, 31.0)]));
        assert!(is_best(&[way(1.0, 120.0), way(0.9, 30.0), way(1.0, 120.0)]));
        let row = row("x", 5, &[way(0.9, 30.0), way(0.95, 29.0), way(0.96, 31.0)]);
        assert_eq!(row[..4], ["x, 5 %", "0.9000", "0.9500", "0.9600"]);
        assert_eq!(row[7..], ["12", "12", "12", "yes"]);
    }
}
