//! From recordings and settings to a regression problem: band-pass, window, observation matrix, parallel decimation, and the
//! reference that simulations follow.
//!
//! ```
//! use thetahat::{Method, Robot, Settings, preparation::PreparationError};
//!
//! # let robot = "name = 'r'\n[[joint]]\nname = 'a'\nkind = 'revolute'\n";
//! # let robot = Robot::parse(robot, std::path::Path::new("r.toml")).unwrap();
//! // A cut-off of 20 Hz, every tenth sample kept; DIDIM needs a controller that is stated.
//! let settings = Settings::new(20.0, 10);
//! assert!(settings.validate(&robot).is_ok());
//! let error = settings.with_methods([Method::DIDIM]).validate(&robot).unwrap_err();
//! assert!(matches!(error, PreparationError::Missing { missing: "[controller]", .. }));
//! ```

mod consistent_set;
mod described_links;
mod error;
mod estimated_size;
mod filtered;
mod loop_parameters;
mod near_rest;
mod payload;
mod physical;
mod problem;
mod proposed_controller;
mod recording;
mod reference;
mod reference_correction;
mod reference_of_motion;
mod settings;
mod setup;
mod simulable;
mod unpowered;
mod validation;
mod wrapped;

pub(crate) use consistent_set::consistent_set_of;
pub(crate) use described_links::describes_links;
pub use error::PreparationError;
#[doc(hidden)]
pub use estimated_size::EstimatedSize;
pub(crate) use filtered::{
    FilteredRecording, MOVING, MotionOfRecording, STILL, accelerates, distorted_samples, near_ends, torques, window_of,
};
#[doc(hidden)]
pub use loop_parameters::LoopParameter;
pub(crate) use loop_parameters::{LoopParameters, LoopParts};
#[doc(hidden)]
pub use near_rest::near_rest;
pub(crate) use near_rest::near_rest_of_noise;
pub use payload::{Payload, PayloadFrame};
pub use physical::PriorOptions;
pub(crate) use physical::known_in_words;
#[doc(hidden)]
pub use physical::{Axis, KnownQuantity, PriorKind, PriorWeight, ValueOrRange, WeightRule};
pub(crate) use problem::Problem;
pub(crate) use proposed_controller::{ProposedController, is_iv, propose_controller};
#[doc(hidden)]
pub use recording::Recording;
pub(crate) use reference::{FoundPeriod, RecordedReference};
#[doc(hidden)]
pub use reference_correction::ReferenceCorrection;
pub use settings::{
    Case, EstimationOptions, Mask, ModelOptions, ParameterChoice, ParameterSelection, SignalOptions, SimulationOptions,
};
#[doc(hidden)]
pub use settings::{Gains, NamedChoice, NamedMask, PositionFilter, Settings, Start, StatedMask};
pub(crate) use setup::{Basis, Setup};
pub(crate) use simulable::Simulable;
pub(crate) use validation::validate_window;
pub(crate) use wrapped::unwrap;
