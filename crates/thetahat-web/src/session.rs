use std::{
    error::Error,
    path::{Path, PathBuf},
};

use serde::Serialize;
use thetahat::{
    Experiment, Results,
    experiment::{EstimateRequest, propose_for_motion},
    export::{ExportFormat, IdentifiedModel},
    recording::{Contents, inspect_with_time},
    report::Published,
    robot::RobotSource,
};
use thetahat_report::{
    report::{self, TextWidth},
    results::Remedy,
};

use crate::{
    answers::{Exported, Identified, LinkBody, Sample, Understanding},
    budget,
    kind::Kind,
    request::Request,
    store,
};

/// A result, or an error of the library.
pub type Outcome<T> = Result<T, Box<dyn Error>>;

/// The name of the experiment file.
const EXPERIMENT: &str = "experiment.toml";

/// Files in a folder, and the work on them. Answers are JSON, unless they are a single text.
#[derive(Debug, Clone)]
pub struct Session {
    folder: PathBuf,
    threads: usize,
    files: Vec<(String, usize)>,
}

#[derive(Serialize)]
struct File<'a> {
    path: &'a str,
    bytes: usize,
}

impl Session {
    /// A session with its files in a folder; in a page that is the empty path.
    #[must_use]
    pub fn in_folder(folder: &Path) -> Self {
        Self { folder: folder.to_owned(), threads: 1, files: Vec::new() }
    }

    /// The same with this many threads; answers do not depend on their number.
    #[must_use]
    pub fn on_threads(self, threads: usize) -> Self {
        Self { threads, ..self }
    }

    /// Puts a file into the folder, replacing a file with the same path.
    ///
    /// # Errors
    /// A file with which the folder is too large, or that cannot be written.
    pub fn put(&mut self, path: &str, bytes: Vec<u8>) -> Outcome<()> {
        let others: usize = self.files.iter().filter(|(known, _)| known != path).map(|(_, bytes)| bytes).sum();
        budget::require_size(path, bytes.len(), others)?;
        self.files.retain(|(known, _)| known != path);
        self.files.push((path.to_owned(), bytes.len()));
        store::put(&self.folder.join(path), bytes)
    }

    /// Removes a file that was put.
    ///
    /// # Errors
    /// A file that cannot be removed.
    pub fn remove(&mut self, path: &str) -> Outcome<()> {
        self.files.retain(|(known, _)| known != path);
        store::remove(&self.folder.join(path))
    }

    /// The files that were put.
    ///
    /// # Errors
    /// Infallible in practice.
    pub fn files(&self) -> Outcome<String> {
        let files: Vec<File<'_>> = self.files.iter().map(|(path, bytes)| File { path, bytes: *bytes }).collect();
        Ok(serde_json::to_string(&files)?)
    }

    /// The kind of a file, by its content: `robot`, `experiment`, `results`, `recording` or `unknown`.
    ///
    /// # Errors
    /// A missing file.
    pub fn kind(&self, path: &str) -> Outcome<&'static str> {
        Ok(Kind::of(&self.folder.join(path)).map_err(|e| format!("{path}: {e}"))?.name())
    }

    /// What was read from a request's files.
    ///
    /// # Errors
    /// A malformed request; errors in files are part of the answer.
    pub fn understand(&self, request: &str) -> Outcome<String> {
        Ok(serde_json::to_string(&Understanding::of(&parse(request)?, &self.folder))?)
    }

    /// The proposed experiment file, with the filter chosen on a simulated twin of the recording.
    ///
    /// # Errors
    /// As the command `init`.
    pub fn propose(&self, request: &str, progress: &mut dyn FnMut(&str)) -> Outcome<String> {
        let request = parse(request)?;
        let files = request.files(&self.folder);
        if request.robot.is_none() {
            return Err("no robot is given: a URDF or a TOML description".into());
        }
        progress("reading the recordings");
        let contents: Vec<Contents> = (files.recordings.iter())
            .map(|file| inspect_with_time(file, request.time.as_deref()))
            .collect::<Result<_, _>>()?;
        let source = RobotSource::read(&files.robot)?;
        let proposal = propose_for_motion(&request.proposal(&files), &source, &contents)?;
        progress("choosing the filter on a simulated twin of the recording");
        Ok(proposal.with_chosen_filter(source.to_text(), &files.data_folder(), self.threads)?.text())
    }

    /// The findings in an experiment's recordings, as of `check --json`.
    ///
    /// # Errors
    /// As the command `check`.
    pub fn check(&self, experiment: &str) -> Outcome<String> {
        let findings = self.experiment(experiment)?.check(&self.folder)?;
        Ok(report::findings_json(&findings)?)
    }

    /// The results of an experiment, and the files of its report.
    ///
    /// # Errors
    /// As the command `identify`, and for recordings that are too long for a page.
    pub fn identify(&self, experiment: &str, progress: &mut dyn FnMut(&str)) -> Outcome<String> {
        let experiment = self.experiment(experiment)?;
        let published = experiment.published_path().map(|path| Published::read(&path)).transpose()?;
        progress("reading and filtering the recordings");
        let recordings = experiment.recordings(&self.folder)?;
        budget::require_length(&recordings)?;
        let results = experiment.run_on(recordings, &self.folder, self.threads, progress)?;
        progress("writing the report");
        Ok(serde_json::to_string(&Identified::of(&results, published.as_ref())?)?)
    }

    /// An experiment with the remedies of these codes: from the remedies of results or of findings, and the codes, as JSON lists.
    ///
    /// # Errors
    /// As `--apply` of the command `identify`.
    pub fn apply(&self, experiment: &str, remedies: &str, codes: &str) -> Outcome<String> {
        let remedies: Vec<Remedy> = serde_json::from_str(remedies).map_err(|e| format!("the remedies: {e}"))?;
        let codes: Vec<String> = serde_json::from_str(codes).map_err(|e| format!("the codes: {e}"))?;
        Ok(self.experiment(experiment)?.with_remedies(&remedies, &codes)?)
    }

    /// What a run with remedies changed against the run before, from the texts of their `results.json`.
    ///
    /// # Errors
    /// Texts that are not results.
    pub fn changed(&self, before: &str, after: &str) -> Outcome<String> {
        let read = |text| Results::from_json(Path::new("results.json"), text);
        Ok(report::change_text(&read(before)?, &read(after)?, TextWidth::default()))
    }

    /// Puts the files of a sample into the folder, `demo`, `arm`, `axis` or `exchanged`, and returns a request for
    /// [`Session::understand`], and the experiment where the sample has its own.
    ///
    /// # Errors
    /// A sample of another name.
    pub fn sample(&mut self, name: &str) -> Outcome<String> {
        let sample = Sample::named(name)?;
        for (path, bytes) in sample.files {
            self.put(path, bytes)?;
        }
        Ok(serde_json::to_string(&sample.answer)?)
    }

    /// The identified robot of a `results.json` in a format, as the command `export` writes it.
    ///
    /// # Errors
    /// As the command `export`.
    pub fn export(&self, results: &str, format: &str, untrusted: bool) -> Outcome<String> {
        let path = Path::new("results.json");
        let results = Results::from_json(path, results)?;
        let request = EstimateRequest { untrusted, ..EstimateRequest::default() };
        let model = IdentifiedModel::of_results(path, &results, &request)?;
        let format: ExportFormat = format.parse()?;
        Ok(serde_json::to_string(&Exported::of(&model, format)?)?)
    }

    /// The bodies of the identified robot of a `results.json` as ellipsoids, those that an export writes.
    ///
    /// # Errors
    /// As the command `export`, but not for untrusted results.
    pub fn bodies(&self, results: &str) -> Outcome<String> {
        let path = Path::new("results.json");
        let results = Results::from_json(path, results)?;
        let request = EstimateRequest { untrusted: true, ..EstimateRequest::default() };
        let model = IdentifiedModel::of_results(path, &results, &request)?;
        Ok(serde_json::to_string(&LinkBody::all_of(&model.identified.robot, &model.standard))?)
    }

    /// The URDF of a robot, its xacro expanded; empty for a robot of another format.
    ///
    /// # Errors
    /// A file that is no robot.
    pub fn urdf(&self, path: &str) -> Outcome<String> {
        Ok(RobotSource::read(&self.folder.join(path))?.urdf_text().unwrap_or_default().to_owned())
    }

    fn experiment(&self, text: &str) -> Outcome<Experiment> {
        let path = self.folder.join(EXPERIMENT);
        store::put(&path, text.as_bytes().to_vec())?;
        Ok(Experiment::read(&path, &self.folder)?)
    }
}

fn parse(request: &str) -> Outcome<Request> {
    serde_json::from_str(request).map_err(|e| format!("the request: {e}").into())
}
