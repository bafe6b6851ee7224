//! Dynamics and regressor against Pinocchio 4.1.0: `shared/reference/dynamics_tx40.json`, made by the script beside it.

mod common;

use libtest_mimic::Failed;
use serde::Deserialize;
use thetahat::{
    dynamics::{DynamicParameters, Model, Sign, Workspace},
    regressor::Regressor,
    robot::Robot,
};

/// Both sides are exact but for rounding.
const TOLERANCE: f64 = 1e-9;

#[derive(Deserialize)]
struct Reference {
    phi: Vec<f64>,
    states: Vec<State>,
}

#[derive(Deserialize)]
struct State {
    q: Vec<f64>,
    dq: Vec<f64>,
    ddq: Vec<f64>,
    tau: Vec<f64>,
    mass_matrix: Vec<Vec<f64>>,
    nonlinear: Vec<f64>,
    gravity: Vec<f64>,
    regressor: Vec<Vec<f64>>,
}

/// Pinocchio's order of the ten inertial parameters, by our names.
const ORDER: [&str; 10] = ["m", "mx", "my", "mz", "xx", "xy", "yy", "xz", "yz", "zz"];

struct Case {
    model: Model,
    theta: Vec<f64>,
    indices: Vec<usize>,
    states: Vec<State>,
}

fn tx40() -> Case {
    let robot = Robot::read(&common::root().join("robots/tx40.toml")).unwrap();
    let text = std::fs::read_to_string(common::shared().join("reference/dynamics_tx40.json")).unwrap();
    let reference: Reference = serde_json::from_str(&text).unwrap();
    let model = Model::new(&robot);
    let table = model.parameter_table();
    let name = |k: usize| format!("{}{}", ORDER[k % 10], k / 10 + 1);
    let indices: Vec<usize> = (0..60).map(|k| table.index_of(&name(k)).unwrap()).collect();
    let mut theta = vec![0.0; table.len()];
    indices.iter().zip(&reference.phi).for_each(|(&i, &v)| theta[i] = v);
    Case { model, theta, indices, states: reference.states }
}

fn worst(pairs: impl Iterator<Item = (f64, f64)>) -> f64 {
    pairs.map(|(a, b)| (a - b).abs() / b.abs().max(1.0)).fold(0.0, f64::max)
}

fn assert_states(check: impl Fn(&Case, &State, &mut Workspace) -> f64) -> Result<(), Failed> {
    let case = tx40();
    let mut workspace = Workspace::new(&case.model);
    for (k, state) in case.states.iter().enumerate() {
        let error = check(&case, state, &mut workspace);
        if error.is_nan() || error > TOLERANCE {
            return Err(format!("state {k}: {error:e}").into());
        }
    }
    Ok(())
}

fn inverse_dynamics(case: &Case, q: &[f64], dq: &[f64], ddq: &[f64], workspace: &mut Workspace) -> Vec<f64> {
    let parameters = DynamicParameters::new(case.model.parameter_table(), 6, &case.theta);
    let mut tau = vec![0.0; 6];
    case.model.inverse_dynamics(&parameters, q, dq, ddq, Sign::Exact, workspace, &mut tau);
    tau
}

fn torques() -> Result<(), Failed> {
    assert_states(|case, s, w| {
        worst(inverse_dynamics(case, &s.q, &s.dq, &s.ddq, w).into_iter().zip(s.tau.iter().copied()))
    })
}

fn nonlinear_effects_and_gravity() -> Result<(), Failed> {
    let zero = [0.0; 6];
    assert_states(|case, s, w| {
        let h = inverse_dynamics(case, &s.q, &s.dq, &zero, w);
        let g = inverse_dynamics(case, &s.q, &zero, &zero, w);
        worst(h.into_iter().zip(s.nonlinear.iter().copied()).chain(g.into_iter().zip(s.gravity.iter().copied())))
    })
}

fn mass_matrix() -> Result<(), Failed> {
    assert_states(|case, s, w| {
        let parameters = DynamicParameters::new(case.model.parameter_table(), 6, &case.theta);
        let mut m = vec![0.0; 36];
        case.model.mass_matrix(&parameters, &s.q, w, &mut m);
        worst(m.into_iter().zip(s.mass_matrix.iter().flatten().copied()))
    })
}

fn regressor() -> Result<(), Failed> {
    assert_states(|case, s, w| {
        let regressor = Regressor::new(&case.model, &case.indices);
        let mut phi = vec![0.0; regressor.entries().len()];
        regressor.evaluate(&case.model, &s.q, &s.dq, &s.ddq, Sign::Exact, w, &mut phi);
        let mut dense = vec![vec![0.0; 60]; 6];
        for (entry, value) in regressor.entries().iter().zip(&phi) {
            dense[entry.joint][entry.column] = *value;
        }
        worst(dense.into_iter().flatten().zip(s.regressor.iter().flatten().copied()))
    })
}

fn main() {
    common::run_with_shared_data(vec![
        ("inverse_dynamics_of_25_states", torques),
        ("nonlinear_effects_and_gravity_of_25_states", nonlinear_effects_and_gravity),
        ("mass_matrix_of_25_states", mass_matrix),
        ("regressor_of_25_states", regressor),
    ]);
}
