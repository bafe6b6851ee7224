//! Which standard parameters are exported: consistent ones nearest to the a-priori ones that have the base parameters.

use super::{error::ExportError, posterior::Posterior, provenance::Provenance};
use thetahat_ground::linear_algebra::Matrix;
use thetahat_model::consistency::{ConsistencyError, ConsistentSet, LeastSquares, Prior, fit};
use thetahat_report::results::ParameterResult;

/// Weight of the divergence from the a-priori parameters relative to the distance from the estimate in its variances: small enough to
/// decide only what the data leave free.
const PRIOR: Prior = Prior::LogDet { weight: 1e-3 };

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

    /// Also sets whether what was not estimated is held at zero.
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

    /// The result of an attempt with the base parameters held that were not estimated, or else with these free; and whether they are held.
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
}

/// Whether there are no parameters to find, known values that exclude the wanted ones included.
fn lacks_room(error: &ConsistencyError) -> bool {
    matches!(error, ConsistencyError::NoInterior { .. } | ConsistencyError::ContradictoryValues { .. })
}
