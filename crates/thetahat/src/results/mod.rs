//! What a run gives, as plain data: the content of `results.json`, and what the report prints.

mod content;
mod curves;
mod diagnosis;
mod parameters;
mod prediction;
mod recordings;
mod run;
mod sensitivity;
mod twin;

pub use content::{NOMINAL, Results};
pub use curves::{Plots, RunPlots};
pub use diagnosis::{
    Advice, BiasExplanation, BiasedSimulatorResult, CaseDiagnosis, EndogeneityResult, Influence, InstrumentResult,
    JointResidual, ParameterDifference, ResidualResult, Verdict,
};
pub use parameters::{EliminationResult, ParameterResult};
pub use prediction::Prediction;
pub use recordings::{Bandwidth, RecordingFindings, RecordingResult, ReferenceResult};
pub use run::{IterationResult, RunResult};
pub use sensitivity::{Sensitivity, SensitivityPoint};
pub use twin::TwinRecord;
