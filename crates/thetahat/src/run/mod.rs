//! Recordings and settings to results: the way of the data without a file.
//!
//! [`Identification`] takes arrays ([`crate::preparation::Recording`]) and [`crate::preparation::Settings`]; an experiment
//! file lowers to the same. Every case and method is estimated, diagnosed and validated on what it has not seen.

mod assessment;
mod cases;
mod cross_validation;
mod examination;
mod identification;
mod parameters;
mod prediction;
mod prepared;
mod sensitivity;

pub(crate) use examination::check_recording;
pub use identification::Identification;
pub(crate) use identification::{CaseProblem, explain};
pub(crate) use parameters::parameter_results;
pub(crate) use prediction::{Identified, predict_torques};
