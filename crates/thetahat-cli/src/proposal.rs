//! What is in recordings, and the experiment proposed for them.

use std::{
    error::Error,
    path::{Path, PathBuf},
};

use thetahat::{
    experiment::{Experiment, Proposal, ProposalRequest, ProposedSignal, propose},
    output::{OutputGuard, replace_file},
    recording::{Contents, RecordingError, inspect_with_time},
    report,
    robot::RobotSource,
};

use crate::{
    arguments::{Columns, Init, Inspect},
    inputs::threads,
    progress::Progress,
    terminal::{Ending, print, width},
};

pub fn inspect_recordings(request: &Inspect) -> Result<Ending, Box<dyn Error>> {
    let files = [&request.files[..], &request.recording[..]].concat();
    let contents = contents(&files, &request.columns)?;
    for (number, contents) in contents.iter().enumerate() {
        print(&format!("{}{}", if number > 0 { "\n" } else { "" }, report::contents_text(contents, width())))?;
    }
    if let Some(robot) = &request.robot {
        let data = common_folder(&files);
        let proposal = proposal(robot, &files, &request.columns, &contents, &data)?;
        print(&format!("\nproposed experiment; `thetahat init` writes it:\n\n{proposal}"))?;
    }
    Ok(Ending::Good)
}

pub fn write_experiment(init: &Init) -> Result<Ending, Box<dyn Error>> {
    let contents = contents(&init.recording, &init.columns)?;
    let folder = init.out.parent().map_or_else(PathBuf::new, Path::to_owned);
    let proposal = proposal(&init.robot, &init.recording, &init.columns, &contents, &folder)?;
    OutputGuard::new(init.recording.iter().chain([&init.robot]).cloned(), init.force.force).file(&init.out)?;
    replace_file(&init.out, proposal.as_bytes())
        .map_err(|e| format!("{}: cannot be written: {e}", init.out.display()))?;
    print(&format!(
        "written: {out}\nRead it: what could not be known is marked as a guess. Then:\n  thetahat check {out}{options}\n  \
         thetahat identify {out}{options}\n",
        out = init.out.display(),
        options = options_for(&init.robot, &init.recording, &folder),
    ))?;
    Ok(Ending::Good)
}

fn contents(files: &[PathBuf], columns: &Columns) -> Result<Vec<Contents>, RecordingError> {
    files.iter().map(|file| inspect_with_time(file, columns.time.as_deref())).collect()
}

/// What the command line must say about files that do not lie in the folder of the experiment.
fn options_for(robot: &Path, recordings: &[PathBuf], folder: &Path) -> String {
    let data = data_folder(recordings, folder);
    let mut options = String::new();
    if data != folder {
        options += &format!(" --data {}", data.display());
    }
    if within(robot, folder).is_none() && within(robot, &data).is_none() {
        options += &format!(" --robot {}", robot.display());
    }
    options
}

/// The text of an experiment file in `folder`.
fn proposal(
    robot: &Path,
    recordings: &[PathBuf],
    columns: &Columns,
    contents: &[Contents],
    folder: &Path,
) -> Result<String, Box<dyn Error>> {
    let name = |path: &Path| path.file_name().map_or_else(PathBuf::new, PathBuf::from);
    let data = data_folder(recordings, folder);
    let request = ProposalRequest {
        robot_file: within(robot, folder).or_else(|| within(robot, &data)).unwrap_or_else(|| name(robot)),
        recording_files: recordings.iter().map(|r| within(r, &data).unwrap_or_else(|| name(r))).collect(),
        position: columns.position.clone(),
        torque: columns.torque.clone(),
        joints: columns.joints.clone(),
        time: columns.time.clone(),
        sample_rate_hz: columns.rate,
        position_unit: columns.position_unit,
        torque_unit: columns.torque_unit,
    };
    let source = RobotSource::read(robot)?;
    let mut proposal = propose(&request, &source, contents)?;
    proposal.signal = signal(&proposal, source.to_text(), &data)?;
    Ok(proposal.text())
}

/// The filter chosen from the recordings, or the usual one with the reason why none was.
fn signal(proposal: &Proposal, robot_text: String, data: &Path) -> Result<ProposedSignal, Box<dyn Error>> {
    let experiment = Experiment::from_texts(Path::new("the proposed experiment"), proposal.text(), robot_text)?;
    let _progress = Progress::of("choosing the filter on a twin of the record");
    Ok(match experiment.choose_filter(data, false, threads(None)) {
        Ok(choice) => ProposedSignal::chosen(&choice),
        Err(error) => {
            let rate_hz = proposal.recordings.first().map_or(0.0, |r| r.clock.rate_hz);
            ProposedSignal::not_chosen(rate_hz, &error.to_string())
        }
    })
}

/// The folder against which the recordings are named: that of the experiment if they lie in it, or else the one that
/// they have in common.
fn data_folder(recordings: &[PathBuf], folder: &Path) -> PathBuf {
    let all_within = recordings.iter().all(|r| within(r, folder).is_some());
    if all_within { folder.to_owned() } else { common_folder(recordings) }
}

/// The innermost folder that holds all of some files.
fn common_folder(files: &[PathBuf]) -> PathBuf {
    let parent = |file: &PathBuf| file.parent().map_or_else(PathBuf::new, Path::to_owned);
    let Some(first) = files.first() else { return PathBuf::new() };
    let mut folder = parent(first);
    while !files.iter().all(|file| within(file, &folder).is_some()) {
        let Some(above) = folder.parent().map(Path::to_owned) else { return absolute_common_folder(files) };
        folder = above;
    }
    folder
}

/// The same for files that are named by unlike paths.
fn absolute_common_folder(files: &[PathBuf]) -> PathBuf {
    let absolute: Vec<PathBuf> = files.iter().filter_map(|file| file.canonicalize().ok()).collect();
    let mut folder = absolute.first().and_then(|f| f.parent()).map_or_else(PathBuf::new, Path::to_owned);
    while !absolute.iter().all(|file| file.starts_with(&folder)) && folder.pop() {}
    folder
}

/// The path of a file relative to a folder that it lies in.
fn within(file: &Path, folder: &Path) -> Option<PathBuf> {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let (file, folder) = (file.canonicalize().ok()?, folder.canonicalize().ok()?);
    file.strip_prefix(folder).ok().map(Path::to_owned)
}
