//! `svs build --remove-hidden`: the flag, and how its result looks.

use super::error::Failure;
use super::output::{bytes, count, counted, number, percent, ratio};
use clap::{Args, ValueEnum};
use std::fmt::Write as _;
use std::path::Path;
use svs::bake::Progress;
use svs::gltf::Document;
use svs::hidden::{HiddenOptions, HiddenReport, RemoveMode};

/// Options of `svs build` on what can never be seen.
#[derive(Clone, Debug, Args)]
pub(crate) struct Hidden {
    /// Drop objects (or triangles too) that no camera can see, neither from outside nor where one fits inside
    #[arg(long, value_enum, value_name = "WHAT", num_args = 0..=1, require_equals = true,
          default_missing_value = "objects")]
    pub(crate) remove_hidden: Option<RemoveHidden>,
    /// With --remove-hidden: free radius that a camera inside needs [default: 0.5 % of the scene's radius]
    #[arg(long, value_name = "METRES", value_parser = super::args::positive, requires = "remove_hidden")]
    pub(crate) hidden_clearance: Option<f64>,
}

/// What `--remove-hidden` drops.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum RemoveHidden {
    /// Objects
    Objects,
    /// Objects, and triangles of those that stay
    Triangles,
}

/// Removes what is hidden, if that was asked for.
pub(crate) fn apply(
    args: &Hidden,
    document: &mut Document,
    input: &Path,
    progress: &dyn Progress,
) -> Result<Option<HiddenReport>, Failure> {
    let Some(what) = args.remove_hidden else { return Ok(None) };
    let options = HiddenOptions {
        mode: match what {
            RemoveHidden::Objects => RemoveMode::Objects,
            RemoveHidden::Triangles => RemoveMode::Triangles,
        },
        clearance: args.hidden_clearance,
        ..HiddenOptions::default()
    };
    svs::hidden::remove(document, &options, progress)
        .map(Some)
        .map_err(|error| Failure::doing("remove what is hidden from", input, &error))
}

/// The row of the short report.
pub(crate) fn row(report: &HiddenReport) -> (&'static str, String) {
    let text = format!(
        "{} of {} and {} of {} ({}) removed; {} to {}; at most {} ppm of the pixels estimated to change",
        count(report.objects_removed as u64),
        counted(report.objects as u64, "object"),
        count(report.triangles_removed),
        counted(report.triangles, "triangle"),
        percent(ratio(report.triangles_removed, report.triangles)),
        bytes(report.bytes_before),
        bytes(report.bytes_after),
        number(report.estimated_missing_ppm),
    );
    ("hidden", text)
}

/// The largest removed objects by name, and what stayed although unused.
pub(crate) fn details(report: &HiddenReport) -> String {
    let mut text = String::new();
    if !report.largest.is_empty() {
        text += "\nlargest removed objects\n";
        for object in &report.largest {
            let name = object.name.clone().unwrap_or_else(|| format!("node {}", object.node));
            // Names come from the file: no line breaks, no escape sequences.
            let name: String = name.chars().filter(|c| !c.is_control()).take(60).collect();
            let _ = writeln!(text, "  {name}  {}", counted(object.triangles, "triangle"));
        }
    }
    if let Some(reason) = &report.bytes_kept_because {
        let _ = writeln!(text, "\nunused bytes stay in the file: {reason}");
    }
    text
}
