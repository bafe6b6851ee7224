//! The identified robot as files for simulators and controllers.

use std::{
    error::Error,
    fs, io,
    path::{Path, PathBuf},
};

use thetahat::{
    experiment::{EstimateRequest, ExperimentError, IdentifiedRobot},
    export::{ExportError, ExportFormat, IdentifiedModel, MjcfModel, Target},
};
use thetahat_ground::output::{FileKind, OutputGuard, UnfinishedFolder, remove_own, replace_file};

use crate::{
    arguments::{Export as Request, Exported, Sample},
    inputs::threads,
    progress::Counter,
    terminal::{Ending, print, remark},
};

/// Digits of a sample's number in its name, independent of the count: names sort by number.
const DIGITS: usize = 6;

/// Writes the robot of results, or prints it.
pub fn export_robot(request: &Request) -> Result<Ending, Box<dyn Error>> {
    let model = model(&request.exported)?;
    let identified = identified(&request.exported)?;
    let sidecar = request.out.as_deref().map(covariance_file);
    let guard = guard(&request.exported, &identified);
    let kind = kind(request.exported.to);
    request.out.iter().try_for_each(|path| guard.file(path, kind))?;
    sidecar.iter().try_for_each(|path| guard.file(path, FileKind::RobotJson))?;
    let robot = IdentifiedModel::new(identified)?;
    let export = robot.export(target(&request.exported, model.as_ref()))?;
    let checked = if request.check { Some(export.check()?) } else { None };
    let remarks = robot.in_words(&export, checked);
    let Some((path, sidecar)) = request.out.as_ref().zip(sidecar) else {
        remark(&remarks)?;
        print(&export.text)?;
        return Ok(Ending::of(Some(robot.identified.verdict)));
    };
    let covariance = robot.covariance_json_or_reason()?;
    replace_file(path, export.text.as_bytes())?;
    print(&format!("{remarks}\nwritten: {}\n", path.display()))?;
    print(&format!("         {}\n", write_sidecar(&sidecar, covariance)?))?;
    Ok(Ending::of(Some(robot.identified.verdict)))
}

/// Writes the covariance, or removes that of an earlier export. Returns a line about it.
fn write_sidecar(sidecar: &Path, covariance: Result<String, ExportError>) -> io::Result<String> {
    match covariance {
        Ok(text) => replace_file(sidecar, text.as_bytes()).map(|()| sidecar.display().to_string()),
        Err(reason) => {
            let removed = remove_own(sidecar, FileKind::RobotJson)?;
            let removed =
                if removed { format!("; removed: {} of an earlier export", sidecar.display()) } else { String::new() };
            Ok(format!("no covariance: {reason}{removed}"))
        }
    }
}

/// Writes random robots from the distribution of the estimates.
pub fn sample_robots(request: &Sample) -> Result<Ending, Box<dyn Error>> {
    let model = model(&request.exported)?;
    let identified = identified(&request.exported)?;
    let extension = request.exported.to.extension();
    let names: Vec<String> = (1..=request.count).map(|number| format!("{number:0DIGITS$}.{extension}")).collect();
    let guard = guard(&request.exported, &identified);
    let kind = kind(request.exported.to);
    guard.folder(&request.out, names.iter().map(|name| (name.as_str(), kind)))?;
    refuse_others(&request.out, request.count, extension)?;
    let robot = IdentifiedModel::new(identified)?;
    write_samples(&robot, target(&request.exported, model.as_ref()), request, &names)?;
    print(&format!(
        "{}: {} samples of the estimates by {}, seed {}\nwritten: {} to {}\n",
        robot.identified.robot.name,
        request.count,
        robot.identified.source_of_estimates(),
        request.seed,
        request.out.join(&names[0]).display(),
        names[names.len() - 1]
    ))?;
    Ok(Ending::of(Some(robot.identified.verdict)))
}

/// Writes the samples into a temporary folder, and moves them once all are complete.
fn write_samples(
    robot: &IdentifiedModel,
    target: Target<'_>,
    request: &Sample,
    names: &[String],
) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(&request.out)?;
    let unfinished = UnfinishedFolder::new(&request.out, "samples")?;
    let mut counter = Counter::new("samples");
    let mut waiting = names.iter().enumerate();
    let made = robot.export_samples(request.count, request.seed, target, threads(None), |_, export| {
        let Some((done, name)) = waiting.next() else { return Ok(()) };
        fs::write(unfinished.path().join(name), export.text)?;
        counter.show(done + 1, names.len(), String::new());
        Ok::<(), Box<dyn Error>>(())
    });
    drop(counter);
    made?;
    Ok(names.iter().try_for_each(|name| fs::rename(unfinished.path().join(name), request.out.join(name)))?)
}

/// Refuses a folder with samples of higher numbers: a reader would mix them with these.
fn refuse_others(folder: &Path, count: u32, extension: &str) -> Result<(), Box<dyn Error>> {
    let Ok(entries) = fs::read_dir(folder) else { return Ok(()) };
    let higher = |name: String| {
        let stem = name.strip_suffix(extension)?.strip_suffix('.')?;
        stem.parse::<u32>().is_ok_and(|number| number > count || stem.len() != DIGITS).then_some(name)
    };
    let names = entries.flatten().filter_map(|entry| higher(entry.file_name().to_string_lossy().into_owned()));
    match names.min() {
        None => Ok(()),
        Some(name) => Err(format!(
            "{}: is a sample that this command does not replace; give another folder with --out, or remove the old \
             samples",
            folder.join(name).display()
        )
        .into()),
    }
}

/// The user's own model that gets the robot.
fn model(request: &Exported) -> Result<Option<MjcfModel>, Box<dyn Error>> {
    match (&request.into, request.to) {
        (None, _) => Ok(None),
        (Some(path), ExportFormat::Mjcf) => Ok(Some(MjcfModel::read(path)?)),
        (
            Some(_),
            ExportFormat::Urdf
            | ExportFormat::Sdf
            | ExportFormat::Json
            | ExportFormat::Pace
            | ExportFormat::Isaac
            | ExportFormat::Bam,
        ) => {
            Err("--into needs a MuJoCo model; use it with --to mjcf. A URDF of the robot is edited without --into"
                .into())
        }
    }
}

fn target<'a>(request: &Exported, model: Option<&'a MjcfModel>) -> Target<'a> {
    model.map_or(Target::File(request.to), Target::Into)
}

fn kind(format: ExportFormat) -> FileKind {
    match format {
        ExportFormat::Urdf | ExportFormat::Mjcf | ExportFormat::Sdf => FileKind::Robot,
        ExportFormat::Json | ExportFormat::Pace | ExportFormat::Isaac | ExportFormat::Bam => FileKind::RobotJson,
    }
}

/// Inputs are never replaced.
fn guard(request: &Exported, identified: &IdentifiedRobot) -> OutputGuard {
    OutputGuard::new(identified.files.iter().chain(&request.into).cloned(), request.force.force)
}

fn identified(request: &Exported) -> Result<IdentifiedRobot, ExperimentError> {
    IdentifiedRobot::read(
        &request.results,
        &EstimateRequest {
            method: request.method,
            robot: request.robot.clone(),
            data: request.data.clone(),
            untrusted: request.trust.untrusted,
            ..EstimateRequest::default()
        },
    )
}

/// The file of the covariance.
fn covariance_file(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".covariance.json");
    path.with_file_name(name)
}
