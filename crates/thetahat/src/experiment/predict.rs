//! The torques that identified parameters predict for another motion.

use std::path::{Path, PathBuf};

use super::{
    description::{Experiment, RecordingDescription},
    error::ExperimentError,
};
use crate::{
    base_parameters::BaseParameters,
    diagnosis::judge,
    identification::Method,
    one_or_each::OneOrEach,
    preparation::{Case, ParameterChoice, PreparationError},
    recording::{ChannelSource, Side, Unit},
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
    pub torque_file: Option<PathBuf>,
    /// Columns of the positions; none takes those of the experiment.
    pub position: Vec<String>,
    /// Columns of the torques, likewise.
    pub torque: Vec<String>,
    /// The time column, likewise.
    pub time: Option<String>,
    /// Start and end of the window, s; none takes that of the experiment.
    pub window_s: Option<[f64; 2]>,
    /// The case.
    pub case: String,
    /// The method; none takes the one that the results advise, or else the first with an estimate.
    pub method: Option<Method>,
}

/// Predicts the torques of a motion with the parameters of an earlier identification, in the window of the experiment.
///
/// # Errors
/// [`ExperimentError`] for files that cannot be used.
pub fn predict(request: &PredictionRequest) -> Result<Prediction, ExperimentError> {
    let mut results = Results::read(&request.results)?;
    // Results of before the verdict get it now, by the same rules.
    let verdict = results.verdict.unwrap_or_else(|| judge(&mut results));
    let experiment = Experiment::of_results(&request.results, &results)?;
    let run = chosen_run(request, &results)?;
    let case = experiment.cases().into_iter().find(|c| c.name == run.case).unwrap_or_else(Case::nominal);
    let base = experiment.setup().basis(&case).map_err(|e| experiment.refuse(e))?.base;
    require_same_parameters(&results, run, &base, &experiment.settings.parameters.estimate)
        .map_err(|problem| ExperimentError::ResultsFile { path: request.results.clone(), problem })?;
    let description = described(&experiment, request)?;
    let same_file = description.torque.as_ref().is_some_and(|torque| torque.file == description.position.file);
    let recording = if same_file || request.torque_file.is_some() {
        experiment.read_recording(&description, 1, Path::new(""))?
    } else {
        experiment.read_motion(&description, Path::new(""))?
    };
    let parameters = run.parameters.iter().map(|p| (p.name.clone(), p.estimate)).collect();
    let verdict = (verdict, results.verdict_reasons.clone());
    let identified = Identified { case: &case, method: run.method, parameters, verdict };
    predict_torques(experiment.setup(), &identified, recording).map_err(|e| experiment.refuse(e))
}

impl Experiment {
    /// The experiment that results are of, with the constants of torque terms that were found; `path` names the results in
    /// messages.
    ///
    /// # Errors
    /// As [`Experiment::read`].
    pub fn of_results(path: &Path, results: &Results) -> Result<Self, ExperimentError> {
        let (text, robot) = (results.experiment_description.clone(), results.robot_description.clone());
        let mut experiment = Self::from_texts(path, text, robot)?;
        experiment.robot = with_constants(&experiment.robot, &results.profiled_terms);
        Ok(experiment)
    }
}

/// Refuses a run whose parameters are not those of the robot and the experiment beside it: a prediction without one of
/// them, or with one of another robot, would be wrong without a sign of it.
pub(crate) fn require_same_parameters(
    results: &Results,
    run: &RunResult,
    base: &BaseParameters,
    choice: &ParameterChoice,
) -> Result<(), String> {
    let refuse = |what: String| {
        let (case, method) = (&run.case, run.method.name());
        format!(
            "the parameters of {case} {method} are not those of its robot: {what}; identify again with this version"
        )
    };
    for (i, parameter) in run.parameters.iter().enumerate() {
        let name = &parameter.name;
        let Some(of_robot) = base.parameters().iter().find(|p| p.name == *name) else {
            return Err(refuse(format!("the robot has no {name}")));
        };
        if of_robot.expression != parameter.expression {
            return Err(refuse(format!("{name} is {}, and {} there", of_robot.expression, parameter.expression)));
        }
        if run.parameters[..i].iter().any(|p| p.name == *name) || !parameter.estimate.is_finite() {
            return Err(refuse(format!("{name} is there twice or is no number")));
        }
    }
    let estimated = |name: &str| run.parameter(name).is_some();
    let eliminated = |name: &str| results.elimination.as_ref().is_some_and(|e| e.eliminated.iter().any(|n| n == name));
    let wanted: Vec<&str> = match choice {
        ParameterChoice::List(names) => names.iter().map(String::as_str).collect(),
        ParameterChoice::Base | ParameterChoice::Named(_) => {
            base.parameters().iter().map(|p| p.name.as_str()).collect()
        }
    };
    match wanted.into_iter().find(|name| !estimated(name) && !eliminated(name)) {
        None => Ok(()),
        Some(name) => Err(refuse(format!("{name} is missing"))),
    }
}

/// The run of the request's case and method.
fn chosen_run<'r>(request: &PredictionRequest, results: &'r Results) -> Result<&'r RunResult, ExperimentError> {
    let wanted = request.method.or_else(|| Some(results.taken_in(&request.case)?.method));
    let fits =
        |r: &&RunResult| r.case == request.case && wanted.is_none_or(|m| m == r.method) && !r.parameters.is_empty();
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

/// The experiment's description of a recording, with the files and columns of the request: that of the same file, with
/// its window, or else that of the first recording.
fn described(experiment: &Experiment, request: &PredictionRequest) -> Result<RecordingDescription, ExperimentError> {
    let all = || experiment.file.recording.iter().chain(&experiment.file.validation);
    let same = all().find(|r| request.recording.ends_with(&r.position.file));
    let Some(chosen) = same.or_else(|| all().next()) else {
        return Err(experiment.missing("[recording]", "it describes the channels of the file to predict for"));
    };
    let mut description = chosen.clone();
    if let Some([start, end]) = request.window_s {
        let valid = start.is_finite() && start >= 0.0 && end.is_finite() && end > start;
        let expected = "a start at or above zero and an end behind it";
        PreparationError::require(valid, "--window-s", expected, format!("{start} {end}"))
            .map_err(|e| experiment.refuse(e))?;
        (description.window_start_s, description.window_end_s) = (Some(start), Some(end));
    } else if same.is_none() {
        (description.window_start_s, description.window_end_s) = (None, None);
    }
    if same.is_none() {
        description.payload = None;
    }
    take(&mut description.position, &request.recording, &request.position);
    if let Some(torque) = &mut description.torque {
        let beside = torque.file == chosen.position.file || !request.torque.is_empty();
        let file = request.torque_file.as_ref().or(beside.then_some(&request.recording));
        file.iter().for_each(|file| take(torque, file, &request.torque));
    } else if !request.torque.is_empty() || request.torque_file.is_some() {
        return Err(experiment.missing("[recording] torque", "it says the unit and the side of the torques"));
    }
    let time = description.time.take().or_else(|| request.time.as_ref().map(|_| seconds(&description.position)));
    description.time = time.map(|mut time| {
        take(&mut time, &request.recording, request.time.as_slice());
        time
    });
    if description.time.is_some() {
        description.sample_rate_hz = None;
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

/// A source with another file, and with other columns where any are named.
fn take(source: &mut ChannelSource, file: &Path, columns: &[String]) {
    source.file = file.to_owned();
    source.anywhere = true;
    if !columns.is_empty() {
        source.columns = columns.to_vec();
    }
}

/// A time channel in s in the file of the positions.
fn seconds(position: &ChannelSource) -> ChannelSource {
    ChannelSource { unit: OneOrEach::One(Unit::Second), side: Side::Joint, gain: None, ..position.clone() }
}
