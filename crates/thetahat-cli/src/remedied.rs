//! An experiment identified again with remedies of its findings.

use std::{
    error::Error,
    fs::OpenOptions,
    path::{Path, PathBuf},
};

use thetahat::{Experiment, Results, report::Published};
use thetahat_ground::output::{OutputGuard, replace_file};
use thetahat_report::report;

use crate::{
    arguments::{Described, Identify, Output},
    inputs::{read_described, read_experiment},
    progress::Progress,
    shown::{Remark, show},
    terminal::{Ending, width},
};

/// Versions of an experiment that are looked for.
const MOST_VERSIONS: u32 = 10_000;

/// Writes the next version of the experiment with the remedies that were asked for, next to it, and identifies it.
pub fn identify_with_remedies(identify: &Identify) -> Result<Ending, Box<dyn Error>> {
    let (experiment, data) = read_experiment(&identify.described)?;
    let before = run_before(&experiment, &data, identify.output.out.as_deref())?;
    let text = experiment.with_remedies(&before.remedies, &identify.apply)?;
    let version = Version::after(&identify.described.experiment)?;
    let out = identify.output.out.as_deref().map(|folder| version.folder(folder));
    let inputs = experiment.input_files(&data);
    if let Some(folder) = &out {
        let guard = OutputGuard::new(inputs, identify.output.force.force).of_robot(&experiment.robot.name);
        guard.folder(folder, report::files())?;
    }
    version.write(&text)?;
    let (experiment, data) = read_described(&version.path, Some(&data), identify.described.robot.as_deref())?;
    let published = experiment.published_path().map(|path| Published::read(&path)).transpose()?;
    let mut progress = Progress::new();
    let after = experiment.run(&data, &mut |stage| progress.show(stage))?;
    drop(progress);
    let output = Output { out, ..identify.output.clone() };
    let note = format!("\n{}\nwritten: {}\n", report::change_text(&before, &after, width()), version.path.display());
    let described = Described { experiment: version.path, ..identify.described.clone() };
    show(&after, published.as_ref(), &output, &Remark { note: &note, apply: Some(&command(&described, &output)) })
}

/// The results in the folder of the experiment's last run, or a run anew where they are of another text.
fn run_before(experiment: &Experiment, data: &Path, out: Option<&Path>) -> Result<Results, Box<dyn Error>> {
    let path = out.map(|folder| folder.join(RESULTS)).filter(|path| path.is_file());
    let last = path.map(|path| Results::read(&path)).transpose()?;
    if let Some(last) = last.filter(|results| results.experiment_description == experiment.text) {
        return Ok(last);
    }
    let mut progress = Progress::new();
    Ok(experiment.run(data, &mut |stage| progress.show(stage))?)
}

const RESULTS: &str = "results.json";

/// The command that applies remedies, without their codes.
pub fn command(described: &Described, output: &Output) -> String {
    let option = |name: &str, path: &Option<PathBuf>| {
        path.as_ref().map(|path| format!(" {name} {}", quoted(path))).unwrap_or_default()
    };
    format!(
        "thetahat identify {}{}{}{} --apply",
        quoted(&described.experiment),
        option("--data", &described.data),
        option("--robot", &described.robot),
        option("--out", &output.out)
    )
}

/// A path as a shell takes it.
fn quoted(path: &Path) -> String {
    let text = path.display().to_string();
    let is_plain = |c: char| c.is_alphanumeric() || "/._-+:\\".contains(c);
    if text.chars().all(is_plain) { text } else { format!("'{}'", text.replace('\'', "'\\''")) }
}

/// The next version of an experiment file: `experiment.2.toml` next to `experiment.toml`.
struct Version {
    path: PathBuf,
    number: u32,
}

impl Version {
    fn after(experiment: &Path) -> Result<Self, String> {
        let stem = experiment.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let (stem, own) = split_number(&stem);
        let versions = own + 1..own + MOST_VERSIONS;
        let path = |number: u32| experiment.with_file_name(format!("{stem}.{number}.toml"));
        let free = versions.into_iter().find(|number| !path(*number).exists());
        let number = free.ok_or_else(|| format!("{}: has too many versions next to it", experiment.display()))?;
        Ok(Self { path: path(number), number })
    }

    /// The folder of its results, next to that of the run before: `out.2` next to `out`.
    fn folder(&self, before: &Path) -> PathBuf {
        let name = before.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let (name, _) = split_number(&name);
        if name.is_empty() {
            before.join(self.number.to_string())
        } else {
            before.with_file_name(format!("{name}.{}", self.number))
        }
    }

    /// Writes it, whole and never over a file: an empty one takes the name first.
    fn write(&self, text: &str) -> Result<(), String> {
        let taken = OpenOptions::new().write(true).create_new(true).open(&self.path);
        taken
            .and_then(|_| replace_file(&self.path, text.as_bytes()))
            .map_err(|e| format!("{}: cannot be written: {e}", self.path.display()))
    }
}

/// A name without the number of its version, and that number: one without.
fn split_number(name: &str) -> (&str, u32) {
    let numbered = name.rsplit_once('.').and_then(|(stem, number)| Some((stem, number.parse::<u32>().ok()?)));
    numbered.filter(|(stem, number)| !stem.is_empty() && (1..u32::MAX / 2).contains(number)).unwrap_or((name, 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_version_follows_the_last_and_is_never_written_over_a_file() {
        let folder = thetahat_testing::Folder::new();
        let file = folder.path().join("arm.toml");
        let first = Version::after(&file).unwrap();
        assert_eq!((first.path.file_name().unwrap(), first.number), ("arm.2.toml".as_ref(), 2));
        first.write("title = 1").unwrap();
        assert!(first.write("title = 2").unwrap_err().contains("arm.2.toml"));
        let second = Version::after(&first.path).unwrap();
        assert_eq!(second.path.file_name().unwrap(), "arm.3.toml");
        assert_eq!(Version::after(&file).unwrap().number, 3);
        assert_eq!(second.folder(Path::new("runs/out")), Path::new("runs/out.3"));
        assert_eq!(second.folder(Path::new("out.2")), Path::new("out.3"));
        assert_eq!(second.folder(Path::new(".")), Path::new("./3"));
    }

    #[test]
    fn a_path_with_spaces_is_quoted() {
        assert_eq!(quoted(Path::new("a/b-1.toml")), "a/b-1.toml");
        assert_eq!(quoted(Path::new("my arm's.toml")), "'my arm'\\''s.toml'");
    }
}
