//! A robot with the parameters that results hold.

use std::path::Path;

use super::{
    description::Experiment,
    error::ExperimentError,
    predict::{chosen_run, require_same_parameters},
};
use crate::{
    base_parameters::BaseParameters,
    diagnosis::judge,
    dynamics::Model,
    identification::Method,
    preparation::Case,
    results::{Results, Verdict},
    robot::Robot,
};

/// A robot with identified parameters.
#[derive(Debug, Clone)]
pub struct IdentifiedRobot {
    /// The robot that was identified, with the joints that were locked and the friction model of the case.
    pub robot: Robot,
    /// Standard parameters with the torques that were identified: the kept ones, those that were given, zeros elsewhere.
    pub theta: Vec<f64>,
    /// The case whose estimates they are.
    pub case: String,
    /// The method.
    pub method: Method,
    /// What the results are good for.
    pub verdict: Verdict,
}

impl IdentifiedRobot {
    /// The robot and the estimates of a case in a `results.json`, by a method or that which the results advise.
    ///
    /// # Errors
    /// [`ExperimentError`] for a file that cannot be used, or that holds no such estimate.
    pub fn read(path: &Path, case: &str, method: Option<Method>) -> Result<Self, ExperimentError> {
        let mut results = Results::read(path)?;
        let verdict = results.verdict.unwrap_or_else(|| judge(&mut results));
        let experiment = Experiment::of_results(path, &results)?;
        let run = chosen_run(path, &results, case, method)?;
        let case = experiment.cases().into_iter().find(|c| c.name == run.case).unwrap_or_else(Case::nominal);
        let base = experiment.setup().basis(&case).map_err(|e| experiment.refuse(e))?.base;
        require_same_parameters(&results, run, &base, &experiment.settings.parameters.estimate)
            .map_err(|problem| ExperimentError::ResultsFile { path: path.to_owned(), problem })?;
        let estimate = |name: &String| run.parameter(name).map_or(0.0, |parameter| parameter.estimate);
        let estimates: Vec<f64> = base.parameters().iter().map(|parameter| estimate(&parameter.name)).collect();
        Ok(Self {
            robot: experiment.setup().robot_for(&case),
            theta: base.to_standard(&estimates),
            case: run.case.clone(),
            method: run.method,
            verdict,
        })
    }

    /// Refuses another robot than the one that was identified: one with other base parameters.
    ///
    /// # Errors
    /// [`ExperimentError::ResultsFile`] with the first formula that differs; `path` is the file of the results.
    pub fn require_robot(&self, path: &Path, robot: &Robot) -> Result<(), ExperimentError> {
        let refuse = |problem: String| ExperimentError::ResultsFile { path: path.to_owned(), problem };
        let formulas = |robot: &Robot| -> Result<Vec<String>, ExperimentError> {
            let base = BaseParameters::of(&Model::new(robot), &[]).map_err(|error| refuse(error.to_string()))?;
            Ok(base.parameters().iter().map(|p| p.expression.clone()).collect())
        };
        let (own, other) = (formulas(&self.robot)?, formulas(robot)?);
        let differs = (0..own.len().max(other.len())).find(|&i| own.get(i) != other.get(i));
        let Some(first) = differs else { return Ok(()) };
        let of = |formulas: &[String]| formulas.get(first).cloned().unwrap_or_else(|| "not there".to_owned());
        Err(refuse(format!(
            "is of another robot than {}: its base parameter {} is {} there; give the robot that was identified",
            robot.name,
            of(&own),
            of(&other)
        )))
    }
}
