//! The uncertainty of the exported parameters: a JSON file next to the export.

use serde::Serialize;

use super::{error::ExportError, identified::IdentifiedModel};
use thetahat_ground::linear_algebra::Matrix;

#[derive(Serialize)]
struct Sidecar<'a> {
    thetahat: &'a str,
    content: &'a str,
    robot: &'a str,
    case: &'a str,
    method: &'a str,
    about: &'a str,
    base_parameters: Vec<Base>,
    base_covariance: Vec<Vec<f64>>,
    standard_parameters: Vec<Standard>,
    standard_covariance: Vec<Vec<f64>>,
}

#[derive(Serialize)]
struct Base {
    name: String,
    unit: String,
    expression: String,
    estimate: f64,
    exported: f64,
    standard_deviation: f64,
}

#[derive(Serialize)]
struct Standard {
    name: String,
    unit: String,
    value: f64,
    a_priori: f64,
    provenance: &'static str,
    standard_deviation: f64,
}

const ABOUT: &str = "SI. Covariances are lower triangles, row by row, of the free estimates with what the experiment says is known: \
                     standard deviations with errors that are correlated in time, correlations classical. That of the standard \
                     parameters is how the consistent set nearest to the a-priori parameters follows the base parameters, to first \
                     order: the a-priori values themselves have no uncertainty here.";
/// The same of results that hold deviations alone.
const ABOUT_DEVIATIONS: &str = "SI. Covariances are lower triangles, row by row. The results hold standard deviations and no correlations: those of the free \
     estimates are taken as zero, which they are not; identify again with this version. The covariance of the standard \
     parameters is how the consistent set nearest to the a-priori parameters follows the base parameters, to first order: the \
     a-priori values themselves have no uncertainty here.";

impl IdentifiedModel {
    /// The covariance of the exported parameters as JSON: base parameters, and to first order standard parameters.
    ///
    /// # Errors
    /// [`ExportError::NoDeviations`] where the results do not say how sure the estimates are, and
    /// [`ExportError::SingularCovariance`].
    pub fn covariance_json(&self) -> Result<String, ExportError> {
        let covariance = self.posterior.covariance_at(&self.standard)?;
        let is_correlated = self.posterior.uncertainty.as_ref().is_some_and(|u| u.is_correlated);
        let sidecar = Sidecar {
            thetahat: env!("CARGO_PKG_VERSION"),
            content: "covariance",
            robot: &self.identified.robot.name,
            case: &self.identified.case.name,
            method: self.identified.source_of_estimates().name(),
            about: if is_correlated { ABOUT } else { ABOUT_DEVIATIONS },
            base_parameters: self.base_entries(&covariance.base),
            base_covariance: lower(&covariance.base),
            standard_parameters: self.standard_entries(&covariance.standard),
            standard_covariance: lower(&covariance.standard),
        };
        Ok(serde_json::to_string(&sidecar)? + "\n")
    }

    /// The same; or why there is none, as in results of before deviations.
    ///
    /// # Errors
    /// [`ExportError`] for what cannot be computed or rendered.
    pub fn covariance_json_or_reason(&self) -> Result<Result<String, ExportError>, ExportError> {
        match self.covariance_json() {
            none @ Err(ExportError::NoDeviations { .. } | ExportError::SingularCovariance { .. }) => Ok(none),
            found => found.map(Ok),
        }
    }

    fn base_entries(&self, covariance: &Matrix) -> Vec<Base> {
        let posterior = &self.posterior;
        let exported = posterior.base.from_standard(&self.standard);
        let entry = |(i, p): (usize, &thetahat_model::base_parameters::BaseParameter)| Base {
            name: p.name.clone(),
            unit: p.unit.to_string(),
            expression: p.expression.clone(),
            estimate: posterior.estimates[i].estimate,
            exported: exported[i],
            standard_deviation: deviation_at(covariance, i),
        };
        posterior.base.parameters().iter().enumerate().map(entry).collect()
    }

    fn standard_entries(&self, covariance: &Matrix) -> Vec<Standard> {
        let table = self.posterior.set.parameter_table();
        let entry = |(i, p): (usize, &thetahat_model::robot::Parameter)| Standard {
            name: p.name(),
            unit: p.unit.to_string(),
            value: self.standard[i],
            a_priori: self.posterior.set.a_priori()[i],
            provenance: self.posterior.provenance[i].name(),
            standard_deviation: deviation_at(covariance, i),
        };
        table.iter().enumerate().map(entry).collect()
    }
}

fn deviation_at(covariance: &Matrix, i: usize) -> f64 {
    covariance.at(i, i).max(0.0).sqrt()
}

fn lower(matrix: &Matrix) -> Vec<Vec<f64>> {
    (0..matrix.rows()).map(|i| (0..=i).map(|j| matrix.at(i, j)).collect()).collect()
}
