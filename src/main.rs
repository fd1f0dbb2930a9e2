//! The `svs` command: bakes direction-dependent visibility into glTF scenes.

#![forbid(unsafe_code)]

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::main()
}
