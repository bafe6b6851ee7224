//! The run of an experiment: every case, every method.

use std::path::Path;

use super::{
    Case, CaseDiagnosis, EliminationResult, Experiment, ExperimentError, Influence, IterationResult, ParameterResult,
    Plots, RecordingDescription, RecordingFindings, RecordingResult, ReferenceResult, Results, RunPlots, RunResult,
    Weighting,
    advice::advise,
    chain::{FilteredRecord, Problem},
    cross_validation::{CrossValidation, Folds, folds_by_move, folds_by_part, folds_by_recording, leave_folds_out},
    diagnosis::{Estimated, diagnose, residual},
    record::Record,
    simulator::{RecordReference, Simulator},
    turns::{self, Attempt, Finished, Terms},
    wishes::instruments_side_by_side,
};
use crate::{
    base_parameters::BaseParameters,
    identification::{
        EstimationError, Fit, Method, Outcome, Reason, Uncertainty, idim_ls, joint_weights, relative_error_percent,
        uncertainty,
    },
    linear_algebra::norm,
    pool::available_threads,
    robot::{Friction, Robot},
    series::Series,
    simulation::{Reference, SimulatorBias},
    statistics::{FTest, f_test},
};

/// Part by which the sample rates of recordings may differ: clocks differ by less, chosen rates by more.
const RATE_TOLERANCE: f64 = 0.01;

/// A record ready for every case: filtered, with its reference where a method or report needs one.
pub(super) struct Prepared {
    filtered: FilteredRecord,
    reference: Option<RecordReference>,
}

impl Experiment {
    /// Runs every case and method. `data` is the folder against which the paths of the data are resolved; `progress` is
    /// told what is being done.
    ///
    /// A method that does not converge or a motion that does not identify the parameters is not an error: the run says
    /// so in its status.
    ///
    /// # Errors
    /// [`ExperimentError`] for input that cannot be used.
    pub fn run(&self, data: &Path, progress: &mut dyn FnMut(&str)) -> Result<Results, ExperimentError> {
        let session = self.session(data, progress)?;
        let problems = session.problems(progress)?;
        progress("checking the recordings");
        let findings = session.findings(&problems[0].problem);
        let cases = self.cases();
        let made = session.runs(&problems, &cases, progress)?;
        let (mut runs, mut diagnostics) = (Vec::new(), Vec::new());
        for (case, made) in cases.iter().zip(made) {
            progress(&format!("{}: diagnosis", case.name));
            let (results, estimated): (Vec<_>, Vec<_>) = made.into_iter().unzip();
            runs.extend(results);
            let problem = &problems[session.friction_index(case)].problem;
            diagnostics.push(session.diagnose(problem, case, &estimated));
        }
        session.results(&problems[0], findings, runs, diagnostics)
    }

    /// Reads the recordings, or makes the twin's.
    pub(super) fn session(&self, data: &Path, progress: &mut dyn FnMut(&str)) -> Result<Session<'_>, ExperimentError> {
        progress("reading and filtering the recordings");
        let main = match &self.file.twin {
            Some(twin) => vec![self.prepare(self.filter(self.simulate_twin(twin)?, None)?)?],
            None => self.read_all(&self.file.recording, data)?,
        };
        let validation = self.read_all(&self.file.validation, data)?;
        Ok(Session { experiment: self, main, validation })
    }

    /// A session with one record.
    pub(super) fn session_of(&self, record: Record) -> Result<Session<'_>, ExperimentError> {
        let main = vec![self.prepare(self.filter(record, None)?)?];
        Ok(Session { experiment: self, main, validation: Vec::new() })
    }

    fn read_all(&self, descriptions: &[RecordingDescription], data: &Path) -> Result<Vec<Prepared>, ExperimentError> {
        let read = |(i, description): (usize, &RecordingDescription)| {
            let record = self.read_record(description, i + 1, data)?;
            self.prepare(self.filter(record, Some(description))?)
        };
        let all = descriptions.iter().enumerate().map(read).collect::<Result<Vec<_>, _>>()?;
        self.require_one_rate(&all)?;
        Ok(all)
    }

    /// One parallel filter and one decimation suit only recordings of one rate.
    fn require_one_rate(&self, recordings: &[Prepared]) -> Result<(), ExperimentError> {
        let rate = |p: &Prepared| p.filtered.record.sample_rate_hz;
        let Some(first) = recordings.first().map(rate) else { return Ok(()) };
        match recordings.iter().find(|p| (rate(p) / first - 1.0).abs() > RATE_TOLERANCE) {
            None => Ok(()),
            Some(other) => {
                let key = format!("[[recording]] {}: the sample rate", other.filtered.record.name);
                let expected = format!("that of the first recording, {first:.6} Hz, within 1 %; resample one of them");
                Err(self.value(&key, &expected, format!("{:.6} Hz", rate(other))))
            }
        }
    }

    fn prepare(&self, filtered: FilteredRecord) -> Result<Prepared, ExperimentError> {
        let reference = self.file.controller.as_ref().map(|_| self.reference(&filtered)).transpose()?;
        Ok(Prepared { filtered, reference })
    }

    /// The robot with a case's friction model.
    pub(crate) fn robot_for(&self, case: &Case) -> Robot {
        Robot { friction: case.friction.unwrap_or(self.robot.friction), ..self.robot.clone() }
    }
}

/// The recordings of an experiment, ready for every case.
pub(super) struct Session<'a> {
    experiment: &'a Experiment,
    main: Vec<Prepared>,
    validation: Vec<Prepared>,
}

/// The regression problem of one friction model, with its weights.
pub(super) struct CaseProblem {
    friction: Friction,
    pub(super) problem: Problem,
    /// One over the standard deviation of each joint's LS residual, where LS has an estimate.
    weights: Option<Vec<f64>>,
}

impl Session<'_> {
    /// One problem for each friction model, the nominal one first.
    pub(super) fn problems(&self, progress: &mut dyn FnMut(&str)) -> Result<Vec<CaseProblem>, ExperimentError> {
        let mut problems: Vec<CaseProblem> = Vec::new();
        for case in self.experiment.cases() {
            let robot = self.experiment.robot_for(&case);
            if problems.iter().any(|p| p.friction == robot.friction) {
                continue;
            }
            progress("building the observation matrix");
            let problem = self.experiment.problem(&robot, &filtered(&self.main))?;
            let fit = idim_ls(&problem.x, &problem.y, None, self.experiment.file.estimation.variance).ok();
            let weights = fit.map(|fit| joint_weights(&problem.x, &problem.y, &fit, problem.joints()));
            problems.push(CaseProblem { friction: robot.friction, problem, weights });
        }
        Ok(problems)
    }

    /// The problem of a case: the first is the robot's own friction model, the second the other one.
    fn friction_index(&self, case: &Case) -> usize {
        usize::from(case.friction.is_some_and(|f| f != self.experiment.robot.friction))
    }

    /// Every method of every case.
    fn runs(
        &self,
        problems: &[CaseProblem],
        cases: &[Case],
        progress: &mut dyn FnMut(&str),
    ) -> Result<Vec<Vec<(RunResult, Estimated)>>, ExperimentError> {
        let estimation = &self.experiment.file.estimation;
        let methods = |case: &Case| case.methods.clone().unwrap_or_else(|| estimation.methods.clone());
        let all: Vec<(usize, Method)> =
            cases.iter().enumerate().flat_map(|(c, case)| methods(case).into_iter().map(move |m| (c, m))).collect();
        let attempt =
            |&(c, method): &(usize, Method)| self.attempt(&problems[self.friction_index(&cases[c])], &cases[c], method);
        let attempts: Vec<Attempt<'_>> = all.iter().map(attempt).collect();
        let terms = Terms {
            divisor: estimation.variance,
            convergence: estimation.convergence,
            motion_step: Some(1),
            threads: available_threads(),
        };
        let mut made: Vec<Option<(RunResult, Estimated)>> = all.iter().map(|_| None).collect();
        let mut tell =
            |simulations| progress(&format!("simulating and estimating: {simulations} simulations side by side"));
        turns::make(&attempts, terms, &mut tell, &mut |k, finished| {
            made[k] = Some(self.assess(&cases[all[k].0], &attempts[k], finished)?);
            Ok::<(), ExperimentError>(())
        })?;
        let mut by_case: Vec<Vec<_>> = cases.iter().map(|_| Vec::new()).collect();
        all.iter().zip(made).for_each(|((c, _), run)| by_case[*c].extend(run));
        Ok(by_case)
    }

    /// A method of a case.
    pub(super) fn attempt<'s>(&'s self, case_problem: &'s CaseProblem, case: &Case, method: Method) -> Attempt<'s> {
        let problem = &case_problem.problem;
        let simulator = self.simulator(&self.main, problem, case);
        let start = simulator.as_ref().map(Simulator::start).unwrap_or_default();
        Attempt { problem, method, weights: self.weights(case_problem, method), simulator, start }
    }

    /// What is computed of an estimate: its simulation, its curves, its residual, and how it predicts.
    fn assess(
        &self,
        case: &Case,
        attempt: &Attempt<'_>,
        finished: Finished,
    ) -> Result<(RunResult, Estimated), ExperimentError> {
        let Attempt { problem, method, weights, simulator, .. } = attempt;
        let Finished { outcome, motions, seconds } = finished;
        let mut run = self.summarise(problem, case, *method, &outcome, weights.as_deref());
        run.seconds = seconds;
        if let Some(fit) = &outcome.fit {
            run.simulation_relative_error_percent =
                simulator.as_ref().zip(motions.as_ref()).map(|(s, motions)| s.errors(motions));
            run.plots = problem.plots(&fit.prediction, motions.as_deref().unwrap_or_default());
            run.residual = Some(residual(problem, &fit.prediction, weights.as_deref()));
            self.validate(problem, case, (&outcome, weights.as_deref()), &mut run)?;
        }
        Ok((run, Estimated { method: *method, weights: weights.clone(), outcome }))
    }

    /// How an estimate predicts what it was not made from.
    fn validate(
        &self,
        problem: &Problem,
        case: &Case,
        (outcome, weights): (&Outcome, Option<&[f64]>),
        run: &mut RunResult,
    ) -> Result<(), ExperimentError> {
        let Some(fit) = &outcome.fit else { return Ok(()) };
        if let Some(folds) = self.folds(problem) {
            let instruments = outcome.instruments.as_ref();
            let left_out = leave_folds_out(problem, run.method, instruments, weights, &folds);
            run.influence = left_out.as_ref().and_then(|l| influence(run, l, &folds));
            run.cross_validation_relative_error_percent = left_out.as_ref().map(|l| l.relative_error_percent);
            run.cross_validation_interval_95_percent = left_out.and_then(|l| l.interval_95_percent);
        }
        if !self.validation.is_empty() {
            run.cross_validation_interval_95_percent = None;
            self.validate_on_others(case, (&problem.estimated, &fit.theta), run)?;
        }
        Ok(())
    }

    /// Compares the methods of a case; what needs a simulator with another bias makes one.
    fn diagnose(&self, problem: &Problem, case: &Case, estimated: &[Estimated]) -> CaseDiagnosis {
        let simulate = |biases: &[SimulatorBias], theta: &[f64]| {
            let with_bias = |&bias| self.simulator(&self.main, problem, &Case { simulator: bias, ..case.clone() });
            let Some(simulators) = biases.iter().map(with_bias).collect::<Option<Vec<_>>>() else { return Vec::new() };
            instruments_side_by_side(&simulators, theta, available_threads())
        };
        diagnose(problem, case, estimated, &simulate)
    }

    /// The weight of each row: that of its recording, and where the method asks for it that of its joint. None where all
    /// are one.
    pub(super) fn weights(&self, case_problem: &CaseProblem, method: Method) -> Option<Vec<f64>> {
        let weighting = self.experiment.file.estimation.weighting.get(&method).copied().unwrap_or_default();
        let of_joints = case_problem.weights.clone().filter(|_| weighting == Weighting::PerJoint);
        let of_recordings: Vec<f64> = self.main.iter().map(|p| p.filtered.record.weight).collect();
        if of_recordings.iter().all(|w| *w == 1.0) {
            return of_joints;
        }
        let mut weights = case_problem.problem.rows.spread(&of_recordings);
        weights.iter_mut().zip(of_joints.iter().flatten()).for_each(|(w, joint)| *w *= joint);
        Some(weights)
    }

    fn simulator<'s>(&'s self, prepared: &'s [Prepared], problem: &'s Problem, case: &Case) -> Option<Simulator<'s>> {
        let controller = self.experiment.file.controller.as_ref()?;
        let recordings =
            prepared.iter().map(|p| Some((&p.filtered, p.reference.as_ref()?))).collect::<Option<Vec<_>>>()?;
        Some(Simulator::new(self.experiment, problem, &recordings, controller, case.simulator))
    }

    fn summarise(
        &self,
        problem: &Problem,
        case: &Case,
        method: Method,
        outcome: &Outcome,
        weights: Option<&[f64]>,
    ) -> RunResult {
        let fit = outcome.fit.as_ref();
        let instruments = outcome.instruments.as_ref();
        let rows = problem.rows.blocks();
        let uncertain = |f| uncertainty(method, (&problem.x, instruments, &problem.y), weights, f, &rows).ok();
        let parameters = fit.map(|f| self.parameters(problem, f, uncertain(f).as_ref()));
        let iterations = outcome.iterations.iter().map(|i| IterationResult {
            relative_error_percent: i.relative_error_percent,
            parameter_change: i.parameter_change,
            error_change: i.error_change,
            estimates: i.theta.clone(),
        });
        RunResult {
            case: case.name.clone(),
            method,
            status: outcome.status,
            reason: outcome.reason.as_ref().map(|r| explain(problem, r)),
            iterations: outcome.iterations.len(),
            simulations: outcome.simulations,
            relative_error_percent: fit.map(|f| f.relative_error_percent),
            joint_relative_error_percent: fit.map(|f| problem.joint_errors(&f.prediction)).unwrap_or_default(),
            cross_validation_relative_error_percent: None,
            cross_validation_interval_95_percent: None,
            influence: None,
            residual: None,
            validation_condition_number: None,
            condition_number: fit.map(|f| f.condition_number),
            seconds: 0.0,
            simulation_relative_error_percent: None,
            validation_simulation_relative_error_percent: None,
            f_test: fit.filter(|_| method == Method::IdimLs).and_then(|f| full_model_test(problem, &f.theta)),
            convergence: iterations.collect(),
            parameters: parameters.unwrap_or_default(),
            plots: RunPlots::default(),
        }
    }

    fn parameters(&self, problem: &Problem, fit: &Fit, uncertainty: Option<&Uncertainty>) -> Vec<ParameterResult> {
        let (theta, deviations) = (&fit.theta, &fit.standard_deviation);
        let truth = self
            .main
            .first()
            .and_then(|p| p.filtered.record.truth.as_ref())
            .map(|t| problem.estimated.from_standard(t));
        let show = &self.experiment.file.parameters.show;
        let relative = |sd: f64, value: f64| (value != 0.0).then(|| 100.0 * sd / value.abs());
        problem
            .estimated
            .parameters()
            .iter()
            .enumerate()
            .map(|(i, p)| ParameterResult {
                name: p.name.clone(),
                estimate: theta[i],
                standard_deviation: Some(deviations[i]),
                relative_standard_deviation_percent: relative(deviations[i], theta[i]),
                true_value: truth.as_ref().map(|t| t[i]),
                unit: p.unit.to_owned(),
                expression: p.expression.clone(),
                shown: show.is_empty() || show.contains(&p.name),
                standard_deviation_robust: uncertainty.map(|u| u.standard_deviation[i]),
                interval_95: uncertainty.map(|u| u.interval_95[i]),
            })
            .collect()
    }

    /// What is left out in turn: a recording where there are several, else a move where they are known, else a part.
    fn folds(&self, problem: &Problem) -> Option<Folds> {
        let [only] = &self.main[..] else {
            let of_row = folds_by_recording(problem.rows.recording_of_row())?;
            let names = self.main.iter().map(|p| format!("recording {}", p.filtered.record.name)).collect();
            return Some(Folds { of_row, names });
        };
        match only.reference.as_ref().map(|r| &r.reference) {
            Some(Reference::Moves(moves)) => {
                folds_by_move(moves, &self.times(problem)).map(|f| Folds::numbered("move", f))
            }
            Some(Reference::Sampled(_)) | None => {
                Some(Folds::numbered("part", folds_by_part(problem.rows.per_joint())))
            }
        }
    }

    /// The time of each row of a joint; the recordings follow one another.
    fn times(&self, problem: &Problem) -> Vec<f64> {
        let mut times = Vec::new();
        let mut before_s = 0.0;
        for (Prepared { filtered, .. }, decimator) in self.main.iter().zip(&problem.decimators) {
            let rate = filtered.record.sample_rate_hz;
            times.extend(decimator.kept().map(|k| before_s + filtered.start_s() + k as f64 / rate));
            before_s += filtered.record.position.len() as f64 / rate;
        }
        times
    }

    fn validate_on_others(
        &self,
        case: &Case,
        (estimated, theta): (&BaseParameters, &[f64]),
        run: &mut RunResult,
    ) -> Result<(), ExperimentError> {
        let robot = self.experiment.robot_for(case);
        let problem = self.experiment.validation_problem(&robot, &filtered(&self.validation), estimated)?;
        run.cross_validation_relative_error_percent = Some(relative_error_percent(&problem.y, &problem.x.times(theta)));
        run.validation_condition_number = Some(problem.x.condition_number());
        if let Some(simulator) = self.simulator(&self.validation, &problem, case) {
            let motions = simulator.simulate(theta).ok();
            run.validation_simulation_relative_error_percent = motions.map(|m| simulator.errors(&m));
        }
        Ok(())
    }

    /// What is found in the recordings, those that are identified from and those held back.
    fn findings(&self, nominal: &Problem) -> Vec<RecordingFindings> {
        let examine = |prepared: &Prepared, held_back| {
            self.experiment.examine(&prepared.filtered, prepared.reference.as_ref(), nominal, held_back)
        };
        let main = self.main.iter().map(|p| examine(p, false));
        main.chain(self.validation.iter().map(|p| examine(p, true))).collect()
    }

    fn results(
        &self,
        nominal: &CaseProblem,
        findings: Vec<RecordingFindings>,
        runs: Vec<RunResult>,
        diagnostics: Vec<CaseDiagnosis>,
    ) -> Result<Results, ExperimentError> {
        let problem = &nominal.problem;
        let name = |i: &usize| problem.base.parameters()[*i].name.clone();
        let elimination = problem.elimination.as_ref().map(|e| EliminationResult {
            kept: e.kept.iter().map(name).collect(),
            eliminated: e.eliminated.iter().map(name).collect(),
            f_test: e.f_test,
        });
        let positions: Vec<&Series> = self.main.iter().map(|p| &p.filtered.q).collect();
        let rate = self.main.first().map_or(0.0, |p| p.filtered.record.sample_rate_hz);
        Ok(Results {
            thetahat: env!("CARGO_PKG_VERSION").to_owned(),
            robot: self.experiment.robot.name.clone(),
            title: self.experiment.file.title.clone(),
            samples_used: self.main.iter().map(|p| p.filtered.window.len()).sum(),
            decimated_rows: problem.y.len(),
            recordings: self.main.iter().map(Prepared::describe).collect(),
            validation_recordings: self.validation.iter().map(Prepared::describe).collect(),
            bandwidth: self.experiment.measure_bandwidth(rate)?,
            seed: self.experiment.file.twin.as_ref().map(|t| t.sensors.seed),
            findings,
            elimination,
            advice: diagnostics.iter().map(|d| advise(d, &runs)).collect(),
            diagnostics,
            runs,
            experiment_description: self.experiment.text.clone(),
            robot_description: self.experiment.robot_text.clone(),
            plots: Plots {
                time_s: self.times(problem),
                measured: problem.by_joint(&problem.y),
                position: problem.at_rows(&positions),
            },
        })
    }
}

/// The largest change of an estimate, in its standard deviations with correlated errors, without one of the folds.
fn influence(run: &RunResult, left_out: &CrossValidation, folds: &Folds) -> Option<Influence> {
    let changes = left_out.theta.iter().zip(&folds.names).flat_map(|(theta, part)| {
        run.parameters.iter().zip(theta).filter_map(move |(p, without)| {
            let change = (without - p.estimate) / p.standard_deviation_robust.filter(|sd| *sd > 0.0)?;
            Some(Influence { part: part.clone(), parameter: p.name.clone(), change })
        })
    });
    changes.max_by(|a, b| a.change.abs().total_cmp(&b.change.abs()))
}

fn filtered(prepared: &[Prepared]) -> Vec<&FilteredRecord> {
    prepared.iter().map(|p| &p.filtered).collect()
}

impl Prepared {
    fn describe(&self) -> RecordingResult {
        let FilteredRecord { record, window, .. } = &self.filtered;
        let rate = record.sample_rate_hz;
        RecordingResult {
            name: record.name.clone(),
            weight: record.weight,
            samples_used: window.len(),
            sample_rate_hz: rate,
            window_s: [window.start as f64 / rate, window.end as f64 / rate],
            resampling: record.resampling,
            reference: self.reference.as_ref().map(|r| self.describe_reference(r)),
        }
    }

    fn describe_reference(&self, reference: &RecordReference) -> ReferenceResult {
        let moves = match &reference.reference {
            Reference::Moves(moves) => Some(moves.moves().len()),
            Reference::Sampled(_) => None,
        };
        let rms_deviation = self.filtered.rms_deviation_from(reference);
        ReferenceResult { origin: reference.origin.to_owned(), moves, rms_deviation }
    }
}

/// A reason in words: the estimators know columns, people know names.
pub(crate) fn explain(problem: &Problem, reason: &Reason) -> String {
    let Reason::Estimation(EstimationError::NotIdentifiable { rank, columns, dependent }) = reason else {
        return reason.to_string();
    };
    let names: Vec<&str> = dependent.iter().map(|&c| problem.estimated.parameters()[c].name.as_str()).collect();
    format!(
        "the motion separates only {rank} of {columns} parameters; not separated from the others by this motion: {}",
        names.join(" ")
    )
}

/// The F-test of the estimated parameters against all base parameters, by least squares on X.
fn full_model_test(problem: &Problem, theta: &[f64]) -> Option<FTest> {
    let full_x = problem.full_x.as_ref()?;
    let full = idim_ls(full_x, &problem.y, None, Default::default()).ok()?;
    let residual: Vec<f64> = problem.x.times(theta).iter().zip(&problem.y).map(|(p, y)| y - p).collect();
    let reduced_squares = norm(&residual).powi(2);
    let full_squares = full.residual_sum_of_squares(&problem.y);
    f_test(reduced_squares, theta.len(), full_squares, full_x.columns(), problem.y.len())
}
