//! Every case, every method, on all recordings.

use std::cell::Cell;

use super::{
    assessment::Assessment,
    curves,
    estimated_loop::LoopIdentification,
    estimation_data::EstimationData,
    examination::{ExaminationModel, compare, examine, examine_robot, with_note, with_positions_explained},
    explained_by_model::{keep_causes_of_these_data, with_model_explained, without_drifts_that_do_not_show},
    identification::{CaseProblem, Identification},
    parameters::{elimination_result, not_separated},
    prepared::{PreparedRecording, filtered},
    validation::uncertain,
};
use crate::{
    diagnosis::{MethodEstimate, advise, diagnose, judge},
    preparation::{Case, PreparationError, Problem, is_iv, propose_controller},
    scheduling::{EstimationJob, FitUnderWay, RunOptions, UnderWay, instruments_side_by_side, run_all},
};
use thetahat_estimation::{
    checks::{Code, Severity},
    identification::{Method, Status},
    simulation::SimulatorBias,
};
use thetahat_ground::clock::Stopwatch;
use thetahat_report::results::{
    CaseDiagnosis, JointResult, NOMINAL, Plots, RecordingFindings, Results, RunResult, SCHEMA,
};

/// How long the estimates that are left take, in words, if they take as long as those that are done.
fn time_left(seconds: f64, done: usize, of: usize) -> String {
    if done == 0 || done == of || seconds == 0.0 {
        return String::new();
    }
    format!(", about {:.0} s left", (seconds / done as f64 * (of - done) as f64).max(1.0))
}

/// What is simulated, in words.
fn in_words(UnderWay { simulations, fit }: UnderWay) -> String {
    match fit {
        None if simulations == 1 => "1 simulation".to_owned(),
        None => format!("{simulations} simulations side by side"),
        Some(FitUnderWay { method, error_percent: None, .. }) => format!("{method}: start values"),
        Some(FitUnderWay { method, iterations, error_percent: Some(error) }) => {
            format!("{method}: iteration {iterations}, error {error:.3} %")
        }
    }
}

impl Identification {
    /// Runs every case and method.
    ///
    /// A method that does not converge or a motion that does not identify the parameters is not an error: the run says
    /// so in its status.
    ///
    /// # Errors
    /// [`PreparationError`] for input that cannot be used.
    pub fn run(&self) -> Result<Results, PreparationError> {
        self.run_with_progress(&mut |_| {})
    }

    /// The same; `progress` is called with what is being done.
    ///
    /// # Errors
    /// As [`Identification::run`].
    pub fn run_with_progress(&self, progress: &mut dyn FnMut(&str)) -> Result<Results, PreparationError> {
        let problems = self.problems(progress)?;
        let assessed = self.assess_all(&problems, &self.setup().settings.all_cases(), progress)?;
        match self.with_loop_estimated(&assessed, progress)? {
            Some(LoopIdentification { identification, problems, assessed }) => {
                identification.concluded(&problems, assessed, progress)
            }
            None => self.concluded(&problems, assessed, progress),
        }
    }

    /// The results of all cases, with what is made of their estimates.
    fn concluded(
        &self,
        problems: &[CaseProblem],
        assessed: Vec<Vec<(RunResult, MethodEstimate)>>,
        progress: &mut dyn FnMut(&str),
    ) -> Result<Results, PreparationError> {
        let cases = self.setup().settings.all_cases();
        let (mut runs, mut user_runs, mut diagnostics) = (Vec::new(), Vec::new(), Vec::new());
        for (case, assessed) in cases.iter().zip(assessed) {
            progress(&format!("{}: diagnosis", case.name));
            let (mut results, estimated): (Vec<RunResult>, Vec<MethodEstimate>) = assessed.into_iter().unzip();
            let problem = &self.problem_of(problems, case).problem;
            if case.name == NOMINAL {
                self.add_hidden_biases(problem, &mut results, &estimated);
                user_runs = self.user_runs(problem, &estimated, progress)?;
            }
            runs.extend(results);
            diagnostics.push(self.diagnose(problem, case, &estimated));
        }
        progress("checking the recordings");
        let findings = self.findings(&problems[0].problem, &runs);
        let of_loop = if self.records_torques() { None } else { self.wrong_loop(&runs, progress)? };
        let findings = with_note(findings, of_loop);
        let results = self.results(&problems[0].problem, findings, runs, diagnostics)?;
        let mut results = Results { user_runs, ..results };
        if self.setup().settings.estimation.compare_terms {
            progress("comparing the laws of torque terms");
            results.term_comparison = if self.records_torques() {
                self.compare_terms(&problems[0])?
            } else {
                self.compare_terms_of_positions(progress)?
            };
        }
        progress("choosing the model");
        match self.model(&problems[0].problem, &results.runs)? {
            Ok(mut model) => {
                with_model_explained(&mut results.findings, &model);
                without_drifts_that_do_not_show(&mut results.findings, &model);
                keep_causes_of_these_data(&mut model, &results.findings);
                results.model = Some(model);
            }
            Err(why) => results.no_model = Some(why),
        }
        judge(&mut results);
        Ok(results)
    }

    /// Every method of every case.
    pub(super) fn assess_all(
        &self,
        problems: &[CaseProblem],
        cases: &[Case],
        progress: &mut dyn FnMut(&str),
    ) -> Result<Vec<Vec<(RunResult, MethodEstimate)>>, PreparationError> {
        let estimation = &self.setup().settings.estimation;
        let methods = |case: &Case| case.methods.clone().unwrap_or_else(|| estimation.methods.clone());
        let all: Vec<(usize, Method)> =
            cases.iter().enumerate().flat_map(|(c, case)| methods(case).into_iter().map(move |m| (c, m))).collect();
        let job = |&(c, method): &(usize, Method)| self.job(self.problem_of(problems, &cases[c]), &cases[c], method);
        let jobs: Vec<EstimationJob<'_>> = all.iter().map(job).collect();
        let options = RunOptions { iteration: estimation.iteration(), motion_step: Some(1), threads: self.threads };
        let mut assessed: Vec<Option<(RunResult, MethodEstimate)>> = all.iter().map(|_| None).collect();
        let (done, stopwatch) = (Cell::new(0), Stopwatch::start());
        let mut report = |under_way: UnderWay| {
            let (done, of) = (done.get(), all.len());
            let left = time_left(stopwatch.seconds(), done, of);
            progress(&format!("{done} of {of} estimates{left}, {}", in_words(under_way)));
        };
        run_all(&jobs, options, &mut report, &mut |k, finished| {
            done.set(done.get() + 1);
            let assessment = Assessment { data: EstimationData::Samples(self), case: &cases[all[k].0], job: &jobs[k] };
            let (mut run, estimated) = assessment.assess(finished)?;
            let problem = self.problem_of(problems, &cases[all[k].0]);
            if let Some(reason) = problem.unsettled_weights(self.setup().settings, run.method)
                && run.status == Status::Converged
            {
                (run.status, run.reason) = (Status::IterationLimit, Some(reason));
            }
            assessed[k] = Some((run, estimated));
            Ok::<(), PreparationError>(())
        })?;
        for (&(c, method), run) in all.iter().zip(assessed.iter_mut().flatten()) {
            let (case, problem) = (&cases[c], self.problem_of(problems, &cases[c]));
            if let Some(better) = self.again_along_the_motion((problem, case), method, &run.0)? {
                *run = better;
            }
        }
        let mut by_case: Vec<Vec<_>> = cases.iter().map(|_| Vec::new()).collect();
        all.iter().zip(assessed).for_each(|((c, _), run)| by_case[*c].extend(run));
        Ok(by_case)
    }

    /// IV of the nominal case once more, where it did not converge in the loop that is described or along the reference that is
    /// recorded: a guess of a loop along the motion is enough for it. None if that does not converge either.
    fn again_along_the_motion(
        &self,
        (problem, case): (&CaseProblem, &Case),
        method: Method,
        failed: &RunResult,
    ) -> Result<Option<(RunResult, MethodEstimate)>, PreparationError> {
        let setup = self.setup();
        let is_described = setup.settings.controller.is_some();
        let has_reference = self.main.iter().any(|p| p.filtered.recording.reference.is_some());
        let is_other = (is_described || has_reference) && case.name == NOMINAL;
        if failed.status == Status::Converged || !is_iv(&method) || !is_other {
            return Ok(None);
        }
        let guess = propose_controller(&[]);
        let along = self.main.iter().map(|p| p.along_its_motion(setup)).collect::<Result<Vec<_>, _>>()?;
        let jobs = [self.job_in_loop_of((&guess.description, &along), (problem, case), method)];
        let iteration = setup.settings.estimation.iteration();
        let options = RunOptions { iteration, motion_step: Some(1), threads: self.threads };
        let mut again = None;
        run_all(&jobs, options, &mut |_| {}, &mut |_, finished| {
            again = Some(Assessment { data: EstimationData::Samples(self), case, job: &jobs[0] }.assess(finished)?);
            Ok::<(), PreparationError>(())
        })?;
        Ok(again.filter(|(run, _)| run.status == Status::Converged).map(|(mut run, estimated)| {
            let place = if is_described { "in the loop of [controller]" } else { "along the recorded reference" };
            let why = failed.reason.as_deref().unwrap_or("no reason is known");
            run.notes = vec![format!("{place} it did not converge ({why}); {} along the recorded motion", guess.what)];
            (run, estimated)
        }))
    }

    /// Compares the methods of a case; what needs a simulator with another bias makes one.
    fn diagnose(&self, problem: &Problem, case: &Case, estimated: &[MethodEstimate]) -> CaseDiagnosis {
        let simulate = |biases: &[SimulatorBias], theta: &[f64]| {
            let with_bias = |&bias| self.simulator(&self.main, problem, &case.clone().with_simulator(bias));
            let Some(simulators) = biases.iter().map(with_bias).collect::<Option<Vec<_>>>() else { return Vec::new() };
            instruments_side_by_side(&simulators, theta, self.threads)
        };
        diagnose(problem, case, estimated, &simulate)
    }

    /// What is found in the recordings, those that are identified from and those held back.
    fn findings(&self, nominal: &Problem, runs: &[RunResult]) -> Vec<RecordingFindings> {
        let setup = self.setup();
        let of = |all: &[PreparedRecording], held_back| -> Vec<RecordingFindings> {
            all.iter().map(|p| examine(setup, p, ExaminationModel::of(nominal), held_back)).collect()
        };
        let main = with_note(of(&self.main, false), uncertain::of_runs(setup, nominal, runs));
        let mut of_recordings = main;
        of_recordings.extend(of(&self.validation, true));
        let of_recordings = if is_reproduced(runs) { with_tracking_explained(of_recordings) } else { of_recordings };
        let only_positions = !runs.is_empty() && runs.iter().all(RunResult::is_of_positions);
        let of_recordings = if only_positions { with_positions_explained(of_recordings) } else { of_recordings };
        let mut findings: Vec<_> = examine_robot(setup.robot).into_iter().chain(of_recordings).collect();
        findings.extend(compare(setup, [&self.main, &self.validation], (&nominal.model, &nominal.base)));
        findings
    }

    fn results(
        &self,
        problem: &Problem,
        findings: Vec<RecordingFindings>,
        runs: Vec<RunResult>,
        diagnostics: Vec<CaseDiagnosis>,
    ) -> Result<Results, PreparationError> {
        let rate = self.main.first().map_or(0.0, |p| p.filtered.recording.sample_rate_hz);
        let regression = &problem.regression;
        Ok(Results {
            schema: SCHEMA,
            thetahat: env!("CARGO_PKG_VERSION").to_owned(),
            robot: self.setup().robot.name.clone(),
            title: String::new(),
            verdict: None,
            verdict_reasons: Vec::new(),
            remedies: Vec::new(),
            not_examined: Vec::new(),
            robot_joints: JointResult::of_coordinates(self.setup().robot),
            robot_locked: self.setup().robot.locked.clone(),
            samples_used: self.main.iter().map(|p| p.filtered.used_samples().count()).sum(),
            decimated_rows: regression.y.len(),
            recordings: self.main.iter().map(|p| p.describe(problem)).collect(),
            validation_recordings: self.validation.iter().map(|p| p.describe(problem)).collect(),
            bandwidth: self.setup().measure_bandwidth(rate)?,
            seed: None,
            excluded_parameters: self.setup().settings.parameters.exclude.clone(),
            fixed_parameters: self.setup().settings.parameters.fix.clone(),
            elimination: elimination_result(problem),
            not_separated: not_separated(problem),
            unmasked_comparison: self.unmasked_comparison(problem, &runs)?,
            profiled_terms: self.profiled.clone(),
            term_comparison: None,
            advice: diagnostics.iter().map(|d| advise(d, &runs, &findings)).collect(),
            findings,
            diagnostics,
            runs,
            user_runs: Vec::new(),
            model: None,
            no_model: None,
            payloads: self.payloads()?,
            drive_gains: self.drive_gains(problem)?,
            experiment_description: String::new(),
            robot_description: String::new(),
            robot_files: Vec::new(),
            plots: self.plots(problem)?,
        })
    }

    /// The curves that all runs share.
    fn plots(&self, problem: &Problem) -> Result<Plots, PreparationError> {
        let shared = curves::shared(self.setup().robot, &self.main, problem);
        if self.validation.is_empty() {
            return Ok(shared);
        }
        let nominal = Case::nominal();
        let validation = self.setup().validation_problem(&nominal, &filtered(&self.validation), &problem.estimated)?;
        Ok(Plots { held_back: curves::held_back(&self.validation, &validation), ..shared })
    }
}

/// Error of simulated positions, percent, below which the simulated loop explains how far the motion is from its reference.
const REPRODUCED_PERCENT: f64 = 2.0;

/// Whether the closed loop that was simulated gives the recorded motion.
fn is_reproduced(runs: &[RunResult]) -> bool {
    let of_positions =
        |run: &&RunResult| run.is_of_positions() && run.status == Status::Converged && run.case == NOMINAL;
    let errors = runs.iter().filter(of_positions).filter_map(|run| run.relative_error_percent);
    errors.into_iter().any(|percent| percent < REPRODUCED_PERCENT)
}

/// A soft controller is far from its reference, and that is no fault of the recording where the simulated loop does the same.
fn with_tracking_explained(mut findings: Vec<RecordingFindings>) -> Vec<RecordingFindings> {
    let all = findings.iter_mut().flat_map(|of| &mut of.findings);
    for finding in all.filter(|f| f.code == Code::ReferenceMismatch) {
        finding.severity = Severity::Note;
        finding.message += "; the simulated loop does the same";
        finding.remedy = "nothing to do: the controller is soft".to_owned();
    }
    findings
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_progress_of_a_fit_is_its_iteration_and_error() {
        let of = |iterations, error_percent| {
            in_words(UnderWay {
                simulations: 2,
                fit: Some(FitUnderWay { method: Method::CLOE, iterations, error_percent }),
            })
        };
        assert_eq!(
            (of(0, None), of(3, Some(2.5))),
            ("cloe: start values".into(), "cloe: iteration 3, error 2.500 %".into())
        );
        assert_eq!(in_words(UnderWay { simulations: 2, fit: None }), "2 simulations side by side");
    }

    #[test]
    fn the_time_left_follows_from_what_is_done() {
        assert_eq!(time_left(4.0, 2, 6), ", about 8 s left");
        assert_eq!(time_left(0.1, 5, 6), ", about 1 s left");
        assert_eq!((time_left(4.0, 0, 6), time_left(4.0, 6, 6)), (String::new(), String::new()));
    }
}
