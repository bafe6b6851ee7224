//! Inputs of several commands.

use std::{
    error::Error,
    num::NonZero,
    path::{Path, PathBuf},
};

use thetahat::Experiment;

use crate::arguments::Described;

/// The `results.json` of a folder, or the file itself.
pub fn results_file(path: &Path) -> PathBuf {
    if path.is_dir() { path.join("results.json") } else { path.to_owned() }
}

/// The experiment, and the folder of its data.
pub fn read_experiment(described: &Described) -> Result<(Experiment, PathBuf), Box<dyn Error>> {
    read_described(&described.experiment, described.data.as_deref(), described.robot.as_deref())
}

/// The same of a file with its options.
pub fn read_described(
    file: &Path,
    data: Option<&Path>,
    robot: Option<&Path>,
) -> Result<(Experiment, PathBuf), Box<dyn Error>> {
    let folder = file.parent().map_or_else(PathBuf::new, Path::to_owned);
    let data = data.map_or(folder, Path::to_owned);
    let experiment = match robot {
        Some(robot) => Experiment::read_with_robot(file, robot)?,
        None => Experiment::read(file, &data)?,
    };
    Ok((experiment, data))
}

/// The requested threads, or one for each core.
pub fn threads(requested: Option<usize>) -> usize {
    requested.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, NonZero::get))
}
