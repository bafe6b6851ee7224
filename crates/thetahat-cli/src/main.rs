//! The thetahat command line.

mod arguments;
mod campaign;
mod commands;
mod inputs;
mod progress;
mod proposal;
mod reduction;
mod shell;
mod shown;
mod terminal;

use std::{borrow::Cow, process::ExitCode};

use clap::Parser;
use thetahat::visible::visible_lines;

/// Finished, but a nominal run is not to be trusted.
const NOT_TRUSTED: u8 = 1;
/// Stopped by an error.
const ERROR: u8 = 2;

fn main() -> ExitCode {
    let arguments = match arguments::Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => refuse_arguments(&error),
    };
    match commands::run(arguments) {
        Ok(terminal::Ending::Good) => ExitCode::SUCCESS,
        Ok(terminal::Ending::NotTrusted) => ExitCode::from(NOT_TRUSTED),
        Err(error) => {
            eprintln!("error: {}", visible_lines(&error.to_string()));
            ExitCode::from(ERROR)
        }
    }
}

/// Says what is wrong with the arguments, without what they hold for the terminal, and ends.
fn refuse_arguments(error: &clap::Error) -> ! {
    let text = error.to_string();
    if matches!(visible_lines(&text), Cow::Borrowed(_)) {
        error.exit();
    }
    eprint!("{}", visible_lines(&text));
    std::process::exit(ERROR.into())
}
