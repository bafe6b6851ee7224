//! Every model in `models` against MuJoCo; `values.toml` states the version, `make.py` printed it.

use std::path::Path;

use serde::Deserialize;

use crate::{
    dynamics::{DynamicParameters, Model, Sign, State, Workspace},
    robot::{Quantity, Robot, Role},
};

/// Largest difference relative to the largest entry: rounding in two programs that add in different orders.
const ROUNDING: f64 = 1e-9;
/// Torques below this are zero, N m.
const ZERO: f64 = 1e-3;
const VALUES: &str = include_str!("values.toml");

#[derive(Deserialize)]
struct Values {
    model: Vec<ModelValues>,
}

#[derive(Deserialize)]
struct ModelValues {
    name: String,
    joints: usize,
    frictionloss: Vec<f64>,
    state: Vec<StateValues>,
    simulation: Option<SimulationValues>,
}

/// The state after 1 s in a PD loop that starts at rest.
#[derive(Deserialize)]
struct SimulationValues {
    q: Vec<f64>,
    stiffness: Vec<f64>,
    damping: Vec<f64>,
    end: Vec<f64>,
}

#[derive(Deserialize)]
struct StateValues {
    q: Vec<f64>,
    dq: Vec<f64>,
    ddq: Vec<f64>,
    mass: Vec<f64>,
    bias: Vec<f64>,
    tau: Vec<f64>,
}

fn robot(folder: &str, name: &str) -> Robot {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/dynamics/mujoco_reference").join(folder);
    Robot::read(&folder.join(name).with_extension("xml")).unwrap()
}

/// The parameters of a robot without those of some roles.
fn parameters(model: &Model, robot: &Robot, without: &[Role]) -> DynamicParameters {
    let mut theta = robot.a_priori_parameters();
    for (value, parameter) in theta.iter_mut().zip(model.parameter_table().iter()) {
        if without.contains(&parameter.quantity.role()) {
            *value = 0.0;
        }
    }
    DynamicParameters::new(model, &theta).unwrap()
}

fn torques(model: &Model, parameters: &DynamicParameters, state: &StateValues, ddq: &[f64]) -> Vec<f64> {
    let mut tau = vec![0.0; ddq.len()];
    let mut workspace = Workspace::new(model);
    let at = State::new(&state.q, &state.dq);
    model.inverse_dynamics(parameters, at, ddq, Sign::Exact, &mut workspace, &mut tau);
    tau
}

fn same(found: &[f64], expected: &[f64], what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    let largest = expected.iter().fold(ZERO, |largest, value| largest.max(value.abs()));
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() <= ROUNDING * largest, "{what}: {found} against {expected}");
    }
}

#[test]
fn mass_matrix_bias_forces_and_inverse_dynamics_are_those_of_mujoco() {
    compare("models", VALUES, 26);
}

/// The models of `loops` close: `make_loops.py` projected the dynamics of their trees.
#[test]
fn mechanisms_that_close_are_those_of_mujoco() {
    compare("loops", include_str!("loops.toml"), 6);
}

/// Largest difference after 4000 evaluations, rad: each closes the loops to rounding.
const SIMULATED: f64 = 1e-9;
/// Amplitude of the reference, rad.
const WAVE: f64 = 0.2;
/// Step of Runge and Kutta's method, s.
const STEP: f64 = 1e-3;

/// Positions and velocities after 1 s.
fn simulated(model: &Model, parameters: &DynamicParameters, values: &SimulationValues) -> Vec<f64> {
    let n = values.q.len();
    let mut workspace = Workspace::new(model);
    let mut slope = |t: f64, state: &[f64]| {
        let (q, dq) = state.split_at(n);
        let wave = WAVE * (std::f64::consts::TAU * t).sin();
        let torque = |i: usize| values.stiffness[i] * (values.q[i] + wave - q[i]) - values.damping[i] * dq[i];
        let (tau, mut ddq) = ((0..n).map(torque).collect::<Vec<_>>(), vec![0.0; n]);
        model.forward_dynamics(parameters, State::new(q, dq), &tau, Sign::Exact, &mut workspace, &mut ddq).unwrap();
        [dq, &ddq].concat()
    };
    let moved = |state: &[f64], h: f64, slope: &[f64]| -> Vec<f64> {
        state.iter().zip(slope).map(|(x, dx)| x + h * dx).collect()
    };
    let mut state = [&values.q[..], &vec![0.0; n]].concat();
    for k in 0..1000 {
        let t = f64::from(k) * STEP;
        let a = slope(t, &state);
        let b = slope(t + 0.5 * STEP, &moved(&state, 0.5 * STEP, &a));
        let c = slope(t + 0.5 * STEP, &moved(&state, 0.5 * STEP, &b));
        let d = slope(t + STEP, &moved(&state, STEP, &c));
        let sum: Vec<f64> = (0..2 * n).map(|i| a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]).collect();
        state = moved(&state, STEP / 6.0, &sum);
    }
    state
}

#[test]
fn mechanisms_that_close_move_as_those_of_mujoco() {
    let values: Values = toml::from_str(include_str!("loops.toml")).unwrap();
    for ModelValues { name, simulation, .. } in values.model {
        let (robot, values) = (robot("loops", &name), simulation.unwrap());
        let model = Model::new(&robot);
        let end = simulated(&model, &parameters(&model, &robot, &[Role::CoulombFriction]), &values);
        for (found, expected) in end.iter().zip(&values.end) {
            assert!((found - expected).abs() <= SIMULATED, "{name}: {found} against {expected}");
        }
    }
}

fn compare(folder: &str, values: &str, models: usize) {
    let values: Values = toml::from_str(values).unwrap();
    assert_eq!(values.model.len(), models);
    values.model.iter().for_each(|values| compare_robot(&robot(folder, &values.name), values));
}

fn compare_robot(robot: &Robot, ModelValues { name, joints, state, .. }: &ModelValues) {
    let (model, joints) = (Model::new(robot), *joints);
    assert_eq!(robot.coordinate_count(), joints, "{name}");
    let full = parameters(&model, robot, &[Role::CoulombFriction]);
    let links = parameters(&model, robot, &[Role::CoulombFriction, Role::ViscousFriction, Role::Load]);
    for state in state {
        let mut mass = vec![0.0; joints * joints];
        model.mass_matrix(&full, &state.q, &mut Workspace::new(&model), &mut mass);
        same(&mass, &state.mass, &format!("{name}, mass matrix"));
        same(&torques(&model, &links, state, &vec![0.0; joints]), &state.bias, &format!("{name}, bias forces"));
        same(&torques(&model, &full, state, &state.ddq), &state.tau, &format!("{name}, inverse dynamics"));
    }
}

/// The Delta and the ankle of `robots`, whose rods are distances, are the models whose rods are tendons.
#[test]
fn mechanisms_with_rods_are_those_of_mujoco() {
    let values: Values = toml::from_str(include_str!("loops.toml")).unwrap();
    for (file, name) in [("delta.toml", "delta_rods"), ("ankle.toml", "ankle_rods")] {
        let robots = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../robots");
        let values = values.model.iter().find(|values| values.name == name).unwrap();
        compare_robot(&Robot::read(&robots.join(file)).unwrap(), values);
    }
}

#[test]
fn friction_is_the_frictionloss_of_mujoco() {
    let values: Values = toml::from_str(VALUES).unwrap();
    for ModelValues { name, frictionloss, .. } in values.model {
        let robot = robot("models", &name);
        let (table, theta) = (robot.parameter_table(), robot.a_priori_parameters());
        let of_coordinate = |parameter: &crate::robot::Parameter| robot.joints[parameter.number - 1].mimic.is_none();
        let is_friction = |quantity: Quantity| quantity.is_coulomb_friction() && !quantity.is_coupled_motor();
        let found = table.iter().zip(&theta).filter(|(p, _)| is_friction(p.quantity) && of_coordinate(p));
        same(&found.map(|(_, value)| *value).collect::<Vec<_>>(), &frictionloss, &name);
    }
}

#[derive(Deserialize)]
struct FloatingValues {
    model: Vec<FloatingModel>,
}

#[derive(Deserialize)]
struct FloatingModel {
    name: String,
    state: Vec<FloatingState>,
}

#[derive(Deserialize)]
struct FloatingState {
    q: Vec<f64>,
    dq: Vec<f64>,
    ddq: Vec<f64>,
    tau: Vec<f64>,
}

/// Largest difference of a base that floats, relative to the largest entry: the angular velocity is along other axes in MuJoCo.
const TURNED: f64 = 1e-8;

/// `phi theta` and inverse dynamics of the quadruped of `floating`, with the free joint's values turned by `make_floating.py`.
#[test]
fn a_base_that_floats_is_that_of_mujoco() {
    let values: FloatingValues = toml::from_str(include_str!("floating.toml")).unwrap();
    assert_eq!(values.model.len(), 1);
    for FloatingModel { name, state } in values.model {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/dynamics/mujoco_reference/floating/floating.toml");
        let text = format!("mjcf = '{name}.xml'\nfloating_base = true\n");
        let robot = Robot::parse(&text, &path).unwrap();
        let (model, mut theta) = (Model::new(&robot), robot.a_priori_parameters());
        let is_dry = |quantity: Quantity| quantity.role() == Role::CoulombFriction;
        let table = model.parameter_table();
        theta.iter_mut().zip(table.iter()).filter(|(_, p)| is_dry(p.quantity)).for_each(|(value, _)| *value = 0.0);
        assert_eq!((robot.coordinate_count(), robot.base_coordinates(), robot.root_joint()), (18, 6, Some(5)));
        let all: Vec<usize> = (0..theta.len()).collect();
        let regressor = crate::regressor::Regressor::new(&model, &all);
        for FloatingState { q, dq, ddq, tau } in state {
            let row = |values: &[f64]| thetahat_ground::series::Series::shaped(values.len(), values.to_vec());
            let found = regressor.torques(&model, [&row(&q), &row(&dq), &row(&ddq)], Sign::Exact, &theta);
            let mut inverse = vec![0.0; q.len()];
            let parameters = DynamicParameters::new(&model, &theta).unwrap();
            let at = State::new(&q, &dq);
            model.inverse_dynamics(&parameters, at, &ddq, Sign::Exact, &mut Workspace::new(&model), &mut inverse);
            let largest = tau.iter().fold(ZERO, |largest, value| largest.max(value.abs()));
            for (expected, found) in tau.iter().zip(found.values()).chain(tau.iter().zip(&inverse)) {
                assert!((found - expected).abs() <= TURNED * largest, "{name}: {found} against {expected}");
            }
        }
    }
}
