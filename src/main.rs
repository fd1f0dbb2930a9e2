//! The `svs` command: bakes direction-dependent visibility into glTF scenes.

mod cli;

use std::process::ExitCode;

fn main() -> ExitCode {
    cli::main()
}
