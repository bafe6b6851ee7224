//! Time series as a CSV file.

use std::path::Path;

use super::error::ReportError;
use crate::results::{DesignResults, TwinRecording};
use thetahat_ground::{
    output::{RECORD, TRAJECTORY, replace_file},
    series::Series,
};

/// Writes the recording of a simulated robot: `time_s`, `position_1` ... in rad or m, `torque_1` ... in N m or N; atomically.
///
/// # Errors
/// [`ReportError`] where the file cannot be written.
pub fn write_recording(recording: &TwinRecording, path: &Path) -> Result<(), ReportError> {
    write(&recording_csv(recording)?, path)
}

/// The content that [`write_recording`] writes.
///
/// # Errors
/// [`ReportError`] for what cannot be rendered.
pub fn recording_csv(recording: &TwinRecording) -> Result<Vec<u8>, ReportError> {
    let columns = [("position", &recording.position), ("torque", &recording.torque)];
    let mut content = table(recording.sample_rate_hz, &columns).map_err(|source| ReportError::Csv { source })?;
    let head = RECORD.replace('"', "").len();
    content.splice(..head, RECORD.bytes());
    Ok(content)
}

/// The trajectory of a design: `time_s`, `q_1` ..., `dq_1` ..., `ddq_1` ..., SI.
pub(super) fn trajectory_csv(results: &DesignResults) -> Result<Vec<u8>, csv::Error> {
    let columns = [("q", &results.q), ("dq", &results.dq), ("ddq", &results.ddq)];
    let mut content = table(results.sample_rate_hz, &columns)?;
    let head = TRAJECTORY.replace('"', "").len();
    content.splice(..head, TRAJECTORY.bytes());
    Ok(content)
}

/// Writes series of the same length with their time, atomically: `time_s`, then `name_1` ... of each.
pub(super) fn write_series(sample_rate_hz: f64, columns: &[(&str, &Series)], path: &Path) -> Result<(), ReportError> {
    write(&table(sample_rate_hz, columns).map_err(|source| ReportError::Csv { source })?, path)
}

fn write(content: &[u8], path: &Path) -> Result<(), ReportError> {
    replace_file(path, content).map_err(|source| ReportError::Write { path: path.to_owned(), source })
}

fn table(sample_rate_hz: f64, columns: &[(&str, &Series)]) -> Result<Vec<u8>, csv::Error> {
    let numbered = |(name, series): &(&str, &Series)| {
        let name = (*name).to_owned();
        (1..=series.channels()).map(move |c| format!("{name}_{c}"))
    };
    let header: Vec<String> = std::iter::once("time_s".to_owned()).chain(columns.iter().flat_map(numbered)).collect();
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(&header)?;
    for k in 0..columns.first().map_or(0, |(_, series)| series.len()) {
        let time = k as f64 / sample_rate_hz;
        let values = columns.iter().flat_map(|(_, series)| series.sample(k).iter().copied());
        writer.write_record(std::iter::once(time).chain(values).map(|v| v.to_string()))?;
    }
    writer.into_inner().map_err(|e| e.into_error().into())
}
