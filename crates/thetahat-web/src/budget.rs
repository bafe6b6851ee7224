//! Limits of the page: a browser gives a module at most 4 GB. An identification needs about 140 bytes for each value of a
//! position or torque, and about ten times the bytes of a text.

use thetahat::Recording;

use crate::session::Outcome;

/// Largest number of bytes of all files.
const MOST_BYTES: usize = 160 << 20;
/// Largest number of values of positions and torques of all recordings.
const MOST_VALUES: usize = 16_000_000;
const REMEDY: &str =
    "the command `thetahat reduce` reads recordings of any length, and `thetahat solve` identifies from its output";

/// Refuses a file that is too large together with the others.
pub(crate) fn require_size(path: &str, bytes: usize, others: usize) -> Outcome<()> {
    let all = bytes.saturating_add(others);
    if all <= MOST_BYTES {
        return Ok(());
    }
    let with = if others == 0 { "" } else { ", with the other files" };
    let (found, limit) = (all >> 20, MOST_BYTES >> 20);
    Err(format!("{path}: {found} MiB{with}, more than the {limit} MiB that the page can read; {REMEDY}").into())
}

/// Refuses recordings that are too long.
pub(crate) fn require_length(recordings: &[Recording]) -> Outcome<()> {
    let values: usize = recordings.iter().map(|recording| 2 * recording.position.values().len()).sum();
    if values <= MOST_VALUES {
        return Ok(());
    }
    let of = if recordings.len() == 1 { "the recording has" } else { "the recordings have" };
    Err(format!("{of} {values} positions and torques, more than the {MOST_VALUES} that the page can read; {REMEDY}")
        .into())
}

#[cfg(test)]
mod tests {
    use thetahat::Series;

    use super::*;

    #[test]
    fn too_large_inputs_are_refused_with_the_remedy() {
        assert!(require_size("a.csv", MOST_BYTES, 0).is_ok());
        let error = require_size("a.csv", MOST_BYTES, 1 << 20).unwrap_err().to_string();
        assert!(error.starts_with("a.csv: 161 MiB, with the other files") && error.contains("reduce"), "{error}");
        let recording = || Recording::without_torque(1000.0, Series::zeros(MOST_VALUES / 4, 2));
        assert!(require_length(&[recording()]).is_ok());
        let error = require_length(&[recording(), recording()]).unwrap_err().to_string();
        assert!(error.contains("the recordings have 32000000") && error.contains("thetahat reduce"), "{error}");
    }
}
