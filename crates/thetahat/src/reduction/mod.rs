//! Recordings of any length reduced to triangular factors, which can be kept, merged and solved later.
//!
//! [`Experiment::reduce`](crate::experiment::Experiment::reduce) reads the recordings in pieces, makes the rows of an
//! identification of them, and keeps for each joint and stretch of time the upper triangular factor of `[X y]`, with
//! instruments of `[Z X y]`, and what the model is chosen from. A [`Reduction`] is a value: written to a file and read, merged
//! with others in any order, solved ([`Reduction::solve`]). No product `X^T X` or `Z^T X` of rows is formed.
//!
//! | letter | word | shape |
//! | --- | --- | --- |
//! | `R_j` | factor of joint j: `[X_j y_j] = Q_j R_j`, columns that cannot act on the joint left out | n_j + 1, square |
//! | `r_x, r_y` | its columns of X and y, which stand for the rows | |
//! | `W_g` | rows of Q, with `X = Q R`, of the stretch of time g | |
//!
//! | file | what it does |
//! | --- | --- |
//! | `source` | a recording of which any part can be had, on the joint side |
//! | `pieces` | its pieces, and what their positions show |
//! | `survey` | what must be known before rows are made: the window, and what counts as near rest |
//! | `near_rest` | which samples of a piece make no rows |
//! | `rows` | one piece on its way to rows |
//! | `instruments` | the simulated motion of a piece |
//! | `reduce` | all of it, recording by recording |
//! | `factors` | rows to factors, stretch by stretch |
//! | `model_rows` | the rows of every sample, from which the model is chosen |
//! | `samples` | the samples of short recordings |
//! | `part` | parts of an experiment that are reduced by themselves |
//! | `value`, `file`, `fingerprint` | the reduction, its merging and its file; by what a recording is known again |
//! | `identity` | what must agree between reductions that are merged |
//! | `compressed`, `solve` | the factors as a regression, its estimates and results |
//! | `segments` | intervals from the scores of the stretches of time |
//! | `information` | the information of recordings, for the design of the next |
//! | `estimates` | estimates of a `results.json`, for instruments |
//!
//! `docs/manual/long_recordings.md` says how pieces are kept equal to the whole, and what is refused.
//!
//! ```
//! use std::path::PathBuf;
//! use thetahat::reduction::{Reduction, ReductionError};
//! /// The estimates from recordings that were reduced one by one.
//! fn solve_all(files: &[PathBuf]) -> Result<usize, ReductionError> {
//!     Ok(Reduction::read_all(files)?.solve()?.results.runs.len())
//! }
//! assert!(matches!(solve_all(&[]), Err(ReductionError::Nothing)));
//! ```

mod compressed;
mod error;
mod estimates;
mod examined;
mod factors;
mod file;
mod fingerprint;
mod identity;
mod information;
mod instruments;
mod model_rows;
mod near_rest;
mod options;
mod overlap;
mod part;
mod parts;
mod pieces;
mod reduce;
mod rows;
mod samples;
mod solve;
mod source;
mod survey;
mod value;

#[doc(hidden)]
pub use crate::run::{ModelCell, ModelFactors, Parts, RepeatedRows, SettledRows};
pub use error::{ReductionError, SharedSpan};
pub use estimates::estimates_of_results;
#[doc(hidden)]
pub use factors::{JointRows, KeptRows, Segment};
#[doc(hidden)]
pub use identity::Identity;
pub use options::{ReduceOptions, ReduceProgress};
#[doc(hidden)]
pub use overlap::Marks;
pub use solve::{IntervalSource, Solution};
#[doc(hidden)]
pub use value::{ComparedRecordings, RecordingFolds};
pub use value::{ReducedRecording, Reduction};
