//! How the channels of a signal are arranged in its columns.

use std::path::Path;

use super::error::RecordingError;
use thetahat_ground::series::Series;

/// Most channels of a long table.
const MOST_CHANNELS: usize = 100;

/// How the channels of a signal are arranged in its columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Layout {
    /// A channel in each column.
    Columns,
    /// The channels of a sample one after the other in one column.
    Interleaved {
        /// Number of channels.
        channels: usize,
    },
    /// A channel in each row of two columns: its value, and its number.
    Long,
}

/// Arranges the channels of columns.
pub(super) fn laid_out(layout: Layout, columns: Series, path: &Path) -> Result<Series, RecordingError> {
    match layout {
        Layout::Columns => Ok(columns),
        Layout::Interleaved { channels } => {
            let (values, found) = (columns.len(), columns.channels());
            if channels == 0 || found != 1 || !values.is_multiple_of(channels) {
                return Err(RecordingError::NotInterleaved { file: path.to_owned(), values, columns: found, channels });
            }
            Ok(Series::shaped(channels, columns.values().to_vec()))
        }
        Layout::Long => of_long_table(&columns, path),
    }
}

fn of_long_table(columns: &Series, path: &Path) -> Result<Series, RecordingError> {
    let refuse = |problem: String| RecordingError::NotLong { file: path.to_owned(), problem };
    if columns.channels() != 2 {
        return Err(refuse(format!("{} columns of values, expected one", columns.channels() - 1)));
    }
    let numbers = columns.channel(1);
    let mut distinct = numbers.clone();
    distinct.sort_by(f64::total_cmp);
    distinct.dedup();
    if distinct.len() > MOST_CHANNELS {
        return Err(refuse(format!(
            "{} different numbers of channels, at most {MOST_CHANNELS} are read",
            distinct.len()
        )));
    }
    let of = |number: &f64| -> Vec<f64> {
        (0..columns.len()).filter(|&k| numbers[k] == *number).map(|k| columns.sample(k)[0]).collect()
    };
    let channels: Vec<Vec<f64>> = distinct.iter().map(of).collect();
    match channels.iter().position(|c| c.len() != channels[0].len()) {
        None => Ok(Series::side_by_side(&channels)),
        Some(other) => {
            let (first, rows) = (distinct[0], channels[0].len());
            Err(refuse(format!(
                "channel {first} has {rows} rows, channel {} has {}",
                distinct[other],
                channels[other].len()
            )))
        }
    }
}
