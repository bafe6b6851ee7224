//! How much a page takes: a browser gives a module 4 GB at most, and less on small machines.

use thetahat::preparation::Recording;

use crate::session::Outcome;

/// Bytes of the largest file.
const LARGEST_FILE: usize = 512 << 20;
/// Values of positions and torques of all recordings: one identification holds some hundred bytes for each.
const MOST_VALUES: usize = 12_000_000;

/// Refuses a file that is too large.
pub(crate) fn require_size(path: &str, bytes: usize) -> Outcome<()> {
    if bytes <= LARGEST_FILE {
        return Ok(());
    }
    let (found, limit) = (bytes >> 20, LARGEST_FILE >> 20);
    Err(format!("{path}: a file of {found} MiB is too large for the page, which takes {limit} MiB; {REMEDY}").into())
}

/// Refuses recordings that are too long.
pub(crate) fn require_length(recordings: &[Recording]) -> Outcome<()> {
    let values: usize = recordings.iter().map(|r| 2 * r.position.values().len()).sum();
    if values <= MOST_VALUES {
        return Ok(());
    }
    let samples: usize = recordings.iter().map(|r| r.position.len()).sum();
    let place =
        if recordings.len() == 1 { "the recording".to_owned() } else { format!("{} recordings", recordings.len()) };
    Err(format!("{place}: {samples} samples are too many for the page, which takes {MOST_VALUES} values of positions and torques; {REMEDY}").into())
}

const REMEDY: &str =
    "the command `thetahat reduce` takes records of any length, and `thetahat solve` identifies from what it writes";
