//! `svs verify`: measures a baked file on held-out cameras.

use super::args::{Common, Verify};
use super::error::Failure;
use super::output::{self, number};
use super::progress::Bars;
use super::{file, memory};
use serde_json::Value;
use std::time::Instant;
use svs::verify::{VerifyOptions, VerifyReport};

pub(crate) fn run(args: &Verify, common: &Common) -> Result<(), Failure> {
    let start = Instant::now();
    let document = file::read(&args.file)?;
    let mut options = VerifyOptions::default();
    if let Some(cameras) = args.cameras {
        options.cameras = cameras as usize;
    }
    if let Some(seed) = args.seed {
        options.seed = seed;
    }
    let bars = Bars::new(common.quiet);
    let report = svs::verify::verify(&document, &options, &bars)
        .map_err(|error| Failure::doing("verify", &args.file, &error))?;
    bars.clear();

    let mut json = serde_json::to_value(&report).unwrap_or_default();
    if let Value::Object(all) = &mut json {
        all.insert("file".to_owned(), args.file.display().to_string().into());
        all.insert("wall_seconds".to_owned(), start.elapsed().as_secs_f64().into());
        all.insert("peak_memory_bytes".to_owned(), memory::peak().into());
    }
    output::print(common, &json, &to_text(&report, args))
}

/// One table per group of cameras: a query a row.
fn to_text(report: &VerifyReport, args: &Verify) -> String {
    let mut text = format!("{}\n", args.file.display());
    let mut groups: Vec<&str> = Vec::new();
    for group in &report.groups {
        if !groups.contains(&group.group.as_str()) {
            groups.push(&group.group);
        }
    }
    for name in groups {
        let head = ["query", "ppm mean", "median", "p95", "worst", "x EVS", "x frustum"];
        let mut rows = vec![head.map(str::to_owned).to_vec()];
        for group in report.groups.iter().filter(|group| group.group == name) {
            let (missing, drawn) = (&group.missing_ppm, &group.triangles);
            let numbers =
                [missing.mean, missing.median, missing.p95, missing.worst, drawn.over_evs, drawn.over_frustum];
            let mut row = vec![group.method.clone()];
            row.extend(numbers.map(number));
            rows.push(row);
        }
        text += &format!("\n{name}: missing pixels per million, triangles drawn\n{}", output::table(&rows));
    }
    text
}
