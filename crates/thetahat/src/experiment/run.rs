//! The run of an experiment: every case, every method.

use std::path::Path;

use super::{
    Case, Experiment, ExperimentError, RecordingDescription, Weighting,
    advice::advise,
    chain::{FilteredRecord, Problem},
    diagnosis::{Estimated, diagnose},
    record::Record,
    simulator::{RecordReference, Simulator},
    turns::{self, Attempt, Terms},
    wishes::instruments_side_by_side,
};
use crate::{
    identification::{EstimationError, Method, Reason, idim_ls, joint_weights},
    pool::available_threads,
    results::{
        CaseDiagnosis, EliminationResult, JointResult, Plots, RecordingFindings, RecordingResult, ReferenceResult,
        Results, RunResult, SCHEMA,
    },
    robot::{Friction, Robot},
    series::Series,
    simulation::{Reference, SimulatorBias},
};

/// Part by which the sample rates of recordings may differ: clocks differ by less, chosen rates by more.
const RATE_TOLERANCE: f64 = 0.01;

/// A record ready for every case: filtered, with its reference where a method or report needs one.
pub(super) struct Prepared {
    pub(super) filtered: FilteredRecord,
    pub(super) reference: Option<RecordReference>,
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
    pub(super) experiment: &'a Experiment,
    pub(super) main: Vec<Prepared>,
    pub(super) validation: Vec<Prepared>,
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

    pub(super) fn simulator<'s>(
        &'s self,
        prepared: &'s [Prepared],
        problem: &'s Problem,
        case: &Case,
    ) -> Option<Simulator<'s>> {
        let controller = self.experiment.file.controller.as_ref()?;
        let recordings =
            prepared.iter().map(|p| Some((&p.filtered, p.reference.as_ref()?))).collect::<Option<Vec<_>>>()?;
        Some(Simulator::new(self.experiment, problem, &recordings, controller, case.simulator))
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
            schema: SCHEMA,
            thetahat: env!("CARGO_PKG_VERSION").to_owned(),
            robot: self.experiment.robot.name.clone(),
            title: self.experiment.file.title.clone(),
            robot_joints: JointResult::of_coordinates(&self.experiment.robot),
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

pub(super) fn filtered(prepared: &[Prepared]) -> Vec<&FilteredRecord> {
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
