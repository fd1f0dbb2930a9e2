//! `svs strip`: removes the baked visibility.

use super::args::{Common, Strip};
use super::error::Failure;
use super::{file, output};
use serde_json::json;
use svs::gltf::payload;

pub(crate) fn run(args: &Strip, common: &Common) -> Result<(), Failure> {
    file::check_output(&args.output)?;
    let mut document = file::read(&args.input)?;
    let removed = payload::strip(&mut document);
    file::write(&document, &args.output)?;
    let output = args.output.display();
    let json = json!({
        "input": args.input.display().to_string(),
        "output": output.to_string(),
        "removed": removed,
    });
    let text = if removed {
        format!("{output} written without baked visibility\n")
    } else {
        format!("{output} written; {} had no baked visibility to remove\n", args.input.display())
    };
    output::print(common, &json, &text)
}
