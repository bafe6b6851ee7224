//! Recordings: numeric columns read from files, in SI units, checked before anything is computed from them.
//!
//! A [`ChannelSource`] says where the channels of one signal are (file, columns) and what they are (unit, side of the
//! transmission, gain); [`read_channels`] gives them as a [`Series`](crate::series::Series), and refuses what is unclear or
//! not a finite number. [`inspect`] tells what a file holds, whatever is wrong with it. The [`Format`] follows from the
//! extension: text in columns, NumPy, MATLAB, Parquet and ROS 2 bags; `docs/recordings.md` describes each. Values from the
//! motor side stay on the motor side: the robot's transmission converts them.
//!
//! | file | what it does |
//! | --- | --- |
//! | `source` | the description of a signal and its reading |
//! | `place`, `limits`, `caught` | where a file may lie, how much memory it may ask for, panics of libraries |
//! | `format` | the formats, and the reader of each |
//! | `csv`, `npy` with `npy_header`, `npz`, `mat`, `parquet`, `bag` | the readers |
//! | `parts` | signals of files that are longer than memory, part by part |
//! | `table`, `select` | what readers give, and the columns asked for out of it |
//! | `inspect` | what a file holds: columns, their ranges and resolution, rate, jitter and gaps |
//! | `unit` | units, their factors to SI, and what they measure |
//! | `checks` | the sample rate from a time column; signals of the same length |
//! | `clock` | the sampling instants, and equal steps where they jitter |
//! | `error` | what can be wrong with a recording |
//! | `fuzzing` | every reader on bytes, for fuzz tests |

mod bag;
#[cfg(any(feature = "hdf5", feature = "parquet", feature = "rosbag"))]
mod caught;
mod checks;
mod clock;
mod csv;
mod error;
mod format;
#[doc(hidden)]
pub mod fuzzing;
mod inspect;
mod limits;
mod mat;
mod npy;
mod npy_header;
#[cfg(feature = "npz")]
mod npz;
#[cfg(feature = "parquet")]
mod parquet;
mod parts;
mod place;
mod select;
mod source;
mod table;
mod unit;

#[cfg(test)]
mod test_files;

pub use bag::{BagError, OtherTopic};
pub use checks::{STEP_TOLERANCE, not_all_zero, one_channel, same_length, sample_rate_from_time};
pub use clock::{Clock, Resampling};
pub use csv::{Decimal, Dialect};
pub use error::RecordingError;
pub use format::Format;
pub use inspect::{ChannelSummary, ColumnSummary, Contents, Gap, TableSummary, TimeSummary, inspect};
pub use parts::SignalParts;
pub use source::{ChannelSource, Side, read_channels};
pub use unit::{Quantity, Unit};
