//! Whether a robot description is the one that was identified.

use std::path::{Path, PathBuf};

use super::error::ExperimentError;
use thetahat_model::robot::{Robot, RobotFile, RobotSource};
use thetahat_report::results::Results;

/// Refuses a description that is not that of the results. Returns the files that were read.
///
/// # Errors
/// [`ExperimentError::AnotherRobot`], [`ExperimentError::RobotChanged`], and [`ExperimentError::Robot`] for one that cannot be
/// read.
pub(super) fn require_same(results: &Results, robot: &Robot, path: &Path) -> Result<Vec<PathBuf>, ExperimentError> {
    let source = RobotSource::read(path)?;
    let files = source.files();
    let is_same = if results.robot_files.is_empty() {
        source.to_text() == results.robot_description
    } else {
        // By content: a file may have another name by now.
        let is_there = |then: &RobotFile| files.iter().any(|now| now.sha256 == then.sha256);
        results.robot_files.iter().all(is_there)
    };
    if !is_same {
        return Err(difference(results, robot, &source));
    }
    Ok(source.paths().to_vec())
}

/// What differs: the joints, or else the bytes.
fn difference(results: &Results, robot: &Robot, source: &RobotSource) -> ExperimentError {
    let found = match source.robot_without_transmission() {
        Ok(found) => found,
        Err(error) => return error.into(),
    };
    let path = source.path();
    let names: Vec<String> = found.joints.iter().map(|j| j.name.clone()).collect();
    if robot.joints.iter().any(|joint| !names.contains(&joint.name)) {
        return ExperimentError::AnotherRobot {
            path: path.to_owned(),
            robot: results.robot.clone(),
            found: names,
            identified: robot.joints.iter().map(|j| j.name.clone()).collect(),
        };
    }
    let files = source.files();
    let hash_then = |file: &RobotFile| hash_in(results, &file.name).filter(|then| *then != file.sha256);
    let changed = files.iter().find_map(|file| Some((file, hash_then(file)?)));
    let (file, then) = changed.map_or((files.first(), None), |(file, then)| (Some(file), Some(then)));
    let unknown = || "not known".to_owned();
    ExperimentError::RobotChanged {
        path: file.map_or_else(|| path.to_owned(), |f| path.with_file_name(&f.name)),
        found: file.map_or_else(unknown, |f| f.sha256.clone()),
        identified: then.or_else(|| results.robot_files.first().map(|f| f.sha256.clone())).unwrap_or_else(unknown),
    }
}

fn hash_in(results: &Results, name: &str) -> Option<String> {
    results.robot_files.iter().find(|f: &&RobotFile| f.name == name).map(|f| f.sha256.clone())
}
