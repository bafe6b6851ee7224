//! The files that an experiment is proposed for, and how its file is to name them.

use std::path::{Path, PathBuf};

use super::request::ProposalRequest;
use thetahat_ground::files;

/// A robot description, its recordings, and the folder of the experiment file that is proposed.
#[derive(Debug, Clone)]
pub struct ProposalFiles {
    /// The robot description.
    pub robot: PathBuf,
    /// The recordings.
    pub recordings: Vec<PathBuf>,
    /// The folder of the experiment file.
    pub folder: PathBuf,
}

impl ProposalFiles {
    /// The same for an experiment file in the folder that the recordings have in common.
    #[must_use]
    pub fn in_folder_of_recordings(robot: PathBuf, recordings: Vec<PathBuf>) -> Self {
        let folder = common_folder(&recordings);
        Self { robot, recordings, folder }
    }

    /// The folder against which the recordings are named: that of the experiment if they lie in it, or else the one that
    /// they have in common.
    #[must_use]
    pub fn data_folder(&self) -> PathBuf {
        let all_within = self.recordings.iter().all(|r| within(r, &self.folder).is_some());
        if all_within { self.folder.clone() } else { common_folder(&self.recordings) }
    }

    /// The request with the files as the experiment is to name them.
    #[must_use]
    pub fn name_in(&self, request: ProposalRequest) -> ProposalRequest {
        let data = self.data_folder();
        let name = |path: &Path| path.file_name().map_or_else(PathBuf::new, PathBuf::from);
        ProposalRequest {
            robot_file: self.robot_within(&data).unwrap_or_else(|| name(&self.robot)),
            recording_files: self.recordings.iter().map(|r| within(r, &data).unwrap_or_else(|| name(r))).collect(),
            ..request
        }
    }

    /// Whether the experiment finds its robot without `--robot`.
    #[must_use]
    pub fn robot_is_found(&self) -> bool {
        self.robot_within(&self.data_folder()).is_some()
    }

    /// The robot relative to the folder of the experiment, or else to that of the data.
    fn robot_within(&self, data: &Path) -> Option<PathBuf> {
        within(&self.robot, &self.folder).or_else(|| within(&self.robot, data))
    }
}

/// The innermost folder that holds all of some files.
fn common_folder(paths: &[PathBuf]) -> PathBuf {
    let parent = |file: &PathBuf| file.parent().map_or_else(PathBuf::new, Path::to_owned);
    let Some(first) = paths.first() else { return PathBuf::new() };
    let mut folder = parent(first);
    while !paths.iter().all(|file| within(file, &folder).is_some()) {
        let Some(above) = folder.parent().map(Path::to_owned) else { return absolute_common_folder(paths) };
        folder = above;
    }
    folder
}

/// The same for files that are named by unlike paths.
fn absolute_common_folder(paths: &[PathBuf]) -> PathBuf {
    let absolute: Vec<PathBuf> = paths.iter().filter_map(|file| files::real(file).ok()).collect();
    let mut folder = absolute.first().and_then(|f| f.parent()).map_or_else(PathBuf::new, Path::to_owned);
    while !absolute.iter().all(|file| file.starts_with(&folder)) && folder.pop() {}
    folder
}

/// The path of a file relative to a folder that it lies in.
fn within(file: &Path, folder: &Path) -> Option<PathBuf> {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let (file, folder) = (files::real(file).ok()?, files::real(folder).ok()?);
    file.strip_prefix(folder).ok().map(Path::to_owned)
}
