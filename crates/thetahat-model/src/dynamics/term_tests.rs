//! All kinds of terms on one robot, tested by mechanics: potentials, central differences, identities.

use std::path::Path;

use super::{DynamicParameters, Jacobian, Model, Sign, State, Workspace};
use crate::{
    regressor::Regressor,
    robot::{JointKind, Robot, RobotError},
};
use thetahat_ground::{
    series::Series,
    vector::{Vec3, add, norm, times},
};
use thetahat_testing::ROBOT_WITH_TERMS;

const SIGN: Sign = Sign::smooth(0.1);

struct Case {
    robot: Robot,
    model: Model,
    theta: Vec<f64>,
}

fn case() -> Case {
    let robot = Robot::parse(ROBOT_WITH_TERMS, Path::new("all.toml")).unwrap();
    let model = Model::new(&robot);
    let theta = (0..model.parameter_table().len()).map(|i| (1.7 * i as f64).sin()).collect();
    Case { robot, model, theta }
}

const DDQ: [f64; 3] = [2.0, -1.0, 3.0];

impl Case {
    fn torques(&self, theta: &[f64], state: &[f64]) -> [f64; 3] {
        let (q, dq) = state.split_at(3);
        let (mut tau, mut workspace) = ([0.0; 3], Workspace::new(&self.model));
        let parameters = DynamicParameters::sorted(&self.model, theta);
        self.model.inverse_dynamics(&parameters, State::new(q, dq), &DDQ, SIGN, &mut workspace, &mut tau);
        tau
    }

    /// The torques for a unit of one parameter.
    fn torques_of(&self, name: &str, state: &[f64]) -> [f64; 3] {
        let mut unit = vec![0.0; self.theta.len()];
        unit[self.model.parameter_table().index_of(name).unwrap()] = 1.0;
        self.torques(&unit, state)
    }

    /// A point of link `joint` in the base frame, by matrices.
    fn point(&self, joint: Option<usize>, point: Vec3, q: &[f64]) -> Vec3 {
        let Some(j) = joint else { return point };
        let of = &self.robot.joints[j];
        let own = self.model.coordinate_of(j);
        let value = own.ratio * q[own.coordinate] + own.offset;
        let placed = match of.kind {
            crate::robot::JointKind::Revolute => {
                let (s, c) = value.sin_cos();
                times(&[[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]], point)
            }
            crate::robot::JointKind::Prismatic => add(point, [0.0, 0.0, value]),
        };
        self.point(of.parent, add(of.placement.origin, times(&of.placement.rotation(), placed)), q)
    }

    fn distance(&self, ends: [(Option<usize>, Vec3); 2], q: &[f64]) -> f64 {
        let [a, b] = ends.map(|(joint, point)| self.point(joint, point, q));
        norm([0, 1, 2].map(|i| a[i] - b[i]))
    }
}

const STATES: [[f64; 6]; 3] =
    [[0.3, -0.2, 1.1, 0.07, -0.6, 0.9], [-1.4, 0.3, 0.2, 0.5, 0.02, -1.3], [2.2, 0.1, -0.9, -0.3, 0.4, 0.001]];

/// The gradient of an energy, by central differences.
fn gradient(energy: impl Fn(&[f64]) -> f64, q: &[f64]) -> [f64; 3] {
    [0, 1, 2].map(|c| {
        let moved = |by: f64| {
            let mut q = q.to_vec();
            q[c] += by;
            energy(&q)
        };
        (moved(1e-5) - moved(-1e-5)) / 2e-5
    })
}

/// The torque that holds a spring is the gradient of its energy.
#[test]
fn springs_have_their_potentials() {
    let case = case();
    let first = [(None, [0.5, -0.8, 0.9]), (Some(2), [0.1, 0.2, -0.3])];
    let second = [(Some(3), [0.3, 0.1, 0.0]), (Some(2), [-0.2, 0.25, 0.1])];
    let third = [(None, [-0.6, 0.3, 1.0]), (Some(1), [0.2, 0.0, 0.1])];
    let half_square = |x: f64| 0.5 * x * x;
    type Energy<'a> = Box<dyn Fn(&[f64]) -> f64 + 'a>;
    let energies: [(&str, Energy<'_>); 8] = [
        ("k1", Box::new(|q| half_square(q[0] - 25f64.to_radians()))),
        ("k4", Box::new(|q| half_square(-1.5 * q[0] - 25f64.to_radians()))),
        ("k2", Box::new(|q| half_square(q[1]))),
        ("kr2", Box::new(|q| q[1])),
        ("k_first", Box::new(|q| half_square(case.distance(first, q) - 0.6))),
        ("f_second", Box::new(|q| -case.distance(second, q))),
        ("k_second", Box::new(|q| half_square(case.distance(second, q) - 0.9))),
        // The work done on the gas: the integral of (h / (h - x))^n.
        ("f_third", Box::new(|q| 0.8 / 0.2 * (0.8 / (0.8 - (case.distance(third, q) - 1.0))).powf(0.2))),
    ];
    for (name, energy) in energies {
        for state in STATES {
            let expected = gradient(&energy, &state[..3]);
            for (found, expected) in case.torques_of(name, &state).iter().zip(expected) {
                assert!((found - expected).abs() < 1e-8 * (1.0 + expected.abs()), "{name}: {found} {expected}");
            }
        }
    }
}

#[test]
fn load_friction_is_by_the_torque_of_gravity() {
    let case = case();
    let a_priori = case.robot.a_priori_parameters();
    for state in STATES {
        let still: Vec<f64> = state[..3].iter().chain(&[0.0; 3]).copied().collect();
        let mut gravity = [0.0; 3];
        let parameters = DynamicParameters::sorted(&case.model, &a_priori);
        let (q, dq) = still.split_at(3);
        let state_at_rest = State::new(q, dq);
        case.model.inverse_dynamics(
            &parameters,
            state_at_rest,
            &[0.0; 3],
            SIGN,
            &mut Workspace::new(&case.model),
            &mut gravity,
        );
        for (j, name) in ["fl1", "fl2", "fl3"].iter().enumerate() {
            let found = case.torques_of(name, &state)[j];
            let expected = gravity[j].abs() * SIGN.of(state[3 + j], JointKind::Revolute);
            assert!((found - expected).abs() < 1e-12 * (1.0 + expected.abs()), "{name}: {found} {expected}");
        }
    }
}

#[test]
fn friction_follows_its_formulas() {
    let case = case();
    for state in STATES {
        let (v, s) = (state[5], SIGN.of(state[5], JointKind::Revolute));
        for (name, expected) in [
            ("fs3", s * (-(v.abs() / 0.4).powf(1.3)).exp()),
            ("fvq3", v * v.abs()),
            ("fvc3", v.powi(3)),
            ("fva3", v * s),
            ("hs0.05_1", (0.05 * 45.0 * state[0]).sin()),
            ("own", (2.0 * state[2]).sin() * state[3] + 0.3 * s * v.abs().powf(0.7) + state[1].powi(2)),
        ] {
            let joint = usize::from(!name.ends_with("_1")) * 2;
            let found = case.torques_of(name, &state)[joint];
            assert!((found - expected).abs() < 1e-12 * (1.0 + expected.abs()), "{name}: {found} {expected}");
        }
        // Motor 3 turns with coordinates 1 and 3: its ripple acts on both.
        let ripple = (0.1 * (3.0 * state[0] + 32.0 * state[2])).cos();
        let found = case.torques_of("hc0.1_3", &state);
        assert!((found[2] - ripple).abs() < 1e-12 && (found[0] - 3.0 / 32.0 * ripple).abs() < 1e-12, "{found:?}");
    }
}

#[test]
fn phi_theta_is_inverse_dynamics_alone_and_side_by_side() {
    let Case { model, theta, .. } = &case();
    let all: Vec<usize> = (0..theta.len()).collect();
    let regressor = Regressor::new(model, &all);
    let column = |range: std::ops::Range<usize>| {
        let values = (0..9).flat_map(|k| STATES[k % 3][range.clone()].to_vec()).collect();
        Series::shaped(3, values)
    };
    let (q, dq) = (column(0..3), column(3..6));
    let ddq = Series::shaped(3, DDQ.repeat(9));
    let phi = regressor.evaluate_series(model, &q, &dq, &ddq, SIGN);
    for k in 0..9 {
        let mut tau = [0.0; 3];
        for (entry, value) in regressor.entries().iter().zip(phi.sample(k)) {
            tau[entry.joint] += value * theta[entry.column];
        }
        assert_eq!(phi.sample(k), phi.sample(k % 3), "side by side or alone");
        for (found, expected) in tau.iter().zip(case().torques(theta, &STATES[k % 3])) {
            assert!((found - expected).abs() < 1e-11 * (1.0 + expected.abs()), "{found} {expected}");
        }
    }
}

/// Sensitivities of simulations use these derivatives.
#[test]
fn derivatives_are_central_differences() {
    let case = case();
    let parameters = DynamicParameters::sorted(&case.model, &case.theta);
    for state in STATES {
        let [q, dq, ddq] = [&state[..3], &state[3..], &DDQ].map(|x| Series::shaped(3, x.to_vec()));
        let mut found = [Jacobian::zeros(3)];
        case.model.inverse_dynamics_jacobians(&parameters, [&q, &dq, &ddq], None, 0..1, SIGN, &mut found);
        let mut damping = [0.0; 9];
        case.model.damping_into(
            &parameters,
            State::new(&state[..3], &state[3..]),
            SIGN,
            &mut Default::default(),
            &mut damping,
        );
        for direction in 0..6 {
            let moved = |by: f64| {
                let mut state = state;
                state[direction] += by;
                case.torques(&case.theta, &state)
            };
            let (above, below) = (moved(1e-6), moved(-1e-6));
            let rows = if direction < 3 { &found[0].by_position } else { &found[0].by_velocity };
            for i in 0..3 {
                let (value, expected) = (rows[i * 3 + direction % 3], (above[i] - below[i]) / 2e-6);
                assert!(
                    (value - expected).abs() < 1e-6 * (1.0 + expected.abs()),
                    "{direction} {i}: {value} {expected}"
                );
            }
        }
    }
}

#[test]
fn what_cannot_be_a_term_is_named() {
    let message = |from: &str, to: &str| match Robot::parse(&ROBOT_WITH_TERMS.replace(from, to), Path::new("all.toml"))
    {
        Err(RobotError::Term { source, .. }) => source.to_string(),
        Err(other) => other.to_string(),
        Ok(_) => "read".to_owned(),
    };
    assert_eq!(
        message("joints = [\"b\"]", "joints = [\"e\"]"),
        "[[term]] 2 (joint-spring): the robot has no joint `e`; its joints are a, b, c, d"
    );
    assert_eq!(
        message("exponent = 1.3", "exponent = 30"),
        "[[term]] 3 (exponential-stribeck): exponent is 30, expected from 0.3 to 10"
    );
    assert_eq!(
        message("joints = [\"b\"]", "joints = [\"b\"]\nrest_deg = 3"),
        "[[term]] 2 (joint-spring): rest_deg is 3, expected rest_m: the joint is prismatic"
    );
    assert_eq!(
        message("name = \"second\"", "name = \"first\""),
        "[[term]] 9 (gas-spring): its parameter k_first exists already; state each law once for a joint, and give springs \
         and expressions names of their own"
    );
    assert!(
        message("q2^2", "log(q2)")
            .starts_with("[[term]] 11 (expression): expression `sin(2*q) * dq1 + 0.3*s*abs(dq)^0.7 + log(q2)`: it is ")
    );
    assert_eq!(
        message("link_of = \"c\", point_m = [-0.2", "link_of = \"d\", point_m = [-0.2"),
        "[[term]] 9 (gas-spring): to.link_of is d, expected another link than from: a force inside one link moves nothing"
    );
    assert!(message("velocity = 0.4", "speed = 0.4").contains("unknown field `speed`"));
}
