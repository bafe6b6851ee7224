//! The thetahat command line: arguments in, exit code out. The program `thetahat` and the Python package both run it.

mod arguments;
mod campaign;
mod commands;
mod design;
mod export;
mod generate;
mod inputs;
mod progress;
mod proposal;
mod reduction;
mod remedied;
mod remedies;
mod shell;
mod shown;
mod terminal;
mod watch;

use std::{borrow::Cow, ffi::OsString};

use clap::Parser;
use thetahat_ground::visible::visible_lines;

/// Finished, but the verdict is do-not-use, or an alarm was raised.
const NOT_TRUSTED: u8 = 1;
/// Stopped by an error.
const ERROR: u8 = 2;

/// Runs the command in the arguments, the first of which is the name of the program; returns its exit code: 0 the
/// verdict is good or care; 1 finished, but the verdict is do-not-use; 2 error.
#[must_use]
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let arguments = match arguments::Arguments::try_parse_from(arguments) {
        Ok(arguments) => arguments,
        Err(error) => return refuse_arguments(&error),
    };
    match commands::run(arguments) {
        Ok(terminal::Ending::Good) => 0,
        Ok(terminal::Ending::NotTrusted) => NOT_TRUSTED,
        Err(error) => {
            eprintln!("error: {}", visible_lines(&remedies::with_remedy(error.as_ref())));
            ERROR
        }
    }
}

/// Reports an error in the arguments, with control characters made visible, or prints the requested help.
fn refuse_arguments(error: &clap::Error) -> u8 {
    let text = error.to_string();
    if let Cow::Owned(visible) = visible_lines(&text) {
        eprint!("{visible}");
        return ERROR;
    }
    // A closed pipe (`| head`) is not an error.
    let _ = error.print();
    if error.use_stderr() { ERROR } else { 0 }
}
