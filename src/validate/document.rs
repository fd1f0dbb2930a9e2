//! How the document declares the extension.

use super::ROOT;
use super::report::ValidationReport;
use serde_json::Value;
use svs_runtime::format::{EXTENSION_NAME, VERSION};

/// Checks `extensionsUsed` and `extensionsRequired`; the extension object is there if it is anywhere.
pub(super) fn check_declaration(json: &Value, report: &mut ValidationReport) {
    let present = json.pointer(ROOT).is_some();
    let used = position(json, "extensionsUsed");
    if present && used.is_none() {
        report.error(
            "UNDECLARED_EXTENSION",
            ROOT,
            format!("Extension is not declared: add \"{EXTENSION_NAME}\" to extensionsUsed."),
        );
    }
    if !present {
        let pointer = used.map_or(String::new(), |index| format!("/extensionsUsed/{index}"));
        report.information(
            "EXTENSION_ABSENT",
            pointer,
            format!("The document has no {EXTENSION_NAME} data."),
        );
    }
    if let Some(index) = position(json, "extensionsRequired") {
        report.warning(
            "EXTENSION_REQUIRED",
            format!("/extensionsRequired/{index}"),
            format!("{EXTENSION_NAME} is optional: clients that do not know it can show the document."),
        );
    }
}

/// Checks the version; `false` if the rest cannot be understood.
pub(super) fn check_version(extension: &Value, report: &mut ValidationReport) -> bool {
    let Some(version) = extension["version"].as_str() else { return true };
    let parts = |text: &str| {
        let (major, minor) = text.split_once('.')?;
        Some((major.parse::<u32>().ok()?, minor.parse::<u32>().ok()?))
    };
    let (Some(found), Some(known)) = (parts(version), parts(VERSION)) else { return true };
    let pointer = format!("{ROOT}/version");
    if found.0 != known.0 {
        report.error(
            "UNSUPPORTED_VERSION",
            pointer,
            format!("Version {version} is not supported; this validator knows {VERSION}."),
        );
        return false;
    }
    if found.1 > known.1 {
        report.information(
            "NEWER_VERSION",
            pointer,
            format!("Version {version} is newer than {VERSION}: new properties are not checked."),
        );
    }
    true
}

fn position(json: &Value, list: &str) -> Option<usize> {
    json.get(list)?.as_array()?.iter().position(|name| name == EXTENSION_NAME)
}
