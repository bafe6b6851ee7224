//! Errors of the library as exceptions of the package: the library's texts, and the remedies of [`crate::remedies`].

use std::{error::Error, sync::Arc};

use pyo3::prelude::*;
use thetahat::{
    base_parameters::BaseParametersError,
    campaign::CampaignError,
    dynamics::DynamicsError,
    experiment::{ExperimentError, ProposalError},
    export::ExportError,
    filter_choice::FilterChoiceError,
    identification::{EstimationError, UnknownMethod},
    preparation::PreparationError,
    recording::RecordingError,
    reduction::ReductionError,
    report::ReportError,
    results::ResultsError,
    robot::RobotError,
    signal::SignalError,
    simulation::SimulationError,
};
use thetahat_ground::output::OutputError;

use crate::remedies;

/// An exception to be raised: the name of its class in `thetahat.errors`, and its text.
#[derive(Debug)]
pub struct PythonError {
    class: &'static str,
    text: String,
    /// What a function of the user's raised, where that is the cause.
    cause: Option<Arc<dyn Error + Send + Sync>>,
}

impl PythonError {
    pub fn new(class: &'static str, text: impl ToString) -> Self {
        Self { class, text: text.to_string(), cause: None }
    }

    /// An error of the library with its remedy in the words of the package.
    pub fn with_remedy(class: &'static str, error: impl ToString, remedy: Option<String>) -> Self {
        let text = error.to_string();
        Self::new(class, remedy.map_or_else(|| text.clone(), |remedy| format!("{text}; {remedy}")))
    }
}

impl From<PythonError> for PyErr {
    fn from(raised: PythonError) -> Self {
        Python::attach(|py| {
            let error = py
                .import("thetahat.errors")
                .and_then(|errors| errors.getattr(raised.class))
                .and_then(|class| class.call1((raised.text,)));
            let error = error.map_or_else(|failed| failed, PyErr::from_value);
            if let Some(cause) = raised.cause.as_ref().and_then(|cause| cause.downcast_ref::<PyErr>()) {
                error.set_cause(py, Some(cause.clone_ref(py)));
            }
            error
        })
    }
}

macro_rules! raised_as {
    ($($error:ty => $class:literal),* $(,)?) => {$(
        impl From<$error> for PythonError {
            fn from(error: $error) -> Self {
                Self::new($class, error)
            }
        }
    )*};
}

raised_as! {
    BaseParametersError => "RobotError",
    RobotError => "RobotError",
    RecordingError => "RecordingError",
    FilterChoiceError => "SettingsError",
    UnknownMethod => "SettingsError",
    SignalError => "SignalError",
    EstimationError => "EstimationError",
    SimulationError => "SimulationError",
    ReportError => "ReportError",
    ResultsError => "ResultsError",
}

impl From<PreparationError> for PythonError {
    /// What an estimator of the user's own raised is the cause of its error.
    fn from(error: PreparationError) -> Self {
        if let PreparationError::Estimator { source, .. } = &error {
            return Self { cause: Some(source.clone()), ..Self::new("EstimationError", &error) };
        }
        Self::new("SettingsError", error)
    }
}

impl From<OutputError> for PythonError {
    fn from(error: OutputError) -> Self {
        let remedy = remedies::of_output(&error);
        Self::with_remedy("ReportError", error, remedy)
    }
}

impl From<ProposalError> for PythonError {
    fn from(error: ProposalError) -> Self {
        let remedy = remedies::of_proposal(&error);
        Self::with_remedy("RecordingError", error, remedy)
    }
}

impl From<ExportError> for PythonError {
    fn from(error: ExportError) -> Self {
        let remedy = remedies::of_export(&error);
        Self::with_remedy("ResultsError", error, remedy)
    }
}

impl From<ExperimentError> for PythonError {
    /// What is wrong with the robot or a recording of an experiment is what would be wrong without it.
    fn from(error: ExperimentError) -> Self {
        match error {
            ExperimentError::Robot(error) => error.into(),
            ExperimentError::Recording(error) => error.into(),
            ExperimentError::Results(error) => error.into(),
            error @ (ExperimentError::Unreadable { .. }
            | ExperimentError::Syntax { .. }
            | ExperimentError::Preparation { .. }
            | ExperimentError::Filter { .. }
            | ExperimentError::Plan { .. }
            | ExperimentError::Twin { .. }
            | ExperimentError::ResultsFile { .. }
            | ExperimentError::OutsideFolder { .. }
            | _) => {
                let remedy = remedies::of_experiment(&error);
                Self::with_remedy("ExperimentError", error, remedy)
            }
        }
    }
}

impl From<CampaignError> for PythonError {
    /// An experiment that cannot be used is one without its campaign, too.
    fn from(error: CampaignError) -> Self {
        match error {
            CampaignError::Experiment(error) => error.into(),
            error @ (CampaignError::Unreadable { .. }
            | CampaignError::Syntax { .. }
            | CampaignError::Value { .. }
            | CampaignError::NoPhysicalStart { .. }
            | CampaignError::NoRecording { .. }
            | CampaignError::OtherCampaign { .. }
            | CampaignError::NoCampaign { .. }
            | CampaignError::NoParquet { .. }
            | CampaignError::Damaged { .. }
            | CampaignError::Write { .. }
            | _) => Self::new("CampaignError", error),
        }
    }
}

impl From<ReductionError> for PythonError {
    fn from(error: ReductionError) -> Self {
        match error {
            ReductionError::Experiment(error) => error.into(),
            ReductionError::Results(error) => error.into(),
            ReductionError::Estimation(error) => error.into(),
            error @ (ReductionError::UnequalSteps { .. }
            | ReductionError::Gaps { .. }
            | ReductionError::NoTorque { .. }
            | ReductionError::Unlike { .. }
            | ReductionError::SameRecording { .. }
            | ReductionError::Overlap { .. }
            | ReductionError::Apart { .. }
            | ReductionError::NoReference { .. }
            | ReductionError::Simulation { .. }
            | ReductionError::Seam { .. }
            | ReductionError::NoEstimates { .. }
            | ReductionError::Damaged { .. }
            | ReductionError::Version { .. }
            | ReductionError::Unreadable { .. }
            | ReductionError::Unwritable { .. }
            | _) => Self::new("ReductionError", error),
        }
    }
}

impl From<(usize, DynamicsError)> for PythonError {
    fn from((sample, error): (usize, DynamicsError)) -> Self {
        Self::new("SimulationError", format!("at sample {sample}: {error}"))
    }
}
