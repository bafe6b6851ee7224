//! Identities of mechanics on seeded random robots, and closed forms: no data needed.

mod common;

use common::assert_close;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::{fmt::Write, path::Path};
use thetahat::{
    dynamics::{DynamicParameters, DynamicsError, Model, Sign, Workspace},
    regressor::Regressor,
    robot::Robot,
};

const SMOOTH: Sign = Sign::Smooth { scale: 0.3 };

/// A chain of `joints` random joints with a random coupling matrix near the identity.
fn random_robot(joints: usize, friction: &str, rng: &mut ChaCha8Rng) -> Robot {
    let mut text = format!("name = \"random\"\ngravity = [1.0, -2.0, -9.0]\nfriction = \"{friction}\"\n");
    for j in 0..joints {
        let kind = if rng.random_bool(0.3) { "prismatic" } else { "revolute" };
        let mut value = || rng.random_range(-1.0..1.0);
        let (a, d, alpha, theta) = (value(), value(), 180.0 * value(), 180.0 * value());
        writeln!(text, "[[joint]]\nname = \"j{j}\"\nkind = \"{kind}\"\na_m = {a}\nd_m = {d}").unwrap();
        writeln!(text, "alpha_deg = {alpha}\ntheta_deg = {theta}").unwrap();
    }
    let row = |i: usize| {
        (0..joints).map(move |j| {
            if i == j {
                10.0
            } else if j + 1 == i {
                4.0
            } else {
                0.0
            }
        })
    };
    let rows: Vec<String> = (0..joints).map(|i| format!("{:?}", row(i).collect::<Vec<_>>())).collect();
    writeln!(text, "[transmission]\nmatrix = [{}]", rows.join(", ")).unwrap();
    Robot::parse(&text, Path::new("random.toml")).unwrap()
}

/// Parameters of real bodies: each link is a cloud of point masses; motor inertias and friction are positive.
fn physical_parameters(robot: &Robot, rng: &mut ChaCha8Rng) -> Vec<f64> {
    let table = robot.parameter_table();
    let mut theta: Vec<f64> = table.iter().map(|_| rng.random_range(0.1..1.0)).collect();
    for j in 1..=robot.joint_count() {
        let mut set = |name: &str, value: f64, add: bool| {
            let i = table.index_of(&format!("{name}{j}")).unwrap();
            theta[i] = if add { theta[i] + value } else { value };
        };
        for name in ["xx", "xy", "xz", "yy", "yz", "zz", "mx", "my", "mz", "m"] {
            set(name, 0.0, false);
        }
        for _ in 0..5 {
            let [x, y, z, m] = [0; 4].map(|_| rng.random_range(-1.0..1.0f64));
            let m = m.abs();
            let values = [
                ("xx", y * y + z * z),
                ("xy", -x * y),
                ("xz", -x * z),
                ("yy", x * x + z * z),
                ("yz", -y * z),
                ("zz", x * x + y * y),
                ("mx", x),
                ("my", y),
                ("mz", z),
                ("m", 1.0),
            ];
            values.iter().for_each(|(name, v)| set(name, m * v, true));
        }
    }
    for (value, parameter) in theta.iter_mut().zip(table.iter()) {
        if parameter.name().starts_with("iam") {
            *value *= 0.1;
        }
    }
    theta
}

fn state(n: usize, rng: &mut ChaCha8Rng) -> [Vec<f64>; 3] {
    [2.0, 3.0, 5.0].map(|range| (0..n).map(|_| rng.random_range(-range..range)).collect())
}

struct Case {
    robot: Robot,
    model: Model,
    theta: Vec<f64>,
    n: usize,
}

impl Case {
    fn parameters(&self) -> DynamicParameters {
        DynamicParameters::new(&self.model, &self.theta)
    }

    fn torques(&self, q: &[f64], dq: &[f64], ddq: &[f64]) -> Vec<f64> {
        let mut tau = vec![0.0; self.n];
        let mut workspace = Workspace::new(&self.model);
        self.model.inverse_dynamics(&self.parameters(), q, dq, ddq, SMOOTH, &mut workspace, &mut tau);
        tau
    }
}

fn for_random_robots(check: impl Fn(&Case, &mut ChaCha8Rng)) {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    for k in 0..20 {
        let n = 1 + k % 7;
        let robot = random_robot(n, if k % 2 == 0 { "symmetric" } else { "asymmetric" }, &mut rng);
        let theta = physical_parameters(&robot, &mut rng);
        check(&Case { model: Model::new(&robot), robot, theta, n }, &mut rng);
    }
}

#[test]
fn phi_theta_is_inverse_dynamics() {
    for_random_robots(|case, rng| {
        let [q, dq, ddq] = state(case.n, rng);
        let all: Vec<usize> = (0..case.theta.len()).collect();
        let regressor = Regressor::new(&case.model, &all);
        let mut phi = vec![0.0; regressor.entries().len()];
        regressor.evaluate(&case.model, &q, &dq, &ddq, SMOOTH, &mut Workspace::new(&case.model), &mut phi);
        let mut tau = vec![0.0; case.n];
        for (entry, value) in regressor.entries().iter().zip(&phi) {
            tau[entry.joint] += value * case.theta[entry.column];
        }
        for (a, b) in tau.iter().zip(case.torques(&q, &dq, &ddq)) {
            assert_close(*a, b, 1e-11, "torque");
        }
    });
}

#[test]
fn mass_matrix_is_the_derivative_of_the_torque() {
    for_random_robots(|case, rng| {
        let [q, dq, ddq] = state(case.n, rng);
        let mut m = vec![0.0; case.n * case.n];
        case.model.mass_matrix(&case.parameters(), &q, &mut Workspace::new(&case.model), &mut m);
        let tau = case.torques(&q, &dq, &ddq);
        for j in 0..case.n {
            let mut moved = ddq.clone();
            moved[j] += 1.0;
            for (i, (a, b)) in case.torques(&q, &dq, &moved).iter().zip(&tau).enumerate() {
                assert_close(a - b, m[i * case.n + j], 1e-10, "M");
            }
        }
    });
}

#[test]
fn forward_dynamics_undoes_inverse_dynamics() {
    for_random_robots(|case, rng| {
        let [q, dq, ddq] = state(case.n, rng);
        let tau = case.torques(&q, &dq, &ddq);
        let mut found = vec![0.0; case.n];
        let mut workspace = Workspace::new(&case.model);
        case.model.forward_dynamics(&case.parameters(), &q, &dq, &tau, SMOOTH, &mut workspace, &mut found).unwrap();
        for (a, b) in found.iter().zip(&ddq) {
            assert_close(*a, *b, 1e-9, "acceleration");
        }
    });
}

/// The power of the torques, less what friction and offsets take, is the rate of the energy: the energy is differenced
/// along the motion, and shares nothing with Newton-Euler but the placements.
#[test]
fn energy_balances() {
    for_random_robots(|case, rng| {
        let [q, dq, ddq] = state(case.n, rng);
        let without_losses: Vec<f64> = case
            .robot
            .parameter_table()
            .iter()
            .zip(&case.theta)
            .map(|(p, v)| if p.quantity.is_inertial() || p.quantity.is_motor_inertia() { *v } else { 0.0 })
            .collect();
        let parameters = DynamicParameters::new(&case.model, &without_losses);
        let mut workspace = Workspace::new(&case.model);
        let mut tau = vec![0.0; case.n];
        case.model.inverse_dynamics(&parameters, &q, &dq, &ddq, SMOOTH, &mut workspace, &mut tau);
        let power: f64 = tau.iter().zip(&dq).map(|(t, v)| t * v).sum();
        let mut energy_at = |h: f64| {
            let q: Vec<f64> = (0..case.n).map(|i| q[i] + h * dq[i] + 0.5 * h * h * ddq[i]).collect();
            let dq: Vec<f64> = (0..case.n).map(|i| dq[i] + h * ddq[i]).collect();
            case.model.energy(&parameters, &q, &dq, &mut workspace)
        };
        let h = 1e-4;
        assert_close((energy_at(h) - energy_at(-h)) / (2.0 * h), power, 1e-5, "power");
    });
}

#[test]
fn a_pendulum_has_its_closed_form() {
    let text = "name = \"p\"\n[[joint]]\nname = \"j\"\nkind = \"revolute\"\nalpha_deg = 90\n[parameters]\n\
                m1 = 2.0\nmx1 = 1.0\nzz1 = 0.6\nia1 = 0.1\nfv1 = 0.3\nfc1 = 0.2\noff1 = 0.05\n";
    let robot = Robot::parse(text, Path::new("p.toml")).unwrap();
    let model = Model::new(&robot);
    let theta = robot.a_priori_parameters();
    let case = Case { robot, model, theta, n: 1 };
    let (q, dq, ddq) = (0.4f64, 1.3f64, -2.0);
    let expected = 0.7 * ddq + 9.81 * q.cos() + 0.3 * dq + 0.2 * (dq / 0.3).tanh() + 0.05;
    assert_close(case.torques(&[q], &[dq], &[ddq])[0], expected, 1e-13, "torque");
}

/// Two equal links in the plane: the textbook's mass matrix and centrifugal torque.
#[test]
fn a_planar_arm_of_two_links_has_its_closed_form() {
    let text = "name = \"p\"\ngravity = [0, 0, 0]\n[[joint]]\nname = \"a\"\nkind = \"revolute\"\n\
                [[joint]]\nname = \"b\"\nkind = \"revolute\"\na_m = 0.5\n[parameters]\nzz1 = 0.3\nzz2 = 0.2\nm2 = 2.0\nmx2 = 0.6\n";
    let robot = Robot::parse(text, Path::new("p.toml")).unwrap();
    let model = Model::new(&robot);
    let theta = robot.a_priori_parameters();
    let case = Case { robot, model, theta, n: 2 };
    let (q, dq, ddq) = ([0.2, 0.9f64], [1.1, -0.7], [0.4, 2.0]);
    let (l, c, s) = (0.5, q[1].cos(), q[1].sin());
    let m11 = 0.3 + 0.2 + 2.0 * l * l + 2.0 * l * 0.6 * c;
    let m12 = 0.2 + l * 0.6 * c;
    let h = l * 0.6 * s;
    let expected = [
        m11 * ddq[0] + m12 * ddq[1] - h * (2.0 * dq[0] * dq[1] + dq[1] * dq[1]),
        m12 * ddq[0] + 0.2 * ddq[1] + h * dq[0] * dq[0],
    ];
    for (a, b) in case.torques(&q, &dq, &ddq).iter().zip(expected) {
        assert_close(*a, b, 1e-13, "torque");
    }
}

#[test]
fn a_mass_matrix_that_is_not_positive_definite_is_named() {
    let robot = Robot::parse(
        "name = \"p\"\n[[joint]]\nname = \"j\"\nkind = \"revolute\"\n[parameters]\nia1 = -0.1\n",
        Path::new("p.toml"),
    )
    .unwrap();
    let model = Model::new(&robot);
    let parameters = DynamicParameters::new(&model, &robot.a_priori_parameters());
    let mut ddq = [0.0];
    let mut workspace = Workspace::new(&model);
    let result = model.forward_dynamics(&parameters, &[0.0], &[0.0], &[1.0], SMOOTH, &mut workspace, &mut ddq);
    assert!(matches!(result, Err(DynamicsError::MassMatrixNotPositiveDefinite { joint: 1, .. })));
}
