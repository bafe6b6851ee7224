//! Which files an experiment file may name: files of its own project only, so that an experiment from elsewhere cannot
//! read others.

use std::path::{Path, PathBuf};

use super::error::ExperimentError;
use thetahat_ground::files;

/// The robot description: relative to the experiment, or else in the folder of the data.
pub(super) fn robot(experiment: &Path, named: &Path, data: &Path) -> Result<PathBuf, ExperimentError> {
    let here = folder(experiment).join(named);
    let there = data.join(named);
    if files::exists(&here) || !files::exists(&there) {
        return path_in_project(experiment, "robot", named);
    }
    if is_inside(&there, data) { Ok(there) } else { Err(outside(experiment, "robot", named)) }
}

/// A file named by the experiment, relative to it: inside its folder or the folder above.
pub(crate) fn path_in_project(experiment: &Path, key: &str, named: &Path) -> Result<PathBuf, ExperimentError> {
    let own = folder(experiment);
    let path = own.join(named);
    // What is not there is reported where it is read.
    if !files::exists(&path) || is_inside(&path, &own.join("..")) {
        return Ok(path);
    }
    Err(outside(experiment, key, named))
}

fn folder(file: &Path) -> PathBuf {
    let folder = file.parent().unwrap_or(Path::new(""));
    if folder.as_os_str().is_empty() { PathBuf::from(".") } else { folder.to_owned() }
}

/// Whether a file lies below a folder, links followed.
fn is_inside(file: &Path, folder: &Path) -> bool {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let real = |path: &Path| files::real(path).ok();
    real(file).zip(real(folder)).is_some_and(|(file, folder)| file.starts_with(folder))
}

fn outside(experiment: &Path, key: &str, named: &Path) -> ExperimentError {
    ExperimentError::OutsideFolder { path: experiment.to_owned(), key: key.to_owned(), found: named.to_owned() }
}
