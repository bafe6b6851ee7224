//! The run of an experiment: every case, every method.

use std::{path::Path, time::Instant};

use super::{
    Case, EliminationResult, Experiment, ExperimentError, IterationResult, ParameterResult, Plots, ReferenceResult,
    Results, RunPlots, RunResult, Weighting,
    chain::{FilteredRecord, Problem},
    cross_validation::{folds_by_move, leave_folds_out},
    simulator::{RecordReference, Simulator},
};
use crate::{
    base_parameters::BaseParameters,
    identification::{
        EstimationError, Method, Outcome, Reason, idim_ls, iterate, joint_weights, relative_error_percent,
    },
    linear_algebra::norm,
    robot::{Friction, Robot},
    simulation::{Reference, SimulatedMotion},
    statistics::{FTest, f_test},
};

/// A record ready for every case: filtered, with its reference where a method or report needs one.
struct Prepared {
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
        progress("reading the recording");
        let record = match (&self.file.recording, &self.file.twin) {
            (Some(recording), _) => self.read_record(recording, data)?,
            (None, Some(twin)) => self.simulate_twin(twin)?,
            (None, None) => return Err(self.missing("[recording] or [twin]", "there is nothing to identify from")),
        };
        progress("filtering and reconstructing the reference");
        let main = self.prepare(self.filter(record)?)?;
        let validation = match &self.file.validation {
            Some(recording) => Some(self.prepare(self.filter(self.read_record(recording, data)?)?)?),
            None => None,
        };
        let session = Session { experiment: self, main, validation };
        let problems = session.problems(progress)?;
        let mut runs = Vec::new();
        for case in self.cases() {
            let problem = &problems[session.friction_index(&case)];
            for &method in case.methods.as_ref().unwrap_or(&self.file.estimation.methods) {
                progress(&format!("{}: {}", case.name, method.name()));
                runs.push(session.run(problem, &case, method)?);
            }
        }
        session.results(&problems[0], runs)
    }

    fn prepare(&self, filtered: FilteredRecord) -> Result<Prepared, ExperimentError> {
        let reference = self.file.controller.as_ref().map(|_| self.reference(&filtered)).transpose()?;
        Ok(Prepared { filtered, reference })
    }

    /// The robot with a case's friction model.
    fn robot_for(&self, case: &Case) -> Robot {
        Robot { friction: case.friction.unwrap_or(self.robot.friction), ..self.robot.clone() }
    }
}

struct Session<'a> {
    experiment: &'a Experiment,
    main: Prepared,
    validation: Option<Prepared>,
}

/// The regression problem of one friction model, with its weights.
struct CaseProblem {
    friction: Friction,
    problem: Problem,
    /// One over the standard deviation of each joint's LS residual, where LS has an estimate.
    weights: Option<Vec<f64>>,
}

impl Session<'_> {
    /// One problem for each friction model, the nominal one first.
    fn problems(&self, progress: &mut dyn FnMut(&str)) -> Result<Vec<CaseProblem>, ExperimentError> {
        let mut problems: Vec<CaseProblem> = Vec::new();
        for case in self.experiment.cases() {
            let robot = self.experiment.robot_for(&case);
            if problems.iter().any(|p| p.friction == robot.friction) {
                continue;
            }
            progress("building the observation matrix");
            let problem = self.experiment.problem(&robot, &self.main.filtered)?;
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

    fn run(&self, case_problem: &CaseProblem, case: &Case, method: Method) -> Result<RunResult, ExperimentError> {
        let started = Instant::now();
        let CaseProblem { problem, weights, .. } = case_problem;
        let weighting = self.experiment.file.estimation.weighting.get(&method).copied().unwrap_or_default();
        let weights = weights.as_deref().filter(|_| weighting == Weighting::PerJoint);
        let simulator = self.simulator(&self.main, problem, case);
        let outcome = self.estimate(problem, method, weights, simulator.as_ref());
        let seconds = started.elapsed().as_secs_f64();
        let mut run = self.summarise(problem, case, method, &outcome);
        run.seconds = seconds;
        let Some(fit) = &outcome.fit else { return Ok(run) };
        let motion = simulator.as_ref().and_then(|s| s.simulate(&fit.theta).ok());
        run.simulation_relative_error_percent = simulator.as_ref().zip(motion.as_ref()).map(|(s, m)| s.errors(m));
        run.plots = problem.plots(&fit.prediction, motion.as_ref().map(|m: &SimulatedMotion| &m.q));
        if self.validation.is_some() {
            self.validate_on_second_recording(case, (&problem.estimated, &fit.theta), &mut run)?;
        } else if let Some(folds) = self.folds(problem) {
            let instruments = outcome.instruments.as_ref();
            run.cross_validation_relative_error_percent =
                leave_folds_out(problem, method, instruments, weights, &folds);
        }
        Ok(run)
    }

    fn simulator<'s>(&'s self, prepared: &'s Prepared, problem: &'s Problem, case: &Case) -> Option<Simulator<'s>> {
        let controller = self.experiment.file.controller.as_ref()?;
        let reference = prepared.reference.as_ref()?;
        Some(Simulator::new(self.experiment, problem, &prepared.filtered, (controller, reference), case.simulator))
    }

    fn estimate(
        &self,
        problem: &Problem,
        method: Method,
        weights: Option<&[f64]>,
        simulator: Option<&Simulator<'_>>,
    ) -> Outcome {
        let estimation = &self.experiment.file.estimation;
        match (method, simulator) {
            (Method::IdimIv | Method::Didim, Some(simulator)) => iterate(
                method,
                (&problem.x, &problem.y),
                weights,
                (estimation.variance, estimation.convergence),
                &simulator.start(),
                &mut |theta| simulator.instruments(theta),
            ),
            _ => Outcome::direct(idim_ls(&problem.x, &problem.y, weights, estimation.variance)),
        }
    }

    fn summarise(&self, problem: &Problem, case: &Case, method: Method, outcome: &Outcome) -> RunResult {
        let fit = outcome.fit.as_ref();
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
            validation_condition_number: None,
            condition_number: fit.map(|f| f.condition_number),
            seconds: 0.0,
            simulation_relative_error_percent: None,
            validation_simulation_relative_error_percent: None,
            f_test: fit.filter(|_| method == Method::IdimLs).and_then(|f| full_model_test(problem, &f.theta)),
            convergence: iterations.collect(),
            parameters: fit.map(|f| self.parameters(problem, &f.theta, &f.standard_deviation)).unwrap_or_default(),
            plots: RunPlots::default(),
        }
    }

    fn parameters(&self, problem: &Problem, theta: &[f64], deviations: &[f64]) -> Vec<ParameterResult> {
        let truth = self.main.filtered.record.truth.as_ref().map(|t| problem.estimated.from_standard(t));
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
            })
            .collect()
    }

    fn folds(&self, problem: &Problem) -> Option<Vec<usize>> {
        match &self.main.reference.as_ref()?.reference {
            Reference::Moves(moves) => folds_by_move(moves, &self.times(problem)),
            Reference::Sampled(_) => None,
        }
    }

    fn times(&self, problem: &Problem) -> Vec<f64> {
        let filtered = &self.main.filtered;
        problem.decimator.kept().map(|k| filtered.start_s() + k as f64 / filtered.record.sample_rate_hz).collect()
    }

    fn validate_on_second_recording(
        &self,
        case: &Case,
        (estimated, theta): (&BaseParameters, &[f64]),
        run: &mut RunResult,
    ) -> Result<(), ExperimentError> {
        let Some(validation) = &self.validation else { return Ok(()) };
        let robot = self.experiment.robot_for(case);
        let problem = self.experiment.validation_problem(&robot, &validation.filtered, estimated)?;
        run.cross_validation_relative_error_percent = Some(relative_error_percent(&problem.y, &problem.x.times(theta)));
        run.validation_condition_number = Some(problem.x.condition_number());
        if let Some(simulator) = self.simulator(validation, &problem, case) {
            let motion = simulator.simulate(theta).ok();
            run.validation_simulation_relative_error_percent = motion.map(|m| simulator.errors(&m));
        }
        Ok(())
    }

    fn results(&self, nominal: &CaseProblem, runs: Vec<RunResult>) -> Result<Results, ExperimentError> {
        let problem = &nominal.problem;
        let filtered = &self.main.filtered;
        let rate = filtered.record.sample_rate_hz;
        let name = |i: &usize| problem.base.parameters()[*i].name.clone();
        let elimination = problem.elimination.as_ref().map(|e| EliminationResult {
            kept: e.kept.iter().map(name).collect(),
            eliminated: e.eliminated.iter().map(name).collect(),
            f_test: e.f_test,
        });
        Ok(Results {
            thetahat: env!("CARGO_PKG_VERSION").to_owned(),
            robot: self.experiment.robot.name.clone(),
            title: self.experiment.file.title.clone(),
            samples_used: filtered.window.len(),
            decimated_rows: problem.y.len(),
            sample_rate_hz: rate,
            window_s: [filtered.window.start as f64 / rate, filtered.window.end as f64 / rate],
            bandwidth: self.experiment.measure_bandwidth(rate)?,
            reference: self.main.reference.as_ref().map(|r| self.describe_reference(r)),
            seed: self.experiment.file.twin.as_ref().map(|t| t.sensors.seed),
            elimination,
            runs,
            experiment_description: self.experiment.text.clone(),
            robot_description: self.experiment.robot_text.clone(),
            plots: Plots {
                time_s: self.times(problem),
                measured: problem.by_joint(&problem.y),
                position: problem.at_rows(&filtered.q),
            },
        })
    }

    fn describe_reference(&self, reference: &RecordReference) -> ReferenceResult {
        let filtered = &self.main.filtered;
        let joints = filtered.q.channels();
        let [mut q, mut dq, mut ddq] = [(); 3].map(|()| vec![0.0; joints]);
        let mut squares = vec![0.0; joints];
        for k in filtered.window.clone() {
            reference.reference.evaluate(k as f64 / filtered.record.sample_rate_hz, &mut q, &mut dq, &mut ddq);
            let measured = filtered.record.position.sample(k);
            squares.iter_mut().zip(measured.iter().zip(&q)).for_each(|(s, (m, r))| *s += (m - r).powi(2));
        }
        let moves = match &reference.reference {
            Reference::Moves(moves) => Some(moves.moves().len()),
            Reference::Sampled(_) => None,
        };
        let rms = squares.iter().map(|s| (s / filtered.window.len() as f64).sqrt()).collect();
        ReferenceResult { origin: reference.origin.to_owned(), moves, rms_deviation: rms }
    }
}

/// A reason in words: the estimators know columns, people know names.
fn explain(problem: &Problem, reason: &Reason) -> String {
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
