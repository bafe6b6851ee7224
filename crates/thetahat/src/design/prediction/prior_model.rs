//! The model of an earlier identification as the a-priori robot.

use std::path::{Path, PathBuf};

use crate::design::error::DesignError;
use thetahat_model::robot::Robot;
use thetahat_report::results::Results;

/// Whether a file is a `results.json`, by its name.
pub(in crate::design) fn is_results(file: &Path) -> bool {
    file.extension().is_some_and(|extension| extension == "json")
}

pub(in crate::design) fn no_model(file: &Path) -> DesignError {
    DesignError::NoModel { file: file.to_owned() }
}

/// The robot with the model of the last of the files that are results.
pub(in crate::design) fn with_model(robot: Robot, files: &[PathBuf]) -> Result<Robot, DesignError> {
    let Some(file) = files.iter().rfind(|file| is_results(file)) else { return Ok(robot) };
    let model = Results::read(file)?.model.ok_or_else(|| no_model(file))?;
    let mut robot = robot;
    robot.a_priori.extend(model.standard.into_iter().map(|parameter| (parameter.name, parameter.value)));
    Ok(robot)
}
