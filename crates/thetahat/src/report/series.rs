//! Time series as a CSV file.

use std::{fs, path::Path};

use super::error::ReportError;
use crate::{results::TwinRecord, series::Series};

/// Writes the record of a twin: `time_s`, `position_1` ... in rad or m, `torque_1` ... in N m or N; whole or not at all.
///
/// # Errors
/// [`ReportError`] where the file cannot be written.
pub fn write_record(record: &TwinRecord, path: &Path) -> Result<(), ReportError> {
    write_series(record.sample_rate_hz, &[("position", &record.position), ("torque", &record.torque)], path)
}

/// Writes series of the same length beside their time, whole or not at all: `time_s`, then `name_1` ... of each.
pub(super) fn write_series(sample_rate_hz: f64, columns: &[(&str, &Series)], path: &Path) -> Result<(), ReportError> {
    let content = table(sample_rate_hz, columns).map_err(|source| ReportError::Csv { source })?;
    let temporary = path.with_extension(format!("{}.part", std::process::id()));
    let write = fs::write(&temporary, content).and_then(|()| fs::rename(&temporary, path));
    write.map_err(|source| {
        // Where there is no temporary file, nothing is to be taken away.
        let _ = fs::remove_file(&temporary);
        ReportError::Write { path: path.to_owned(), source }
    })
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
