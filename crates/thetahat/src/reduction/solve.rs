use std::path::Path;

use super::{Reduction, ReductionError, compressed::Compressed, essential::choose, segments::cluster_variances};
use crate::{
    base_parameters::{BaseParameter, BaseParameters},
    experiment::{Experiment, ExperimentError, Weighting},
    identification::{EstimationError, Fit, Method, Status, Uncertainty},
    linear_algebra::Matrix,
    results::{
        EliminationResult, JointResult, NOMINAL, ParameterResult, Plots, RecordingResult, Results, RunPlots, RunResult,
        SCHEMA,
    },
    statistics::{FTest, f_test},
};

/// The estimate from a reduction.
#[derive(Debug, Clone)]
pub struct Solution {
    /// In the form of an identification: the nominal run of IDIM-LS, and with instruments that of IDIM-IV.
    pub results: Results,
    /// Stretches of time from which the robust deviations and intervals come; none where there are too few.
    pub segments: Option<usize>,
}

impl Reduction {
    /// IDIM-LS (8) from the factors: estimates, classical deviations and errors are those of all rows.
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
        let (model, base) = experiment.basis(&experiment.robot)?;
        if base.parameters().iter().map(|p| &p.name).ne(&self.identity.parameters) {
            let reason = "its base parameters are not those that this program finds for its robot".to_owned();
            return Err(ReductionError::Damaged { path: (&self.experiment_name).into(), reason });
        }
        if self.recordings.is_empty() {
            return Err(ReductionError::Nothing);
        }
        let problem = Compressed::whole(self);
        let (columns, elimination) = choose(&experiment, &base, &problem);
        let names: Vec<String> = columns.iter().map(|&c| base.parameters()[c].name.clone()).collect();
        let refuse = |source| ExperimentError::Parameters { path: experiment.path.clone(), source };
        let estimated = base.select(model.parameter_table(), &names).map_err(refuse)?;
        let column = |p: &BaseParameter| base.columns().iter().position(|&c| c == p.kept);
        let columns = estimated.parameters().iter().filter_map(column).collect();
        let solver = Solver { reduction: self, experiment: &experiment, problem, columns, estimated };
        let (run, segments) = solver.run(Method::IdimLs);
        let mut runs = vec![run];
        if solver.problem.z.is_some() {
            runs.push(solver.run(Method::IdimIv).0);
        }
        let results = solver.results(runs, elimination.map(|e| e.named(&base)))?;
        Ok(Solution { results, segments })
    }
}

struct Solver<'a> {
    reduction: &'a Reduction,
    experiment: &'a Experiment,
    problem: Compressed,
    columns: Vec<usize>,
    estimated: BaseParameters,
}

impl Solver<'_> {
    fn x(&self, problem: &Compressed) -> Matrix {
        problem.x.select_columns(&self.columns)
    }

    /// The matrix that is correlated with the rows: Z for IV, else X.
    fn z(&self, problem: &Compressed, method: Method) -> Matrix {
        let z = problem.z.as_ref().filter(|_| method == Method::IdimIv);
        z.unwrap_or(&problem.x).select_columns(&self.columns)
    }

    fn joints(&self) -> usize {
        self.reduction.identity.joints.len()
    }

    /// The run, and the stretches behind its intervals.
    fn run(&self, method: Method) -> (RunResult, Option<usize>) {
        match self.fit(method) {
            Err(e) => (self.failed(method, &e), None),
            Ok((fit, of_joints)) => {
                let robust = self.uncertainty(method, &fit, of_joints.as_deref()).ok();
                let segments = self.reduction.recordings.iter().map(|r| r.segments.len()).sum();
                (self.summarise(method, &fit, robust.as_ref()), robust.map(|_| segments))
            }
        }
    }

    /// The fit, and the weight of each joint where the experiment asks for one.
    fn fit(&self, method: Method) -> Result<(Fit, Option<Vec<f64>>), EstimationError> {
        let (x, divisor) = (self.x(&self.problem), self.experiment.file.estimation.variance);
        let of_joints = self.joint_weights(method, &x)?;
        let weights = self.weights(&self.problem, of_joints.as_deref());
        let fit = match method {
            Method::IdimIv => self.problem.fit_iv((&self.z(&self.problem, method), &x), weights.as_deref(), divisor)?,
            _ => self.problem.fit(&x, weights.as_deref(), divisor)?,
        };
        Ok((fit, of_joints))
    }

    /// The weight of each joint, where the experiment asks for one.
    fn joint_weights(&self, method: Method, x: &Matrix) -> Result<Option<Vec<f64>>, EstimationError> {
        let estimation = &self.experiment.file.estimation;
        let weighting = estimation.weighting.get(&method).copied().unwrap_or_default();
        if weighting == Weighting::None {
            return Ok(None);
        }
        let fit = self.problem.fit(x, None, estimation.variance)?;
        Ok(Some(self.problem.joint_weights(x, &fit, self.joints(), &self.reduction.identity.acting)))
    }

    /// The weight of each row; none where all are one.
    fn weights(&self, problem: &Compressed, of_joints: Option<&[f64]>) -> Option<Vec<f64>> {
        let of_recordings: Vec<f64> = self.reduction.recordings.iter().map(|r| r.weight).collect();
        if of_joints.is_none() && of_recordings.iter().all(|w| *w == 1.0) {
            return None;
        }
        let weight = |place: &super::compressed::Place| {
            of_recordings[place.recording] * of_joints.map_or(1.0, |joints| joints[place.joint])
        };
        Some(problem.place.iter().map(weight).collect())
    }

    fn uncertainty(
        &self,
        method: Method,
        fit: &Fit,
        of_joints: Option<&[f64]>,
    ) -> Result<Uncertainty, EstimationError> {
        let problem = Compressed::in_segments(self.reduction);
        let weights = self.weights(&problem, of_joints).unwrap_or_else(|| vec![1.0; problem.y.len()]);
        let x = self.x(&problem);
        let residual: Vec<f64> = x.times(&fit.theta).iter().zip(&problem.y).map(|(p, y)| y - p).collect();
        let residual: Vec<f64> = residual.iter().zip(&weights).map(|(e, w)| w * e).collect();
        let segment: Vec<usize> = problem.place.iter().map(|place| place.segment).collect();
        let (z, x) = (self.z(&problem, method).scale_rows(&weights), x.scale_rows(&weights));
        Uncertainty::new(&fit.theta, &cluster_variances((&z, &x), &residual, &segment)?)
    }

    fn failed(&self, method: Method, error: &EstimationError) -> RunResult {
        let name = |c: &usize| self.estimated.parameters()[*c].name.as_str();
        let reason = match error {
            EstimationError::NotIdentifiable { rank, columns, dependent } => format!(
                "the motion separates only {rank} of {columns} parameters; not separated from the others by this \
                 motion: {}",
                dependent.iter().map(name).collect::<Vec<_>>().join(" ")
            ),
            other => other.to_string(),
        };
        RunResult { status: Status::NotIdentifiable, reason: Some(reason), ..empty_run(method) }
    }

    fn summarise(&self, method: Method, fit: &Fit, robust: Option<&Uncertainty>) -> RunResult {
        let (status, reason) = self.convergence(method, fit);
        RunResult {
            status,
            reason,
            iterations: usize::from(method == Method::IdimIv),
            relative_error_percent: Some(fit.relative_error_percent),
            joint_relative_error_percent: self.problem.joint_errors(&fit.prediction, self.joints()),
            condition_number: Some(fit.condition_number),
            f_test: (method == Method::IdimLs).then(|| self.full_model_test(fit)).flatten(),
            parameters: self.parameters(fit, robust),
            ..empty_run(method)
        }
    }

    /// Whether IV is where its instruments were simulated.
    fn convergence(&self, method: Method, fit: &Fit) -> (Status, Option<String>) {
        let Some(simulated) = self.reduction.instruments.as_ref().filter(|_| method == Method::IdimIv) else {
            return (Status::Converged, None);
        };
        let change = |(i, &c): (usize, &usize)| (fit.theta[i] - simulated[c]).abs() / fit.standard_deviation[i];
        let largest = self.columns.iter().enumerate().map(change).fold(0.0, f64::max);
        if largest <= self.experiment.file.estimation.convergence.parameter_change {
            return (Status::Converged, None);
        }
        let reason = format!(
            "an estimate is {largest:.2} standard deviations from the parameters of its instruments; reduce again with \
             --instruments-from these results"
        );
        (Status::IterationLimit, Some(reason))
    }

    /// The F-test of the estimated parameters against all base parameters, where they are fewer.
    fn full_model_test(&self, fit: &Fit) -> Option<FTest> {
        let all = self.problem.x.columns();
        if self.columns.len() == all {
            return None;
        }
        let full = self.problem.fit(&self.problem.x, None, Default::default()).ok()?;
        let (squares, full) =
            (fit.residual_sum_of_squares(&self.problem.y), full.residual_sum_of_squares(&self.problem.y));
        f_test(squares, self.columns.len(), full, all, self.problem.rows)
    }

    fn parameters(&self, fit: &Fit, robust: Option<&Uncertainty>) -> Vec<ParameterResult> {
        let truth = self.reduction.recordings.first().and_then(|r| r.truth.as_ref());
        let show = &self.experiment.file.parameters.show;
        let relative = |sd: f64, value: f64| (value != 0.0).then(|| 100.0 * sd / value.abs());
        let result = |(i, p): (usize, &BaseParameter)| ParameterResult {
            name: p.name.clone(),
            estimate: fit.theta[i],
            standard_deviation: Some(fit.standard_deviation[i]),
            relative_standard_deviation_percent: relative(fit.standard_deviation[i], fit.theta[i]),
            true_value: truth.and_then(|t| t.get(self.columns[i]).copied()),
            unit: p.unit.to_owned(),
            expression: p.expression.clone(),
            shown: show.is_empty() || show.contains(&p.name),
            standard_deviation_robust: robust.map(|u| u.standard_deviation[i]),
            interval_95: robust.map(|u| u.interval_95[i]),
        };
        self.estimated.parameters().iter().enumerate().map(result).collect()
    }

    fn results(&self, runs: Vec<RunResult>, elimination: Option<EliminationResult>) -> Result<Results, ReductionError> {
        let recordings = &self.reduction.recordings;
        let describe = |r: &super::ReducedRecording| RecordingResult {
            name: r.name.clone(),
            weight: r.weight,
            samples_used: r.samples,
            sample_rate_hz: r.sample_rate_hz,
            window_s: r.window_s,
            resampling: None,
            reference: None,
        };
        let rate = recordings.first().map_or(0.0, |r| r.sample_rate_hz);
        let weighting = |method| Some(self.experiment.file.estimation.weighting_of(method).name().to_owned());
        Ok(Results {
            schema: SCHEMA,
            thetahat: env!("CARGO_PKG_VERSION").to_owned(),
            robot: self.experiment.robot.name.clone(),
            title: self.experiment.file.title.clone(),
            robot_joints: JointResult::of_coordinates(&self.experiment.robot),
            samples_used: recordings.iter().map(|r| r.samples).sum(),
            decimated_rows: self.problem.rows,
            recordings: recordings.iter().map(describe).collect(),
            validation_recordings: Vec::new(),
            bandwidth: self.experiment.measure_bandwidth(rate)?,
            seed: self.experiment.file.twin.as_ref().map(|t| t.sensors.seed),
            findings: Vec::new(),
            elimination,
            advice: Vec::new(),
            diagnostics: Vec::new(),
            runs: runs.into_iter().map(|run| RunResult { weighting: weighting(run.method), ..run }).collect(),
            experiment_description: self.reduction.experiment_description.clone(),
            robot_description: self.reduction.robot_description.clone(),
            plots: Plots::default(),
        })
    }
}

/// A run that has converged and says nothing else.
fn empty_run(method: Method) -> RunResult {
    RunResult {
        case: NOMINAL.to_owned(),
        method,
        weighting: None,
        status: Status::Converged,
        reason: None,
        iterations: 0,
        simulations: 0,
        relative_error_percent: None,
        joint_relative_error_percent: Vec::new(),
        cross_validation_relative_error_percent: None,
        cross_validation_interval_95_percent: None,
        influence: None,
        residual: None,
        validation_condition_number: None,
        condition_number: None,
        seconds: 0.0,
        simulation_relative_error_percent: None,
        validation_simulation_relative_error_percent: None,
        f_test: None,
        convergence: Vec::new(),
        parameters: Vec::new(),
        plots: RunPlots::default(),
    }
}
