//! Recordings and settings to results: the way of the data without a file.
//!
//! [`Identification`] takes arrays ([`crate::preparation::Recording`]) and [`crate::preparation::Settings`]; an experiment
//! file lowers to the same. Every case and method is estimated, diagnosed and validated on what it has not seen.
//!
//! The program on the crate's first page uses it. Recordings that do not fit the robot are refused by name:
//!
//! ```
//! use thetahat::{Identification, Recording, Robot, Series, Settings, preparation::PreparationError};
//!
//! # let robot = "name = 'r'\n[[joint]]\nname = 'a'\nkind = 'revolute'\n";
//! # let robot = Robot::parse(robot, std::path::Path::new("r.toml")).unwrap();
//! let two_channels = Recording::new(1000.0, Series::zeros(500, 2), Series::zeros(500, 2)).named("log");
//! let refused = Identification::new(&robot, vec![two_channels], Settings::new(20.0, 10));
//! assert!(matches!(refused, Err(PreparationError::JointCount { expected: 1, found: 2, .. })));
//! ```

mod assessment;
mod bandwidth;
mod cases;
mod continued;
mod controller_step;
mod curves;
mod estimated_loop;
mod estimation_data;
mod examination;
mod explained_by_model;
mod fitted_positions;
mod hidden_bias;
mod identification;
mod linear;
mod links_of_description;
mod model;
mod parameters;
mod payload;
mod physical;
mod prediction;
mod prepared;
mod reduced;
mod regression;
mod sensitivity;
mod terms;
mod user_estimators;
mod validation;
mod wrong_loop;

pub(crate) use curves::skeleton_in;
pub(crate) use examination::{ExaminationModel, check_recordings, compare, examine, examine_robot};
#[doc(hidden)]
pub use identification::Identification;
pub(crate) use identification::{CaseProblem, explain};
pub(crate) use model::{
    FEWEST_RECORDINGS, FOLDS, InPlaceOfRows, ModelCollector, ModelColumns, ModelData, RowParts, STRETCHES, Slow,
    changing, memory, near_rest_limits, places, span, transitions,
};
#[doc(hidden)]
pub use model::{ModelCell, ModelFactors, Parts, RepeatedRows, SettledRows};
pub(crate) use prediction::{Identified, predict_torques};
pub(crate) use prepared::{PreparedRecording, frequency_hz};
pub(crate) use reduced::data::{ReducedData, ReducedIdentification, SimulatedInstruments};
#[doc(hidden)]
pub use terms::profiled_robot::with_constants;
pub(crate) use validation::cross_validation::Folds;
