//! A robot and its recordings as they are read before an identification.

use std::path::Path;

use serde::Serialize;
use thetahat::{
    Experiment, Recording, Robot,
    experiment::{Proposal, propose_for_motion},
    recording::{Contents, inspect_with_time},
    results::RecordingFindings,
    robot::{RobotError, RobotSource, RobotSummary},
};
use thetahat_report::results::{Finding, Remedy, Severity};

use super::{channels::RecordingAnswer, proposed::ProposalAnswer, series::SeriesAnswer, skeleton::Skeleton};
use crate::{budget, remedies::with_remedy, request::Request, session::Outcome};

/// What was read, and errors in the rest.
#[derive(Serialize, Default)]
pub(crate) struct Understanding {
    robot: Option<RobotSummary>,
    robot_error: Option<String>,
    skeleton: Option<Skeleton>,
    recordings: Vec<RecordingAnswer>,
    recording_errors: Vec<FileError>,
    proposal: Option<ProposalAnswer>,
    proposal_error: Option<String>,
    /// The proposed experiment, if something must be filled in before it can run.
    unfinished: Option<String>,
    series: Option<SeriesAnswer>,
    findings: Vec<FindingAnswer>,
    /// The remedies of findings that are settings of the proposal.
    remedies: Vec<Remedy>,
}

#[derive(Serialize)]
struct FileError {
    path: String,
    message: String,
}

#[derive(Serialize)]
struct FindingAnswer {
    recording: String,
    code: &'static str,
    severity: Severity,
    joint: Option<String>,
    text: String,
    remedy: String,
    /// Codes of the remedies that can be applied.
    apply: Vec<String>,
}

impl Understanding {
    pub(crate) fn of(request: &Request, folder: &Path) -> Self {
        let mut answer = Self::default();
        let robot = request.robot.as_ref().and_then(|robot| answer.read_robot(&folder.join(robot)));
        let contents = answer.read_recordings(request, folder);
        if let Some((source, _)) = robot.as_ref().filter(|_| !contents.is_empty()) {
            let outcome = answer.read_proposed(request, folder, source, &contents);
            answer.proposal_error = outcome.err().map(|error| with_remedy(error.as_ref()));
        }
        if answer.skeleton.is_none() {
            answer.skeleton = robot.as_ref().map(|(_, robot)| Skeleton::at_rest(robot));
        }
        answer
    }

    fn read_robot(&mut self, path: &Path) -> Option<(RobotSource, Robot)> {
        let read = || -> Result<_, RobotError> {
            let source = RobotSource::read(path)?;
            let robot = source.robot()?;
            Ok((source, robot))
        };
        let read = read().map_err(|error| self.robot_error = Some(error.to_string())).ok()?;
        self.robot = Some(RobotSummary::new(&read.0, &read.1));
        Some(read)
    }

    fn read_recordings(&mut self, request: &Request, folder: &Path) -> Vec<Contents> {
        let mut read: Vec<(&Path, Contents)> = Vec::new();
        for path in &request.recordings {
            match inspect_with_time(&folder.join(path), request.time.as_deref()) {
                Ok(contents) => read.push((path, contents)),
                Err(error) => self
                    .recording_errors
                    .push(FileError { path: path.display().to_string(), message: error.to_string() }),
            }
        }
        self.recordings = read.iter().map(|(path, contents)| RecordingAnswer::of(path, contents, &read)).collect();
        read.into_iter().map(|(_, contents)| contents).collect()
    }

    /// The proposal and its recordings. If its recordings cannot be used, the proposal is kept with the error.
    fn read_proposed(
        &mut self,
        request: &Request,
        folder: &Path,
        source: &RobotSource,
        contents: &[Contents],
    ) -> Outcome<()> {
        let readable = request.without(self.recording_errors.iter().map(|error| Path::new(&error.path)));
        let files = readable.files(folder);
        let proposal = propose_for_motion(&readable.proposal(&files), source, contents)?;
        let to_fill_in = proposal.to_fill_in();
        if !to_fill_in.is_empty() {
            self.unfinished = Some(proposal.text());
            return Err(format!("{} Or state it under Corrections.", to_fill_in.join(" ")).into());
        }
        let path = Path::new("the proposed experiment");
        let experiment = Experiment::from_texts(path, proposal.text(), source.to_text())?;
        let recordings = experiment.recordings(&files.data_folder())?;
        budget::require_length(&recordings)?;
        self.add_recorded(request, &proposal, &experiment, &recordings);
        let findings = experiment.check(&files.data_folder())?;
        self.remedies = experiment.remedies_of(&findings);
        self.findings = findings.into_iter().flat_map(|found| FindingAnswer::all_of(found, &self.remedies)).collect();
        Ok(())
    }

    fn add_recorded(
        &mut self,
        request: &Request,
        proposal: &Proposal,
        experiment: &Experiment,
        recordings: &[Recording],
    ) {
        let Some(first) = recordings.first() else { return };
        self.skeleton = Some(Skeleton::of(&experiment.robot, first));
        self.series = Some(SeriesAnswer::of(&experiment.robot, first, request.window_s));
        self.proposal = Some(ProposalAnswer::of(proposal, experiment, first, request.window_s));
    }
}

impl FindingAnswer {
    fn all_of(recording: RecordingFindings, remedies: &[Remedy]) -> impl Iterator<Item = Self> {
        let RecordingFindings { recording, findings, .. } = recording;
        findings.into_iter().map(move |finding| Self::of(&recording, finding, remedies))
    }

    fn of(recording: &str, finding: Finding, remedies: &[Remedy]) -> Self {
        let is_own = |remedy: &&Remedy| {
            remedy.finding == Some(finding.code)
                && (remedy.code == finding.code.name() || remedy.found == finding.message)
        };
        let apply = remedies.iter().filter(is_own).map(|remedy| remedy.code.clone()).collect();
        Self {
            recording: recording.to_owned(),
            code: finding.code.name(),
            severity: finding.severity,
            joint: finding.joint_name,
            text: finding.message,
            remedy: finding.remedy,
            apply,
        }
    }
}
