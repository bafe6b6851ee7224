//! The kernels of the TX40, one state at a time and in batches.

use std::{error::Error, hint::black_box};

use super::{
    fastest,
    peers::Peers,
    table::Row,
    tx40::{DDQ, Q, SIGN, Tx40, motion, state},
};
use thetahat::dynamics::Sign;

const ROUNDS: usize = 15;
const CALLS: usize = 20_000;

/// Kernel by kernel.
pub fn rows(peers: &Peers) -> Result<Vec<Row>, Box<dyn Error>> {
    let row = |name: &str, seconds: f64, peer: &str, target: f64| Row::ratio(name, seconds, peers.call(peer), target);
    Ok(vec![
        row("regressor, in batches, per sample", regressor_in_batches()?, "regressor", 5.0),
        row("regressor, one call", regressor()?, "regressor", 1.0),
        row("inverse dynamics, one call (RNEA)", inverse_dynamics()?, "rnea", 1.0),
        row("mass matrix, one call (CRBA)", mass_matrix()?, "crba", 1.0),
        row("forward dynamics, one call (ABA)", forward_dynamics()?, "aba", 2.0),
        row("forward dynamics, in batches, per sample", forward_dynamics_in_batches()?, "aba", 2.0),
    ])
}

/// Seconds per call.
fn per_call(mut call: impl FnMut() -> f64) -> Result<f64, Box<dyn Error>> {
    let round = || Ok((0..CALLS).map(|_| call()).sum::<f64>());
    let (seconds, sum) = fastest(ROUNDS, round)?;
    black_box(sum);
    Ok(seconds / CALLS as f64)
}

fn regressor() -> Result<f64, Box<dyn Error>> {
    let Tx40 { model, mut workspace, regressor, .. } = Tx40::new()?;
    let mut phi = vec![0.0; regressor.entries().len()];
    per_call(|| {
        regressor.evaluate(&model, state(), &DDQ, Sign::Exact, &mut workspace, &mut phi);
        phi[0]
    })
}

fn regressor_in_batches() -> Result<f64, Box<dyn Error>> {
    let Tx40 { model, regressor, .. } = Tx40::new()?;
    let [q, dq, ddq] = motion(64);
    let mut phi = vec![0.0; 64 * regressor.entries().len()];
    let (seconds, ()) = fastest(ROUNDS, || {
        for _ in 0..CALLS / 64 {
            regressor.evaluate_samples(&model, [black_box(&q), &dq, &ddq], 0..64, Sign::Exact, &mut phi);
        }
        Ok(())
    })?;
    Ok(seconds / (64 * (CALLS / 64)) as f64)
}

fn inverse_dynamics() -> Result<f64, Box<dyn Error>> {
    let Tx40 { model, parameters, mut workspace, .. } = Tx40::new()?;
    let mut tau = [0.0; 6];
    per_call(|| {
        model.inverse_dynamics(&parameters, state(), &DDQ, SIGN, &mut workspace, &mut tau);
        tau[0]
    })
}

fn mass_matrix() -> Result<f64, Box<dyn Error>> {
    let Tx40 { model, parameters, mut workspace, .. } = Tx40::new()?;
    let mut m = [0.0; 36];
    per_call(|| {
        model.mass_matrix(&parameters, black_box(&Q), &mut workspace, &mut m);
        m[0]
    })
}

fn forward_dynamics() -> Result<f64, Box<dyn Error>> {
    let Tx40 { model, parameters, mut workspace, .. } = Tx40::new()?;
    let mut ddq = [0.0; 6];
    per_call(|| {
        let tau = black_box(&DDQ);
        match model.forward_dynamics(&parameters, state(), tau, SIGN, &mut workspace, &mut ddq) {
            Ok(()) => ddq[0],
            Err(_) => f64::NAN,
        }
    })
}

fn forward_dynamics_in_batches() -> Result<f64, Box<dyn Error>> {
    let Tx40 { model, parameters, .. } = Tx40::new()?;
    let [q, dq, tau] = motion(CALLS);
    let run = || Ok(model.forward_dynamics_series(&parameters, [&q, &dq, &tau], SIGN).map_err(|(_, error)| error)?);
    let (seconds, _) = fastest(ROUNDS, run)?;
    Ok(seconds / CALLS as f64)
}
