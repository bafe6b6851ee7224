//! The torques that identified parameters predict for another motion.

use std::path::{Path, PathBuf};

use super::{
    description::{Experiment, RecordingDescription},
    error::ExperimentError,
};
use crate::{
    identification::Method,
    preparation::Case,
    results::{Prediction, Results, RunResult},
    run::{Identified, predict_torques, with_constants},
};

/// What to predict with which run.
#[derive(Debug, Clone)]
pub struct PredictionRequest {
    /// The `results.json` of an identification.
    pub results: PathBuf,
    /// The recording's file; its channels are described as in the experiment.
    pub recording: PathBuf,
    /// The file of the torques, where it is another one.
    pub torque: Option<PathBuf>,
    /// The case.
    pub case: String,
    /// The method; none takes the first converged run of the case.
    pub method: Option<Method>,
}

/// Predicts the torques of a motion with the parameters of an earlier identification.
///
/// # Errors
/// [`ExperimentError`] for files that cannot be used.
pub fn predict(request: &PredictionRequest) -> Result<Prediction, ExperimentError> {
    let results = Results::read(&request.results)?;
    let mut experiment = Experiment::from_texts(
        &request.results,
        results.experiment_description.clone(),
        results.robot_description.clone(),
    )?;
    experiment.robot = with_constants(&experiment.robot, &results.profiled_terms);
    let run = chosen_run(request, &results)?;
    let case = experiment.cases().into_iter().find(|c| c.name == run.case).unwrap_or_else(Case::nominal);
    let description = described(&experiment, request)?;
    let has_torque = request.torque.is_some() || same_file(&experiment);
    let recording = if has_torque {
        experiment.read_recording(&description, 1, Path::new(""))?
    } else {
        experiment.read_motion(&description, Path::new(""))?
    };
    let parameters = run.parameters.iter().map(|p| (p.name.clone(), p.estimate)).collect();
    let identified = Identified { case: &case, method: run.method, parameters };
    let prediction = predict_torques(experiment.setup(), &identified, recording, has_torque);
    prediction.map_err(|e| experiment.refuse(e))?.ok_or_else(|| ExperimentError::ResultsFile {
        path: request.results.clone(),
        problem: "names parameters that its robot does not have; identify again with this version".to_owned(),
    })
}

/// The run of the request's case and method.
fn chosen_run<'r>(request: &PredictionRequest, results: &'r Results) -> Result<&'r RunResult, ExperimentError> {
    let fits = |r: &&RunResult| {
        r.case == request.case && request.method.is_none_or(|m| m == r.method) && !r.parameters.is_empty()
    };
    results.runs.iter().find(fits).ok_or_else(|| {
        let with = |r: &&RunResult| !r.parameters.is_empty();
        let name = |r: &RunResult| format!("{} {}", r.case, r.method.name());
        let found: Vec<String> = results.runs.iter().filter(with).map(name).collect();
        let found = if found.is_empty() { "none".to_owned() } else { found.join(", ") };
        let method = request.method.map_or("any method", Method::name);
        ExperimentError::ResultsFile {
            path: request.results.clone(),
            problem: format!("holds no estimate of {} by {method}; those it holds: {found}", request.case),
        }
    })
}

/// The experiment's description of its recording, with the files of the request.
fn described(experiment: &Experiment, request: &PredictionRequest) -> Result<RecordingDescription, ExperimentError> {
    let Some(of_experiment) = experiment.file.recording.first() else {
        return Err(experiment.missing("[recording]", "it describes the channels of the file to predict for"));
    };
    let mut description = of_experiment.clone();
    description.position.file.clone_from(&request.recording);
    description.position.anywhere = true;
    if let Some(torque) = &mut description.torque {
        torque.file = request.torque.clone().unwrap_or_else(|| request.recording.clone());
        torque.anywhere = true;
    }
    if let Some(time) = &mut description.time {
        time.file.clone_from(&request.recording);
        time.anywhere = true;
    }
    for channel in description.channels.values_mut() {
        channel.file.clone_from(&request.recording);
        channel.anywhere = true;
    }
    description.velocity = None;
    description.reference = None;
    description.reference_correction = None;
    description.added_signal = None;
    Ok(description)
}

/// Whether the experiment has positions and torques in one file.
fn same_file(experiment: &Experiment) -> bool {
    experiment
        .file
        .recording
        .first()
        .is_some_and(|r| r.torque.as_ref().is_some_and(|torque| torque.file == r.position.file))
}
