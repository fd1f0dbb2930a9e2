//! `svs validate`: checks the extension against its schema and the scene.

use super::args::{Common, Validate};
use super::error::Failure;
use super::{file, output};
use std::fmt::Write as _;
use svs::validate::{Severity, ValidationReport};

pub(crate) fn run(args: &Validate, common: &Common) -> Result<(), Failure> {
    let document = file::read(&args.file)?;
    let report = svs::validate::validate(&document);
    let mut json = report.to_json();
    json["uri"] = args.file.display().to_string().into();
    output::print(common, &json, &to_text(&report, &args.file.display().to_string()))?;
    if report.has_errors() { Err(Failure::Reported) } else { Ok(()) }
}

/// The verdict, then one finding a line.
fn to_text(report: &ValidationReport, file: &str) -> String {
    let number = |severity, noun| output::counted(report.count(severity) as u64, noun);
    let mut text = format!(
        "{file}: {}, {}, {}\n",
        number(Severity::Error, "error"),
        number(Severity::Warning, "warning"),
        number(Severity::Information, "note")
    );
    for issue in &report.issues {
        let _ = writeln!(text, "  {issue}");
    }
    text
}
