//! From results to the model that is exported.

use std::path::{Path, PathBuf};

use super::{
    error::ExportError,
    format::Format,
    posterior::{Kept, Posterior},
    provenance::{MovedParameter, Provenance, moved, provenance},
    render::{Export, export_robot},
    robot_file::require_same,
    xml::number,
};
use crate::{
    experiment::{Experiment, require_same_parameters},
    identification::Method,
    preparation::{Case, ParameterChoice, ParameterSelection, Settings, Setup},
    results::{NOMINAL, Results, RunResult, Verdict},
    robot::{Locks, Robot, RobotSource},
};

/// Base parameters that are named where they moved; the others are counted.
const NAMED: usize = 12;

/// Which estimate to export.
#[derive(Debug, Clone, Default)]
pub struct ExportRequest {
    /// The method; none takes the one that the results advise.
    pub method: Option<Method>,
    /// The robot description, which must be the one that was identified; none takes the text in the results.
    pub robot: Option<PathBuf>,
    /// The folder in which that description is looked for by its name.
    pub data: Option<PathBuf>,
    /// Whether results whose verdict is do-not-use are exported.
    pub force: bool,
    /// Which parameters were estimated, where the results are of arrays and hold no experiment.
    pub parameters: ParameterSelection,
}

/// An identified robot with the standard parameters that are exported.
#[derive(Debug, Clone)]
pub struct IdentifiedModel {
    /// The robot.
    pub robot: Robot,
    /// Its standard parameters, SI, in the order of its table: physically consistent.
    pub standard: Vec<f64>,
    /// Where each of them comes from.
    pub provenance: Vec<Provenance>,
    /// The base parameters that are not at their estimates, those moved most first.
    pub moved: Vec<MovedParameter>,
    /// The method.
    pub method: Method,
    /// The verdict on the results.
    pub verdict: Option<Verdict>,
    title: String,
    kept: Kept,
    urdf: Option<String>,
    pub(super) posterior: Posterior,
}

impl IdentifiedModel {
    /// The model of the nominal estimate in results; `path` names these in messages.
    ///
    /// # Errors
    /// [`ExportError`]: untrusted results, no estimate, another robot, or no consistent parameters within the intervals.
    pub fn of_results(path: &Path, results: &Results, request: &ExportRequest) -> Result<Self, ExportError> {
        require_trusted(path, results, request.force)?;
        let run = chosen_run(path, results, request.method)?;
        if results.robot_description.is_empty() {
            return Err(ExportError::NoRobot { path: path.to_owned() });
        }
        let Subject { robot, settings, file } = Subject::of(path, results, run, &request.parameters)?;
        if let Some(file) = description_file(path, request, file.as_deref())? {
            require_same(results, &robot, &file)?;
        }
        let source = RobotSource::from_text(results.robot_description.clone(), path)?;
        Self::new(path, results, run, Setup { robot: &robot, settings: &settings }, source.urdf_text())
    }

    fn new(
        path: &Path,
        results: &Results,
        run: &RunResult,
        setup: Setup<'_>,
        urdf: Option<&str>,
    ) -> Result<Self, ExportError> {
        let other = |problem: String| ExportError::OtherParameters { path: path.to_owned(), problem };
        let base = setup.basis(&Case::nominal()).map_err(|e| other(e.to_string()))?.base;
        require_same_parameters(results, run, &base, &setup.settings.parameters.estimate).map_err(other)?;
        let base = base.filtered(|kept| {
            let own = |p: &crate::base_parameters::BaseParameter| p.kept == kept && run.parameter(&p.name).is_some();
            base.parameters().iter().any(own)
        });
        let posterior = Posterior::new(setup, base, run)?;
        let (standard, kept) = posterior.standard()?;
        Ok(Self {
            robot: setup.robot.clone(),
            provenance: provenance(&posterior),
            moved: moved(&posterior, &standard),
            method: run.method,
            verdict: results.verdict,
            title: results.title.clone(),
            urdf: urdf.map(str::to_owned),
            standard,
            kept,
            posterior,
        })
    }

    /// The file of the robot.
    ///
    /// # Errors
    /// As [`export_robot`].
    pub fn export(&self, format: Format) -> Result<Export, ExportError> {
        export_robot(&self.robot, self.urdf.as_deref(), &self.standard, format, &self.about())
    }

    /// The text of the URDF that the robot was read from; none where a TOML gives the joints.
    pub(super) fn urdf_text(&self) -> Option<&str> {
        self.urdf.as_deref()
    }

    /// What there is to say of the exported parameters, a sentence each: how they were chosen, what moved, and what was not
    /// identified.
    #[must_use]
    pub fn about(&self) -> Vec<String> {
        let verdict = self.verdict.map_or("not judged", Verdict::name);
        let title = if self.title.is_empty() { String::new() } else { format!(" of \"{}\"", self.title) };
        let mut lines = vec![
            format!("identified by {}{title}, {NOMINAL} case; verdict: {verdict}", self.method),
            self.choice().to_owned(),
        ];
        if self.posterior.rejects == Some(true) {
            lines.push(
                "the data reject every robot made of bodies at 5 %: something is wrong that no parameters repair"
                    .to_owned(),
            );
        }
        lines.extend(self.moved_in_words());
        let of = |wanted: Provenance| {
            let table = self.robot.parameter_table();
            let names = table.iter().zip(&self.provenance).filter(|(_, p)| **p == wanted).map(|(p, _)| p.name());
            names.collect::<Vec<_>>().join(" ")
        };
        let says = [
            (Provenance::Identified, "identified by themselves"),
            (Provenance::InSums, "identified in sums with others alone, shared out as the a-priori values are"),
            (Provenance::APriori, "not identified, from the a-priori values"),
        ];
        let named = says.into_iter().map(|(which, what)| (of(which), what)).filter(|(names, _)| !names.is_empty());
        lines.extend(named.map(|(names, what)| format!("{what}: {names}")));
        lines
    }

    fn choice(&self) -> &'static str {
        match self.kept {
            Kept::AtEstimates => {
                "standard parameters: of the physically consistent sets with the estimated base parameters, the one nearest to \
                 the a-priori parameters (log-det)"
            }
            Kept::WithinIntervals => {
                "standard parameters: no robot made of bodies has the estimates; the physically consistent set nearest to them \
                 in the metric of their covariance, with the base parameters within their 95 % intervals"
            }
            Kept::ConsistentEstimate => "standard parameters: the consistent estimate of the results (physical = true)",
        }
    }

    fn moved_in_words(&self) -> Option<String> {
        if self.moved.is_empty() {
            return Some("every base parameter is at its estimate".to_owned());
        }
        let one = |m: &MovedParameter| {
            let far = m.deviations.map_or_else(String::new, |d| format!(" ({d:+.2} standard deviations)"));
            format!("{} {} instead of {} {}{far}", m.name, digits(m.exported), digits(m.estimate), m.unit)
        };
        let named: Vec<String> = self.moved.iter().take(NAMED).map(one).collect();
        let others = self.moved.len().saturating_sub(NAMED);
        let others = if others > 0 { format!(", and {others} others by less") } else { String::new() };
        Some(format!("base parameters that are not at their estimates: {}{others}", named.join(", ")))
    }
}

/// Four digits.
fn digits(value: f64) -> String {
    format!("{value:.3e}").parse().map_or_else(|_| value.to_string(), number)
}

fn require_trusted(path: &Path, results: &Results, force: bool) -> Result<(), ExportError> {
    match results.verdict {
        Some(Verdict::DoNotUse) if !force => {
            let grave = results.verdict_reasons.iter().filter(|r| r.verdict == Verdict::DoNotUse);
            let reasons = grave.map(|r| r.seen().to_owned()).collect();
            Err(ExportError::NotTrusted { path: path.to_owned(), reasons })
        }
        Some(Verdict::DoNotUse | Verdict::Care | Verdict::Good) | None => Ok(()),
    }
}

/// The nominal run of the method, or of the one that the results advise.
fn chosen_run<'r>(path: &Path, results: &'r Results, method: Option<Method>) -> Result<&'r RunResult, ExportError> {
    let with = |r: &&RunResult| r.case == NOMINAL && !r.parameters.is_empty();
    let wanted = method.or_else(|| Some(results.taken()?.method));
    let found = results.runs.iter().filter(with).find(|r| wanted.is_none_or(|m| m == r.method));
    found.ok_or_else(|| ExportError::NoEstimate {
        path: path.to_owned(),
        method,
        found: results.runs.iter().filter(with).map(|r| r.method.name().to_owned()).collect(),
    })
}

/// What was identified, and how.
struct Subject {
    robot: Robot,
    settings: Settings,
    /// Name of the file of the robot's description.
    file: Option<PathBuf>,
}

impl Subject {
    /// Those of the experiment in the results, or the usual settings where they are of arrays.
    fn of(
        path: &Path,
        results: &Results,
        run: &RunResult,
        parameters: &ParameterSelection,
    ) -> Result<Self, ExportError> {
        if !results.experiment_description.is_empty() {
            let experiment = Experiment::of_results(path, results)?;
            let file = experiment.file.robot.file_name().map(PathBuf::from);
            return Ok(Self { robot: experiment.robot, settings: experiment.settings, file });
        }
        let source = RobotSource::from_text(results.robot_description.clone(), path)?;
        let whole = source.robot_without_transmission()?;
        let is_free = |name: &str| whole.joints.iter().any(|j| j.name == name && j.mimic.is_none());
        let locked = results.robot_locked.iter().filter(|l| is_free(&l.name));
        let locked = locked.map(|l| (l.name.clone(), l.value)).collect();
        let robot = source.robot_with_locks(&Locks { locked, until: Vec::new() }, path)?;
        let estimate = ParameterChoice::List(run.parameters.iter().map(|p| p.name.clone()).collect());
        let parameters = ParameterSelection { estimate, ..parameters.clone() };
        let file = results.robot_files.first().map(|file| PathBuf::from(&file.name));
        Ok(Self { robot, settings: Settings { parameters, ..Settings::new(1.0, 1) }, file })
    }
}

/// The description that is to be compared with that of the results, where one is asked for.
fn description_file(path: &Path, request: &ExportRequest, name: Option<&Path>) -> Result<Option<PathBuf>, ExportError> {
    match (&request.robot, &request.data, name) {
        (Some(file), _, _) => Ok(Some(file.clone())),
        (None, Some(folder), Some(name)) => Ok(Some(folder.join(name))),
        (None, Some(_), None) => Err(ExportError::UnknownFile { path: path.to_owned() }),
        (None, None, _) => Ok(None),
    }
}
