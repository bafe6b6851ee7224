//! How sure the exported parameters are: a JSON file beside the export.

use serde::Serialize;

use super::{error::ExportError, identified::IdentifiedModel};
use crate::{consistency::dependence_on_base, linear_algebra::Matrix, results::NOMINAL};

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
    standard_deviation: Option<f64>,
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

const ABOUT: &str = "SI. Covariances are lower triangles, row by row, of the free estimates: standard deviations with errors \
                     that are correlated in time, correlations classical. That of the standard parameters is how the consistent \
                     set nearest to the a-priori parameters follows the base parameters, to first order: the a-priori values \
                     themselves have no uncertainty here.";

impl IdentifiedModel {
    /// The covariance of the exported parameters as JSON: base parameters, and to first order standard parameters.
    ///
    /// # Errors
    /// [`ExportError::NoDeviations`] where the results do not say how sure the estimates are.
    pub fn covariance_json(&self) -> Result<String, ExportError> {
        let posterior = &self.posterior;
        let covariance = posterior.covariance.as_ref().ok_or(ExportError::NoDeviations { method: self.method })?;
        let g = dependence_on_base(&posterior.set, &posterior.base, &self.standard)?;
        let standard = g.times_matrix(covariance).times_matrix(&g.transpose());
        let sidecar = Sidecar {
            thetahat: env!("CARGO_PKG_VERSION"),
            content: "covariance",
            robot: &self.robot.name,
            case: NOMINAL,
            method: self.method.name(),
            about: ABOUT,
            base_parameters: self.base_entries(),
            base_covariance: lower(covariance),
            standard_parameters: self.standard_entries(&standard),
            standard_covariance: lower(&standard),
        };
        Ok(serde_json::to_string(&sidecar)? + "\n")
    }

    /// The same; none where the results do not say how sure the estimates are.
    ///
    /// # Errors
    /// [`ExportError`] for what cannot be computed or rendered.
    pub fn covariance_json_if_known(&self) -> Result<Option<String>, ExportError> {
        self.posterior.covariance.is_some().then(|| self.covariance_json()).transpose()
    }

    fn base_entries(&self) -> Vec<Base> {
        let posterior = &self.posterior;
        let exported = posterior.base.from_standard(&self.standard);
        let entry = |(i, p): (usize, &crate::base_parameters::BaseParameter)| Base {
            name: p.name.clone(),
            unit: p.unit.to_string(),
            expression: p.expression.clone(),
            estimate: posterior.estimate[i],
            exported: exported[i],
            standard_deviation: posterior.deviation[i],
        };
        posterior.base.parameters().iter().enumerate().map(entry).collect()
    }

    fn standard_entries(&self, covariance: &Matrix) -> Vec<Standard> {
        let table = self.robot.parameter_table();
        let entry = |(i, p): (usize, &crate::robot::Parameter)| Standard {
            name: p.name(),
            unit: p.unit.to_string(),
            value: self.standard[i],
            a_priori: self.posterior.set.a_priori()[i],
            provenance: self.provenance[i].name(),
            standard_deviation: covariance.at(i, i).max(0.0).sqrt(),
        };
        table.iter().enumerate().map(entry).collect()
    }
}

fn lower(matrix: &Matrix) -> Vec<Vec<f64>> {
    (0..matrix.rows()).map(|i| (0..=i).map(|j| matrix.at(i, j)).collect()).collect()
}
