//! The results of a run as plain data: the content of `results.json`, and the values that the report and exports show.
//!
//! [`Results::read`] and [`Results::to_json`] are the one place that reads and writes `results.json`. Reports and exports
//! import this room and no room that computes.
//!
//! ```
//! use std::path::Path;
//! use thetahat_report::results::Results;
//!
//! # fn main() -> Result<(), thetahat_report::results::ResultsError> {
//! let text = r#"{
//!   "schema": 2, "thetahat": "0.1.0", "robot": "EMPS", "title": "One axis", "samples_used": 100, "decimated_rows": 10,
//!   "recordings": [], "validation_recordings": [], "seed": null, "elimination": null,
//!   "bandwidth": { "position_cutoff_hz": 50.0, "decimation_cutoff_hz": 20.0 },
//!   "experiment_description": "", "robot_description": "",
//!   "runs": [{
//!     "case": "nominal", "method": "idim-ls", "status": "converged", "iterations": 0, "simulations": 0,
//!     "joint_relative_error_percent": [5.5], "seconds": 0.1, "convergence": [],
//!     "parameters": [{ "name": "m1r", "estimate": 95.1, "standard_deviation": 0.2, "unit": "kg",
//!                      "expression": "m1 + ia1", "shown": true }]
//!   }]
//! }"#;
//! let results = Results::from_json(Path::new("results.json"), text)?;
//! let mass = results.runs[0].parameter("m1r").expect("the run estimates it");
//! println!("{} = {} +- {:?} {}", mass.name, mass.estimate, mass.standard_deviation, mass.unit);
//! assert_eq!((mass.estimate, mass.interval_95), (95.1, None));
//! # Ok(())
//! # }
//! ```

mod campaign;
mod card;
mod cause;
mod content;
mod curves;
mod design;
mod diagnosis;
mod estimate;
mod file;
mod filter;
mod grade;
mod joints;
mod limited;
mod model;
mod parameters;
mod payload;
mod physical;
mod predicted_intervals;
mod prediction;
mod recordings;
mod remedy;
mod run;
mod sensitivity;
mod side_by_side;
mod terms;
mod twin;
mod user_run;
mod verdict;
mod watch;

pub use campaign::{CampaignResults, Extent, MethodSummary, ParameterSummary, PublishedStatement, Quantiles};
pub use card::{Card, Physical, Unseen};
pub use cause::{CauseKind, ModelCause, SmallestShown};
pub use content::{NOMINAL, Results, SCHEMA};
pub use curves::{Bin, Frame, HeldBackPlots, Plots, RecordStart, ResidualCurves, RunPlots, Skeleton};
pub use design::{
    CollisionResults, DesignResults, ExecutedMotion, ExperimentText, LimitUse, MotionSpectrum, PairDistance,
    PredictedGain, PredictedParameter, PredictedPayload, PredictedRows, PredictedTorques, SearchResult, SpectrumBound,
    TrajectoryPoints,
};
pub use diagnosis::{
    Advice, ApproximatedParameter, ApproximationResult, BiasExplanation, BiasedSimulatorResult, CaseDiagnosis,
    Comparison, EndogeneityResult, Explained, HiddenBias, HiddenError, Influence, InstrumentResult, JointResidual,
    MovedParameter, ParameterDifference, ResidualResult,
};
pub use estimate::{EstimateSource, NoEstimate};
pub use file::ResultsError;
pub use filter::{ComparedFilter, Filter, FilterChoice, FilterError};
pub use grade::Grade;
pub use joints::JointResult;
pub use limited::Limited;
#[doc(hidden)]
pub use model::kinds_of;
pub use model::{
    ModelCandidate, ModelError, ModelJoint, ModelJointError, ModelParameter, ModelResult, ModelStandardParameter,
    ModelUse, UseGrade,
};
#[doc(hidden)]
pub use parameters::NotSeparated;
pub use parameters::{EliminationResult, ParameterResult};
pub use payload::{DriveGainResult, PayloadParameter, PayloadResult};
pub use physical::{ConsistencyTest, ConsistentEstimate, ConsistentParameter, PhysicalResult};
pub use predicted_intervals::{ComparedInterval, IntervalsAgainstPrediction, PredictedIntervals, PredictionError};
pub use prediction::Prediction;
pub use recordings::{
    Bandwidth, NearRestResult, PeriodicResult, RecordingFindings, RecordingResult, ReferenceResult, UnmaskedComparison,
};
#[doc(hidden)]
pub use remedy::{RecordingStep, Remedy, SettingChange};
pub use run::{IterationResult, LoopParameterResult, RunResult};
pub use sensitivity::{Sensitivity, SensitivityPoint};
pub use side_by_side::{ComparedParameter, SettingDifference, Side, SideBySide, SideBySideError};
pub use terms::{JointTermComparison, ProfiledTerm, TermComparison, TermLaw};
pub use twin::TwinRecording;
pub use user_run::UserRun;
pub use verdict::{NotExamined, ReasonCode, ReasonSubject, Verdict, VerdictReason};
pub use watch::{WatchChange, WatchCollision, WatchDrift, WatchEvent, WatchResidual, WatchSettled, WatchSummary};

// The values of other rooms that results hold and reports show.
pub use thetahat_data::recording::{ChannelSummary, ColumnSummary, Contents, Resampling, TableSummary, TimeSummary};
#[doc(no_inline)]
pub use thetahat_estimation::{
    checks::{Code, Finding, RemedySignal, RemedyStep, Severity},
    identification::{Method, Status, Weighting},
    simulation::BiasKind,
    statistics::{ChiSquaredTest, FTest},
    trajectory::{Move, Moves},
};
pub use thetahat_model::{
    robot::{Doubt, JointKind, LockedJoint, Parameter, Quantity},
    robot_summary::{BaseParameterSummary, JointSummary, ParameterCount, RobotSummary, StandardParameterSummary},
};
