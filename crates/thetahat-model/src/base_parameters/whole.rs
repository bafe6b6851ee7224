//! Dependencies of all columns at once, in cubic time, for nearly special robots.

use super::{
    dependencies::Dependencies,
    error::BaseParametersError,
    observations::{random_channels, random_states},
};
use crate::{
    dynamics::{Model, Sign, State, Workspace},
    regressor::Regressor,
};
use thetahat_ground::linear_algebra::{Matrix, PivotedQr, dot, norm};

/// Random states whose rows are examined: several times as many rows as there can be parameters.
const STATES: usize = 100;
/// Rows for each column, of robots whose loops leave few coordinates.
const ROWS_FOR_EACH: usize = 4;
/// Part of a column, relative to its norm, below which it counts as spanned by earlier ones; also the relative
/// tolerance of the rank. Spanned columns leave about 1e-14, independent ones more than 1e-4 for real geometries.
const TOLERANCE: f64 = 1e-9;

/// The dependencies of the standard parameters at `considered`.
pub(super) fn dependencies(model: &Model, considered: &[usize]) -> Result<Dependencies, BaseParametersError> {
    let x = random_observations(model, considered);
    let size: Vec<f64> = (0..x.columns()).map(|j| norm(x.column(j))).collect();
    let largest = size.iter().copied().fold(0.0, f64::max);
    let effective: Vec<usize> = (0..x.columns()).filter(|&j| size[j] > TOLERANCE * largest).collect();
    if effective.is_empty() {
        return Err(BaseParametersError::NoneLeft);
    }
    let kept = independent_columns(&x, &effective);
    let rank = PivotedQr::new(&x.select_columns(&effective)).rank(TOLERANCE);
    if rank != kept.len() {
        return Err(BaseParametersError::AmbiguousRank { kept: kept.len(), rank });
    }
    let spanned: Vec<usize> = effective.iter().copied().filter(|j| !kept.contains(j)).collect();
    let qr = PivotedQr::new(&x.select_columns(&kept));
    let coefficients = qr.solve_matrix(&x.select_columns(&spanned));
    Ok(Dependencies { kept, spanned, coefficients })
}

/// `phi` of random states, all joints' rows.
pub(super) fn random_observations(model: &Model, indices: &[usize]) -> Matrix {
    let n = model.coordinate_count();
    let regressor = Regressor::new(model, indices);
    let states = STATES.max(ROWS_FOR_EACH * indices.len() / n);
    let [q, dq, ddq] = random_states(model, states);
    let channels = random_channels(model, states);
    let mut workspace = Workspace::new(model);
    let mut phi = vec![0.0; regressor.entries().len()];
    let mut x = Matrix::zeros(states * n, indices.len());
    for k in 0..states {
        let [q, dq, ddq] = [&q, &dq, &ddq].map(|x| x.sample(k));
        let recorded = channels.as_ref().map_or(&[][..], |channels| channels.sample(k));
        let state = State::new(q, dq).with_channels(recorded);
        regressor.evaluate(model, state, ddq, Sign::Exact, &mut workspace, &mut phi);
        for (entry, value) in regressor.entries().iter().zip(&phi) {
            *x.at_mut(k * n + entry.joint, entry.column) = *value;
        }
    }
    x
}

/// The first independent columns from left to right, by Gram-Schmidt with one repetition.
fn independent_columns(x: &Matrix, candidates: &[usize]) -> Vec<usize> {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let mut kept = Vec::new();
    for &j in candidates {
        let mut rest = x.column(j).to_vec();
        for _ in 0..2 {
            for b in &basis {
                let along = dot(b, &rest);
                rest.iter_mut().zip(b).for_each(|(r, b)| *r -= along * b);
            }
        }
        let size = norm(&rest);
        if size > TOLERANCE * norm(x.column(j)) {
            rest.iter_mut().for_each(|r| *r /= size);
            basis.push(rest);
            kept.push(j);
        }
    }
    kept
}
