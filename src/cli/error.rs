//! Failures and their exit codes.

use std::error::Error;
use std::fmt::Write as _;
use std::io;
use std::path::Path;
use std::process::ExitCode;

/// Why a command did not do what it was asked.
#[derive(Debug)]
pub(crate) enum Failure {
    /// Bad input, or a file that cannot be written: exit code 1.
    Input(String),
    /// A command line that makes no sense: exit code 2.
    Usage(String),
    /// The command has printed its findings, and they are bad: exit code 1, no further message.
    Reported,
    /// Whoever read our output went away (`svs info x.glb | head -1`): no failure of ours.
    OutputClosed,
}

impl Failure {
    /// "cannot read plant.glb: what is wrong: what lies behind it".
    pub(crate) fn doing(what: &str, path: &Path, error: &dyn Error) -> Self {
        let begin = format!("cannot {what} {}: ", path.display());
        let message = chain(error);
        // Errors of files begin like this themselves.
        Self::Input(if message.starts_with(&begin) { message } else { begin + &message })
    }

    /// Prints the message, if there is one, and gives the exit code.
    pub(crate) fn report(&self) -> ExitCode {
        match self {
            Self::Input(message) => {
                eprintln!("error: {message}");
                ExitCode::from(1)
            }
            Self::Usage(message) => {
                eprintln!("error: {message}");
                ExitCode::from(2)
            }
            Self::Reported => ExitCode::from(1),
            Self::OutputClosed => ExitCode::SUCCESS,
        }
    }
}

impl From<io::Error> for Failure {
    /// Errors of standard output; files go through [`Failure::doing`].
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::BrokenPipe => Self::OutputClosed,
            _ => Self::Input(format!("cannot write to standard output: {error}")),
        }
    }
}

/// An error with its causes, each said once (a cause that its parent already spells out is left away).
fn chain(error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut next = error.source();
    while let Some(cause) = next {
        let message = cause.to_string();
        if !text.contains(&message) {
            let _ = write!(text, ": {message}");
        }
        next = cause.source();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn causes_are_said_once() {
        #[derive(Debug, thiserror::Error)]
        #[error("outer")]
        struct Outer(#[source] io::Error);
        #[derive(Debug, thiserror::Error)]
        #[error("outer: {0}")]
        struct Spelled(#[source] io::Error);
        let inner = || io::Error::other("inner");
        assert_eq!(chain(&Outer(inner())), "outer: inner");
        assert_eq!(chain(&Spelled(inner())), "outer: inner");
    }

    #[test]
    fn a_closed_pipe_is_no_failure() {
        assert!(matches!(Failure::from(io::Error::from(io::ErrorKind::BrokenPipe)), Failure::OutputClosed));
        assert!(matches!(Failure::from(io::Error::from(io::ErrorKind::StorageFull)), Failure::Input(_)));
    }
}
