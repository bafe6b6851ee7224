//! An experiment: one TOML file that describes a run, and the run.
//!
//! [`Experiment::read`] checks the file, [`Experiment::run`] goes the way of the data and returns [`Results`](crate::results::Results); the twin
//! ([`Experiment::demo`]) goes the same way from a simulated record.

mod advice;
mod assess;
mod chain;
mod checks;
mod column_names;
mod cross_validation;
mod description;
mod diagnosis;
mod error;
mod examination;
mod paths;
mod power;
mod predict;
mod proposal;
mod record;
mod rows;
mod run;
mod sensitivity;
mod simulator;
mod turns;
mod wishes;

#[cfg(feature = "parquet")]
pub(crate) use chain::{FilteredRecord, Problem};
pub(crate) use chain::{MOVING, STILL};
#[cfg(feature = "parquet")]
pub(crate) use paths::beside;
#[cfg(feature = "parquet")]
pub(crate) use run::explain;
#[cfg(feature = "parquet")]
pub(crate) use simulator::{RecordReference, Simulator};
#[cfg(feature = "parquet")]
pub(crate) use turns::{Attempt, Finished, SIDE_BY_SIDE, Terms, make};

pub(crate) use record::Record;

pub use description::{
    Case, EstimationDescription, Experiment, ExperimentFile, Gains, NamedChoice, ParameterChoice, ParameterSelection,
    RecordingDescription, SignalDescription, SimulationDescription, Start, TwinDescription, Unlisted, Weighting,
};
pub use error::ExperimentError;
pub use power::PowerPoint;
pub use predict::{PredictionRequest, predict};
pub use proposal::{ProposalError, ProposalRequest, propose};
pub use record::TwinMotion;
