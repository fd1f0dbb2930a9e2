//! The command line: arguments in, files and reports out.
//!
//! One file per command; each parses nothing and decides little: [`args`] is what was typed, [`options`] what it
//! means, [`output`] how results look.

mod args;
mod build;
#[cfg(feature = "render")]
mod detail;
mod error;
#[cfg(feature = "render")]
mod evaluate;
mod file;
mod hidden;
mod info;
mod interrupt;
mod level_share;
mod lods;
mod memory;
mod options;
mod output;
mod progress;
#[cfg(feature = "render")]
mod render;
mod sample;
mod serve;
mod strip;
mod tree_weights;
mod validate;
mod verify;
#[cfg(feature = "render")]
mod view;

use args::{Cli, Command};
use clap::Parser;
use error::Failure;
use std::process::ExitCode;

/// Parses the command line, runs the command, prints the error if there is one.
pub(crate) fn main() -> ExitCode {
    // Wrong usage ends in here, with exit code 2; --help and --version with 0.
    let cli = Cli::parse();
    interrupt::install();
    match run(&cli) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

fn run(cli: &Cli) -> Result<(), Failure> {
    if let Some(threads) = cli.common.threads {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads as usize)
            .build_global()
            .map_err(|error| Failure::Input(format!("cannot start {threads} threads: {error}")))?;
    }
    match &cli.command {
        Command::Build(args) => build::run(args, &cli.common),
        Command::Info(args) => info::run(args, &cli.common),
        Command::Validate(args) => validate::run(args, &cli.common),
        Command::Verify(args) => verify::run(args, &cli.common),
        #[cfg(feature = "render")]
        Command::Render(args) => render::run(args, &cli.common),
        #[cfg(feature = "render")]
        Command::Evaluate(args) => evaluate::run(args, &cli.common),
        Command::Sample(args) => sample::run(args, &cli.common),
        Command::Serve(args) => serve::run(args, &cli.common),
        Command::Strip(args) => strip::run(args, &cli.common),
        #[cfg(feature = "render")]
        Command::View(args) => view::run(args),
    }
}
