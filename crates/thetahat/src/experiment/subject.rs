//! The robot and the settings that results belong to, from an experiment or of arrays.

use std::path::{Path, PathBuf};

use super::{description::Experiment, error::ExperimentError};
use crate::{
    preparation::{ParameterChoice, ParameterSelection, Settings},
    run::with_constants,
};
use thetahat_model::{
    base_parameters::BaseParameters,
    robot::{Locks, Robot, RobotSource},
};
use thetahat_report::results::{Results, RunResult};

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

/// The identified robot, and the settings.
pub(super) struct Subject {
    pub(super) robot: Robot,
    pub(super) settings: Settings,
    /// Name of the file of the robot's description.
    pub(super) file: Option<PathBuf>,
    pub(super) experiment: Option<Experiment>,
}

impl Subject {
    /// Those of the experiment in the results, or the usual settings where they are of arrays.
    pub(super) fn of(path: &Path, results: &Results, run: &RunResult) -> Result<Self, ExperimentError> {
        if results.robot_description.is_empty() {
            return Err(ExperimentError::NoRobot { path: path.to_owned() });
        }
        if results.experiment_description.is_empty() {
            return Self::of_arrays(path, results, run);
        }
        let experiment = Experiment::of_results(path, results)?;
        Ok(Self {
            robot: experiment.robot.clone(),
            settings: experiment.settings.clone(),
            file: experiment.file.robot.file_name().map(PathBuf::from),
            experiment: Some(experiment),
        })
    }

    fn of_arrays(path: &Path, results: &Results, run: &RunResult) -> Result<Self, ExperimentError> {
        let source = RobotSource::from_text(results.robot_description.clone(), path)?;
        let locks = Locks::restating(&results.robot_locked, &source.robot_without_transmission()?.joints);
        let robot = with_constants(&source.robot_with_locks(&locks, path)?, &results.profiled_terms);
        let parameters = ParameterSelection {
            estimate: ParameterChoice::List(run.parameters.iter().map(|p| p.name.clone()).collect()),
            exclude: results.excluded_parameters.clone(),
            fix: results.fixed_parameters.clone(),
            ..ParameterSelection::default()
        };
        let file = results.robot_files.first().map(|file| PathBuf::from(&file.name));
        Ok(Self { robot, settings: Settings { parameters, ..Settings::new(1.0, 1) }, file, experiment: None })
    }
}

/// Refuses a run whose parameters are not those of its robot and experiment: a prediction that misses one of them, or uses one of
/// another robot, would be wrong without notice.
pub(super) fn require_same_parameters(
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
    let not_separated = |name: &str| results.not_separated.iter().any(|left_out| left_out.parameter == name);
    let wanted: Vec<&str> = match choice {
        ParameterChoice::List(names) => names.iter().map(String::as_str).collect(),
        ParameterChoice::Base | ParameterChoice::Named(_) => {
            base.parameters().iter().map(|p| p.name.as_str()).collect()
        }
    };
    match wanted.into_iter().find(|name| !estimated(name) && !eliminated(name) && !not_separated(name)) {
        None => Ok(()),
        Some(name) => Err(refuse(format!("{name} is missing"))),
    }
}
