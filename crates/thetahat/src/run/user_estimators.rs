//! Estimators of the user's own on the nominal regression: their estimates, their errors, and what they predict of data that
//! they have not seen.

use std::sync::Arc;

use super::{identification::Identification, prepared::filtered, validation::cross_validation::interval};
use crate::{
    diagnosis::MethodEstimate,
    preparation::{Case, PreparationError, Problem},
};
use thetahat_estimation::{
    identification::{Method, Status, UserError, UserEstimate, UserEstimator, UserRegression},
    regression::relative_error_percent,
};
use thetahat_ground::{clock::Stopwatch, linear_algebra::Matrix};
use thetahat_model::base_parameters::BaseParameter;
use thetahat_report::results::{ParameterResult, UserRun};

/// Half of a 95 % interval in standard deviations.
const HALF_WIDTH_95: f64 = 1.959_963_984_540_054;

impl Identification {
    /// The same with an estimator of the user's own in addition to the methods.
    ///
    /// # Errors
    /// [`PreparationError`] where another has its name, or a recording has no torques.
    pub fn with_estimator(mut self, estimator: UserEstimator) -> Result<Self, PreparationError> {
        let name = estimator.name();
        if self.estimators.iter().any(|other| other.name() == name) {
            return Err(PreparationError::value("estimators", "names that differ", format!("{name} twice")));
        }
        if let Some(without) = self.main.iter().find(|p| p.filtered.recording.torque.is_none()) {
            let expected = format!("torques: the estimator {name} is given the regression of the torques");
            let place = format!("recording {}", without.filtered.recording.name);
            return Err(PreparationError::value(&place, &expected, "positions alone"));
        }
        self.estimators.push(estimator);
        Ok(self)
    }

    /// What the estimators of the user's own find in the nominal case, whose methods are estimated already.
    pub(super) fn user_runs(
        &self,
        problem: &Problem,
        estimated: &[MethodEstimate],
        progress: &mut dyn FnMut(&str),
    ) -> Result<Vec<UserRun>, PreparationError> {
        if self.estimators.is_empty() {
            return Ok(Vec::new());
        }
        let iv = estimated.iter().find(|e| e.method == Method::IDIM_IV && e.outcome.status == Status::Converged);
        let rows = self.user_regression(problem, iv.and_then(|e| e.outcome.instruments.as_ref()));
        let data = Data { identification: self, problem, rows };
        self.estimators.iter().map(|estimator| data.run(estimator, progress)).collect()
    }

    pub(super) fn user_regression(&self, problem: &Problem, z: Option<&Matrix>) -> UserRegression {
        let of_recordings: Vec<f64> = self.main.iter().map(|p| p.filtered.recording.weight).collect();
        let weights = problem.regression.row_weights(&of_recordings, None);
        let regression = problem.regression.with_weights(weights);
        let parameters = problem.estimated.parameters();
        let rows = regression.y.len();
        UserRegression {
            x: regression.whiten_matrix(&regression.x).into_owned(),
            y: regression.whiten(&regression.y).into_owned(),
            z: z.map(|z| regression.whiten_matrix(z).into_owned()),
            joint: regression.layout.spread(|block| block.joint),
            recording: regression.layout.spread(|block| block.recording),
            share: regression.layout.shares(0..rows).map_or_else(|| vec![1.0; rows], <[f64]>::to_vec),
            names: parameters.iter().map(|p| p.name.clone()).collect(),
            units: parameters.iter().map(|p| p.unit.to_string()).collect(),
        }
    }
}

/// The nominal regression, as estimators of the user's own are given it.
struct Data<'a> {
    identification: &'a Identification,
    problem: &'a Problem,
    rows: UserRegression,
}

impl Data<'_> {
    fn run(&self, estimator: &UserEstimator, progress: &mut dyn FnMut(&str)) -> Result<UserRun, PreparationError> {
        progress(&format!("the estimator {}", estimator.name()));
        let watch = Stopwatch::start();
        let estimate = estimator.estimate(&self.rows).map_err(|source| failed(estimator, None, source))?;
        let seconds = watch.seconds();
        let regression = &self.problem.regression;
        let prediction = regression.x.times(&estimate.theta);
        let run = UserRun {
            name: estimator.name().to_owned(),
            has_instruments: self.rows.z.is_some(),
            relative_error_percent: relative_error_percent(&regression.y, &prediction),
            joint_relative_error_percent: regression.joint_relative_errors_percent(&prediction),
            cross_validation_relative_error_percent: None,
            cross_validation_interval_95_percent: None,
            seconds,
            parameters: self.parameters(&estimate),
            covariance: estimate.covariance.as_ref().map(lower_triangle).unwrap_or_default(),
            predicted: regression.layout.by_joint(&prediction),
        };
        if self.identification.validation.is_empty() {
            self.with_parts_left_out(run, estimator, progress)
        } else {
            let error = Some(self.error_on_others(&estimate.theta)?);
            Ok(UserRun { cross_validation_relative_error_percent: error, ..run })
        }
    }

    fn parameters(&self, estimate: &UserEstimate) -> Vec<ParameterResult> {
        let truth = self.identification.truth_of(self.problem);
        let settings = self.identification.setup().settings;
        let result = |(i, p): (usize, &BaseParameter)| {
            let theta = estimate.theta[i];
            let deviation = estimate.covariance.as_ref().map(|covariance| covariance.at(i, i).sqrt());
            ParameterResult {
                name: p.name.clone(),
                estimate: theta,
                standard_deviation: deviation,
                relative_standard_deviation_percent: deviation
                    .filter(|_| theta != 0.0)
                    .map(|sd| 100.0 * sd / theta.abs()),
                true_value: truth.as_ref().map(|truth| truth[i]),
                unit: p.unit.to_string(),
                expression: p.expression.clone(),
                shown: settings.shows(&p.name),
                standard_deviation_robust: None,
                interval_95: deviation.map(|sd| [theta - HALF_WIDTH_95 * sd, theta + HALF_WIDTH_95 * sd]),
            }
        };
        self.problem.estimated.parameters().iter().enumerate().map(result).collect()
    }

    /// The run with its error on parts of the recordings, each left out in turn and predicted from the others.
    fn with_parts_left_out(
        &self,
        run: UserRun,
        estimator: &UserEstimator,
        progress: &mut dyn FnMut(&str),
    ) -> Result<UserRun, PreparationError> {
        let Some(folds) = self.identification.folds(self.problem) else { return Ok(run) };
        let regression = &self.problem.regression;
        let of_row: Vec<usize> = (0..regression.y.len()).map(|k| folds.of_row[k % folds.of_row.len()]).collect();
        let mut prediction = vec![0.0; regression.y.len()];
        for (fold, name) in folds.names.iter().enumerate() {
            progress(&format!("the estimator {} without {name}", estimator.name()));
            let keep: Vec<bool> = of_row.iter().map(|of| *of != fold).collect();
            let others = self.rows.select_rows(&keep);
            let estimate = estimator.estimate(&others).map_err(|source| failed(estimator, Some(name), source))?;
            let all = regression.x.times(&estimate.theta);
            prediction.iter_mut().zip(all).zip(&keep).filter(|(_, keep)| !**keep).for_each(|((p, all), _)| *p = all);
        }
        Ok(UserRun {
            cross_validation_relative_error_percent: Some(relative_error_percent(&regression.y, &prediction)),
            cross_validation_interval_95_percent: interval(&regression.y, &prediction, &of_row, folds.names.len()),
            ..run
        })
    }

    /// The relative error on the recordings that were held back.
    fn error_on_others(&self, theta: &[f64]) -> Result<f64, PreparationError> {
        let recordings = filtered(&self.identification.validation);
        let setup = self.identification.setup();
        let others = setup.validation_problem(&Case::nominal(), &recordings, &self.problem.estimated)?;
        Ok(relative_error_percent(&others.regression.y, &others.regression.x.times(theta)))
    }
}

fn lower_triangle(matrix: &Matrix) -> Vec<f64> {
    (0..matrix.rows()).flat_map(|i| (0..=i).map(move |j| matrix.at(i, j))).collect()
}

fn failed(estimator: &UserEstimator, part: Option<&str>, source: UserError) -> PreparationError {
    let part = part.map(|part| format!(" without {part}")).unwrap_or_default();
    PreparationError::Estimator { name: estimator.name().to_owned(), part, source: Arc::from(source) }
}
