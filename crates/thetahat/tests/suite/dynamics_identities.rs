//! Identities of mechanics on seeded random robots, and closed forms: no data needed.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::{fmt::Write, path::Path};
use thetahat::{
    Robot,
    dynamics::{DynamicParameters, DynamicsError, Model, Sign, State, Workspace},
    regressor::Regressor,
    robot::{Friction, Parameter},
};
use thetahat_testing::assert_close;

const SMOOTH: Sign = Sign::smooth(0.3);

/// A chain of `joints` random joints with a random coupling matrix near the identity.
fn random_chain(joints: usize, friction: &str, rng: &mut ChaCha8Rng) -> Robot {
    let mut text = format!("name = \"random\"\ngravity = [1.0, -2.0, -9.0]\nfriction = \"{friction}\"\n");
    for j in 0..joints {
        write_joint(&mut text, j, rng);
    }
    write_coupling(&mut text, joints);
    Robot::parse(&text, Path::new("random.toml")).unwrap()
}

/// A tree of `joints` random joints in Khalil's form; from the third on, some follow others.
fn random_tree(joints: usize, friction: &str, rng: &mut ChaCha8Rng) -> Robot {
    let mut text = format!("name = \"random\"\ngravity = [1.0, -2.0, -9.0]\nfriction = \"{friction}\"\n");
    let mut coordinates = joints;
    for j in 0..joints {
        write_joint(&mut text, j, rng);
        writeln!(text, "gamma_deg = {}\nb_m = {}", rng.random_range(-180.0..180.0), rng.random_range(-1.0..1.0))
            .unwrap();
        if j > 0 && rng.random_bool(0.8) {
            writeln!(text, "parent = \"j{}\"", rng.random_range(0..j)).unwrap();
        }
        if j > 1 && rng.random_bool(0.4) {
            let (leader, ratio) = (rng.random_range(0..j), rng.random_range(-2.0..2.0));
            writeln!(text, "mimic = {{ joint = \"j{leader}\", ratio = {ratio} }}").unwrap();
            coordinates -= 1;
        }
    }
    write_coupling(&mut text, coordinates);
    Robot::parse(&text, Path::new("random.toml")).unwrap()
}

fn write_joint(text: &mut String, j: usize, rng: &mut ChaCha8Rng) {
    let kind = if rng.random_bool(0.3) { "prismatic" } else { "revolute" };
    let mut value = || rng.random_range(-1.0..1.0);
    let (a, d, alpha, theta) = (value(), value(), 180.0 * value(), 180.0 * value());
    writeln!(text, "[[joint]]\nname = \"j{j}\"\nkind = \"{kind}\"\na_m = {a}\nd_m = {d}").unwrap();
    writeln!(text, "alpha_deg = {alpha}\ntheta_deg = {theta}").unwrap();
}

fn write_coupling(text: &mut String, n: usize) {
    let entry = |i: usize, j: usize| match i {
        _ if i == j => 10.0,
        _ if j + 1 == i => 4.0,
        _ => 0.0,
    };
    let rows: Vec<String> = (0..n).map(|i| format!("{:?}", (0..n).map(|j| entry(i, j)).collect::<Vec<_>>())).collect();
    writeln!(text, "[transmission]\nmatrix = [{}]", rows.join(", ")).unwrap();
}

/// A tree from a URDF with skew axes, a fixed joint and a follower.
fn random_urdf(joints: usize, rng: &mut ChaCha8Rng) -> Robot {
    let mut text = "<robot name=\"random\"><link name=\"l0\"/>".to_owned();
    for j in 1..=joints {
        let kind = ["continuous", "prismatic", "revolute"][rng.random_range(0..3)];
        let kind = if j == 3 { "fixed" } else { kind };
        let mut three = || [0; 3].map(|_| rng.random_range(-1.0..1.0).to_string()).join(" ");
        let (xyz, rpy, axis) = (three(), three(), three());
        let parent = rng.random_range(0..j);
        let mimic = if j == 5 { "<mimic joint=\"j1\" multiplier=\"-1.5\" offset=\"0.2\"/>" } else { "" };
        write!(
            text,
            "<link name=\"l{j}\"/><joint name=\"j{j}\" type=\"{kind}\"><parent link=\"l{parent}\"/><child link=\"l{j}\"/>\
             <origin xyz=\"{xyz}\" rpy=\"{rpy}\"/><axis xyz=\"{axis}\"/>{mimic}</joint>"
        )
        .unwrap();
    }
    Robot::parse(&(text + "</robot>"), Path::new("random.urdf")).unwrap()
}

/// Parameters of real bodies: each link is a cloud of point masses; motor inertias and friction are positive.
fn physical_parameters(robot: &Robot, rng: &mut ChaCha8Rng) -> Vec<f64> {
    let table = robot.parameter_table();
    let mut theta: Vec<f64> = table.iter().map(|_| rng.random_range(0.1..1.0)).collect();
    for j in 1..=robot.link_count() {
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
        DynamicParameters::sorted(&self.model, &self.theta)
    }

    fn torques(&self, q: &[f64], dq: &[f64], ddq: &[f64]) -> Vec<f64> {
        let mut tau = vec![0.0; self.n];
        let mut workspace = Workspace::new(&self.model);
        self.model.inverse_dynamics(&self.parameters(), State::new(q, dq), ddq, SMOOTH, &mut workspace, &mut tau);
        tau
    }
}

impl Case {
    fn new(robot: Robot, rng: &mut ChaCha8Rng) -> Self {
        let theta = physical_parameters(&robot, rng);
        Self { model: Model::new(&robot), n: robot.coordinate_count(), robot, theta }
    }
}

fn for_random_robots(check: impl Fn(&Case, &mut ChaCha8Rng)) {
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    for k in 0..20 {
        let n = 1 + k % 7;
        let friction = Friction::ALL[k % Friction::ALL.len()].name();
        let robots =
            [random_chain(n, friction, &mut rng), random_tree(n + 2, friction, &mut rng), random_urdf(n + 1, &mut rng)];
        for robot in robots {
            let case = Case::new(robot, &mut rng);
            check(&case, &mut rng);
        }
    }
}

#[test]
fn phi_theta_is_inverse_dynamics() {
    for_random_robots(|case, rng| {
        let [q, dq, ddq] = state(case.n, rng);
        let all: Vec<usize> = (0..case.theta.len()).collect();
        let regressor = Regressor::new(&case.model, &all);
        let mut phi = vec![0.0; regressor.entries().len()];
        regressor.evaluate(&case.model, State::new(&q, &dq), &ddq, SMOOTH, &mut Workspace::new(&case.model), &mut phi);
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
        case.model
            .forward_dynamics(&case.parameters(), State::new(&q, &dq), &tau, SMOOTH, &mut workspace, &mut found)
            .unwrap();
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
        let parameters = DynamicParameters::sorted(&case.model, &without_losses);
        let mut workspace = Workspace::new(&case.model);
        let mut tau = vec![0.0; case.n];
        case.model.inverse_dynamics(&parameters, State::new(&q, &dq), &ddq, SMOOTH, &mut workspace, &mut tau);
        let power: f64 = tau.iter().zip(&dq).map(|(t, v)| t * v).sum();
        let mut energy_at = |h: f64| {
            let q: Vec<f64> = (0..case.n).map(|i| q[i] + h * dq[i] + 0.5 * h * h * ddq[i]).collect();
            let dq: Vec<f64> = (0..case.n).map(|i| dq[i] + h * ddq[i]).collect();
            case.model.energy(&parameters, State::new(&q, &dq), &mut workspace)
        };
        let h = 1e-4;
        assert_close((energy_at(h) - energy_at(-h)) / (2.0 * h), power, 1e-5, "power");
    });
}

/// Followers are a constraint `q_all = G q + offset`. With tau and M of the same tree in which no joint follows
/// another, the torques are `G^T tau` and the mass matrix is `G^T M G`.
#[test]
fn followers_are_a_constraint_on_the_free_tree() {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    for k in 0..20 {
        let robot = random_urdf(5 + k % 4, &mut rng);
        let mut free = robot.clone();
        free.joints.iter_mut().for_each(|joint| joint.mimic = None);
        free.transmission = thetahat::robot::Transmission::direct(free.link_count());
        let (case, free) = (Case::new(robot, &mut rng), free);
        let free =
            Case { model: Model::new(&free), n: free.coordinate_count(), theta: case.theta.clone(), robot: free };
        assert_eq!((case.n + 1, free.n), (free.n, case.robot.link_count()));
        // Row of G and offset of each joint.
        let coordinates = case.robot.coordinate_joints();
        let place = |joint: usize| coordinates.iter().position(|&c| c == joint).unwrap();
        let rows: Vec<(usize, f64, f64)> = (0..free.n)
            .map(|j| {
                case.robot.joints[j].mimic.map_or_else(|| (place(j), 1.0, 0.0), |m| (place(m.of), m.ratio, m.offset))
            })
            .collect();
        let [q, dq, ddq] = state(case.n, &mut rng);
        let all = |x: &[f64], offset: f64| rows.iter().map(|(c, g, o)| g * x[*c] + offset * o).collect::<Vec<f64>>();
        let of_free = free.torques(&all(&q, 1.0), &all(&dq, 0.0), &all(&ddq, 0.0));
        let mut expected = vec![0.0; case.n];
        rows.iter().zip(&of_free).for_each(|((c, g, _), tau)| expected[*c] += g * tau);
        for (a, b) in case.torques(&q, &dq, &ddq).iter().zip(expected) {
            assert_close(*a, b, 1e-11, "torque");
        }
        let mass = |case: &Case, q: &[f64]| {
            let mut m = vec![0.0; case.n * case.n];
            case.model.mass_matrix(&case.parameters(), q, &mut Workspace::new(&case.model), &mut m);
            m
        };
        let mut expected = vec![0.0; case.n * case.n];
        for (k, value) in mass(&free, &all(&q, 1.0)).iter().enumerate() {
            let ((c, g, _), (d, h, _)) = (rows[k / free.n], rows[k % free.n]);
            expected[c * case.n + d] += g * value * h;
        }
        for (a, b) in mass(&case, &q).iter().zip(expected) {
            assert_close(*a, b, 1e-11, "M");
        }
    }
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
    let robot =
        Robot::parse("name = \"p\"\n[[joint]]\nname = \"j\"\nkind = \"revolute\"\n", Path::new("p.toml")).unwrap();
    let model = Model::new(&robot);
    let is_motor_inertia = |p: &Parameter| p.quantity.is_motor_inertia();
    let theta: Vec<f64> =
        model.parameter_table().iter().map(|p| if is_motor_inertia(p) { -0.1 } else { 0.0 }).collect();
    let parameters = DynamicParameters::sorted(&model, &theta);
    let mut ddq = [0.0];
    let mut workspace = Workspace::new(&model);
    let result =
        model.forward_dynamics(&parameters, State::new(&[0.0], &[0.0]), &[1.0], SMOOTH, &mut workspace, &mut ddq);
    assert!(matches!(result, Err(DynamicsError::MassMatrixNotPositiveDefinite { joint: 1, .. })));
}
