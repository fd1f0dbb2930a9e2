//! `svs sample`: writes a generated scene.

use super::args::{Common, Sample, SampleName};
use super::error::Failure;
use super::{file, output};
use serde_json::json;
use svs::generate::{self, SampleKind};

pub(crate) fn run(args: &Sample, common: &Common) -> Result<(), Failure> {
    file::check_output(&args.output)?;
    let kind = match args.kind {
        SampleName::Plant => SampleKind::Plant,
        SampleName::City => SampleKind::City,
        SampleName::Cubes => SampleKind::Cubes,
        SampleName::Boxes => SampleKind::Boxes,
        SampleName::Shells => SampleKind::Shells,
    };
    let document = generate::generate(kind, args.scale, args.seed)
        .map_err(|error| Failure::Input(format!("cannot generate this scene: {error}")))?;
    file::write(&document, &args.output)?;
    let output = args.output.display().to_string();
    let size = std::fs::metadata(&args.output).map_or(0, |data| data.len());
    let json = json!({ "output": output, "bytes": size, "scale": args.scale, "seed": args.seed });
    output::print(common, &json, &format!("{output} written, {}\n", output::bytes(size)))
}
