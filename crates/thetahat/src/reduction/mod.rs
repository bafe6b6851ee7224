//! Recordings of any length reduced to triangular factors, which can be kept, merged and solved later.
mod compressed;
mod error;
mod estimates;
mod factors;
mod file;
mod fingerprint;
mod instruments;
mod pieces;
mod pool;
mod reduce;
mod segments;
mod solve;
mod source;
mod value;

pub use error::ReductionError;
pub use estimates::estimates_of_results;
pub use factors::Segment;
pub use reduce::{ReduceOptions, ReduceProgress};
pub use solve::Solution;
pub use value::{Identity, ReducedRecording, Reduction};
