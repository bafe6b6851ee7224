//! From recordings and settings to a regression problem: band-pass, window, observation matrix, parallel decimation, and the
//! reference that simulations follow.

mod bandwidth;
mod error;
mod filtered;
mod problem;
mod recording;
mod reference;
mod settings;
mod setup;
mod validation;

pub use error::PreparationError;
pub(crate) use filtered::{FilteredRecording, MOVING, STILL, window_of};
pub(crate) use problem::{Chosen, Problem, full_model_test, named_elimination};
pub use recording::Recording;
pub(crate) use reference::{FILTERED, RecordedReference};
pub use settings::{
    Case, EstimationOptions, Gains, NamedChoice, ParameterChoice, ParameterSelection, Settings, SignalOptions,
    SimulationOptions, Start,
};
pub(crate) use setup::{Basis, Setup};
pub(crate) use validation::PROPOSED_BANDWIDTH_HZ;
pub(crate) use validation::validate_window;
