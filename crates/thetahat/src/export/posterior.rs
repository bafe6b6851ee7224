//! What results say of the base parameters, and the consistent standard parameters nearest to the a-priori ones that have
//! them.

use super::error::ExportError;
use crate::{
    base_parameters::BaseParameters,
    consistency::{ConsistencyError, ConsistentFit, ConsistentSet, Known, LeastSquares, Prior, fit, mass_factor},
    identification::Method,
    linear_algebra::Matrix,
    preparation::{Setup, consistent_set_of},
    results::{ParameterResult, RunResult},
    robot::{Quantity, Robot},
};

/// Weight of the divergence from the a-priori parameters beside the distance from the estimate in its variances: it decides
/// what the data leave free, and nothing that they say anything about.
const WEIGHT: f64 = 1e-3;
/// Half the width of an interval in standard deviations, where the results hold none.
const HALF_WIDTH: f64 = 1.96;

/// The estimates of a run with their uncertainty, and the set of standard parameters that a robot can have.
#[derive(Debug, Clone)]
pub(super) struct Posterior {
    pub(super) method: Method,
    pub(super) set: ConsistentSet,
    /// The base parameters that were estimated.
    pub(super) base: BaseParameters,
    pub(super) estimate: Vec<f64>,
    /// Standard deviations with correlated errors, or else classical ones.
    pub(super) deviation: Vec<Option<f64>>,
    intervals: Vec<Option<[f64; 2]>>,
    /// Covariance of the estimates; of results of before that key it is diagonal.
    pub(super) covariance: Option<Matrix>,
    /// Deviations by which the estimate is outside of the set.
    outside: Option<f64>,
    /// Whether the data reject every consistent robot; none where that was not tested.
    pub(super) rejects: Option<bool>,
    /// The consistent estimate in the results.
    consistent: Option<Vec<f64>>,
}

/// How standard parameters keep the base parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kept {
    /// They have the estimates.
    AtEstimates,
    /// The estimates are not consistent: the base parameters are moved within their intervals.
    WithinIntervals,
    /// They are the consistent estimate that the results hold.
    ConsistentEstimate,
}

impl Posterior {
    pub(super) fn new(setup: Setup<'_>, base: BaseParameters, run: &RunResult) -> Result<Self, ExportError> {
        let found = |name: &String| run.parameter(name);
        let names: Vec<String> = base.parameters().iter().map(|p| p.name.clone()).collect();
        let of = |f: &dyn Fn(&ParameterResult) -> Option<f64>| names.iter().map(|n| found(n).and_then(f)).collect();
        let estimate: Vec<f64> = names.iter().map(|name| found(name).map_or(0.0, |p| p.estimate)).collect();
        let deviation: Vec<Option<f64>> = of(&|p| p.standard_deviation_robust.or(p.standard_deviation));
        let covariance = covariance(&names, run, &deviation);
        let whitening = covariance.as_ref().and_then(whitening);
        let factor = |a_priori: &[f64]| {
            let data = LeastSquares::nearest(whitening.as_ref()?, &estimate, &base, a_priori.len()).ok()?;
            mass_factor(&data, &setup.robot.parameter_table(), a_priori)
        };
        let set = consistent_set_of(setup, setup.robot, factor)?;
        let table = set.parameter_table().clone();
        let physical = run.physical.as_ref();
        let consistent = physical.and_then(|p| p.estimate.as_ref()).map(|estimate| {
            let value = |name: &str| estimate.standard.iter().find(|p| p.name == name).map_or(0.0, |p| p.estimate);
            table.iter().map(|p| value(&p.name())).collect()
        });
        let posterior = Self {
            method: run.method,
            intervals: names.iter().map(|name| found(name).and_then(|p| p.interval_95)).collect(),
            outside: physical.and_then(|p| p.deviations),
            rejects: physical.and_then(|p| p.rejects()),
            set,
            base,
            estimate,
            deviation,
            covariance,
            consistent,
        };
        posterior.with_zeros(setup.robot, &setup.settings.parameters.fix.keys().cloned().collect::<Vec<_>>())
    }

    /// What was not estimated is not in the identified model: friction, offsets and torque terms are zero, and motor inertias
    /// that have no a-priori value.
    fn with_zeros(mut self, robot: &Robot, fixed: &[String]) -> Result<Self, ExportError> {
        let table = robot.parameter_table();
        let estimated = self.estimated();
        for (i, parameter) in table.iter().enumerate() {
            let given = parameter.quantity.is_motor_inertia() && self.set.a_priori()[i] > 0.0;
            let name = parameter.name();
            if estimated[i] || given || matches!(parameter.quantity, Quantity::Link(_)) || fixed.contains(&name) {
                continue;
            }
            if let Some(standard) = &mut self.consistent {
                standard[i] = 0.0;
            }
            self.set = self.set.with_known(&Known::Value { parameter: name, value: 0.0 })?;
        }
        Ok(self)
    }

    /// Which standard parameters are in an estimated base parameter.
    pub(super) fn estimated(&self) -> Vec<bool> {
        let mut estimated = vec![false; self.set.parameter_table().len()];
        for parameter in self.base.parameters() {
            parameter.regrouped.iter().map(|r| r.0).chain([parameter.kept]).for_each(|i| estimated[i] = true);
        }
        estimated
    }

    /// The standard parameters to export: the consistent estimate of the results, or else those nearest to the a-priori ones
    /// that keep the base parameters.
    pub(super) fn standard(&self) -> Result<(Vec<f64>, Kept), ExportError> {
        if let Some(consistent) = &self.consistent {
            return Ok((consistent.clone(), Kept::ConsistentEstimate));
        }
        match self.keeping(&self.estimate) {
            Ok(fit) => Ok((fit.standard, Kept::AtEstimates)),
            Err(ConsistencyError::NoInterior { .. }) => Ok((self.within_intervals()?, Kept::WithinIntervals)),
            Err(error) => Err(error.into()),
        }
    }

    /// Of the consistent parameters that have these base parameters, those nearest to the a-priori ones; where no consistent
    /// parameters have them, those nearest to them in the metric of the covariance.
    pub(super) fn nearest(&self, base: &[f64]) -> Result<Vec<f64>, ExportError> {
        match self.keeping(base) {
            Ok(fit) => Ok(fit.standard),
            Err(ConsistencyError::NoInterior { .. }) => {
                Ok(fit(&self.set, &self.distance(base)?, PRIOR, None)?.standard)
            }
            Err(error) => Err(error.into()),
        }
    }

    /// Minimises `sum_l D(P_l | P_l0)` with the base parameters held.
    fn keeping(&self, base: &[f64]) -> Result<ConsistentFit, ConsistencyError> {
        let bounds: Vec<[f64; 2]> = base.iter().map(|v| [*v, *v]).collect();
        let set = self.set.clone().with_base_between(&self.base, &bounds)?;
        let count = set.parameter_table().len();
        let nothing = LeastSquares::in_standard(Matrix::zeros(1, count), vec![0.0]);
        fit(&set, &nothing, Prior::LogDet { weight: 1.0 }, None)
    }

    /// Minimises the distance from the estimate; if that leaves an interval, with the intervals as conditions.
    fn within_intervals(&self) -> Result<Vec<f64>, ExportError> {
        let distance = self.distance(&self.estimate)?;
        let standard = fit(&self.set, &distance, PRIOR, None)?.standard;
        let intervals = self.all_intervals()?;
        let base = self.base.from_standard(&standard);
        if base.iter().zip(&intervals).all(|(v, [low, high])| (low..=high).contains(&v)) {
            return Ok(standard);
        }
        let bounded = self.set.clone().with_base_between(&self.base, &intervals)?;
        match fit(&bounded, &distance, PRIOR, Some(&standard)) {
            Ok(fit) => Ok(fit.standard),
            Err(ConsistencyError::NoInterior { conflicting, .. }) => {
                Err(ExportError::NotConsistent { method: self.method, deviations: self.outside, conflicting })
            }
            Err(error) => Err(error.into()),
        }
    }

    /// `|R (K theta - base)|^2` with `R^T R` the inverse of the covariance.
    fn distance(&self, base: &[f64]) -> Result<LeastSquares, ExportError> {
        let whitening = self.covariance.as_ref().and_then(whitening);
        let whitening = whitening.ok_or(ExportError::NoDeviations { method: self.method })?;
        Ok(LeastSquares::nearest(&whitening, base, &self.base, self.set.parameter_table().len())?)
    }

    fn all_intervals(&self) -> Result<Vec<[f64; 2]>, ExportError> {
        let interval = |i: usize| {
            let about = |d: f64| [self.estimate[i] - HALF_WIDTH * d, self.estimate[i] + HALF_WIDTH * d];
            self.intervals[i].or(self.deviation[i].map(about))
        };
        let all = (0..self.base.len()).map(interval).collect::<Option<Vec<_>>>();
        all.ok_or(ExportError::NoDeviations { method: self.method })
    }
}

const PRIOR: Prior = Prior::LogDet { weight: WEIGHT };

/// The covariance of the named parameters of a run; none where it has no deviations.
fn covariance(names: &[String], run: &RunResult, deviation: &[Option<f64>]) -> Option<Matrix> {
    let (n, count) = (names.len(), run.parameters.len());
    if run.covariance.len() == count * (count + 1) / 2 {
        let place = |name: &String| run.parameters.iter().position(|p| p.name == *name);
        let places = names.iter().map(place).collect::<Option<Vec<_>>>()?;
        let at = |i: usize, j: usize| {
            let (row, column) = (places[i].max(places[j]), places[i].min(places[j]));
            run.covariance[row * (row + 1) / 2 + column]
        };
        return Some(Matrix::from_fn(n, n, at));
    }
    let deviation = deviation.iter().copied().collect::<Option<Vec<f64>>>()?;
    Some(Matrix::from_fn(n, n, |i, j| if i == j { deviation[i] * deviation[i] } else { 0.0 }))
}

/// `R` with `R^T R = C^-1`: the inverse of the lower factor of the correlations, with the deviations taken out.
fn whitening(covariance: &Matrix) -> Option<Matrix> {
    let n = covariance.rows();
    let deviation: Vec<f64> = (0..n).map(|i| covariance.at(i, i).sqrt()).collect();
    if !deviation.iter().all(|d| d.is_finite() && *d > 0.0) {
        return None;
    }
    let correlation = Matrix::from_fn(n, n, |i, j| covariance.at(i, j) / (deviation[i] * deviation[j]));
    let inverse = correlation.cholesky()?.lower().inverse()?;
    Some(Matrix::from_fn(n, n, |i, j| inverse.at(i, j) / deviation[j]))
}
