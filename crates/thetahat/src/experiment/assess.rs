//! What is computed of an estimate: its numbers with their deviations, its simulation and its curves, and how it predicts
//! what it was not made from.

use super::{
    Case, ExperimentError,
    chain::Problem,
    cross_validation::{CrossValidation, Folds, folds_by_move, folds_by_part, folds_by_recording, leave_folds_out},
    diagnosis::{Estimated, residual},
    run::{Prepared, Session, explain, filtered},
    turns::{Attempt, Finished},
};
use crate::{
    base_parameters::BaseParameters,
    identification::{Fit, Method, Outcome, Uncertainty, idim_ls, relative_error_percent, uncertainty},
    linear_algebra::norm,
    results::{Influence, IterationResult, ParameterResult, RunPlots, RunResult},
    simulation::Reference,
    statistics::{FTest, f_test},
};

impl Session<'_> {
    /// What is computed of an estimate: its simulation, its curves, its residual, and how it predicts.
    pub(super) fn assess(
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
            weighting: Some(self.experiment.file.estimation.weighting_of(method).name().to_owned()),
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
    pub(super) fn times(&self, problem: &Problem) -> Vec<f64> {
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

/// The F-test of the estimated parameters against all base parameters, by least squares on X.
fn full_model_test(problem: &Problem, theta: &[f64]) -> Option<FTest> {
    let full_x = problem.full_x.as_ref()?;
    let full = idim_ls(full_x, &problem.y, None, Default::default()).ok()?;
    let residual: Vec<f64> = problem.x.times(theta).iter().zip(&problem.y).map(|(p, y)| y - p).collect();
    let reduced_squares = norm(&residual).powi(2);
    let full_squares = full.residual_sum_of_squares(&problem.y);
    f_test(reduced_squares, theta.len(), full_squares, full_x.columns(), problem.y.len())
}
