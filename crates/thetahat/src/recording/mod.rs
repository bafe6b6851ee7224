//! Recordings: numeric columns read from files, in SI units, checked before anything is computed from them.
//!
//! A [`ChannelSource`] says where the channels of one signal are (file, columns) and what they are (unit, side of the
//! transmission, gain); [`read_channels`] gives them as a [`Series`](crate::series::Series). Two formats are read, told
//! apart by the extension: `.csv` with a header line, and `.mat` of version 5 (`save -v7` or earlier in MATLAB).
//! Values from the motor side stay on the motor side: the robot's transmission converts them.
//!
//! | file | what it does |
//! | --- | --- |
//! | `source` | the description of a signal and its reading |
//! | `csv`, `mat` | the two formats |
//! | `unit` | units, their factors to SI, and what they measure |
//! | `checks` | the sample rate from a time column; signals of the same length |
//! | `clock` | the sampling instants, and equal steps where they jitter |
//! | `error` | what can be wrong with a recording |

mod checks;
mod clock;
mod csv;
mod error;
mod mat;
mod source;
mod unit;

#[cfg(test)]
mod test_files;

pub use checks::{STEP_TOLERANCE, not_all_zero, one_channel, same_length, sample_rate_from_time};
pub use clock::{Clock, Resampling};
pub use error::RecordingError;
pub use mat::read_scalar;
pub use source::{ChannelSource, Side, read_channels};
pub use unit::{Quantity, Unit};
