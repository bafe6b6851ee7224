//! The files of the report, each whole or not there.

use std::{
    fs,
    path::{Path, PathBuf},
};

use super::{ModelReport, Published, ReportError, html};
use crate::results::{ParameterResult, Results, RunResult};

const PARAMETER_COLUMNS: [&str; 12] = [
    "case",
    "method",
    "name",
    "estimate",
    "standard_deviation",
    "relative_standard_deviation_percent",
    "true_value",
    "unit",
    "expression",
    "standard_deviation_robust",
    "interval_95_low",
    "interval_95_high",
];

/// Writes `results.json`, `parameters.csv` and `report.html` into a folder, which is made where it is not there.
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
    let files = vec![
        ("results.json", json(results)?),
        ("parameters.csv", parameters_csv(results)?),
        ("report.html", html::render(results, published)?.into_bytes()),
    ];
    write_files(directory, files)
}

/// Writes files with their content into a folder, all of them or none; returns their paths.
pub(super) fn write_files(directory: &Path, files: Vec<(&'static str, Vec<u8>)>) -> Result<Vec<PathBuf>, ReportError> {
    fs::create_dir_all(directory).map_err(|source| ReportError::Directory { path: directory.to_owned(), source })?;
    let files: Vec<NewFile> = files.into_iter().map(|(name, content)| NewFile::new(directory, name, content)).collect();
    let written = write_together(&files);
    if written.is_err() {
        files.iter().for_each(NewFile::discard);
    }
    written.map(|()| files.into_iter().map(|f| f.path).collect())
}

/// Writes one file into a folder that is there. Returns its path.
pub(super) fn write_one(directory: &Path, name: &str, content: Vec<u8>) -> Result<PathBuf, ReportError> {
    let file = NewFile::new(directory, name, content);
    let written = write_together(std::slice::from_ref(&file));
    if written.is_err() {
        file.discard();
    }
    written.map(|()| file.path)
}

/// Checks, before a long run, that a folder can be where [`write_all`] will write.
///
/// # Errors
/// [`ReportError::NotAFolder`] if a file is there.
pub fn check_folder(directory: &Path) -> Result<(), ReportError> {
    match directory.ancestors().find(|path| path.exists()) {
        Some(path) if !path.is_dir() => Err(ReportError::NotAFolder { path: path.to_owned() }),
        _ => Ok(()),
    }
}

fn write_together(files: &[NewFile]) -> Result<(), ReportError> {
    files.iter().try_for_each(NewFile::write)?;
    files.iter().try_for_each(NewFile::rename)
}

/// A file under its temporary and its final name.
struct NewFile {
    temporary: PathBuf,
    path: PathBuf,
    content: Vec<u8>,
}

impl NewFile {
    fn new(directory: &Path, name: &str, content: Vec<u8>) -> Self {
        let temporary = directory.join(format!(".{name}.{}.part", std::process::id()));
        Self { temporary, path: directory.join(name), content }
    }

    fn write(&self) -> Result<(), ReportError> {
        if self.path.is_dir() {
            return Err(self.error(std::io::ErrorKind::IsADirectory.into()));
        }
        fs::write(&self.temporary, &self.content).map_err(|source| self.error(source))
    }

    fn rename(&self) -> Result<(), ReportError> {
        fs::rename(&self.temporary, &self.path).map_err(|source| self.error(source))
    }

    /// Takes the temporary file away; where there is none, nothing is to be done.
    fn discard(&self) {
        let _ = fs::remove_file(&self.temporary);
    }

    fn error(&self, source: std::io::Error) -> ReportError {
        ReportError::Write { path: self.path.clone(), source }
    }
}

fn json(results: &Results) -> Result<Vec<u8>, ReportError> {
    let mut text = serde_json::to_vec_pretty(results).map_err(|source| ReportError::Json { source })?;
    text.push(b'\n');
    Ok(text)
}

/// A robot as one JSON object; the units are SI.
///
/// # Errors
/// [`ReportError`] for what cannot be rendered.
pub fn model_json(report: &ModelReport) -> Result<String, ReportError> {
    let text = serde_json::to_string_pretty(report).map_err(|source| ReportError::ModelJson { source })?;
    Ok(text + "\n")
}

fn parameters_csv(results: &Results) -> Result<Vec<u8>, ReportError> {
    let refuse = |source| ReportError::Csv { source };
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(PARAMETER_COLUMNS).map_err(refuse)?;
    for run in &results.runs {
        for parameter in &run.parameters {
            writer.write_record(parameter_record(run, parameter)).map_err(refuse)?;
        }
    }
    writer.into_inner().map_err(|e| refuse(e.into_error().into()))
}

fn parameter_record(run: &RunResult, parameter: &ParameterResult) -> [String; 12] {
    let number = |v: Option<f64>| v.map(|v| v.to_string()).unwrap_or_default();
    [
        run.case.clone(),
        run.method.name().to_owned(),
        parameter.name.clone(),
        number(Some(parameter.estimate)),
        number(parameter.standard_deviation),
        number(parameter.relative_standard_deviation_percent),
        number(parameter.true_value),
        parameter.unit.clone(),
        parameter.expression.clone(),
        number(parameter.standard_deviation_robust),
        number(parameter.interval_95.map(|[low, _]| low)),
        number(parameter.interval_95.map(|[_, high]| high)),
    ]
}
