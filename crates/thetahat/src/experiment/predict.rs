//! The torques that identified parameters predict for another motion.

use std::path::{Path, PathBuf};

use super::{
    base::BaseDescription,
    description::{Experiment, RecordingDescription},
    error::ExperimentError,
    identified::{EstimateRequest, IdentifiedRobot},
    locked_motion::require_locked_at_rest,
};
use crate::preparation::{PreparationError, Recording};
use thetahat_data::recording::{ChannelSource, RecordingError, Side, Unit};
use thetahat_estimation::identification::Method;
use thetahat_ground::one_or_each::OneOrEach;
use thetahat_report::results::Prediction;

/// What to predict, and with which run.
#[derive(Debug, Clone)]
pub struct PredictionRequest {
    /// The `results.json` of an identification.
    pub results: PathBuf,
    /// The recording's file; its channels are described as in the experiment.
    pub recording: PathBuf,
    /// The file of the torques, if it is another one.
    pub torque_file: Option<PathBuf>,
    /// Columns of the positions; those of the experiment if empty.
    pub position: Vec<String>,
    /// Columns of the torques, likewise.
    pub torque: Vec<String>,
    /// The time column, likewise.
    pub time: Option<String>,
    /// Unit of the time; that of the experiment if absent.
    pub time_unit: Option<Unit>,
    /// Start and end of the window, s; `None` for that of the experiment.
    pub window_s: Option<[f64; 2]>,
    /// The case.
    pub case: String,
    /// The method; `None` for the one that the results recommend.
    pub method: Option<Method>,
}

/// Predicts the torques of a motion with the parameters of an earlier identification, in the window of the experiment.
///
/// # Errors
/// [`ExperimentError`] for files that cannot be used.
pub fn predict(request: &PredictionRequest) -> Result<Prediction, ExperimentError> {
    let chosen = EstimateRequest {
        case: request.case.clone(),
        method: request.method,
        // A prediction carries the verdict.
        untrusted: true,
        ..EstimateRequest::default()
    };
    let identified = IdentifiedRobot::read(&request.results, &chosen)?;
    let is_of_experiment = identified.experiment().is_some_and(|e| recorded_in(e, request).is_some());
    // The window of the experiment's recordings is none of another's.
    let identified = if is_of_experiment { identified } else { identified.without_window() };
    let Some(experiment) = identified.experiment() else {
        return Err(ExperimentError::OfArrays { path: request.results.clone() });
    };
    let description = recording_to_predict(experiment, request)?;
    if let Some(whole) = identified.robot_without_locks() {
        require_locked_at_rest(&description, &whole, &experiment.robot.locked)?;
    }
    let same_file = description.torque.as_ref().is_some_and(|torque| torque.file == description.position.file);
    let recording = if same_file || request.torque_file.is_some() {
        match experiment.read_recording(&description, 1, Path::new("")) {
            Err(error) if is_motion_alone(&error, &description, request) => {
                experiment.read_motion(&description, Path::new(""))?
            }
            read => read?,
        }
    } else {
        experiment.read_motion(&description, Path::new(""))?
    };
    require_length(&identified, &description, &recording)?;
    identified.predict_valid(recording).map_err(|e| experiment.refuse(e))
}

/// A recording with stamps is long enough: where it is not, they are in another unit as a rule.
fn require_length(
    identified: &IdentifiedRobot,
    description: &RecordingDescription,
    recording: &Recording,
) -> Result<(), ExperimentError> {
    let Some(time) = &description.time else { return Ok(()) };
    let (samples, rate) = (recording.position.len(), recording.sample_rate_hz);
    if identified.setup().require_periods(samples, rate).is_ok() {
        return Ok(());
    }
    Err(ExperimentError::ShortMotion {
        path: time.file.clone(),
        duration_s: samples as f64 / rate,
        unit: *time.unit.of(0),
    })
}

/// Whether a file was refused because it has none of the torques, which the request does not name: a planned motion.
fn is_motion_alone(error: &ExperimentError, description: &RecordingDescription, request: &PredictionRequest) -> bool {
    let ExperimentError::Recording(RecordingError::MissingColumn { column, found, .. }) = error else { return false };
    let Some(torque) = &description.torque else { return false };
    let is_asked = request.torque_file.is_some() || !request.torque.is_empty();
    !is_asked && torque.columns.contains(column) && !torque.columns.iter().any(|name| found.contains(name))
}

/// The recording of an experiment that a request is for.
fn recorded_in<'e>(experiment: &'e Experiment, request: &PredictionRequest) -> Option<&'e RecordingDescription> {
    let mut all = experiment.file.recording.iter().chain(&experiment.file.validation);
    all.find(|recording| request.recording.ends_with(&recording.position.file))
}

/// The experiment's description of a recording, with the files and columns of the request: that of the same file, with
/// its window, or else that of the first recording.
pub(crate) fn recording_to_predict(
    experiment: &Experiment,
    request: &PredictionRequest,
) -> Result<RecordingDescription, ExperimentError> {
    let same = recorded_in(experiment, request);
    let Some(chosen) = same.or_else(|| experiment.file.recording.iter().chain(&experiment.file.validation).next())
    else {
        return Err(experiment.missing("[recording]", "it describes the channels of the file to predict for"));
    };
    let mut description = chosen.clone();
    if let Some([start, end]) = request.window_s {
        let valid = start.is_finite() && start >= 0.0 && end.is_finite() && end > start;
        let expected = "a start at or above zero and an end after it";
        PreparationError::require(valid, "window_s", expected, format!("{start} {end}"))
            .map_err(|e| experiment.refuse(e))?;
        (description.window_start_s, description.window_end_s) = (Some(start), Some(end));
    } else if same.is_none() {
        (description.window_start_s, description.window_end_s) = (None, None);
    }
    if same.is_none() {
        description.payload = None;
    }
    rename_source(&mut description.position, &request.recording, &request.position);
    if let Some(torque) = &mut description.torque {
        let in_same_file = torque.file == chosen.position.file || !request.torque.is_empty();
        let file = request.torque_file.as_ref().or(in_same_file.then_some(&request.recording));
        file.iter().for_each(|file| rename_source(torque, file, &request.torque));
    } else if !request.torque.is_empty() || request.torque_file.is_some() {
        return Err(experiment.missing("[recording] torque", "it says the unit and the side of the torques"));
    }
    let time = description.time.take().or_else(|| request.time.as_ref().map(|_| seconds(&description.position)));
    description.time = time.map(|mut time| {
        rename_source(&mut time, &request.recording, request.time.as_slice());
        if let Some(unit) = request.time_unit {
            time.unit = OneOrEach::One(unit);
        }
        time
    });
    if description.time.is_some() {
        description.sample_rate_hz = None;
    }
    for channel in description.channels.values_mut() {
        channel.file.clone_from(&request.recording);
        channel.anywhere = true;
    }
    let base = description.base.iter_mut().flat_map(BaseDescription::sources_mut);
    for source in base.filter(|source| source.file == chosen.position.file) {
        rename_source(source, &request.recording, &[]);
    }
    description.velocity = None;
    description.reference = None;
    description.reference_correction = None;
    description.added_signal = None;
    Ok(description)
}

/// A source with another file, and with other columns where any are named.
fn rename_source(source: &mut ChannelSource, file: &Path, columns: &[String]) {
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
