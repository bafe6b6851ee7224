//! Recordings: numeric columns read from files, converted to SI units and checked before use.
//!
//! A [`ChannelSource`] describes where the channels of one signal are (file, columns) and what they are (unit, side of the transmission,
//! gain); [`read_channels`] reads them as a [`Series`](thetahat_ground::series::Series), and rejects ambiguous columns and values that are
//! not finite. [`inspect`] lists the content of a file, even of a flawed one. The [`Format`] follows from the extension: text in columns,
//! NumPy, MATLAB, HDF5, Parquet and ROS bags; `docs/reference/recordings.md` describes each. Values from the motor side stay on the motor side:
//! the robot's transmission converts them.
//!
//! | file | what it does |
//! | --- | --- |
//! | `source` | the description of a signal and its reading |
//! | `place`, `budget`, `panic_guard` | where a file may be, how much memory it may request, panics of libraries |
//! | `format`, `reader`, `conversion` | the formats, the reader of each, and what another program has to convert |
//! | `csv`, `npy` with `npy_header`, `npz`, `mat`, `parquet`, `bag` | the readers |
//! | `pieces` | signals of files larger than memory, piece by piece |
//! | `stream` | signals of a text that grows |
//! | `layout` | channels interleaved, or one in each row |
//! | `table`, `select` | the columns that readers return, and the selection from them |
//! | `split_time` | times in two columns, seconds and nanoseconds |
//! | `inspect` | the content of a file: columns, their ranges and resolution, rate, jitter and gaps |
//! | `unit` | units, their factors to SI, and the dimensions they measure |
//! | `checks` | the sample rate from a time column; signals of the same length |
//! | `stretches` | gaps between time steps |
//! | `clock` | the sampling instants, and resampling to equal steps |
//! | `error` | what can be wrong with a recording |
//! | `fuzzing` | every reader applied to bytes, for fuzz tests |
//!
//! ```
//! use thetahat_data::recording::{read_channels, ChannelSource};
//! let folder = std::env::temp_dir();
//! let file = format!("thetahat-example-{}.csv", std::process::id());
//! std::fs::write(folder.join(&file), "t,q\n0,0\n1,90\n")?;
//! let source: ChannelSource = toml::from_str(&format!("file = '{file}'\ncolumns = ['q']\nunit = 'deg'"))?;
//! let q = read_channels(&source, &folder)?;
//! assert_eq!(q.channel(0), [0.0, std::f64::consts::FRAC_PI_2]);
//! std::fs::remove_file(folder.join(&file))?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod bag;
mod budget;
mod checks;
mod clock;
mod conversion;
mod csv;
mod error;
mod format;
#[doc(hidden)]
pub mod fuzzing;
mod inspect;
mod layout;
mod mat;
mod npy;
mod npy_header;
#[cfg(feature = "npz")]
mod npz;
#[cfg(any(feature = "hdf5", feature = "parquet", feature = "rosbag"))]
mod panic_guard;
#[cfg(feature = "parquet")]
mod parquet;
mod pieces;
mod place;
mod reader;
mod select;
mod source;
mod split_time;
mod stream;
mod stretches;
mod table;
mod unit;

#[cfg(test)]
mod test_files;
#[cfg(test)]
mod written_elsewhere;

pub use bag::{BagError, OtherTopic};
pub use checks::{STEP_TOLERANCE, not_all_zero, one_channel, same_length, sample_rate_from_time};
pub use clock::{Clock, Resampling};
pub use csv::{Decimal, Dialect};
pub use error::RecordingError;
pub use format::Format;
pub use inspect::{
    ChannelSummary, ColumnSummary, Contents, Gap, TableSummary, TimeSummary, contradicting_times, inspect,
    inspect_with_time,
};
pub use pieces::SignalPieces;
pub use source::{ChannelSource, Side, read_channels, read_channels_with_missing_values};
#[doc(hidden)]
pub use stream::SignalStream;
pub use unit::{Dimension, Unit, UnknownUnit};
