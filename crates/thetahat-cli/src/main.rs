//! The thetahat command line.

mod arguments;
mod campaign;
mod commands;
mod progress;
mod reduction;
mod shell;

use std::process::ExitCode;

use clap::Parser;

/// Finished, but a nominal run is not to be trusted.
const NOT_TRUSTED: u8 = 1;
/// Stopped by an error.
const ERROR: u8 = 2;

fn main() -> ExitCode {
    match commands::run(arguments::Arguments::parse()) {
        Ok(commands::Verdict::Good) => ExitCode::SUCCESS,
        Ok(commands::Verdict::NotTrusted) => ExitCode::from(NOT_TRUSTED),
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(ERROR)
        }
    }
}
