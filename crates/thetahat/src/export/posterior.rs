//! What results say of the base parameters, and the consistent standard parameters nearest to the a-priori ones that have
//! them.

use std::path::PathBuf;

use super::{
    error::ExportError,
    provenance::{Provenance, provenance},
    uncertainty::Uncertainty,
};
use crate::{
    base_parameters::BaseParameters,
    consistency::{ConsistencyError, ConsistentSet, Known, LeastSquares, Prior, dependence_on_base, fit, mass_factor},
    experiment::IdentifiedRobot,
    identification::Method,
    linear_algebra::{Matrix, PivotedQr},
    preparation::{KnownQuantity, consistent_set_of},
    results::{ParameterResult, RunResult},
    robot::{ParameterTable, Quantity},
};

/// Weight of the divergence from the a-priori parameters beside the distance from the estimate in its variances: it decides
/// what the data leave free, and nothing that they say anything about.
const PRIOR: Prior = Prior::LogDet { weight: 1e-3 };

/// The estimates of a run with their uncertainty, and the set of standard parameters that a robot can have.
#[derive(Debug, Clone)]
pub(super) struct Posterior {
    /// The file of the results, for messages.
    path: PathBuf,
    method: Method,
    pub(super) set: ConsistentSet,
    /// The part of the set that has the base parameters at zero that were not estimated, as the identified model has; none
    /// where all were.
    held: Option<ConsistentSet>,
    /// The base parameters that were estimated.
    pub(super) base: BaseParameters,
    /// Those that were not.
    left_out: BaseParameters,
    pub(super) estimates: Vec<ParameterResult>,
    pub(super) uncertainty: Option<Uncertainty>,
    /// Where each standard parameter comes from.
    pub(super) provenance: Vec<Provenance>,
    /// Deviations by which the estimate is outside of the set.
    outside: Option<f64>,
    /// Whether the data reject every consistent robot; none where that was not tested.
    pub(super) rejects: Option<bool>,
    /// The consistent estimate in the results.
    consistent: Option<Vec<f64>>,
}

/// The covariance of the exported parameters.
#[derive(Debug, Clone)]
pub(super) struct ExportedCovariance {
    pub(super) base: Matrix,
    pub(super) standard: Matrix,
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
    pub(super) fn new(identified: &IdentifiedRobot) -> Result<Self, ExportError> {
        let IdentifiedRobot { robot, settings, run, base: whole, .. } = identified;
        let path = identified.files.first().cloned().unwrap_or_default();
        let estimated: Vec<usize> =
            whole.parameters().iter().filter(|p| run.parameter(&p.name).is_some()).map(|p| p.kept).collect();
        let base = whole.filtered(|kept| estimated.contains(&kept));
        let estimates: Vec<ParameterResult> =
            base.parameters().iter().filter_map(|p| run.parameter(&p.name)).cloned().collect();
        let uncertainty = Uncertainty::of(run, &estimates);
        let values: Vec<f64> = estimates.iter().map(|p| p.estimate).collect();
        let mass_factor = |a_priori: &[f64]| {
            let whitening = uncertainty.as_ref()?.whitening()?;
            let data = LeastSquares::nearest(whitening, &values, &base, a_priori.len()).ok()?;
            mass_factor(&data, &robot.parameter_table(), a_priori)
        };
        let set = consistent_set_of(identified.setup(), robot, mass_factor)
            .map_err(|source| ExportError::Consistency { path: path.clone(), source })?;
        let physical = run.physical.as_ref();
        let mut posterior = Self {
            method: run.method,
            provenance: provenance(&base, &settings.parameters, set.parameter_table()),
            consistent: consistent_estimate(run, set.parameter_table()),
            outside: physical.and_then(|p| p.deviations),
            rejects: physical.and_then(|p| p.rejects()),
            left_out: whole.filtered(|kept| !estimated.contains(&kept)),
            held: None,
            path,
            set,
            base,
            estimates,
            uncertainty,
        };
        posterior.set_zeros(&settings.parameters.known)?;
        posterior.held = posterior.holding()?;
        Ok(posterior)
    }

    /// What was not estimated is not in the identified model: friction, offsets and torque terms are zero, and motor inertias
    /// that have no a-priori value; not so what is known of them.
    fn set_zeros(&mut self, known: &[KnownQuantity]) -> Result<(), ExportError> {
        let known: Vec<String> = known.iter().flat_map(KnownQuantity::named).collect();
        let table = self.set.parameter_table().clone();
        for (i, parameter) in table.iter().enumerate() {
            let has_a_priori = parameter.quantity.is_motor_inertia() && self.set.a_priori()[i] > 0.0;
            let stays = has_a_priori || matches!(parameter.quantity, Quantity::Link(_));
            let name = parameter.name();
            if self.provenance[i] != Provenance::APriori || stays || known.contains(&name) {
                continue;
            }
            self.provenance[i] = Provenance::Zero;
            self.consistent.iter_mut().for_each(|standard| standard[i] = 0.0);
            let zero = Known::Value { parameter: name, value: 0.0 };
            self.set = self.set.clone().with_known(&zero).map_err(|e| self.refuse(e))?;
        }
        Ok(())
    }

    /// The part of the set with the base parameters at zero that were not estimated, but for those that are given.
    fn holding(&self) -> Result<Option<ConsistentSet>, ExportError> {
        let left_out = self.left_out.filtered(|kept| self.provenance[kept] != Provenance::Given);
        let zeros = vec![[0.0; 2]; left_out.len()];
        let held = self.set.clone().with_base_between(&left_out, &zeros).map_err(|e| self.refuse(e))?;
        Ok((!left_out.is_empty()).then_some(held))
    }

    /// The standard parameters to export: the consistent estimate of the results, or else those nearest to the a-priori ones
    /// that keep the base parameters. Those that were not estimated stay at zero where some robot has them there; the samples
    /// do as the export does.
    pub(super) fn choose(&mut self) -> Result<(Vec<f64>, Kept), ExportError> {
        if let Some(consistent) = &self.consistent {
            return Ok((consistent.clone(), Kept::ConsistentEstimate));
        }
        let estimates: Vec<f64> = self.estimates.iter().map(|p| p.estimate).collect();
        match self.first_with_room(|set| self.keeping(set, &estimates)) {
            Ok((holds, standard)) => Ok((self.settle(holds, standard), Kept::AtEstimates)),
            Err(error) if lacks_room(&error) => {
                let (holds, standard) = self.within_intervals(&estimates)?;
                Ok((self.settle(holds, standard), Kept::WithinIntervals))
            }
            Err(error) => Err(self.refuse(error)),
        }
    }

    /// Takes over whether what was not estimated is held at zero.
    fn settle(&mut self, holds: bool, standard: Vec<f64>) -> Vec<f64> {
        let held = self.held.take().filter(|_| holds);
        if let Some(held) = held {
            self.set = held;
            for parameter in self.left_out.parameters() {
                let in_sums = parameter.regrouped.iter().map(|r| r.0).chain([parameter.kept]);
                let found = if parameter.regrouped.is_empty() { Provenance::Zero } else { Provenance::InSums };
                for i in in_sums.filter(|i| self.provenance[*i] == Provenance::APriori).collect::<Vec<_>>() {
                    self.provenance[i] = found;
                }
            }
        }
        standard
    }

    /// What an attempt finds with the base parameters held that were not estimated, or else with these free; and whether they
    /// are held.
    fn first_with_room(
        &self,
        attempt: impl Fn(&ConsistentSet) -> Result<Vec<f64>, ConsistencyError>,
    ) -> Result<(bool, Vec<f64>), ConsistencyError> {
        match self.held.as_ref().map(&attempt) {
            Some(Ok(standard)) => Ok((true, standard)),
            Some(Err(error)) if !lacks_room(&error) => Err(error),
            Some(Err(_)) | None => attempt(&self.set).map(|standard| (false, standard)),
        }
    }

    /// Of the consistent parameters that have these base parameters, those nearest to the a-priori ones; where no consistent
    /// parameters have them, those nearest to them in the metric of the covariance.
    pub(super) fn nearest(&self, base: &[f64]) -> Result<Vec<f64>, ExportError> {
        match self.keeping(&self.set, base) {
            Err(error) if lacks_room(&error) => {
                let found = fit(&self.set, &self.distance(base)?, PRIOR, None);
                found.map(|fit| fit.standard).map_err(|e| self.refuse(e))
            }
            found => found.map_err(|e| self.refuse(e)),
        }
    }

    /// Minimises `sum_l D(P_l | P_l0)` with the estimated base parameters held.
    fn keeping(&self, set: &ConsistentSet, base: &[f64]) -> Result<Vec<f64>, ConsistencyError> {
        let bounds: Vec<[f64; 2]> = base.iter().map(|v| [*v, *v]).collect();
        let set = set.clone().with_base_between(&self.base, &bounds)?;
        let count = set.parameter_table().len();
        let nothing = LeastSquares::in_standard(Matrix::zeros(1, count), vec![0.0]);
        Ok(fit(&set, &nothing, Prior::LogDet { weight: 1.0 }, None)?.standard)
    }

    /// Minimises the distance from the estimate; if that leaves an interval, with the intervals as conditions.
    fn within_intervals(&self, estimates: &[f64]) -> Result<(bool, Vec<f64>), ExportError> {
        let distance = self.distance(estimates)?;
        let intervals: Option<Vec<[f64; 2]>> = self.estimates.iter().map(ParameterResult::interval).collect();
        let intervals = intervals.ok_or_else(|| self.no_deviations())?;
        let found = self.first_with_room(|set| {
            let standard = fit(set, &distance, PRIOR, None)?.standard;
            let base = self.base.from_standard(&standard);
            if base.iter().zip(&intervals).all(|(v, [low, high])| (low..=high).contains(&v)) {
                return Ok(standard);
            }
            let bounded = set.clone().with_base_between(&self.base, &intervals)?;
            Ok(fit(&bounded, &distance, PRIOR, Some(&standard))?.standard)
        });
        found.map_err(|error| {
            let ConsistencyError::NoInterior { conflicting, .. } = error else { return self.refuse(error) };
            let (path, method, deviations) = (self.path.clone(), self.method, self.outside);
            ExportError::NotConsistent { path, method, deviations, conflicting }
        })
    }

    /// `|R (K theta - base)|^2` with `R^T R` the inverse of the covariance.
    fn distance(&self, base: &[f64]) -> Result<LeastSquares, ExportError> {
        let whitening = self.known_uncertainty()?.whitening().ok_or_else(|| self.singular())?;
        LeastSquares::nearest(whitening, base, &self.base, self.set.parameter_table().len()).map_err(|e| self.refuse(e))
    }

    /// Base parameters from the normal distribution about the estimates, of independent standard normal numbers.
    pub(super) fn drawn(&self, normal: &[f64]) -> Result<Vec<f64>, ExportError> {
        self.known_uncertainty()?.drawn(&self.estimates, normal).ok_or_else(|| self.singular())
    }

    /// The covariance of the base parameters with what is known of them, and to first order that of the standard parameters.
    pub(super) fn covariance_at(&self, standard: &[f64]) -> Result<ExportedCovariance, ExportError> {
        let uncertainty = self.known_uncertainty()?;
        let by = dependence_on_base(&self.set, &self.base, standard).map_err(|e| self.refuse(e))?;
        if by.base.columns() == self.base.len() {
            return Ok(ExportedCovariance {
                base: uncertainty.covariance.clone(),
                standard: image(&by.standard, &uncertainty.covariance),
            });
        }
        let whitening = uncertainty.whitening().ok_or_else(|| self.singular())?;
        let of_free = match by.base.columns() {
            0 => Matrix::zeros(0, 0),
            _ => PivotedQr::with_equal_columns(&whitening.times_matrix(&by.base)).inverse_gram(),
        };
        Ok(ExportedCovariance { base: image(&by.base, &of_free), standard: image(&by.standard, &of_free) })
    }

    fn known_uncertainty(&self) -> Result<&Uncertainty, ExportError> {
        self.uncertainty.as_ref().ok_or_else(|| self.no_deviations())
    }

    fn no_deviations(&self) -> ExportError {
        ExportError::NoDeviations { path: self.path.clone(), method: self.method }
    }

    fn singular(&self) -> ExportError {
        ExportError::SingularCovariance { path: self.path.clone(), method: self.method }
    }

    fn refuse(&self, source: ConsistencyError) -> ExportError {
        ExportError::Consistency { path: self.path.clone(), source }
    }
}

/// Whether there are no parameters to find, known values that exclude the wanted ones included.
fn lacks_room(error: &ConsistencyError) -> bool {
    matches!(error, ConsistencyError::NoInterior { .. } | ConsistencyError::ContradictoryValues { .. })
}

/// `G C G^T`.
fn image(g: &Matrix, covariance: &Matrix) -> Matrix {
    g.times_matrix(covariance).times_transposed(g)
}

/// The consistent estimate of a run, in the order of the table.
fn consistent_estimate(run: &RunResult, table: &ParameterTable) -> Option<Vec<f64>> {
    let estimate = run.physical.as_ref()?.estimate.as_ref()?;
    let value = |name: &str| estimate.standard.iter().find(|p| p.name == name).map_or(0.0, |p| p.estimate);
    Some(table.iter().map(|p| value(&p.name())).collect())
}
