//! What is computed of an estimate: its numbers with their deviations, its simulation and its curves, and how it predicts
//! what it was not made from.

use std::borrow::Cow;

use super::{
    controller_step::allow_for_steps,
    curves::{self, residual},
    estimation_data::EstimationData,
    identification::{Identification, explain},
    linear::Linear,
    links_of_description::allow_for_links,
    parameters::{covariance_of, loop_parameter_results, parameter_results, without_deviations_of_sums},
    physical::Examined,
    prepared::filtered,
    validation::{
        cross_validation::{CrossValidation, Folds, leave_folds_out},
        no_predictive_power::{Data, no_predictive_power},
    },
};
use crate::{
    diagnosis::{MethodEstimate, residual},
    preparation::{Case, PreparationError},
    scheduling::{EstimationJob, Finished},
};
use thetahat_estimation::{
    identification::{
        EstimationError, Fit, Method, Needs, Outcome, Response, Uncertainty, uncertainty, uncertainty_of_stretches,
    },
    regression::relative_error_percent,
    signal::Motion,
    simulation::SimulatedMotion,
};
use thetahat_ground::series::Series;
use thetahat_report::results::{
    Influence, IterationResult, LoopParameterResult, NOMINAL, ParameterResult, RunPlots, RunResult,
};

/// An estimation of a case that is to be assessed.
pub(super) struct Assessment<'a> {
    pub(super) data: EstimationData<'a>,
    pub(super) case: &'a Case,
    pub(super) job: &'a EstimationJob<'a>,
}

impl Assessment<'_> {
    /// The run of a finished estimation, and what the diagnosis of its case needs.
    pub(super) fn assess(&self, finished: Finished) -> Result<(RunResult, MethodEstimate), PreparationError> {
        let EstimationJob { problem, method, regression, simulator, .. } = self.job;
        let Finished { outcome, motions, note, seconds } = finished;
        let mut run = self.summarise(&outcome);
        run.seconds = seconds;
        if method.needs() != Needs::Measurement {
            let notes = self.data.samples().map(Identification::simulation_notes).unwrap_or_default();
            run.notes = notes.into_iter().chain(note).collect();
        }
        if let Some(fit) = &outcome.fit {
            if run.case == NOMINAL {
                run.covariance = covariance_of(fit, &run.parameters);
            }
            run.simulation_relative_error_percent =
                simulator.as_ref().zip(motions.as_ref()).map(|(s, motions)| s.errors(motions));
            if method.response() == Response::Position {
                let deviation = simulator.as_ref().zip(motions.as_ref()).map(|(s, m)| s.deviation_of_positions(m));
                run.notes.extend(deviation.map(|rms| note_of_positions(rms, "those recorded")));
            }
            if let Some(identification) = self.data.samples() {
                allow_for_links(identification, &mut run);
                allow_for_steps(identification, &mut run);
                run.plots = self.plots(identification, fit, motions.as_deref().unwrap_or_default());
            }
            let setup = self.data.setup();
            let folds = self.data.folds(problem).filter(|_| setup.settings.parameters.physical);
            let linear = Linear::of(self.job, &outcome, fit);
            run.physical = Examined { setup, job: self.job, linear: &linear, run: &run, folds }.physical();
            run.residual = regression.is_in_time_order.then(|| residual(regression, &fit.prediction));
            if method.response() == Response::Torque {
                let robot = setup.robot;
                run.findings.extend(no_predictive_power(robot, regression, &fit.prediction, Data::Own));
            }
            self.leave_parts_out(&outcome, &mut run);
            if let Some(identification) = self.data.samples().filter(|i| !i.validation.is_empty()) {
                run.cross_validation_interval_95_percent = None;
                self.validate_on_others(identification, fit, &mut run)?;
            }
        }
        Ok((run, MethodEstimate { method: *method, regression: regression.clone(), outcome }))
    }

    /// The predicted torque: of the measured motion where the response that is fitted is another.
    fn torque<'f>(&self, fit: &'f Fit) -> Cow<'f, [f64]> {
        match self.job.method.response() {
            Response::Torque => Cow::Borrowed(&fit.prediction),
            Response::Position => Cow::Owned(self.job.problem.regression.x.times(self.of_robot(fit))),
        }
    }

    /// The curves of the run.
    fn plots(&self, identification: &Identification, fit: &Fit, motions: &[SimulatedMotion]) -> RunPlots {
        let problem = self.job.problem;
        let main = &identification.main;
        let at_rows = |of: fn(&Motion) -> &Series| {
            problem.at_rows(&main.iter().map(|p| of(&p.filtered.motion)).collect::<Vec<_>>())
        };
        let motion = residual::Motion {
            position: at_rows(|m| &m.q),
            velocity: at_rows(|m| &m.dq),
            rate_hz: main.first().map_or(0.0, |p| p.filtered.recording.sample_rate_hz) / self.decimation(),
        };
        let torque = self.torque(fit);
        let of_robot = self.job.problem.estimated.len();
        let correlations = residual::correlations(&fit.covariance);
        RunPlots {
            residual: residual::residual_curves(&problem.regression, &torque, &motion),
            correlation: correlations.into_iter().take(of_robot).map(|row| row[..of_robot].to_vec()).collect(),
            numbers: curves::numbers(&problem.model, &problem.estimated),
            a_priori: curves::a_priori(self.data.setup().robot, &problem.model, &problem.estimated),
            ..curves::of_prediction(problem, &torque, motions)
        }
    }

    fn decimation(&self) -> f64 {
        self.data.setup().settings.signal.decimation as f64
    }

    fn summarise(&self, outcome: &Outcome) -> RunResult {
        let EstimationJob { problem, method, regression, .. } = self.job;
        let fit = outcome.fit.as_ref();
        let iterations = outcome.iterations.iter().map(|i| IterationResult {
            relative_error_percent: i.relative_error_percent,
            parameter_change: i.parameter_change,
            error_change: i.error_change,
            estimates: i.theta.iter().take(problem.estimated.len()).copied().collect(),
        });
        let test = |f| if *method == Method::IDIM_LS { problem.full_model_test(f) } else { None };
        RunResult {
            weighting: Some(self.data.setup().settings.weighting(*method)),
            reason: outcome.reason.as_ref().map(|r| explain(&problem.estimated, &self.job.names_of_loop(), r)),
            iterations: outcome.iterations.len(),
            simulations: outcome.simulations,
            relative_error_percent: fit.map(|f| f.relative_error_percent),
            joint_relative_error_percent: fit
                .map(|f| regression.joint_relative_errors_percent(&f.prediction))
                .unwrap_or_default(),
            condition_number: fit.map(|f| f.condition_number),
            f_test: fit.and_then(test),
            convergence: iterations.collect(),
            parameters: fit.map(|f| self.parameters(f, outcome)).unwrap_or_default(),
            loop_parameters: fit.map(|f| self.loop_parameters(f, outcome)).unwrap_or_default(),
            ..RunResult::new(&self.case.name, *method, outcome.status)
        }
    }

    fn parameters(&self, fit: &Fit, outcome: &Outcome) -> Vec<ParameterResult> {
        let problem = self.job.problem;
        let uncertainty = self.uncertainty(outcome, fit).ok();
        let truth = self.data.truth_of(problem);
        let settings = self.data.setup().settings;
        let all = parameter_results(settings, &problem.estimated, fit, uncertainty.as_ref(), truth.as_deref());
        without_deviations_of_sums(problem, all)
    }

    fn loop_parameters(&self, fit: &Fit, outcome: &Outcome) -> Vec<LoopParameterResult> {
        let EstimationJob { problem, simulator, .. } = self.job;
        let Some(simulator) = simulator.as_ref().filter(|s| !s.loop_parameters().is_empty()) else { return Vec::new() };
        let uncertainty = self.uncertainty(outcome, fit).ok();
        let scale = self.data.setup().settings.simulation.sign_velocity_scale;
        let asked = (simulator.loop_parameters(), scale);
        loop_parameter_results(asked, problem.estimated.len(), fit, uncertainty.as_ref())
    }

    /// From the correlation of the rows in time, or where they are triangular factors from their stretches of time.
    fn uncertainty(&self, outcome: &Outcome, fit: &Fit) -> Result<Uncertainty, EstimationError> {
        let EstimationJob { method, regression, .. } = self.job;
        let z = outcome.instruments.as_ref();
        if regression.is_in_time_order {
            return uncertainty(*method, regression, z, fit);
        }
        uncertainty_of_stretches(regression, z, &fit.theta)
    }

    /// The estimates of the robot's parameters, without those of the loop.
    fn of_robot<'f>(&self, fit: &'f Fit) -> &'f [f64] {
        &fit.theta[..self.job.problem.estimated.len()]
    }

    /// Leaves recordings, moves or parts out in turn, and predicts them from the others.
    fn leave_parts_out(&self, outcome: &Outcome, run: &mut RunResult) {
        let EstimationJob { problem, method, regression, .. } = self.job;
        let Some(folds) = self.data.folds(problem) else { return };
        let Some(left_out) = leave_folds_out(regression, *method, outcome, &folds) else { return };
        run.influence = influence(run, &left_out, &folds);
        run.cross_validation_relative_error_percent = Some(left_out.relative_error_percent);
        run.cross_validation_interval_95_percent = left_out.interval_95_percent;
    }

    /// Predicts the recordings that were held back.
    fn validate_on_others(
        &self,
        identification: &Identification,
        fit: &Fit,
        run: &mut RunResult,
    ) -> Result<(), PreparationError> {
        let recordings = filtered(&identification.validation);
        let setup = identification.setup();
        let problem = setup.validation_problem(self.case, &recordings, &self.job.problem.estimated)?;
        let regression = &problem.regression;
        let prediction = regression.x.times(self.of_robot(fit));
        // The error of a run that fits positions is of positions: that of its torques does not belong there.
        if !run.is_of_positions() {
            run.cross_validation_relative_error_percent = Some(relative_error_percent(&regression.y, &prediction));
            run.findings.extend(no_predictive_power(setup.robot, regression, &prediction, Data::HeldBack));
        }
        run.plots.held_back = regression.layout.by_joint(&prediction);
        run.validation_condition_number = Some(regression.x.condition_number());
        if let Some(simulator) = identification.simulator(&identification.validation, &problem, self.case) {
            let motions = simulator.simulate(&fit.theta).ok();
            if run.is_of_positions() {
                let errors = motions.as_ref().map(|m| simulator.errors(m));
                run.cross_validation_relative_error_percent = errors.and_then(|e| e.get("position").copied());
                let deviation = motions.as_ref().map(|m| simulator.deviation_of_positions(m));
                run.notes.extend(deviation.map(|rms| note_of_positions(rms, "those of the recordings held back")));
            }
            run.validation_simulation_relative_error_percent = motions.map(|m| simulator.errors(&m));
        }
        Ok(())
    }
}

fn note_of_positions(rms: f64, of: &str) -> String {
    format!("the simulated positions are {rms:.2e} rad or m rms from {of}")
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
