use std::path::Path;

use super::{
    compressed::Compressed,
    error::ReductionError,
    segments::cluster_variances,
    value::{ReducedRecording, Reduction},
};
use crate::{
    diagnosis::judge,
    experiment::Experiment,
    preparation::{Case, SelectedParameters, Settings, full_model_test, named_elimination},
    run::{covariance_of, explain, parameter_results},
};
use thetahat_estimation::{
    identification::{EstimationError, Fit, JointWeights, Method, Needs, Outcome, Status, Uncertainty, Weighting},
    regression::Regression,
};
use thetahat_ground::linear_algebra::Matrix;
use thetahat_report::results::{
    EliminationResult, JointResult, NOMINAL, Plots, RecordingResult, Results, RunResult, SCHEMA,
};

/// The estimate from a reduction.
#[derive(Debug, Clone)]
pub struct Solution {
    /// In the form of an identification: the nominal run of IDIM-LS, and with instruments also of IDIM-IV.
    pub results: Results,
    /// Stretches of time from which the robust deviations and intervals come; none where there are too few.
    pub segments: Option<usize>,
}

impl Reduction {
    /// IDIM-LS (8) from the factors: estimates, classical deviations and errors are the same as from all rows.
    ///
    /// Which parameters are estimated, weights and the divisor of the variance follow the experiment of the first
    /// reduction. Robust deviations and intervals come from the scores of the stretches of time, by bias-reduced
    /// linearisation (CR2) of R. M. Bell and D. F. McCaffrey, 2002, with its degrees of freedom.
    ///
    /// A motion that does not identify the parameters is not an error: the run says so in its status.
    ///
    /// # Errors
    /// [`ReductionError`] where the experiment in the reduction cannot be used.
    pub fn solve(&self) -> Result<Solution, ReductionError> {
        let (text, robot) = (self.experiment_description.clone(), self.robot_description.clone());
        let experiment = Experiment::from_texts(Path::new(&self.experiment_name), text, robot)?;
        let setup = experiment.setup();
        let basis = setup.basis(&Case::nominal()).map_err(|e| experiment.refuse(e))?;
        if basis.base.parameters().iter().map(|p| &p.name).ne(&self.identity.parameters) {
            let reason = "its base parameters are not those that this program finds for its robot".to_owned();
            return Err(ReductionError::Damaged { path: (&self.experiment_name).into(), reason });
        }
        if self.recordings.is_empty() {
            return Err(ReductionError::Nothing);
        }
        let all = Compressed::whole(self);
        let choice = &setup.settings.parameters.estimate;
        let chosen = setup.choose(choice, (&basis.model, &basis.base), &all.regression);
        let chosen = chosen.map_err(|e| experiment.refuse(e))?;
        let elimination = chosen.elimination.as_ref().map(|e| named_elimination(e, &basis.base));
        let solver = Solver { reduction: self, settings: setup.settings, all, chosen };
        let (run, segments) = solver.run(Method::IDIM_LS);
        let mut runs = vec![run];
        if solver.all.z.is_some() {
            runs.push(solver.run(Method::IDIM_IV).0);
        }
        let mut results = self.results(&experiment, runs, elimination)?;
        judge(&mut results);
        Ok(Solution { results, segments })
    }

    fn results(
        &self,
        experiment: &Experiment,
        runs: Vec<RunResult>,
        elimination: Option<EliminationResult>,
    ) -> Result<Results, ReductionError> {
        let recordings = &self.recordings;
        let rate = recordings.first().map_or(0.0, |r| r.sample_rate_hz);
        Ok(Results {
            schema: SCHEMA,
            thetahat: env!("CARGO_PKG_VERSION").to_owned(),
            robot: experiment.robot.name.clone(),
            title: experiment.file.title.clone(),
            verdict: None,
            verdict_reasons: Vec::new(),
            robot_joints: JointResult::of_coordinates(&experiment.robot),
            robot_locked: experiment.robot.locked.clone(),
            samples_used: recordings.iter().map(|r| r.samples).sum(),
            decimated_rows: recordings.iter().map(|r| r.rows * self.identity.joints.len()).sum(),
            recordings: recordings.iter().map(ReducedRecording::describe).collect(),
            validation_recordings: Vec::new(),
            bandwidth: experiment.setup().measure_bandwidth(rate).map_err(|e| experiment.refuse(e))?,
            seed: experiment.file.twin.as_ref().map(|t| t.sensors.seed),
            findings: Vec::new(),
            unmasked_comparison: None,
            profiled_terms: Vec::new(),
            term_comparison: None,
            excluded_parameters: experiment.settings.parameters.exclude.clone(),
            fixed_parameters: experiment.settings.parameters.fix.clone(),
            elimination,
            advice: Vec::new(),
            diagnostics: Vec::new(),
            runs,
            user_runs: Vec::new(),
            payloads: Vec::new(),
            drive_gains: Vec::new(),
            experiment_description: self.experiment_description.clone(),
            robot_description: self.robot_description.clone(),
            robot_files: experiment.robot_hashes.clone(),
            plots: Plots::default(),
        })
    }
}

impl ReducedRecording {
    fn describe(&self) -> RecordingResult {
        RecordingResult {
            name: self.name.clone(),
            weight: self.weight,
            samples_used: self.samples,
            sample_rate_hz: self.sample_rate_hz,
            window_s: self.window_s,
            resampling: None,
            torque_bandwidth_hz: None,
            torque_hold_s: self.torque_hold_s,
            near_rest: self.near_rest.clone(),
            reference: None,
        }
    }
}

struct Solver<'a> {
    reduction: &'a Reduction,
    settings: &'a Settings,
    /// The factors with all base columns.
    all: Compressed,
    chosen: SelectedParameters,
}

impl Solver<'_> {
    /// The run, and the stretches behind its intervals.
    fn run(&self, method: Method) -> (RunResult, Option<usize>) {
        let joint_weights = self.joint_weights(method);
        let regression = self.regression(&self.all, joint_weights.as_deref());
        let z = self.z(&self.all, method);
        let outcome = Outcome::direct(method.estimate(&regression, z.as_ref(), self.settings.estimation.variance));
        let Some(fit) = &outcome.fit else { return (self.failed(method, &outcome), None) };
        let uncertainty = self.uncertainty(method, fit, joint_weights.as_deref()).ok();
        let segments = self.reduction.recordings.iter().map(|r| r.segments.len()).sum();
        let run = self.summarise(method, &regression, fit, uncertainty.as_ref());
        (run, uncertainty.map(|_| segments))
    }

    /// The columns that are estimated, weighted.
    fn regression(&self, all: &Compressed, joint_weights: Option<&[f64]>) -> Regression {
        let of_recordings: Vec<f64> = self.reduction.recordings.iter().map(|r| r.weight).collect();
        let weights = all.regression.row_weights(&of_recordings, joint_weights);
        all.regression.with_columns(&self.chosen.columns).with_weights(weights)
    }

    /// The columns of Z, where the method needs any.
    fn z(&self, all: &Compressed, method: Method) -> Option<Matrix> {
        match method.needs() {
            Needs::Measurement => None,
            Needs::Instruments | Needs::Sensitivities => all.z.as_ref().map(|z| z.select_columns(&self.chosen.columns)),
        }
    }

    /// The weight of each joint, where the experiment asks for one and LS has an estimate.
    fn joint_weights(&self, method: Method) -> Option<Vec<f64>> {
        match self.settings.weighting(method) {
            Weighting::None => None,
            Weighting::PerJoint => {
                let regression = self.all.regression.with_columns(&self.chosen.columns);
                let of_recordings: Vec<f64> = self.reduction.recordings.iter().map(|r| r.weight).collect();
                Some(JointWeights::of(&regression, &of_recordings).ok()?.weights)
            }
        }
    }

    fn uncertainty(
        &self,
        method: Method,
        fit: &Fit,
        joint_weights: Option<&[f64]>,
    ) -> Result<Uncertainty, EstimationError> {
        let all = Compressed::in_segments(self.reduction);
        let regression = self.regression(&all, joint_weights);
        let z = self.z(&all, method);
        let residual = regression.residual(&regression.x.times(&fit.theta));
        Uncertainty::new(&fit.theta, &cluster_variances(&regression, z.as_ref(), &residual)?)
    }

    fn failed(&self, method: Method, outcome: &Outcome) -> RunResult {
        let reason = outcome.reason.as_ref().map(|r| explain(&self.chosen.estimated, &[], r));
        RunResult {
            weighting: Some(self.settings.weighting(method)),
            reason,
            ..RunResult::new(NOMINAL, method, outcome.status)
        }
    }

    fn summarise(
        &self,
        method: Method,
        regression: &Regression,
        fit: &Fit,
        uncertainty: Option<&Uncertainty>,
    ) -> RunResult {
        let (status, reason) = self.convergence(method, fit);
        let is_reduced = self.chosen.columns.len() < self.all.regression.parameters();
        let truth = self.reduction.recordings.first().and_then(|r| r.truth.as_ref());
        let truth: Option<Vec<f64>> = truth.map(|t| self.chosen.columns.iter().map(|&c| t[c]).collect());
        let parameters = parameter_results(self.settings, &self.chosen.estimated, fit, uncertainty, truth.as_deref());
        RunResult {
            weighting: Some(self.settings.weighting(method)),
            reason,
            iterations: usize::from(method.needs() == Needs::Instruments),
            relative_error_percent: Some(fit.relative_error_percent),
            joint_relative_error_percent: regression.joint_relative_errors_percent(&fit.prediction),
            condition_number: Some(fit.condition_number),
            f_test: (is_reduced && method == Method::IDIM_LS)
                .then(|| full_model_test(&self.all.regression, fit))
                .flatten(),
            covariance: covariance_of(fit, &parameters),
            parameters,
            ..RunResult::new(NOMINAL, method, status)
        }
    }

    /// Whether IV is where its instruments were simulated.
    fn convergence(&self, method: Method, fit: &Fit) -> (Status, Option<String>) {
        let simulated = match method.needs() {
            Needs::Measurement => None,
            Needs::Instruments | Needs::Sensitivities => self.reduction.instruments.as_ref(),
        };
        let Some(simulated) = simulated else { return (Status::Converged, None) };
        let change = |(i, &c): (usize, &usize)| (fit.theta[i] - simulated[c]).abs() / fit.standard_deviation[i];
        let largest = self.chosen.columns.iter().enumerate().map(change).fold(0.0, f64::max);
        if largest <= self.settings.estimation.convergence.parameter_change {
            return (Status::Converged, None);
        }
        let reason = format!(
            "an estimate is {largest:.2} standard deviations from the parameters of its instruments; reduce again with \
             instruments simulated from these results"
        );
        (Status::IterationLimit, Some(reason))
    }
}
