//! Runs of a program.

use std::path::Path;
use std::process::{Command, Output};

/// Runs a program in a folder with these arguments.
pub fn run<'a>(program: &str, folder: &Path, arguments: impl IntoIterator<Item = &'a str>) -> Output {
    Command::new(program).current_dir(folder).args(arguments).output().expect("the program starts")
}

/// All that a run printed.
#[must_use]
pub fn shown(output: &Output) -> String {
    [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes)).concat()
}

/// What a successful run printed.
pub fn succeeded(output: &Output) -> String {
    let shown = shown(output);
    assert_eq!(output.status.code(), Some(0), "{shown}");
    shown
}

/// The error message of a failed run.
pub fn refused(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(2), "{}", shown(output));
    String::from_utf8_lossy(&output.stderr).into_owned()
}
