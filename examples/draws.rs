//! What the library says to draw of a baked file, for cameras from another program: the tests of the web packages compare
//! their own answers with these.
//!
//! `cargo run --release --example draws -- FILE CAMERAS.json [REPEATS]` prints JSON: for each camera the ids that
//! `Stage::select` gives (objects, then levels and proxies) and, with REPEATS, the median time in milliseconds.

use glam::{DMat4, DVec3};
use serde::Deserialize;
use std::collections::HashMap;
use std::path::Path;
use std::time::Instant;
use svs::gltf::Document;
use svs::stage::{Extra, Stage};
use svs_runtime::{Budget, Camera, Detail, Metric, Selected, SelectedKind, Settings};

/// A camera and how to cull for it.
#[derive(Deserialize)]
struct View {
    /// By columns.
    view_projection: [f64; 16],
    eye: [f64; 3],
    pixels_per_radian: f64,
    quality: f32,
    /// Pixels.
    tau: f32,
    /// Triangles.
    budget: Option<u64>,
    /// Objects hidden from this camera on; the list stays in force.
    #[serde(default)]
    hide: Vec<u32>,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (file, cameras, repeats) = match arguments.as_slice() {
        [file, cameras] => (file, cameras, 0),
        [file, cameras, repeats] => (file, cameras, repeats.parse()?),
        _ => return Err("usage: draws FILE CAMERAS.json [REPEATS]".into()),
    };
    let mut stage = Stage::open(&Document::read(Path::new(file))?)?;
    if let Some(notice) = stage.notice() {
        return Err(notice.into());
    }
    let views: Vec<View> = serde_json::from_slice(&std::fs::read(cameras)?)?;
    let objects = stage.scene.objects.len() as u32;
    let extras: HashMap<Extra, u32> = (objects..).map_while(|id| Some((stage.extra(id)?, id))).collect();
    let mut answers = Vec::new();
    for view in views {
        for object in view.hide {
            stage.set_hidden(object, true);
        }
        let view_projection = DMat4::from_cols_array(&view.view_projection);
        let camera =
            Camera::from_view_projection(view_projection, DVec3::from(view.eye), view.pixels_per_radian);
        let settings = Settings::from_quality(view.quality);
        let detail = Detail { tau: view.tau, metric: Metric::default() };
        let budget = view.budget.map_or(Budget::Unlimited, Budget::Triangles);
        let mut times: Vec<f64> = Vec::new();
        for _ in 0..repeats {
            // What was asked last is answered from memory.
            stage.culler().select(&camera, &Settings::FRUSTUM, &detail, &budget);
            let start = Instant::now();
            stage.culler().select(&camera, &settings, &detail, &budget);
            times.push(start.elapsed().as_secs_f64() * 1e3);
        }
        times.sort_by(f64::total_cmp);
        let selected = stage.culler().select(&camera, &settings, &detail, &budget).to_vec();
        let ids: Vec<Option<u32>> = selected.iter().map(|selected| id(&stage, &extras, selected)).collect();
        answers.push(serde_json::json!({ "ids": ids, "milliseconds": times.get(times.len() / 2) }));
    }
    println!("{}", serde_json::to_string(&answers)?);
    Ok(())
}

/// The number that draws what was selected.
fn id(stage: &Stage, extras: &HashMap<Extra, u32>, selected: &Selected) -> Option<u32> {
    let draw = selected.draw;
    match selected.kind {
        SelectedKind::Object => stage.object_of(draw),
        SelectedKind::Level(level) => {
            extras.get(&Extra::Level { object: stage.object_of(draw)?, level }).copied()
        }
        SelectedKind::Proxy => {
            extras.get(&Extra::Proxy { tree: draw.tree, anchor: draw.anchor, node: draw.object }).copied()
        }
    }
}
