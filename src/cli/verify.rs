//! `svs verify`: measures a baked file on held-out cameras.

use super::args::{Common, Verify};
use super::error::Failure;
use super::progress::Bars;
use super::{file, memory, output};
use serde_json::Value;
use std::time::Instant;
use svs::verify::VerifyOptions;

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
    output::print(common, &json, &format!("{}: {report}", args.file.display()))
}
