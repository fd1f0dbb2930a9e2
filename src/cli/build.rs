//! `svs build`: bakes a scene.

use super::args::{Build, Common, LayoutName};
use super::error::Failure;
use super::options::BuildOptions;
use super::output::{self, bytes, count, counted, number, percent, ratio};
use super::progress::Bars;
use super::{file, hidden, memory};
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::path::Path;
use std::time::Instant;
use svs::bake::BakeReport;
use svs::gltf::{Container, Document};
use svs::hidden::HiddenReport;
use svs::proxies::{LodReport, ProxyReport};

pub(crate) fn run(args: &Build, common: &Common) -> Result<(), Failure> {
    let options = BuildOptions::try_from(args)?;
    let start = Instant::now();
    let bars = Bars::new(common.quiet);
    let mut document = file::read(&options.input)?;
    let hidden = hidden::apply(&args.hidden, &mut document, &options.input, &bars)?;
    let report = svs::bake::build(&mut document, &options.bake, &bars)
        .map_err(|error| Failure::doing("bake", &options.input, &error))?;
    if args.layout == LayoutName::Stream {
        let failed = |error: &dyn std::error::Error| Failure::doing("arrange", &options.input, error);
        // As written: what came from a .gltf has its buffers elsewhere still.
        if document.container() != Container::Glb {
            let glb = document.to_glb().map_err(|error| failed(&error))?;
            document = Document::from_glb(&glb).map_err(|error| failed(&error))?;
        }
        svs::stream::arrange(&mut document).map_err(|error| failed(&error))?;
    }
    file::write(&document, &options.output)?;
    bars.clear();
    let seconds = start.elapsed().as_secs_f64();

    let mut json = to_json(&report, &options, seconds);
    if let Some(hidden) = &hidden {
        json["hidden"] = serde_json::to_value(hidden).unwrap_or_default();
    }
    if let Some(path) = &options.report {
        file::write_json(&json, path)?;
    }
    output::print(common, &json, &to_text(&report, hidden.as_ref(), &options.output, seconds))
}

/// The whole report: the bake's own, and what only the command knows.
fn to_json(report: &BakeReport, options: &BuildOptions, seconds: f64) -> Value {
    let mut json = json!({
        "input": options.input.display().to_string(),
        "output": options.output.display().to_string(),
        "wall_seconds": seconds,
        "peak_memory_bytes": memory::peak(),
    });
    if let (Some(all), Ok(Value::Object(baked))) = (json.as_object_mut(), serde_json::to_value(report)) {
        all.extend(baked);
    }
    json
}

/// The short report: what was gained and what is missing first, then what it cost.
fn to_text(report: &BakeReport, hidden: Option<&HiddenReport>, output: &Path, seconds: f64) -> String {
    let mut missing = format!("{} ppm estimated", number(report.estimated_missing_ppm));
    let mut drawn = Vec::new();
    let mut measured = Vec::new();
    for group in report.verification.iter().flat_map(|verification| &verification.groups) {
        if group.method == "default" {
            measured.push(format!("{} ppm {}", number(group.missing_ppm.mean), group.group));
            drawn.push(format!("{} {}", percent(group.triangles.over_frustum), group.group));
        }
    }
    if !measured.is_empty() {
        let _ = write!(missing, "; measured {}", measured.join(", "));
    }
    let kept: u64 = report.trees.iter().map(|tree| tree.nodes_kept as u64).sum();
    let before: u64 = report.trees.iter().map(|tree| tree.nodes_before as u64).sum();
    let mut rows = vec![("missing pixels", missing)];
    if !drawn.is_empty() {
        rows.push(("triangles", format!("{} of those in the view frustum are drawn", drawn.join(", "))));
    }
    rows.push((
        "objects",
        format!("{}, {}", count(report.objects as u64), counted(report.triangles, "triangle")),
    ));
    rows.push((
        "spheres",
        format!(
            "{} kept of {}, in {}",
            count(kept),
            count(before),
            counted(report.trees.len() as u64, "tree")
        ),
    ));
    rows.push((
        "added",
        format!(
            "{}, {} of the geometry, {} bytes per object",
            bytes(report.bytes_added),
            percent(ratio(report.bytes_added, report.geometry_bytes)),
            number(ratio(report.bytes_added, report.objects as u64)),
        ),
    ));
    if let Some(proxies) = &report.proxies {
        rows.push(("proxies", proxies_text(proxies)));
        rows.extend(proxies.msft_lod.as_ref().map(|lod| ("MSFT_lod", lod_text(lod))));
    }
    rows.push(("rays", count(report.rays)));
    rows.extend(hidden.map(hidden::row));
    let mut text =
        format!("{} written in {} s\n\n{}", output.display(), number(seconds), output::fields(&rows));
    text += &hidden.map(hidden::details).unwrap_or_default();
    if !report.notes.is_empty() {
        text += "\nnotes\n";
        for note in &report.notes {
            let _ = writeln!(text, "  {} x {}", count(note.count as u64), note.message);
        }
    }
    text
}

/// What became of the proxies, in one line.
fn proxies_text(report: &ProxyReport) -> String {
    if report.nodes == 0 && report.mesh_levels == 0 {
        let why = report.without.first().map_or("they do not pay here", String::as_str);
        return format!("none: {why}");
    }
    let root = report.levels.first().map_or(0, |level| level.triangles);
    format!(
        "{} in {} levels, the coarsest {}; {} of {}; {}, {} of the geometry; {} s",
        count(report.nodes as u64),
        report.levels.len(),
        counted(root, "triangle"),
        counted(report.mesh_levels as u64, "simplified version"),
        mesh_count(report.simplified_meshes as u64),
        bytes(report.bytes),
        percent(report.share),
        number(report.seconds),
    )
}

/// What became of `MSFT_lod`, in one line.
fn lod_text(report: &LodReport) -> String {
    format!(
        "on {}; {} for their simplified versions, {}; {} left",
        counted(report.nodes as u64, "node"),
        counted(report.appended as u64, "node"),
        bytes(report.bytes),
        count(report.left as u64),
    )
}

fn mesh_count(number: u64) -> String {
    format!("{} {}", count(number), if number == 1 { "mesh" } else { "meshes" })
}
