//! Inputs of several commands.

use std::{
    error::Error,
    num::NonZero,
    path::{Path, PathBuf},
};

use thetahat::Experiment;

use crate::arguments::Described;

/// The experiment, and the folder of its data.
pub fn read_experiment(described: &Described) -> Result<(Experiment, PathBuf), Box<dyn Error>> {
    let folder = described.experiment.parent().map_or_else(PathBuf::new, Path::to_owned);
    let data = described.data.clone().unwrap_or(folder);
    let experiment = match &described.robot {
        Some(robot) => Experiment::read_with_robot(&described.experiment, robot)?,
        None => Experiment::read(&described.experiment, &data)?,
    };
    Ok((experiment, data))
}

/// The requested threads, or one for each core.
pub fn threads(requested: Option<usize>) -> usize {
    requested.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, NonZero::get))
}
