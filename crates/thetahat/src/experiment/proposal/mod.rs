//! An experiment file proposed from what is in recordings.
//!
//! | file | what it does |
//! | --- | --- |
//! | `request`, `error` | what a proposal is made for, and why there is none |
//! | `files` | the files that a proposal is made for, and how the experiment names them |
//! | `named` | the columns that the user named: `NAME`, `FILE` or `FILE:NAME` |
//! | `of_driver` | what is said of the driver that wrote the log |
//! | `driver_units` | units and gains as the driver has them, and what in the log contradicts it |
//! | `source` | a file with the table of it that is used |
//! | `joint_names`, `joints` | which column is of which joint; joints that the log lacks are locked |
//! | `standing` | joints that stand in all recordings, which are locked as well |
//! | `set_aside` | columns that look like a signal next to those of its measurement: limits, external torques, copies |
//! | `columns` | which columns of a file hold a signal, by their names or the file's |
//! | `offer` | what each file offers |
//! | `grouping` | which files are of one recording |
//! | `written`, `unit_names` | the units that names say, of a column and of each channel |
//! | `gains` | what a gain is to hold, where a unit is no torque |
//! | `stated` | methods, and gains of the torques and of the controller, as the user states them |
//! | `control` | the controller of a log without torques |
//! | `units` | units and sides, by names and ranges |
//! | `clock` | times or a rate |
//! | `recordings` | each recording as it is to be described |
//! | `recorded` | the positions that a file has of a robot's joints, for a prediction |
//! | `filter` | the filter chosen from the recordings |
//! | `text` | the proposal as data, and as the text of an experiment file |

mod clock;
mod columns;
mod control;
mod driver_units;
mod error;
mod files;
mod filter;
mod gains;
mod grouping;
mod joint_names;
mod joints;
mod named;
mod of_driver;
mod offer;
mod recorded;
mod recordings;
mod request;
mod set_aside;
mod source;
mod standing;
mod stated;
mod text;
mod unit_names;
mod units;
mod written;

pub use control::ProposedControl;
pub use error::ProposalError;
pub use files::ProposalFiles;
pub use joints::ProposedLock;
pub(super) use recorded::recorded_positions;
pub use recordings::propose;
#[doc(hidden)]
pub use recordings::propose_for_motion;
pub use request::ProposalRequest;
pub use text::{Proposal, ProposedChannels, ProposedClock, ProposedDriver, ProposedRecording, ProposedSignal};

#[cfg(test)]
mod driver_bags;
#[cfg(test)]
mod driver_tests;
#[cfg(test)]
mod length_tests;
#[cfg(test)]
mod mixed_unit_tests;
#[cfg(test)]
mod tests;
