//! From results to a robot with identified parameters: the only way, for predictions and exports.

use std::path::{Path, PathBuf};

use super::{
    description::Experiment,
    error::ExperimentError,
    robot_file::require_same,
    subject::{Subject, require_same_parameters},
};
use crate::{
    diagnosis::judge,
    preparation::{Case, ParameterChoice, PreparationError, Recording, Settings, Setup, SignalOptions},
    run::{Identification, Identified, predict_torques},
};
use thetahat_estimation::identification::{Method, Status};
use thetahat_model::{
    base_parameters::BaseParameters,
    robot::{Robot, RobotSource},
};
use thetahat_report::results::{
    EstimateSource, ModelResult, NOMINAL, Prediction, Results, RunResult, Verdict, VerdictReason,
};

/// Which estimate of results to use, and what is required of it.
#[derive(Debug, Clone, PartialEq)]
pub struct EstimateRequest {
    /// The case.
    pub case: String,
    /// The method; `None` for the model, or where there is none for the method that the results recommend.
    pub method: Option<Method>,
    /// The robot description, which must be the identified one; `None` for the text in the results.
    pub robot: Option<PathBuf>,
    /// The folder in which that description is looked for by its name.
    pub data: Option<PathBuf>,
    /// Whether results with the verdict do-not-use are accepted.
    pub untrusted: bool,
}

impl Default for EstimateRequest {
    /// The model.
    fn default() -> Self {
        Self { case: NOMINAL.to_owned(), method: None, robot: None, data: None, untrusted: false }
    }
}

/// A robot with identified parameters.
#[derive(Debug, Clone)]
pub struct IdentifiedRobot {
    /// The robot, with the joints that were locked, the constants of torque terms that were found, and the friction model of
    /// the case.
    pub robot: Robot,
    /// How it was identified; for results of arrays the estimated parameters, and defaults otherwise.
    pub settings: Settings,
    /// The case.
    pub case: Case,
    /// The run whose estimates they are; the model as a run.
    pub run: RunResult,
    /// The model, where the estimates are its own.
    pub model: Option<ModelResult>,
    /// All base parameters of the robot, those that the run does not estimate included.
    pub base: BaseParameters,
    /// The verdict on the results.
    pub verdict: Verdict,
    /// The reasons of the verdict, the most serious first.
    pub verdict_reasons: Vec<VerdictReason>,
    /// Title of the results.
    pub title: String,
    /// The robot's description, where the results hold it: an export to URDF edits it.
    pub source: Option<RobotSource>,
    /// The files that were read: that of the results, and those of the description that was compared with it.
    pub files: Vec<PathBuf>,
    experiment: Option<Experiment>,
    /// Whether the settings' filters are those of the identification.
    knows_filters: bool,
}

impl IdentifiedRobot {
    /// The same for a recording that the experiment does not have: all of it counts.
    pub(super) fn without_window(self) -> Self {
        let signal = SignalOptions { window_start_s: None, window_end_s: None, ..self.settings.signal };
        Self { settings: Settings { signal, ..self.settings }, ..self }
    }

    /// The robot of an identification with the estimates of a run of its results, in memory.
    ///
    /// # Errors
    /// As [`IdentifiedRobot::of_results`].
    pub fn of_identification(
        identification: &Identification,
        results: &Results,
        request: &EstimateRequest,
    ) -> Result<Self, ExperimentError> {
        let Setup { robot, settings } = identification.setup();
        let subject = Subject { robot: robot.clone(), settings: settings.clone(), file: None, experiment: None };
        let robot = Self::of_subject(Path::new("results"), results, request, |_| Ok(subject))?;
        Ok(Self { knows_filters: true, files: Vec::new(), ..robot })
    }

    /// The same with the text of the robot's description, which an export to URDF edits.
    #[must_use]
    pub fn with_description(self, source: RobotSource) -> Self {
        Self { source: Some(source), ..self }
    }

    /// The same with the filters of the identification, which results of arrays do not hold and a prediction needs.
    #[must_use]
    pub fn with_filters(mut self, signal: SignalOptions) -> Self {
        self.settings.signal = signal;
        Self { knows_filters: true, ..self }
    }

    /// That of a `results.json`.
    ///
    /// # Errors
    /// As [`IdentifiedRobot::of_results`], and for a file that cannot be read.
    pub fn read(path: &Path, request: &EstimateRequest) -> Result<Self, ExperimentError> {
        Self::of_results(path, &Results::read(path)?, request)
    }

    /// The robot of results with the estimates of a run; `path` names the results in messages. The verdict of results from before
    /// verdicts existed is computed now.
    ///
    /// # Errors
    /// [`ExperimentError`]: results that are not to be used, no such estimate, parameters that are not those of the robot, or
    /// another description than the one that was identified.
    pub fn of_results(path: &Path, results: &Results, request: &EstimateRequest) -> Result<Self, ExperimentError> {
        let text = results.robot_description.clone();
        let source = |path| RobotSource::from_text(text, path);
        let robot = Self::of_subject(path, results, request, |run| Subject::of(path, results, run))?;
        Ok(Self { source: Some(source(path)?), knows_filters: robot.experiment.is_some(), ..robot })
    }

    /// The robot of results and of what they were identified from.
    fn of_subject(
        path: &Path,
        results: &Results,
        request: &EstimateRequest,
        subject: impl FnOnce(&RunResult) -> Result<Subject, ExperimentError>,
    ) -> Result<Self, ExperimentError> {
        let (verdict, verdict_reasons) = judged(results);
        if verdict == Verdict::DoNotUse && !request.untrusted {
            return Err(not_trusted(path, &verdict_reasons));
        }
        let no_estimate = |source| ExperimentError::NoEstimate { path: path.to_owned(), source };
        let model = results.model_for(&request.case, request.method);
        let (run, _) = results.estimate_and_source(&request.case, request.method).map_err(no_estimate)?;
        let Subject { mut robot, settings, file, experiment } = subject(&run)?;
        let mut files = vec![path.to_owned()];
        if let Some(description) = description_file(path, request, file)? {
            files.extend(require_same(results, &robot, &description)?);
        }
        let refuse = |problem: String| ExperimentError::ResultsFile { path: path.to_owned(), problem };
        if let Some(model) = model {
            robot.add_terms(&model.terms).map_err(|e| refuse(e.to_string()))?;
        }
        let case = settings.all_cases().into_iter().find(|c| c.name == run.case).unwrap_or_else(Case::nominal);
        let setup = Setup { robot: &robot, settings: &settings };
        let base = setup.basis(&case).map_err(|e| refuse(e.to_string()))?.base;
        let choice = if model.is_some() { &ParameterChoice::Base } else { &settings.parameters.estimate };
        require_same_parameters(results, &run, &base, choice).map_err(refuse)?;
        Ok(Self {
            robot: setup.robot_for(&case),
            run: run.into_owned(),
            model: model.cloned(),
            title: results.title.clone(),
            source: None,
            settings,
            case,
            base,
            verdict,
            verdict_reasons,
            files,
            experiment,
            knows_filters: false,
        })
    }

    /// The torques that the estimates predict for a motion, with the verdict on them; and their error where the recording has
    /// torques. The motion is filtered as the recordings of the identification were.
    ///
    /// # Errors
    /// [`PreparationError`] for a recording that does not fit the robot, and where the filters are not known: results of arrays
    /// that were read from a file need [`IdentifiedRobot::with_filters`].
    pub fn predict(&self, mut recording: Recording) -> Result<Prediction, PreparationError> {
        if !self.knows_filters {
            let why = "the results are of arrays and do not hold the filters of the identification";
            return Err(PreparationError::Missing { missing: "[signal]", why });
        }
        if recording.name.is_empty() {
            recording.name = "1".to_owned();
        }
        recording.validate(self.robot.coordinate_count())?;
        self.predict_valid(recording)
    }

    /// The same for a recording that is known to fit.
    pub(super) fn predict_valid(&self, recording: Recording) -> Result<Prediction, PreparationError> {
        let Self { run, case, verdict, verdict_reasons, model, .. } = self;
        let parameters = run.parameters.iter().map(|p| (p.name.clone(), p.estimate)).collect();
        let verdict = (*verdict, verdict_reasons.clone());
        let estimate =
            Identified { case, source: self.source_of_estimates(), parameters, model: model.as_ref(), verdict };
        predict_torques(self.setup(), &estimate, recording)
    }

    /// What the estimates come from.
    #[must_use]
    pub fn source_of_estimates(&self) -> EstimateSource {
        if self.model.is_some() { EstimateSource::Model } else { EstimateSource::Run(self.run.method) }
    }

    /// Whether the recordings decided a base parameter: every one that a run estimates, and of the model those that can be quoted.
    pub(crate) fn is_decided(&self, name: &str) -> bool {
        let of_model = |model: &ModelResult| model.parameters.iter().any(|p| p.name == name && p.is_decided());
        self.model.as_ref().is_none_or(of_model)
    }

    /// The estimates of all base parameters: zero of those that the run does not estimate, as in its model.
    #[must_use]
    pub fn estimates(&self) -> Vec<f64> {
        let estimate = |name: &str| self.run.parameter(name).map_or(0.0, |parameter| parameter.estimate);
        self.base.parameters().iter().map(|parameter| estimate(&parameter.name)).collect()
    }

    /// Standard parameters with the torques that were identified: those of the model, or else the kept ones, those that were
    /// given, zeros elsewhere.
    #[must_use]
    pub fn theta(&self) -> Vec<f64> {
        let table = self.robot.parameter_table();
        match &self.model {
            Some(model) => table.iter().map(|p| model.standard_value(&p.name()).unwrap_or(0.0)).collect(),
            None => self.base.to_standard(&self.estimates()),
        }
    }

    /// Method, case and verdict in a line, and how the run ended where it did not converge.
    #[must_use]
    pub fn origin(&self) -> String {
        let Self { run, case, verdict, title, .. } = self;
        let title = if title.is_empty() { String::new() } else { format!(" of \"{title}\"") };
        let status =
            if run.status == Status::Converged { String::new() } else { format!("; status: {}", run.status.name()) };
        if let Some(model) = &self.model {
            let kinds = model.kinds_of_terms();
            let sliding = model.friction_transition_sliding;
            let of_slides = sliding.map_or_else(String::new, |v| format!(" (joints that slide: {v})"));
            let terms = if kinds.is_empty() { String::new() } else { format!(", terms {}", kinds.join(" and ")) };
            return format!(
                "the model{title}: physically consistent least squares in the rows of {}, belief in the a-priori robot of \
                 weight {}, friction fc tanh(dq / {}){of_slides}{terms}; verdict: {verdict}",
                model.method, model.belief_weight, model.friction_transition
            );
        }
        format!("identified by {}{title}, {} case; verdict: {verdict}{status}", run.method, case.name)
    }

    /// The experiment that the results are of; `None` if they are of arrays.
    #[must_use]
    pub fn experiment(&self) -> Option<&Experiment> {
        self.experiment.as_ref()
    }

    /// The URDF that the robot was read from, where it was and is known.
    pub(crate) fn urdf_text(&self) -> Option<&str> {
        self.source.as_ref().and_then(RobotSource::urdf_text)
    }

    /// The robot without locks, where its description is known.
    pub(super) fn robot_without_locks(&self) -> Option<Robot> {
        self.source.as_ref().and_then(|source| source.robot_without_transmission().ok())
    }

    pub(crate) fn setup(&self) -> Setup<'_> {
        Setup { robot: &self.robot, settings: &self.settings }
    }
}

/// The verdict on results with its reasons.
fn judged(results: &Results) -> (Verdict, Vec<VerdictReason>) {
    match results.verdict {
        Some(verdict) => (verdict, results.verdict_reasons.clone()),
        None => {
            let mut results = results.clone();
            (judge(&mut results), results.verdict_reasons)
        }
    }
}

fn not_trusted(path: &Path, reasons: &[VerdictReason]) -> ExperimentError {
    let grave = reasons.iter().filter(|r| r.verdict == Verdict::DoNotUse);
    ExperimentError::NotTrusted { path: path.to_owned(), reasons: grave.map(|r| r.seen().to_owned()).collect() }
}

/// The description that is to be compared with that of the results, where one is asked for.
fn description_file(
    path: &Path,
    request: &EstimateRequest,
    name: Option<PathBuf>,
) -> Result<Option<PathBuf>, ExperimentError> {
    match (&request.robot, &request.data, name) {
        (Some(file), _, _) => Ok(Some(file.clone())),
        (None, Some(folder), Some(name)) => Ok(Some(folder.join(name))),
        (None, Some(_), None) => Err(ExperimentError::UnknownRobotFile { path: path.to_owned() }),
        (None, None, _) => Ok(None),
    }
}
