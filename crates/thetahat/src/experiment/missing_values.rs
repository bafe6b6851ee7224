//! Samples in which a logger had no value of a channel.

use thetahat_data::recording::{self, ChannelSource, RecordingError};
use thetahat_ground::series::Series;

use std::path::Path;

/// Part of the samples that must have all their values: with fewer, signals are of different clocks, and steps are not gaps.
const LEAST_COMPLETE: f64 = 0.5;

/// The samples that have all their values, where some have not.
///
/// # Errors
/// The error of reading strictly, for a recording in which too many samples lack a value: it names file, line and column.
pub(super) fn complete_samples(
    signals: &[(&ChannelSource, &Series)],
    data: &Path,
) -> Result<Option<Vec<usize>>, RecordingError> {
    let samples = signals.first().map_or(0, |(_, series)| series.len());
    let is_complete = |k: &usize| signals.iter().all(|(_, series)| series.sample(*k).iter().all(|v| v.is_finite()));
    let complete: Vec<usize> = (0..samples).filter(is_complete).collect();
    if complete.len() == samples {
        return Ok(None);
    }
    if (complete.len() as f64) < LEAST_COMPLETE * samples as f64 {
        signals.iter().try_for_each(|(source, series)| refuse_sparse(source, series, data))?;
    }
    Ok(Some(complete))
}

/// Refuses a signal that lacks values: of most samples as one of a lower rate, of few with their place.
fn refuse_sparse(source: &ChannelSource, series: &Series, data: &Path) -> Result<(), RecordingError> {
    let samples = series.len();
    let complete = (0..samples).filter(|&k| series.sample(k).iter().all(|value| value.is_finite())).count();
    if (complete as f64) < LEAST_COMPLETE * samples as f64 {
        let (file, columns) = (source.path(data), source.columns.clone());
        return Err(RecordingError::Sparse { file, columns, complete, samples });
    }
    refuse_missing(source, series, data)
}

/// Refuses a signal that lacks a value.
///
/// # Errors
/// The error of reading it strictly.
pub(super) fn refuse_missing(source: &ChannelSource, series: &Series, data: &Path) -> Result<(), RecordingError> {
    if series.values().iter().all(|value| value.is_finite()) {
        return Ok(());
    }
    recording::read_channels(source, data).map(drop)
}
