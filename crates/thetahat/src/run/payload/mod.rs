//! Payloads that are estimated: recordings with and without one in a single regression.
//!
//! In recordings that carry a payload the torque is `phi theta + phi_k T theta_p`, with the ten columns `phi_k` of the link
//! that carries it and T from the payload's frame to the link's. Robot and payload are estimated together by least squares,
//! each joint weighted by its noise (W. Khalil, M. Gautier, P. Lemoine, "Identification of the payload inertial parameters of
//! industrial manipulators", 2007).

pub(in crate::run) mod drive_gains;

use std::path::Path;

use super::{
    identification::{CaseProblem, Identification},
    prepared::{PreparedRecording, filtered},
};
use crate::preparation::{Case, ParameterChoice, Payload, PreparationError};
use thetahat_estimation::{
    identification::{Method, idim_ls, uncertainty},
    regression::{Regression, relative_error_percent},
    statistics::CovarianceFactor,
};
use thetahat_ground::linear_algebra::{Matrix, PivotedQr, norm};
use thetahat_model::{
    consistency::{ConsistentSet, Known, LeastSquares, Prior, completed_a_priori, fit, pseudo_inertia},
    robot::{INERTIAL, JointKind, LinkQuantity, Quantity, Robot},
};
use thetahat_report::results::{PayloadParameter, PayloadResult};

/// Size of a diagonal entry of R, relative to the largest, below which a column depends on others.
const RANK_TOLERANCE: f64 = 1e-10;
/// Part of a dependent column, both of norm one, with which a parameter is part of what is not separated.
const PART: f64 = 1e-6;
/// Weight of the prior of the nearest body, in variances: it only bounds what the data leave free.
const PRIOR: f64 = 1e-3;

impl Identification {
    /// Every payload that is to be estimated, with the recordings that carry it.
    pub(super) fn payloads(&self) -> Result<Vec<PayloadResult>, PreparationError> {
        let unknown = self.setup().settings.payloads.iter().filter(|p| !p.is_known());
        let carried = unknown.filter(|p| self.loaded.iter().any(|r| carries(r, p)));
        carried.map(|payload| self.payload(payload)).collect()
    }

    fn payload(&self, payload: &Payload) -> Result<PayloadResult, PreparationError> {
        let setup = self.setup();
        let loaded: Vec<&PreparedRecording> = self.loaded.iter().filter(|r| carries(r, payload)).collect();
        let mut recordings = filtered(&self.main);
        let unloaded = recordings.len();
        recordings.extend(loaded.iter().map(|p| &p.filtered));
        let problem = setup.problem_on(setup.basis(&Case::nominal())?, &recordings, &ParameterChoice::Base)?;
        let columns = payload.columns(setup.robot, problem.model.parameter_table())?;
        let mut blocks = Vec::with_capacity(recordings.len());
        for (i, recording) in recordings.iter().enumerate() {
            let assembly = problem.assembly_of(i, &problem.model, &columns);
            let rows = assembly.rows_per_joint() * problem.model.coordinate_count();
            blocks.push(if i < unloaded {
                Matrix::zeros(rows, INERTIAL.len())
            } else {
                recording.observation_matrix(&assembly)?.times_matrix(&payload.to_link())
            });
        }
        let of_payload = problem.regression.layout.stack_matrices(blocks);
        let problem = CaseProblem::new(setup.robot.friction, problem);
        let of_recordings: Vec<f64> = recordings.iter().map(|r| r.recording.weight).collect();
        let weights = problem.weights(setup.settings, Method::IDIM_WLS, &of_recordings);
        let problem = problem.problem;
        let x = Matrix::side_by_side(&[&problem.regression.x, &of_payload]);
        let regression = problem.regression.with_matrix(x).with_weights(weights);
        let found = EstimatedPayload::of(&regression, problem.base.len());
        let layout = &regression.layout;
        let rows: Vec<usize> =
            layout.blocks().iter().filter(|b| b.recording >= unloaded).flat_map(|b| b.rows.clone()).collect();
        let pick = |values: &[f64]| rows.iter().map(|&k| values[k]).collect::<Vec<f64>>();
        let estimates: Option<Vec<f64>> = found.parameters.iter().map(|p| p.map(|p| p.estimate)).collect();
        let physical =
            estimates.as_deref().zip(found.covariance.as_ref()).and_then(|(theta, c)| nearest_body(theta, c));
        Ok(PayloadResult {
            name: payload.name.clone(),
            joint: setup.robot.joints[payload.link(setup.robot)?].name.clone(),
            recordings: loaded.iter().map(|p| p.filtered.recording.name.clone()).collect(),
            relative_error_percent: relative_error_percent(&pick(&regression.y), &pick(&found.prediction)),
            centre_m: found.centre(),
            is_physical: estimates.as_deref().map(is_body),
            physical,
            parameters: INERTIAL.into_iter().zip(&found.parameters).map(|(q, p)| named(q, *p)).collect(),
        })
    }
}

fn carries(prepared: &PreparedRecording, payload: &Payload) -> bool {
    prepared.filtered.recording.payload.as_deref() == Some(&payload.name)
}

/// The estimate of a payload's parameters together with those of the robot.
struct EstimatedPayload {
    /// None if the motion does not identify one.
    parameters: Vec<Option<One>>,
    /// Their covariance with correlated errors, where all are identified.
    covariance: Option<Matrix>,
    prediction: Vec<f64>,
}

/// One estimate.
#[derive(Debug, Clone, Copy)]
struct One {
    estimate: f64,
    standard_deviation: Option<f64>,
    interval_95: Option<[f64; 2]>,
}

impl EstimatedPayload {
    /// The last ten columns of a regression, after so many of the robot.
    fn of(regression: &Regression, robot: usize) -> Self {
        let none = || Self {
            parameters: vec![None; INERTIAL.len()],
            covariance: None,
            prediction: vec![0.0; regression.y.len()],
        };
        let Separated { independent, mixed } = Separated::of(&regression.whiten_matrix(&regression.x));
        let reduced = regression.with_columns(&independent);
        let Ok(fit) = idim_ls(&reduced, Default::default()) else { return none() };
        let found = uncertainty(Method::IDIM_LS, &reduced, None, &fit).ok();
        let one = |column: usize| {
            let place = independent.iter().position(|&c| c == column).filter(|_| !mixed[column])?;
            let standard_deviation = found.as_ref().map(|u| u.standard_deviation[place]);
            let interval_95 = found.as_ref().map(|u| u.interval_95[place]);
            Some(One { estimate: fit.theta[place], standard_deviation, interval_95 })
        };
        let parameters: Vec<Option<One>> = (robot..robot + INERTIAL.len()).map(one).collect();
        let covariance = found.filter(|_| parameters.iter().all(Option::is_some)).map(|u| {
            // The correlations of the classical covariance with the deviations of correlated errors.
            let places: Vec<usize> = (robot..robot + INERTIAL.len())
                .filter_map(|column| independent.iter().position(|&c| c == column))
                .collect();
            let wider = |i: usize| u.standard_deviation[places[i]] / fit.standard_deviation[places[i]];
            let entry = |i: usize, j: usize| fit.covariance.at(places[i], places[j]) * wider(i) * wider(j);
            Matrix::from_fn(places.len(), places.len(), entry)
        });
        Self { parameters, covariance, prediction: fit.prediction }
    }

    /// The centre of mass, first moments over the mass.
    fn centre(&self) -> Option<[f64; 3]> {
        let value = |i: usize| self.parameters[i].map(|p| p.estimate);
        let mass = value(9).filter(|m| *m > 0.0)?;
        Some([value(6)? / mass, value(7)? / mass, value(8)? / mass])
    }
}

/// An estimate under the name of its parameter; none if there is none.
fn named(quantity: LinkQuantity, found: Option<One>) -> PayloadParameter {
    PayloadParameter {
        name: quantity.name().to_owned(),
        unit: Quantity::Link(quantity).unit(JointKind::Revolute).to_string(),
        estimate: found.map(|p| p.estimate),
        standard_deviation: found.and_then(|p| p.standard_deviation),
        interval_95: found.and_then(|p| p.interval_95),
    }
}

/// Which columns of a matrix are independent, and which depend on others or others on them.
struct Separated {
    independent: Vec<usize>,
    mixed: Vec<bool>,
}

impl Separated {
    fn of(x: &Matrix) -> Self {
        let qr = PivotedQr::with_equal_columns(x);
        let rank = qr.rank(RANK_TOLERANCE);
        let (independent, dependent) = qr.pivots().split_at(rank);
        let (independent, dependent) = (independent.to_vec(), dependent.to_vec());
        let mut mixed = vec![false; x.columns()];
        if !dependent.is_empty() {
            let coefficients = PivotedQr::with_equal_columns(&x.select_columns(&independent))
                .solve_matrix(&x.select_columns(&dependent));
            for (d, &column) in dependent.iter().enumerate() {
                let size = norm(x.column(column));
                mixed[column] = true;
                for (i, &other) in independent.iter().enumerate() {
                    mixed[other] |= coefficients.at(i, d).abs() * norm(x.column(other)) > PART * size;
                }
            }
        }
        Self { independent, mixed }
    }
}

/// Whether some body has these ten parameters.
fn is_body(theta: &[f64]) -> bool {
    <[f64; 10]>::try_from(theta).is_ok_and(|theta| pseudo_inertia(theta).smallest_eigenvalue() > 0.0)
}

/// The parameters of the body nearest to an estimate in the metric of its covariance.
fn nearest_body(theta: &[f64], covariance: &Matrix) -> Option<Vec<f64>> {
    let body = Robot::parse(BODY, Path::new(BODY_FILE)).ok()?;
    let a_priori = completed_a_priori(&body, Some(theta[9].abs().max(SMALLEST_MASS)));
    let mut set = ConsistentSet::new(&body, &a_priori).ok()?;
    let table = body.parameter_table();
    for parameter in table.iter().filter(|p| !p.quantity.is_inertial()) {
        set = set.with_known(&Known::Value { parameter: parameter.name(), value: 0.0 }).ok()?;
    }
    let whitening = CovarianceFactor::of(covariance)?.whitening()?;
    let mut matrix = Matrix::zeros(theta.len(), table.len());
    (0..theta.len()).for_each(|j| matrix.column_mut(j).copy_from_slice(whitening.column(j)));
    let data = LeastSquares::in_standard(matrix, whitening.times(theta));
    let found = fit(&set, &data, Prior::LogDet { weight: PRIOR }, None).ok()?;
    Some(found.standard[..theta.len()].to_vec())
}

/// A robot of one body, whose first ten standard parameters are those of a payload.
const BODY: &str = "name = 'payload'\n[[joint]]\nname = 'payload'\nkind = 'revolute'\n";
const BODY_FILE: &str = "payload.toml";
/// Mass from which the a-priori body of an estimate without mass is drawn, kg.
const SMALLEST_MASS: f64 = 1e-2;
