//! What several commands take from their arguments.

use std::{
    error::Error,
    num::NonZero,
    path::{Path, PathBuf},
};

use thetahat::Experiment;

use crate::arguments::Described;

/// The experiment, and the folder of its data.
pub fn read_experiment(described: &Described) -> Result<(Experiment, PathBuf), Box<dyn Error>> {
    let beside = described.experiment.parent().map_or_else(PathBuf::new, Path::to_owned);
    let data = described.data.clone().unwrap_or(beside);
    let experiment = match &described.robot {
        Some(robot) => Experiment::read_with_robot(&described.experiment, robot)?,
        None => Experiment::read(&described.experiment, &data)?,
    };
    Ok((experiment, data))
}

/// The threads asked for, or one for each core.
pub fn threads(asked: Option<usize>) -> usize {
    asked.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, NonZero::get))
}
