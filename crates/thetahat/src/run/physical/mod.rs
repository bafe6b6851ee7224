//! Whether a robot made of bodies has an estimate, and with `physical = true` the parameters nearest to it that one has.

pub(in crate::run) mod consistent_data;
pub(in crate::run) mod not_physical;

use super::{
    linear::Linear,
    validation::cross_validation::{Folds, without_each},
};
use crate::{
    preparation::{ParameterSelection, PriorKind, PriorWeight, Problem, Setup, WeightRule, known_in_words},
    scheduling::EstimationJob,
};
use consistent_data::{LeftOut, Metric, metric};
use not_physical::not_physical;
use thetahat_estimation::{regression::Regression, statistics::f_probability};
use thetahat_ground::{clock::Stopwatch, linear_algebra::norm};
use thetahat_model::consistency::{
    ConsistentFit, ConsistentSet, LeastSquares, Prior, bounds_of, examine_within, fit, interval_in,
};
use thetahat_report::results::{ConsistencyTest, ConsistentEstimate, ConsistentParameter, PhysicalResult, RunResult};

/// Accuracy with which what an estimate lacks is computed.
const EXAMINATION_GAP: f64 = 1e-3;
/// Margin, in usual values, below which a condition counts as at its boundary.
const AT_BOUNDARY: f64 = 1e-3;
/// Weights of the prior that cross-validation tries, in variances of the error.
const WEIGHTS: [f64; 7] = [1e-3, 1e-2, 1e-1, 1.0, 10.0, 100.0, 1000.0];
/// Least freedom of the test: what conditions and the prior take may be next to nothing, and so is the distance then.
const LEAST_FREEDOM: f64 = 1.0;

/// An estimate that is examined.
pub(super) struct Examined<'a> {
    pub(super) setup: Setup<'a>,
    pub(super) job: &'a EstimationJob<'a>,
    pub(super) linear: &'a Linear<'a>,
    /// Its run, with the parameters.
    pub(super) run: &'a RunResult,
    /// What is left out in turn where cross-validation chooses the weight of the prior.
    pub(super) folds: Option<Folds>,
}

impl Examined<'_> {
    pub(super) fn physical(&self) -> Option<PhysicalResult> {
        let problem = self.job.problem;
        let set = problem.consistent_set(self.setup).ok()?;
        let found = examine_within(set, &problem.estimated, &self.linear.fit.theta, EXAMINATION_GAP).ok()?;
        let widening = self.run.widening().unwrap_or(1.0);
        let estimate = self.parameters().physical.then(|| self.estimate(set));
        let (estimate, reason) = match estimate {
            Some(Ok(estimate)) => (Some(estimate), None),
            Some(Err(reason)) => (None, Some(reason)),
            None => (None, None),
        };
        let physical = PhysicalResult {
            consistent: found.consistent,
            inconsistent: found.outside.iter().map(|(condition, _)| condition.to_string()).collect(),
            violations: found.outside.iter().map(|(_, lacking)| *lacking).collect(),
            deviations: found.deviations(&self.linear.fit.covariance).map(|d| d / widening),
            smallest_eigenvalue: found.smallest_eigenvalue,
            findings: Vec::new(),
            estimate,
            reason,
        };
        let (robot, asked) = (self.setup.robot, self.parameters().physical);
        let findings = not_physical(robot, set, &problem.estimated, self.run, &physical, asked);
        Some(PhysicalResult { findings, ..physical })
    }

    fn parameters(&self) -> &ParameterSelection {
        &self.setup.settings.parameters
    }

    /// The consistent estimate, or why there is none.
    fn estimate(&self, set: &ConsistentSet) -> Result<ConsistentEstimate, String> {
        let EstimationJob { problem, method, .. } = self.job;
        let metric =
            metric(*method, &self.linear.regression, self.linear.instruments.as_deref()).map_err(|e| e.to_string())?;
        let tried = self.weights_tried(set, &metric);
        let (count, weight) = (set.parameter_table().len(), self.weight(&tried)?);
        let stopwatch = Stopwatch::start();
        let nearest = LeastSquares::nearest(&metric.triangle, &self.linear.fit.theta, &problem.estimated, count);
        let found = nearest.and_then(|data| fit(set, &data, self.prior(weight), None)).map_err(|e| e.to_string())?;
        let seconds = stopwatch.seconds();
        let result = self.result(set, &metric, &found);
        Ok(ConsistentEstimate { prior_weight: weight, weights_tried: tried, seconds, ..result })
    }

    /// A weight of the prior, with the squared error that each gives on what is left out.
    fn weights_tried(&self, set: &ConsistentSet, metric: &Metric<'_>) -> Vec<[f64; 2]> {
        let (PriorWeight::Rule(WeightRule::CrossValidation), Some(folds)) =
            (self.parameters().prior.weight, &self.folds)
        else {
            return Vec::new();
        };
        let EstimationJob { problem, method, .. } = self.job;
        let regression = &self.linear.regression;
        let others = without_each(regression, *method, self.linear.instruments.as_deref(), folds);
        let left_out = LeftOut { regression, base: &problem.estimated, design: metric.design, others };
        let error = |weight: &f64| Some([*weight, left_out.squared_error(set, self.prior(*weight))?]);
        WEIGHTS.iter().filter_map(error).collect()
    }

    /// The weight that is given, or the one that predicts best.
    fn weight(&self, tried: &[[f64; 2]]) -> Result<f64, String> {
        match self.parameters().prior.weight {
            PriorWeight::Number(weight) => Ok(weight),
            PriorWeight::Rule(WeightRule::CrossValidation) => {
                let best = tried.iter().min_by(|a, b| a[1].total_cmp(&b[1])).map(|best| best[0]);
                best.ok_or_else(|| {
                    "no part of the recording can be left out to choose the weight of the prior".to_owned()
                })
            }
        }
    }

    fn prior(&self, weight: f64) -> Prior {
        let weight = weight * self.variance();
        match self.parameters().prior.kind {
            PriorKind::LogDet => Prior::LogDet { weight },
            PriorKind::Euclidean => Prior::Euclidean { weight },
        }
    }

    /// Squared residual, in the weights of the method, over rows less parameters.
    fn variance(&self) -> f64 {
        let regression = &self.linear.regression;
        squared_residual(regression, &self.linear.fit.prediction) / self.freedom()
    }

    fn freedom(&self) -> f64 {
        let regression = &self.linear.regression;
        regression.rows_represented().saturating_sub(self.linear.fit.theta.len()).max(1) as f64
    }

    fn result(&self, set: &ConsistentSet, metric: &Metric<'_>, found: &ConsistentFit) -> ConsistentEstimate {
        let (problem, regression) = (self.job.problem, &self.linear.regression);
        let theta = problem.estimated.from_standard(&found.standard);
        let prediction = metric.design.times(&theta);
        let smallest = set.pseudo_inertias(&found.standard).into_iter().map(|p| p.smallest_eigenvalue());
        let options = self.parameters();
        let is_given = |name: &String| options.exclude.contains(name) || options.fix.contains_key(name);
        let near = set.margins(&found.standard).into_iter().filter(|(_, margin)| *margin < AT_BOUNDARY);
        let at_boundary = near.map(|(condition, _)| condition.to_string()).filter(|name| !is_given(name));
        ConsistentEstimate {
            parameters: self.base_parameters(set, problem, &theta),
            standard: standard_parameters(set, &found.standard),
            known: known_in_words(&options.fix, &options.known),
            prior: options.prior.kind.name().to_owned(),
            prior_weight: 0.0,
            weights_tried: Vec::new(),
            smallest_eigenvalue: smallest.fold(f64::INFINITY, f64::min),
            at_boundary: at_boundary.collect(),
            squared_residual_free: squared_residual(regression, &self.linear.fit.prediction),
            squared_residual: squared_residual(regression, &prediction),
            relative_error_percent: 100.0 * norm(&regression.residual(&prediction)) / norm(self.linear.measured),
            test: self.test(found),
            converged: found.converged,
            iterations: found.iterations,
            seconds: 0.0,
        }
    }

    fn base_parameters(&self, set: &ConsistentSet, problem: &Problem, theta: &[f64]) -> Vec<ConsistentParameter> {
        let parameter = |(i, p): (usize, &thetahat_model::base_parameters::BaseParameter)| {
            let free = self.run.parameter(&p.name);
            let inside = |free: [f64; 2]| interval_in(bounds_of(set, p), free, theta[i]);
            ConsistentParameter {
                name: p.name.clone(),
                unit: p.unit.to_string(),
                estimate: theta[i],
                reference_value: free.map(|f| f.estimate),
                interval_95: free.and_then(|f| f.interval_95).map(inside),
            }
        };
        problem.estimated.parameters().iter().enumerate().map(parameter).collect()
    }

    /// The distance to the set against what noise makes of it.
    fn test(&self, found: &ConsistentFit) -> Option<ConsistencyTest> {
        let widening = self.run.widening().unwrap_or(1.0);
        let taken = self.linear.fit.theta.len() as f64 - found.effective_parameters;
        let (numerator_freedom, denominator_freedom) = (taken.max(LEAST_FREEDOM), self.freedom());
        let statistic = found.squared_residual / (numerator_freedom * self.variance() * widening * widening);
        let p_value = f_probability(statistic, numerator_freedom, denominator_freedom)?;
        Some(ConsistencyTest { statistic, numerator_freedom, denominator_freedom, p_value })
    }
}

/// Of `W (y - y_hat)`.
fn squared_residual(regression: &Regression, prediction: &[f64]) -> f64 {
    regression.whiten(&regression.residual(prediction)).iter().map(|e| e * e).sum()
}

fn standard_parameters(set: &ConsistentSet, standard: &[f64]) -> Vec<ConsistentParameter> {
    let parameters = set.parameter_table().iter().zip(standard).zip(set.a_priori());
    let parameter = |((p, value), a_priori): ((&thetahat_model::robot::Parameter, &f64), &f64)| ConsistentParameter {
        name: p.name(),
        unit: p.unit.to_string(),
        estimate: *value,
        reference_value: Some(*a_priori),
        interval_95: None,
    };
    parameters.map(parameter).collect()
}
