//! Whether a robot description is the one that was identified.

use std::path::Path;

use super::error::ExportError;
use crate::{
    results::Results,
    robot::{Robot, RobotFile, RobotSource},
};

/// Refuses a description that is not that of the results.
///
/// # Errors
/// [`ExportError::AnotherRobot`], [`ExportError::RobotChanged`], and [`ExportError::Robot`] for one that cannot be read.
pub(super) fn require_same(results: &Results, robot: &Robot, path: &Path) -> Result<(), ExportError> {
    let source = RobotSource::read(path)?;
    let files = source.files();
    let changed =
        files.iter().find_map(|file| Some((file, hash_in(results, &file.name).filter(|h| *h != file.sha256)?)));
    let is_same = if results.robot_files.is_empty() {
        source.to_text() == results.robot_description
    } else {
        // By content: a file may have another name by now.
        let is_there = |then: &RobotFile| files.iter().any(|now| now.sha256 == then.sha256);
        results.robot_files.iter().all(is_there)
    };
    if is_same {
        return Ok(());
    }
    let (found, identified) = (source.robot()?, &robot.joints);
    let names: Vec<String> = found.joints.iter().map(|j| j.name.clone()).collect();
    if identified.iter().any(|joint| !names.contains(&joint.name)) {
        return Err(ExportError::AnotherRobot {
            path: path.to_owned(),
            robot: results.robot.clone(),
            found: names,
            identified: identified.iter().map(|j| j.name.clone()).collect(),
        });
    }
    let (file, then) = changed.map_or((files.first(), None), |(file, then)| (Some(file), Some(then)));
    let unknown = || "not known".to_owned();
    Err(ExportError::RobotChanged {
        path: file.map_or_else(|| path.to_owned(), |f| path.with_file_name(&f.name)),
        found: file.map_or_else(unknown, |f| f.sha256.clone()),
        identified: then.or_else(|| results.robot_files.first().map(|f| f.sha256.clone())).unwrap_or_else(unknown),
    })
}

fn hash_in(results: &Results, name: &str) -> Option<String> {
    results.robot_files.iter().find(|f: &&RobotFile| f.name == name).map(|f| f.sha256.clone())
}
