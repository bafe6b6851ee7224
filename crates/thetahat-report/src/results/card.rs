//! Summary of the results: the verdict, the recommended numbers, what to do next.

use super::{
    cause::SmallestShown,
    content::{NOMINAL, Results},
    estimate::EstimateSource,
    grade::Grade,
    model::ModelUse,
    run::RunResult,
    verdict::{ReasonCode, Verdict, VerdictReason},
};
use thetahat_estimation::{
    checks::{Code, Severity},
    identification::{Method, Status},
};
use thetahat_ground::number::significant;

/// Most actions on a card.
const ACTIONS: usize = 3;

/// Ratio of errors on data not used below which another case fits clearly better.
const BETTER: f64 = 0.95;

/// The last action if the data must be fixed first.
const AGAIN: &str = "then identify again: the other findings may disappear";

/// The verdict and the figures that it is based on, gathered from the results.
#[derive(Debug, Clone, PartialEq)]
pub struct Card {
    /// Whether the results can be used; none in files from before this key.
    pub verdict: Option<Verdict>,
    /// What to use: the model, or where there is none the recommended method; none if no method can be recommended.
    pub source: Option<EstimateSource>,
    /// What the model may be used for; empty without a model.
    pub uses: Vec<ModelUse>,
    /// Its case, if there are several.
    pub case: Option<String>,
    /// Its relative error, percent of the torques (of the positions for `cloe`).
    pub relative_error_percent: Option<f64>,
    /// Its relative error on data not used.
    pub unseen: Option<Unseen>,
    /// Label and relative error in percent of the joint with the largest error.
    pub worst_joint: Option<(String, f64)>,
    /// The names of its parameters by grade, in the order of [`Grade::ALL`].
    pub parameters: [Vec<String>; 4],
    /// Whether the residual shows effects that are missing in the model: the grades then hold only if the model does.
    pub model_is_doubted: bool,
    /// Whether the estimates are physically consistent; none if that was not examined.
    pub physical: Option<Physical>,
    /// Errors of the description that these recordings do not show, which the values of parameters would have.
    pub hidden: Vec<String>,
    /// What to do next, the most urgent action first; at most three.
    pub actions: Vec<String>,
}

/// Whether the estimates can be those of a robot of rigid bodies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Physical {
    /// They are consistent.
    Yes,
    /// They are inconsistent, but within noise.
    WithinNoise,
    /// They are inconsistent by more than noise.
    No,
}

/// The relative error on data not used for the estimate, percent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unseen {
    /// On recordings that were held back.
    HeldBack(f64),
    /// On parts of the recording, each left out in turn.
    LeftOut(f64),
}

impl Unseen {
    /// The error, percent.
    #[must_use]
    pub fn percent(self) -> f64 {
        match self {
            Self::HeldBack(error) | Self::LeftOut(error) => error,
        }
    }
}

impl Results {
    /// The summary of the nominal case.
    #[must_use]
    pub fn card(&self) -> Card {
        let model = self.model.as_ref().map(|model| model.quoted(NOMINAL));
        let run = model.as_ref().or_else(|| self.recommended_run());
        let of_run = run.map(|r| EstimateSource::Run(r.method));
        Card {
            verdict: self.verdict,
            source: model.as_ref().map(|_| EstimateSource::Model).or(of_run),
            uses: self.model.iter().flat_map(|model| model.uses.clone()).collect(),
            relative_error_percent: run.and_then(|r| r.relative_error_percent),
            unseen: run.and_then(|r| self.unseen(r)),
            worst_joint: run.and_then(|r| self.worst_joint(r)),
            parameters: Grade::ALL
                .map(|grade| run.iter().flat_map(|r| r.graded(grade)).map(|p| p.name.clone()).collect()),
            model_is_doubted: self.model_is_doubted(),
            case: run.map(|r| r.case.clone()).filter(|_| model.is_none() && self.cases().len() > 1),
            physical: run.and_then(RunResult::physically),
            hidden: self.model.as_ref().map(|m| SmallestShown::hidden(&m.smallest_shown)).unwrap_or_default(),
            actions: self.next(run),
        }
    }

    /// The actions. The last one is for simulation, if the numbers are inconsistent and no other action says so.
    fn next(&self, recommended: Option<&RunResult>) -> Vec<String> {
        let mut actions: Vec<String> = self.better_case().into_iter().chain(self.actions()).take(ACTIONS).collect();
        let mut of_bodies = self.verdict_reasons.iter().filter(|r| r.code == ReasonCode::NotPhysical);
        let is_covered = of_bodies.any(|r| actions.contains(&r.remedy));
        let before = recommended.and_then(RunResult::before_simulation);
        if let Some(before) = before.filter(|_| !is_covered && self.verdict != Some(Verdict::DoNotUse)) {
            actions.truncate(ACTIONS - 1);
            actions.push(before.to_owned());
        }
        actions
    }

    /// Whether something is missing in the model or in the processing, which may bias precise estimates.
    #[must_use]
    pub fn model_is_doubted(&self) -> bool {
        self.verdict_reasons.iter().any(|r| matches!(r.code, ReasonCode::CorrelatedResidual | ReasonCode::Cause))
    }

    /// The recommended run of the nominal case.
    #[must_use]
    pub fn recommended_run(&self) -> Option<&RunResult> {
        self.recommended_run_in(NOMINAL)
    }

    /// The run of a case that the advice recommends; without advice, as from reductions, that of idim-iv or otherwise
    /// idim-ls, if it converged.
    #[must_use]
    pub fn recommended_run_in(&self, case: &str) -> Option<&RunResult> {
        let converged = |method| self.run(case, method).filter(|run| run.status == Status::Converged);
        match self.advice.iter().find(|a| a.case == case) {
            Some(advice) => self.run(case, advice.recommended?),
            None => [Method::IDIM_IV, Method::IDIM_LS].into_iter().find_map(converged),
        }
    }

    /// The error of a run on data not used for its estimate.
    #[must_use]
    pub fn unseen(&self, run: &RunResult) -> Option<Unseen> {
        let kind = if self.validation_recordings.is_empty() { Unseen::LeftOut } else { Unseen::HeldBack };
        run.cross_validation_relative_error_percent.map(kind)
    }

    /// The case to look at, if the same method fits another case clearly better: its model covers more than the nominal one.
    fn better_case(&self) -> Option<String> {
        let run = self.recommended_run().filter(|_| self.verdict != Some(Verdict::DoNotUse))?;
        let errors = |r: &RunResult| Some((r.relative_error_percent?, self.unseen(r)?.percent()));
        let (fit, unseen) = errors(run)?;
        let others = self.runs.iter().filter(|r| r.method == run.method && r.status == Status::Converged);
        let better =
            others.filter_map(|r| Some((r, errors(r)?))).filter(|(_, (f, u))| *f < fit && *u < BETTER * unseen);
        let (other, (other_fit, other_unseen)) = better.min_by(|a, b| a.1.1.total_cmp(&b.1.1))?;
        Some(format!(
            "use case {} instead if its model is right for you: it fits better, {} % instead of {} % (on data not used {} % instead of {} %)",
            other.case,
            significant(other_fit, 3),
            significant(fit, 3),
            significant(other_unseen, 3),
            significant(unseen, 3)
        ))
    }

    fn worst_joint(&self, run: &RunResult) -> Option<(String, f64)> {
        let errors = run.joint_relative_error_percent.iter().enumerate().filter_map(|(j, e)| Some((j, (*e)?)));
        let (joint, error) = errors.max_by(|a, b| a.1.total_cmp(&b.1))?;
        (run.joint_relative_error_percent.len() > 1).then(|| (self.joint_label(joint), error))
    }

    /// A coordinate's joint, counted from zero, as [`JointResult::label`](super::JointResult::label) writes it.
    #[must_use]
    pub fn joint_label(&self, joint: usize) -> String {
        let number = joint + 1;
        self.robot_joints.get(joint).map_or_else(|| format!("joint {number}"), |j| j.label(number))
    }

    /// Only fixes to the data if the data are wrong, as other findings may disappear with them; otherwise the remedies of the reasons,
    /// then that of parameters which the motion does not excite.
    fn actions(&self) -> Vec<String> {
        let of_data = self.verdict_reasons.iter().filter(|r| r.is_of_data()).map(|r| &r.remedy);
        let of_data = distinct(of_data, ACTIONS - 1);
        if !of_data.is_empty() {
            return of_data.into_iter().chain([AGAIN.to_owned()]).collect();
        }
        let of_checks = self.findings.iter().filter(|r| !r.held_back).flat_map(|r| &r.findings);
        let not_excited = of_checks.filter(|f| f.code == Code::NotExcited).map(|f| &f.remedy);
        distinct(self.verdict_reasons.iter().map(|r| &r.remedy).chain(not_excited), ACTIONS)
    }
}

/// The first texts that are not empty, each once.
fn distinct<'a>(texts: impl Iterator<Item = &'a String>, most: usize) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for text in texts.filter(|text| !text.is_empty()) {
        if found.len() < most && !found.contains(text) {
            found.push(text.clone());
        }
    }
    found
}

impl Card {
    /// The number of parameters of all grades.
    #[must_use]
    pub fn parameter_count(&self) -> usize {
        self.parameters.iter().map(Vec::len).sum()
    }

    /// The error on data not used over the error of the fit.
    #[must_use]
    pub fn times_unseen(&self) -> Option<f64> {
        let times = self.unseen?.percent() / self.relative_error_percent?;
        times.is_finite().then_some(times)
    }
}

impl RunResult {
    /// Whether its estimates are physically consistent.
    fn physically(&self) -> Option<Physical> {
        let physical = self.physical.as_ref()?;
        let mut findings = physical.findings.iter().filter(|f| f.code == Code::NotPhysical);
        Some(match (physical.consistent, findings.any(|f| f.severity != Severity::Note)) {
            (true, _) => Physical::Yes,
            (false, false) => Physical::WithinNoise,
            (false, true) => Physical::No,
        })
    }
}

impl RunResult {
    /// What to do before simulating, if the estimates are inconsistent.
    fn before_simulation(&self) -> Option<&'static str> {
        let physical = self.physical.as_ref().filter(|p| !p.consistent)?;
        Some(match physical.estimate {
            Some(_) => "use the physically consistent estimate for simulation and control",
            None => "set physical = true in [parameters] before simulating with them",
        })
    }
}

impl VerdictReason {
    /// Whether the data are wrong, which may cause everything else.
    fn is_of_data(&self) -> bool {
        let of_data = match self.code {
            ReasonCode::CheckProblem | ReasonCode::RecordingsDisagree | ReasonCode::DriveGain => true,
            ReasonCode::NotConverged
            | ReasonCode::Undecided
            | ReasonCode::NothingExplained
            | ReasonCode::JointNotExplained
            | ReasonCode::JointPoorlyExplained
            | ReasonCode::Lag
            | ReasonCode::CheckWarning
            | ReasonCode::CrossValidation
            | ReasonCode::NotPhysical
            | ReasonCode::LastResort
            | ReasonCode::CorrelatedResidual
            | ReasonCode::Influence
            | ReasonCode::Cause
            | ReasonCode::ChangedFile
            | ReasonCode::FewRows => false,
        };
        of_data && self.verdict == Verdict::DoNotUse
    }

    /// The observation: the text without the remedy.
    #[must_use]
    pub fn seen(&self) -> &str {
        let text = self.text.trim_end_matches('.');
        let seen = text.strip_suffix(self.remedy.as_str()).filter(|_| !self.remedy.is_empty()).unwrap_or(text);
        seen.trim_end_matches([' ', ';', ':'])
    }
}

#[cfg(test)]
mod tests {
    use std::{collections::BTreeMap, path::Path};

    use super::*;
    use crate::results::ReasonSubject;

    fn results() -> Results {
        let text = r#"{
            "schema": 1, "thetahat": "0.1.0", "robot": "A", "title": "T", "samples_used": 100, "decimated_rows": 10,
            "recordings": [], "validation_recordings": [], "seed": null, "elimination": null, "verdict": "care",
            "robot_joints": [
              { "name": "base", "kind": "revolute", "position_unit": "rad", "torque_unit": "N m" },
              { "name": "elbow", "kind": "revolute", "position_unit": "rad", "torque_unit": "N m" }],
            "bandwidth": { "position_cutoff_hz": 50.0, "decimation_cutoff_hz": 20.0 },
            "experiment_description": "", "robot_description": "",
            "advice": [{ "case": "nominal", "take": "idim-ls", "distrust": [], "text": "Take idim-ls." }],
            "runs": [{
              "case": "nominal", "method": "idim-ls", "status": "converged", "iterations": 0, "simulations": 0,
              "relative_error_percent": 4.0, "joint_relative_error_percent": [3.0, 7.5],
              "cross_validation_relative_error_percent": 5.0, "seconds": 0.1, "convergence": [],
              "parameters": [
                { "name": "a", "estimate": 1.0, "interval_95": [0.9, 1.1], "unit": "", "expression": "a", "shown": true },
                { "name": "b", "estimate": 1.0, "interval_95": [0.5, 1.5], "unit": "", "expression": "b", "shown": true },
                { "name": "c", "estimate": 1.0, "interval_95": [-1, 3.0], "unit": "", "expression": "c", "shown": true },
                { "name": "ia2", "estimate": -1.0, "interval_95": [-1.1, -0.9], "unit": "", "expression": "ia2", "shown": true }],
              "physical": { "consistent": false, "outside": ["ia2"], "smallest_eigenvalue": -1.0, "findings": [
                { "code": "not-physical", "severity": "problem", "joint": 2, "joint_name": "elbow", "value": -1.0, "unit": "",
                  "limit": 0.0, "message": "ia2 is negative", "remedy": "give it", "parameters": ["ia2"] }] }
            }]
        }"#;
        Results::from_json(Path::new("results.json"), text).unwrap()
    }

    fn reason(remedy: &str) -> VerdictReason {
        VerdictReason {
            code: ReasonCode::FewRows,
            verdict: Verdict::Care,
            numbers: BTreeMap::new(),
            subject: ReasonSubject::default(),
            text: format!("Rows are few; {remedy}."),
            remedy: remedy.to_owned(),
            remedies: Vec::new(),
        }
    }

    #[test]
    fn it_summarizes_the_results() {
        let mut results = results();
        results.verdict_reasons = ["one", "two", "one", "three", "four"].map(reason).into();
        let card = results.card();
        assert_eq!(card.source, Some(EstimateSource::Run(Method::IDIM_LS)));
        assert_eq!((card.relative_error_percent, card.unseen), (Some(4.0), Some(Unseen::LeftOut(5.0))));
        assert_eq!(card.worst_joint, Some(("joint 2 (elbow)".to_owned(), 7.5)));
        assert_eq!(card.parameters, ["a", "b", "c", "ia2"].map(|name| vec![name.to_owned()]));
        assert_eq!(card.actions, ["one", "two", BEFORE_SIMULATION]);
    }

    const BEFORE_SIMULATION: &str = "set physical = true in [parameters] before simulating with them";

    #[test]
    fn a_simulation_is_warned_of_once_and_not_if_no_number_is_usable() {
        let mut results = results();
        let of_bodies = reason("give ia2, with physical = true");
        results.verdict_reasons = vec![VerdictReason { code: ReasonCode::NotPhysical, ..of_bodies }];
        assert_eq!(results.card().actions, ["give ia2, with physical = true"]);
        results.verdict_reasons.clear();
        assert_eq!(results.card().actions, [BEFORE_SIMULATION]);
        results.verdict = Some(Verdict::DoNotUse);
        assert!(results.card().actions.is_empty());
    }

    #[test]
    fn wrong_data_must_be_fixed_first() {
        let mut results = results();
        results.verdict_reasons = ["exchange them", "", "set it"].map(reason).into();
        results.verdict_reasons[0].code = ReasonCode::CheckProblem;
        results.verdict_reasons[0].verdict = Verdict::DoNotUse;
        results.verdict = Some(Verdict::DoNotUse);
        assert_eq!(results.card().actions, ["exchange them", AGAIN]);
    }

    #[test]
    fn without_a_recommended_method_it_has_no_numbers() {
        let mut results = results();
        results.advice[0].recommended = None;
        let card = results.card();
        assert_eq!((card.source, card.relative_error_percent), (None, None));
        assert!(card.parameters.iter().all(Vec::is_empty), "{card:?}");
        results.advice.clear();
        assert_eq!(
            results.card().source,
            Some(EstimateSource::Run(Method::IDIM_LS)),
            "a reduction is solved without advice"
        );
    }

    #[test]
    fn the_observation_is_the_text_without_the_remedy() {
        assert_eq!(reason("record longer").seen(), "Rows are few");
        let of_before = VerdictReason { remedy: String::new(), text: "Rows are few: record.".to_owned(), ..reason("") };
        assert_eq!(of_before.seen(), "Rows are few: record");
    }
}
