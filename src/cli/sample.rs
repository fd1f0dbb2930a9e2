//! `svs sample`: writes a generated scene.

use super::args::{Common, Sample};
use super::error::Failure;
use super::{file, output};
use serde_json::json;
use svs::generate::{self, SampleOptions};
use svs::gltf::Document;

pub(crate) fn run(args: &Sample, common: &Common) -> Result<(), Failure> {
    file::check_output(&args.output)?;
    let options = SampleOptions { kind: args.kind, scale: args.scale, seed: args.seed };
    options.check().map_err(|error| Failure::Usage(error.to_string()))?;
    let sample = generate::generate(&options);
    let document = Document::from_parts(sample.json, Some(sample.bin))
        .map_err(|error| Failure::Input(format!("cannot generate this scene: {error}")))?;
    file::write(&document, &args.output)?;
    let output = args.output.display().to_string();
    let size = std::fs::metadata(&args.output).map_or(0, |data| data.len());
    let json = json!({
        "output": output,
        "bytes": size,
        "kind": args.kind.name(),
        "scale": args.scale,
        "seed": args.seed,
    });
    output::print(common, &json, &format!("{output} written, {}\n", output::bytes(size)))
}
