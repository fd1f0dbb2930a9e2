//! `svs sample`: writes a generated scene, or a grid of a scene of the user's.

use super::args::{Common, Sample, SampleName};
use super::error::Failure;
use super::{file, output};
use serde_json::{Value, json};
use std::path::Path;
use svs::generate::{self, GridError, GridOptions, SampleKind, SampleOptions};
use svs::gltf::Document;

pub(crate) fn run(args: &Sample, common: &Common) -> Result<(), Failure> {
    file::check_output(&args.output)?;
    let (document, mut json, notes) = match (args.kind, &args.of) {
        (SampleName::Generated(_), Some(_)) => {
            return Err(Failure::Usage("--of is for `svs sample grid`; the others are generated".to_owned()));
        }
        (SampleName::Generated(kind), None) => generated(args, kind)?,
        (SampleName::Grid, Some(of)) => grid(args, of)?,
        (SampleName::Grid, None) => {
            return Err(Failure::Usage("`svs sample grid` needs --of FILE: the scene to repeat".to_owned()));
        }
    };
    file::write(&document, &args.output)?;
    let output = args.output.display().to_string();
    let size = std::fs::metadata(&args.output).map_or(0, |data| data.len());
    json["output"] = json!(output);
    json["bytes"] = json!(size);
    let mut text = format!("{output} written, {}\n", output::bytes(size));
    notes.iter().for_each(|note| text += &format!("  note: {note}\n"));
    output::print(common, &json, &text)
}

type Made = (Document, Value, Vec<String>);

fn generated(args: &Sample, kind: SampleKind) -> Result<Made, Failure> {
    let defaults = SampleOptions::new(kind);
    let (scale, seed) = (args.scale.unwrap_or(defaults.scale), args.seed.unwrap_or(defaults.seed));
    let options = SampleOptions { kind, scale, seed };
    options.check().map_err(|error| Failure::Usage(error.to_string()))?;
    let sample = generate::generate(&options);
    let document = Document::from_parts(sample.json, Some(sample.bin))
        .map_err(|error| Failure::Input(format!("cannot generate this scene: {error}")))?;
    Ok((document, json!({"kind": kind.name(), "scale": scale, "seed": seed}), Vec::new()))
}

fn grid(args: &Sample, of: &Path) -> Result<Made, Failure> {
    if args.scale.is_some() || args.seed.is_some() {
        return Err(Failure::Usage(
            "a grid has --copies and --spacing, but no --scale and no --seed".to_owned(),
        ));
    }
    let options = GridOptions { copies: args.copies.unwrap_or(100), spacing: args.spacing.unwrap_or(1.1) };
    options.check().map_err(|error| Failure::Usage(error.to_string()))?;
    let mut document = file::read(of)?;
    let report = generate::grid(&mut document, &options).map_err(|error| match error {
        GridError::TooLarge { .. } => Failure::Usage(error.to_string()),
        _ => Failure::doing("repeat", of, &error),
    })?;
    let json = json!({
        "kind": "grid",
        "of": of.display().to_string(),
        "copies": options.copies,
        "spacing": options.spacing,
        "objects": report.objects,
        "nodes": report.nodes,
        "notes": report.notes,
    });
    Ok((document, json, report.notes))
}
