//! The files that a report consists of: one file here for each, and their list.

mod output;
mod parameters_csv;
mod report_html;
mod results_json;

use std::path::{Path, PathBuf};

use self::output::Output;
use super::{error::ReportError, files::write_files, published::Published};
use crate::results::Results;
use thetahat_ground::output::FileKind;

/// Every file, in the order in which they are listed.
const OUTPUTS: [Output; 3] = [results_json::OUTPUT, parameters_csv::OUTPUT, report_html::OUTPUT];

/// The names of the files that [`write_all`] writes.
pub fn file_names() -> impl Iterator<Item = &'static str> {
    OUTPUTS.into_iter().map(|output| output.name)
}

/// The same with their kinds.
pub fn files() -> impl Iterator<Item = (&'static str, FileKind)> {
    OUTPUTS.into_iter().map(|output| (output.name, output.kind))
}

/// The content of one of the files that [`write_all`] writes; none for another name.
///
/// # Errors
/// [`ReportError`] for what cannot be rendered.
pub fn render(name: &str, results: &Results, published: Option<&Published>) -> Result<Option<Vec<u8>>, ReportError> {
    let output = OUTPUTS.into_iter().find(|output| output.name == name);
    output.map(|output| (output.render)(results, published)).transpose()
}

/// Writes `results.json`, `parameters.csv` and `report.html` into a folder, which is created if necessary.
/// Returns their paths.
///
/// Everything is rendered before anything is written, and written under temporary names before anything is renamed: an
/// error leaves no file in part.
///
/// # Errors
/// [`ReportError`] for what cannot be rendered or written.
pub fn write_all(
    results: &Results,
    published: Option<&Published>,
    directory: &Path,
) -> Result<Vec<PathBuf>, ReportError> {
    let render = |output: Output| Ok((output.name, (output.render)(results, published)?));
    write_files(directory, OUTPUTS.into_iter().map(render).collect::<Result<_, ReportError>>()?)
}
