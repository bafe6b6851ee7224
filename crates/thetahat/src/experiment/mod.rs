//! An experiment: one TOML file that describes a run, and what it proposes for a recording.
//!
//! [`Experiment::read`] checks the file; [`Experiment::run`] reads its recordings and identifies the robot with its settings
//! ([`crate::run::Identification`]). The twin ([`Experiment::demo`]) does the same with a simulated recording.
//!
//! ```
//! use thetahat::Experiment;
//!
//! // The built-in demonstration: a TX40 twin, nominal and with gear ratios at 90 %.
//! let experiment = Experiment::demo()?;
//! let cases: Vec<String> = experiment.cases().into_iter().map(|case| case.name).collect();
//! assert_eq!(cases, ["nominal", "gear_ratio_0.9"]);
//! # Ok::<(), thetahat::experiment::ExperimentError>(())
//! ```

mod arrival_times;
mod base;
mod column_names;
mod copies;
mod delays;
mod description;
mod driver;
mod error;
mod floating;
mod identified;
mod locked_motion;
mod low_pass;
mod missing_values;
mod paths;
mod power;
mod predict;
mod proposal;
mod reading;
mod remedies;
mod repeated_rows;
mod robot_file;
mod run;
mod straight_lines;
mod subject;
mod twin;
mod unit_words;
mod validation;

pub(crate) use paths::path_in_project;

#[doc(hidden)]
pub use base::{BaseDescription, ContactDescription, Contacts, NamedContacts, Orientation, WrenchAxes};
#[doc(hidden)]
pub use description::{Experiment, ExperimentFile, RecordingDescription, TwinDescription, Unlisted};
pub use driver::Driver;
#[doc(hidden)]
pub use driver::{DriverController, DriverError, DriverSignal, DriverTime};
pub use error::ExperimentError;
pub use identified::{EstimateRequest, IdentifiedRobot};
#[doc(hidden)]
pub use power::PowerPoint;
pub(crate) use predict::recording_to_predict;
pub use predict::{PredictionRequest, predict};
pub use proposal::{
    Proposal, ProposalError, ProposalFiles, ProposalRequest, ProposedChannels, ProposedSignal, propose,
};
#[doc(hidden)]
pub use proposal::{
    ProposedClock, ProposedControl, ProposedDriver, ProposedLock, ProposedRecording, propose_for_motion,
};
#[doc(hidden)]
pub use twin::{TwinMotion, TwinReference};
