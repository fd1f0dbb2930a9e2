//! What a validation found, in the shape of the Khronos validator's report.

use serde_json::{Value, json};
use std::fmt;

/// How bad an issue is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// The data breaks a MUST of the specification: a client may refuse it or draw wrong images.
    Error,
    /// Allowed, but likely a mistake.
    Warning,
    /// Good to know.
    Information,
}

impl Severity {
    /// The number that the Khronos validator's JSON uses: 0 error, 1 warning, 2 information.
    pub fn number(self) -> u8 {
        match self {
            Self::Error => 0,
            Self::Warning => 1,
            Self::Information => 2,
        }
    }
}

impl fmt::Display for Severity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Error => "Error",
            Self::Warning => "Warning",
            Self::Information => "Information",
        })
    }
}

/// One finding.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Issue {
    /// Stable name, upper snake case. Tools may compare it; messages may change.
    pub code: &'static str,
    /// How bad it is.
    pub severity: Severity,
    /// Sentence for people.
    pub message: String,
    /// JSON pointer (RFC 6901) into the document.
    pub pointer: String,
}

impl fmt::Display for Issue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { code, severity, message, pointer } = self;
        write!(f, "{severity}: {code}: {message} ({pointer})")
    }
}

/// All findings, in the order in which they were made.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ValidationReport {
    /// The findings.
    pub issues: Vec<Issue>,
}

impl ValidationReport {
    /// There is at least one issue of severity [`Severity::Error`].
    pub fn has_errors(&self) -> bool {
        self.count(Severity::Error) > 0
    }

    /// Number of issues of one severity.
    pub fn count(&self, severity: Severity) -> usize {
        self.issues.iter().filter(|issue| issue.severity == severity).count()
    }

    /// The report as the Khronos validator writes it: `{"issues": {"numErrors", "numWarnings", "numInfos", "messages":
    /// [{"code", "severity", "message", "pointer"}]}}`, severities as 0 (error), 1 (warning), 2 (information).
    pub fn to_json(&self) -> Value {
        let messages: Vec<Value> = self
            .issues
            .iter()
            .map(|issue| {
                json!({
                    "code": issue.code,
                    "severity": issue.severity.number(),
                    "message": issue.message,
                    "pointer": issue.pointer,
                })
            })
            .collect();
        json!({
            "issues": {
                "numErrors": self.count(Severity::Error),
                "numWarnings": self.count(Severity::Warning),
                "numInfos": self.count(Severity::Information),
                "messages": messages,
            }
        })
    }

    pub(super) fn error(
        &mut self,
        code: &'static str,
        pointer: impl Into<String>,
        message: impl Into<String>,
    ) {
        self.push(Severity::Error, code, pointer.into(), message.into());
    }

    pub(super) fn warning(
        &mut self,
        code: &'static str,
        pointer: impl Into<String>,
        message: impl Into<String>,
    ) {
        self.push(Severity::Warning, code, pointer.into(), message.into());
    }

    pub(super) fn information(
        &mut self,
        code: &'static str,
        pointer: impl Into<String>,
        message: impl Into<String>,
    ) {
        self.push(Severity::Information, code, pointer.into(), message.into());
    }

    fn push(&mut self, severity: Severity, code: &'static str, pointer: String, message: String) {
        self.issues.push(Issue { code, severity, message, pointer });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_has_the_khronos_shape() {
        let mut report = ValidationReport::default();
        assert!(!report.has_errors());
        report.warning("B", "/b", "second");
        report.error("A", "/a", "first");
        report.information("C", "", "third");
        assert!(report.has_errors());
        assert_eq!(
            report.to_json(),
            json!({"issues": {"numErrors": 1, "numWarnings": 1, "numInfos": 1, "messages": [
                {"code": "B", "severity": 1, "message": "second", "pointer": "/b"},
                {"code": "A", "severity": 0, "message": "first", "pointer": "/a"},
                {"code": "C", "severity": 2, "message": "third", "pointer": ""},
            ]}})
        );
        assert_eq!(report.issues[1].to_string(), "Error: A: first (/a)");
    }
}
