//! The thetahat command line.

mod arguments;
mod campaign;
mod commands;
mod inputs;
mod progress;
mod proposal;
mod reduction;
mod shell;
mod terminal;

use std::process::ExitCode;

use clap::Parser;

/// Finished, but a nominal run is not to be trusted.
const NOT_TRUSTED: u8 = 1;
/// Stopped by an error.
const ERROR: u8 = 2;

fn main() -> ExitCode {
    match commands::run(arguments::Arguments::parse()) {
        Ok(terminal::Verdict::Good) => ExitCode::SUCCESS,
        Ok(terminal::Verdict::NotTrusted) => ExitCode::from(NOT_TRUSTED),
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(ERROR)
        }
    }
}
