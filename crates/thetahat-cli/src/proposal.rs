//! The content of recordings, and the experiment proposed for them.

use std::{
    error::Error,
    path::{Path, PathBuf},
};

use thetahat::{
    design::Design,
    experiment::{Driver, DriverError, Proposal, ProposalFiles, ProposalRequest, ProposedControl, propose_for_motion},
    recording::{Contents, RecordingError, inspect_with_time},
    robot::RobotSource,
};
use thetahat_ground::{
    files,
    output::{FileKind, OutputGuard, replace_file},
};
use thetahat_report::report;

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
        let files = ProposalFiles::in_folder_of_recordings(robot.clone(), files);
        let proposal = proposal(&files, &RobotSource::read(robot)?, &request.columns, &contents)?;
        print(&format!("\nproposed experiment; `thetahat init` writes it:\n\n{}", proposal.text()))?;
    }
    Ok(Ending::Good)
}

/// The name in place of a driver's that shows all of them.
const LIST: &str = "list";

pub fn write_experiment(init: &Init) -> Result<Ending, Box<dyn Error>> {
    if init.columns.from.as_deref() == Some(LIST) {
        return show_drivers();
    }
    if let (Some(robot), true) = (&init.robot, init.design) {
        let out = init.out.as_deref().unwrap_or(Path::new("design.toml"));
        return write_design(robot, out, init.force.force);
    }
    let (Some(robot), false) = (&init.robot, init.recording.is_empty()) else {
        return Err("--robot FILE and --recording FILE are needed; --from list alone shows the drivers".into());
    };
    let source = RobotSource::read(robot)?;
    let of_driver = init.columns.from.iter().map(PathBuf::from);
    let inputs = init.recording.iter().chain(source.paths()).cloned().chain(of_driver);
    let out = init.out.as_deref().unwrap_or(Path::new("experiment.toml"));
    OutputGuard::new(inputs, init.force.force).file(out, FileKind::Unmarked)?;
    let contents = contents(&init.recording, &init.columns)?;
    let folder = out.parent().map_or_else(PathBuf::new, Path::to_owned);
    let files = ProposalFiles { robot: robot.clone(), recordings: init.recording.clone(), folder };
    let proposal = proposal(&files, &source, &init.columns, &contents)?;
    replace_file(out, proposal.text().as_bytes()).map_err(|e| format!("{}: cannot be written: {e}", out.display()))?;
    let to_fill_in: String = proposal.to_fill_in().iter().map(|what| format!("To fill in: {what}\n")).collect();
    let without_gains = |c: &ProposedControl| c.position_gain.is_empty() || c.velocity_gain.is_empty();
    let is_without = proposal.control.as_ref().is_some_and(without_gains);
    let options_of_gains = if is_without { "Or run init with --kp and --kd.\n" } else { "" };
    let of_driver: String = proposal.of_driver().iter().map(|what| format!("{what}\n")).collect();
    let not_used: String = proposal.not_used().iter().map(|what| format!("{what}\n")).collect();
    let read = contents.iter().flat_map(|c| c.notes.iter().map(|note| (c.file.display(), note)));
    let notes: String = read.map(|(file, note)| format!("{file}: {note}\n")).collect();
    let guesses: String = proposal.guesses().iter().map(|what| format!("Assumed: {what}\n")).collect();
    let fill_in = if to_fill_in.is_empty() { "" } else { " Fill in what is missing." };
    print(&format!(
        "written: {out}\n{notes}{of_driver}{not_used}{guesses}{to_fill_in}{options_of_gains}Review it: assumptions are marked as guesses.{fill_in} Then:\n  thetahat check {out}{options}\n  \
         thetahat identify {out}{options}\n",
        out = out.display(),
        options = options_for(&files),
    ))?;
    Ok(Ending::Good)
}

/// The design of a motion to record, for a robot alone.
fn write_design(robot: &Path, out: &Path, force: bool) -> Result<Ending, Box<dyn Error>> {
    let source = RobotSource::read(robot)?;
    OutputGuard::new(source.paths().iter().cloned(), force).file(out, FileKind::Unmarked)?;
    let folder = out.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let (robot, folder) = (files::real(robot)?, files::real(folder)?);
    let text = Design::proposed(&source, robot.strip_prefix(&folder).unwrap_or(&robot), out)?;
    replace_file(out, text.as_bytes()).map_err(|e| format!("{}: cannot be written: {e}", out.display()))?;
    let guesses: String =
        text.lines().filter(|line| line.contains("guess of")).map(|line| format!("  {line}\n")).collect();
    let guesses =
        if guesses.is_empty() { guesses } else { format!("Limits that the description does not state:\n{guesses}") };
    print(&format!(
        "written: {out}\n{guesses}Review it: accelerations, noise and controller are guesses, and the robot will travel the ranges. Then:\n  thetahat design {out} --out design\n",
        out = out.display()
    ))?;
    Ok(Ending::Good)
}

fn contents(files: &[PathBuf], columns: &Columns) -> Result<Vec<Contents>, RecordingError> {
    files.iter().map(|file| inspect_with_time(file, columns.time.as_deref())).collect()
}

/// Options for files that are not in the folder of the experiment.
fn options_for(files: &ProposalFiles) -> String {
    let data = files.data_folder();
    let mut options = String::new();
    if data != files.folder {
        let data = if data.as_os_str().is_empty() { Path::new(".") } else { &data };
        options += &format!(" --data {}", data.display());
    }
    if !files.robot_is_found() {
        options += &format!(" --robot {}", files.robot.display());
    }
    options
}

fn proposal(
    files: &ProposalFiles,
    source: &RobotSource,
    columns: &Columns,
    contents: &[Contents],
) -> Result<Proposal, Box<dyn Error>> {
    let request = files.name_in(request(columns)?);
    let proposal = propose_for_motion(&request, source, contents)?;
    let _progress = Progress::of("choosing the filter on a simulated twin of the recording");
    Ok(proposal.with_chosen_filter(source.to_text(), &files.data_folder(), threads(None))?)
}

/// The drivers that come with the program: what each means by effort.
fn show_drivers() -> Result<Ending, Box<dyn Error>> {
    for driver in Driver::presets()? {
        let sources: String = driver.source.iter().map(|source| format!("    source: {source}\n")).collect();
        print(&format!("{}: {}\n    effort: {}\n{sources}", driver.name, driver.title, driver.effort))?;
    }
    Ok(Ending::Good)
}

fn request(columns: &Columns) -> Result<ProposalRequest, DriverError> {
    Ok(ProposalRequest {
        driver: columns.from.as_deref().map(Driver::find).transpose()?,
        position: columns.position.clone(),
        torque: columns.torque.clone(),
        joints: columns.joints.clone(),
        time: columns.time.clone(),
        sample_rate_hz: columns.rate,
        position_unit: columns.position_unit.clone(),
        torque_unit: columns.torque_unit.clone(),
        side: columns.side,
        position_gain: columns.kp.clone(),
        velocity_gain: columns.kd.clone(),
        window_s: columns.window_s.as_ref().map_or([None; 2], |w| [Some(w[0]), Some(w[1])]),
        locked: columns.lock.iter().cloned().collect(),
        ..ProposalRequest::default()
    })
}
