//! What results say of the base parameters, and the consistent standard parameters nearest to the a-priori ones that have
//! them.

use std::path::PathBuf;

use super::{
    error::ExportError,
    provenance::{Provenance, provenance},
    uncertainty::Uncertainty,
};
use crate::{
    experiment::IdentifiedRobot,
    preparation::{KnownQuantity, consistent_set_of},
};
use thetahat_estimation::identification::Method;
use thetahat_model::{
    base_parameters::BaseParameters,
    consistency::{ConsistencyError, ConsistentSet, Known, LeastSquares, mass_factor},
    robot::{ParameterTable, Quantity},
};
use thetahat_report::results::{ParameterResult, RunResult};

/// The estimates of a run with their uncertainty, and the set of standard parameters that a robot can have.
#[derive(Debug, Clone)]
pub(super) struct Posterior {
    /// The file of the results, for messages.
    pub(super) path: PathBuf,
    pub(super) method: Method,
    pub(super) set: ConsistentSet,
    /// The part of the set that has the base parameters at zero that were not estimated, as the identified model has; `None`
    /// if all were.
    pub(super) held: Option<ConsistentSet>,
    /// The base parameters that were estimated.
    pub(super) base: BaseParameters,
    /// Those that were not.
    pub(super) left_out: BaseParameters,
    pub(super) estimates: Vec<ParameterResult>,
    pub(super) uncertainty: Option<Uncertainty>,
    /// Where each standard parameter comes from.
    pub(super) provenance: Vec<Provenance>,
    /// Deviations by which the estimate is outside of the set.
    pub(super) outside: Option<f64>,
    /// Whether the data reject every consistent robot; `None` if that was not tested.
    pub(super) rejects: Option<bool>,
    /// The consistent estimate in the results.
    pub(super) consistent: Option<Vec<f64>>,
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
            provenance: provenance(&base, &settings.parameters, set.parameter_table(), |name| {
                identified.is_decided(name)
            }),
            consistent: match &identified.model {
                Some(_) => Some(identified.theta()),
                None => consistent_estimate(run, set.parameter_table()),
            },
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
        if identified.model.is_none() {
            posterior.set_zeros(&settings.parameters.known)?;
        }
        posterior.held = posterior.holding()?;
        Ok(posterior)
    }

    /// What was not estimated is not in the identified model: friction, offsets and torque terms are zero, and motor inertias
    /// that have no a-priori value; except those that are given.
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

    /// The part of the set with the base parameters at zero that were not estimated, except those that are given.
    fn holding(&self) -> Result<Option<ConsistentSet>, ExportError> {
        let left_out = self.left_out.filtered(|kept| self.provenance[kept] != Provenance::Given);
        let zeros = vec![[0.0; 2]; left_out.len()];
        let held = self.set.clone().with_base_between(&left_out, &zeros).map_err(|e| self.refuse(e))?;
        Ok((!left_out.is_empty()).then_some(held))
    }

    pub(super) fn known_uncertainty(&self) -> Result<&Uncertainty, ExportError> {
        self.uncertainty.as_ref().ok_or_else(|| self.no_deviations())
    }

    pub(super) fn no_deviations(&self) -> ExportError {
        ExportError::NoDeviations { path: self.path.clone(), method: self.method }
    }

    pub(super) fn singular(&self) -> ExportError {
        ExportError::SingularCovariance { path: self.path.clone(), method: self.method }
    }

    pub(super) fn refuse(&self, source: ConsistencyError) -> ExportError {
        ExportError::Consistency { path: self.path.clone(), source }
    }
}

/// The consistent estimate of a run, in the order of the table.
fn consistent_estimate(run: &RunResult, table: &ParameterTable) -> Option<Vec<f64>> {
    let estimate = run.physical.as_ref()?.estimate.as_ref()?;
    let value = |name: &str| estimate.standard.iter().find(|p| p.name == name).map_or(0.0, |p| p.estimate);
    Some(table.iter().map(|p| value(&p.name())).collect())
}
