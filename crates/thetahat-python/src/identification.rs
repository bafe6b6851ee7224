//! Identification from recordings and settings, or from an experiment file.

use std::{path::PathBuf, sync::Arc};

use numpy::{IntoPyArray, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use thetahat::{
    Experiment, Identification, Method, Settings,
    experiment::ProposedSignal,
    filter_choice,
    identification::{UserEstimate, UserEstimator, UserRegression},
};

use crate::{
    arrays::{matrix_array, matrix_of},
    interruptible::{self, Interpreter},
    python_error::PythonError,
    recording::{Recording, into_library},
    results::Results,
    robot::{Robot, vector_of},
    values,
};

/// Identifies a robot from recordings, and validates on others, with settings and the user's own estimators, on a number of threads;
/// without a number on all processors.
#[pyfunction]
pub fn identify(
    py: Python<'_>,
    robot: &Robot,
    recordings: (Vec<Recording<'_>>, Vec<Recording<'_>>),
    settings: (Bound<'_, PyAny>, Vec<(String, Py<PyAny>)>),
    title: String,
    threads: Option<usize>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Results> {
    let (settings, estimators) = settings;
    let settings: Settings = values::read(&settings)?;
    let (recordings, validation) = (into_library(recordings.0)?, into_library(recordings.1)?);
    let robot = robot.clone();
    let (description, robot_files) = (robot.description(), robot.source()?.files());
    let results = interruptible::run(py, progress, move |interpreter| {
        interpreter.report_stage("reading and filtering the recordings");
        let estimators =
            estimators.into_iter().map(|(name, function)| user_estimator(&name, function, interpreter.clone()));
        let identification = Identification::new(&robot.robot, recordings, settings)?.with_validation(validation)?;
        let identification = match threads {
            Some(threads) => identification.on_threads(threads),
            None => identification,
        };
        let identification = estimators.into_iter().try_fold(identification, |identification, estimator| {
            Ok::<_, PythonError>(identification.with_estimator(estimator?)?)
        })?;
        Ok(identification.run_with_progress(&mut |stage| interpreter.report_stage(stage))?)
    })?;
    let results = thetahat::Results { title, robot_description: description, robot_files, ..results };
    Ok(Results::new(results, None))
}

/// The user's own estimator: a function of arrays that returns parameters and their covariance.
fn user_estimator(name: &str, function: Py<PyAny>, interpreter: Interpreter) -> Result<UserEstimator, PythonError> {
    let function = Arc::new(function);
    let estimator = UserEstimator::new(name, move |rows| {
        let (function, rows) = (function.clone(), rows.clone());
        Ok(interpreter.call(move |py| call(py, &function, rows))?)
    });
    estimator.map_err(|e| PythonError::new("SettingsError", e))
}

fn call(py: Python<'_>, function: &Py<PyAny>, rows: UserRegression) -> PyResult<UserEstimate> {
    let z = rows.z.map(|z| matrix_array(py, z)).transpose()?;
    let (x, y) = (matrix_array(py, rows.x)?, rows.y.into_pyarray(py));
    let share = rows.share.into_pyarray(py);
    let arguments = (x, y, z, rows.joint, rows.recording, share, rows.names, rows.units);
    let found = function.bind(py).call1((arguments,))?;
    let (theta, covariance): (PyReadonlyArray1<'_, f64>, Option<PyReadonlyArray2<'_, f64>>) = found.extract()?;
    Ok(UserEstimate { theta: vector_of(&theta), covariance: covariance.map(|c| matrix_of(c.as_array())) })
}

/// Runs an experiment file.
#[pyfunction]
pub fn run(
    py: Python<'_>,
    path: PathBuf,
    data: PathBuf,
    robot: Option<PathBuf>,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<(Results, Robot)> {
    interruptible::run(py, progress, move |interpreter| {
        let experiment = match robot {
            Some(robot) => Experiment::read_with_robot(&path, &robot)?,
            None => Experiment::read(&path, &data)?,
        };
        let results = experiment.run(&data, &mut |stage| interpreter.report_stage(stage))?;
        let (text, robot_text) = (&results.experiment_description, &results.robot_description);
        let robot = Robot::of_experiment(&path, text, robot_text, &results.profiled_terms)?;
        Ok((Results::new(results, experiment.published_path()), robot))
    })
}

/// Refuses an unknown method.
#[pyfunction]
pub fn require_method(name: &str) -> Result<(), PythonError> {
    name.parse::<Method>()?;
    Ok(())
}

/// The filter with the smallest error of the estimates, and why it was chosen, as in `thetahat init`.
#[pyfunction]
pub fn choose_filter(
    py: Python<'_>,
    robot: &Robot,
    recordings: Vec<Recording<'_>>,
    settings: &Bound<'_, PyAny>,
) -> PyResult<(f64, usize, Vec<String>)> {
    let settings: Settings = values::read(settings)?;
    let (recordings, robot) = (into_library(recordings)?, robot.robot.clone());
    interruptible::run(py, None, move |_| {
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        let rate_hz = recordings.iter().map(|r| r.sample_rate_hz).fold(f64::INFINITY, f64::min);
        let signal = match filter_choice::choose_filter(&robot, &settings, &recordings, None, threads) {
            Ok(choice) => ProposedSignal::chosen(&choice),
            Err(filter_choice::FilterChoiceError::Preparation { source }) => return Err(PythonError::from(source)),
            Err(reason) => ProposedSignal::not_chosen(rate_hz, &reason.to_string()),
        };
        Ok((signal.cutoff_hz, signal.decimation, signal.comment))
    })
}
