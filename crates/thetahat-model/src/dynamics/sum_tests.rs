//! A joint that follows a sum of joints, tested by closed forms, by the chain of joints that follow one each, by finite differences
//! and by the balance of energy.

use std::path::Path;

use super::{DynamicParameters, Model, Sign, State, Workspace};
use crate::{regressor::Regressor, robot::Robot};
use thetahat_ground::series::Series;

const GRAVITY: f64 = 9.81;
const SMOOTH: Sign = Sign::smooth(0.1);

fn robot(text: &str) -> Robot {
    Robot::parse(text, Path::new("r.toml")).unwrap()
}

/// Torques of a motion.
fn torques(robot: &Robot, [q, dq, ddq]: [&[f64]; 3]) -> Vec<f64> {
    let model = Model::new(robot);
    let parameters = DynamicParameters::new(&model, &robot.a_priori_parameters()).unwrap();
    let (mut tau, mut workspace) = (vec![0.0; q.len()], Workspace::new(&model));
    model.inverse_dynamics(&parameters, State::new(q, dq), ddq, SMOOTH, &mut workspace, &mut tau);
    tau
}

fn assert_near(found: &[f64], expected: &[f64], tolerance: f64) {
    let near = found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| (a - b).abs() < tolerance);
    assert!(near, "{found:?} {expected:?}");
}

/// A parallelogram, as in a palletiser: the upper arm and a crank turn on the base; a rod turns the forearm as the crank turns, so
/// that the forearm's joint is the crank's angle less that of the upper arm. Rod and loop have no mass.
fn parallelogram() -> Robot {
    let joint = |name: &str, more: &str| format!("[[joint]]\nname = '{name}'\nkind = 'revolute'\n{more}\n");
    let joints = [
        joint("arm", ""),
        joint("crank", ""),
        joint(
            "forearm",
            "parent = 'arm'\na_m = 0.5\nmimic = [{ joint = 'crank', ratio = 1 }, { joint = 'arm', ratio = -1 }]",
        ),
    ];
    // Depth first: the forearm, which the arm carries, comes before the crank.
    let links =
        "zz1 = 0.4\nmx1 = 0.9\nm1 = 4\nzz3 = 0.05\nm2 = 3\nmx2 = 0.8\nzz2 = 0.3\nfv2 = 0.6\nfc2 = 0.2\nia2 = 0.07\n";
    let text = format!("name = 'p'\ngravity = [0, -{GRAVITY}, 0]\n{}[parameters]\n{links}", joints.concat());
    robot(&text)
}

/// The equations of motion in the absolute angles of both arms, from the Lagrangian of the loop.
fn of_lagrangian([q, dq, ddq]: [&[f64]; 3]) -> [f64; 2] {
    const LENGTH: f64 = 0.5;
    let (inertia, first_moment, crank, mass, moment, forearm) = (0.4, 0.9, 0.05, 3.0, 0.8, 0.3);
    let (s, c) = (q[0] - q[1]).sin_cos();
    let coupling = moment * LENGTH;
    let upper = inertia + mass * LENGTH * LENGTH;
    let links = [
        upper * ddq[0]
            + coupling * (c * ddq[1] + s * dq[1] * dq[1])
            + GRAVITY * (first_moment + mass * LENGTH) * q[0].cos(),
        (crank + forearm) * ddq[1] + coupling * (c * ddq[0] - s * dq[0] * dq[0]) + GRAVITY * moment * q[1].cos(),
    ];
    // The forearm's own joint turns by the difference of both.
    let (rate, acceleration) = (dq[1] - dq[0], ddq[1] - ddq[0]);
    let drive = 0.07 * acceleration + 0.6 * rate + 0.2 * (rate / 0.1).tanh();
    [links[0] - drive, links[1] + drive]
}

#[test]
fn a_parallelogram_has_the_equations_of_its_lagrangian() {
    let robot = parallelogram();
    assert_eq!(robot.coordinate_count(), 2);
    for k in 0..20 {
        let at = |f: f64| [(f * k as f64).sin() * 1.4, (f * k as f64 + 1.0).cos() * 1.1];
        let [q, dq, ddq] = [0.7, 1.3, 2.1].map(at);
        let motion: [&[f64]; 3] = [&q, &dq, &ddq];
        assert_near(&torques(&robot, motion), &of_lagrangian(motion), 1e-12);
    }
}

/// A chain in space whose fourth joint follows two others and whose last slides with the first and the fourth.
fn sum_and_steps() -> [Robot; 2] {
    let joint = |name: &str, kind: &str, place: &str, mimic: &str| {
        format!("[[joint]]\nname = '{name}'\nkind = '{kind}'\n{place}\n{mimic}\n")
    };
    let first = [
        joint("a", "revolute", "alpha_deg = 20", ""),
        joint("b", "revolute", "alpha_deg = 90\na_m = 0.3", ""),
        joint("c", "prismatic", "alpha_deg = -50\nd_m = 0.2", ""),
    ]
    .concat();
    let tip = "alpha_deg = 35\na_m = 0.15\nd_m = 0.1";
    let sum = joint(
        "d",
        "revolute",
        tip,
        "mimic = [{ joint = 'a', ratio = 0.3 }, { joint = 'b', ratio = -1.7, offset_deg = 25 }]",
    );
    let steps = joint("s", "revolute", tip, "mimic = { joint = 'a', ratio = 0.3 }")
        + &joint("d", "revolute", "", "mimic = { joint = 'b', ratio = -1.7, offset_deg = 25 }");
    let own = |n: usize| {
        format!(
            "m{n} = 2\nmx{n} = 0.2\nmy{n} = -0.1\nmz{n} = 0.3\nxx{n} = 0.4\nyy{n} = 0.5\nzz{n} = 0.6\nxy{n} = 0.05\n"
        )
    };
    let text = |last: &str, n: usize| {
        format!(
            "name = 'r'\n{first}{last}[parameters]\n{}{}{}{}fv1 = 0.4\nia2 = 0.2\nfc3 = 1\n",
            own(1),
            own(2),
            own(3),
            own(n)
        )
    };
    [robot(&text(&sum, 4)), robot(&text(&steps, 5))]
}

const STATE: [[f64; 3]; 3] = [[0.4, -1.1, 0.3], [1.3, -0.8, 0.5], [2.0, 5.0, -1.0]];

/// The links move as by the chain of joints that follow one each.
#[test]
fn a_sum_moves_its_link_as_its_shares_one_after_the_other() {
    let [sum, steps] = sum_and_steps().map(|robot| torques(&robot, [&STATE[0], &STATE[1], &STATE[2]]));
    assert_near(&sum, &steps, 1e-12);
}

/// The sum with friction and inertia of its own joint.
fn with_drive() -> Robot {
    let mut robot = sum_and_steps()[0].clone();
    robot.a_priori.extend([("fv4", 0.7), ("fc4", 0.9), ("ia4", 0.05), ("off4", 0.3)].map(|(n, v)| (n.to_owned(), v)));
    robot
}

/// `phi theta` is the torque of inverse dynamics, with the friction of the joint that follows.
#[test]
fn the_regressor_gives_the_torques_of_inverse_dynamics() {
    let robot = with_drive();
    let model = Model::new(&robot);
    let all: Vec<usize> = (0..model.parameter_table().len()).collect();
    let [q, dq, ddq] = STATE.map(|values| Series::from_values(3, values.to_vec()).unwrap());
    let found = Regressor::new(&model, &all).torques(&model, [&q, &dq, &ddq], SMOOTH, &robot.a_priori_parameters());
    assert_near(found.sample(0), &torques(&robot, [&STATE[0], &STATE[1], &STATE[2]]), 1e-12);
}

/// Accelerations from torques, and back: the mass matrix is the derivative of the torques.
#[test]
fn direct_dynamics_inverts_inverse_dynamics() {
    let robot = with_drive();
    let model = Model::new(&robot);
    let parameters = DynamicParameters::new(&model, &robot.a_priori_parameters()).unwrap();
    let mut workspace = Workspace::new(&model);
    let tau = torques(&robot, [&STATE[0], &STATE[1], &STATE[2]]);
    let mut ddq = [0.0; 3];
    let state = State::new(&STATE[0], &STATE[1]);
    model.forward_dynamics(&parameters, state, &tau, SMOOTH, &mut workspace, &mut ddq).unwrap();
    assert_near(&ddq, &STATE[2], 1e-9);
}

/// Without friction, the power of the torques is the change of kinetic and potential energy.
#[test]
fn the_power_of_the_torques_is_the_change_of_energy() {
    let robot = {
        let mut robot = sum_and_steps()[0].clone();
        robot.a_priori.retain(|name, _| !name.starts_with('f'));
        robot.a_priori.insert("ia4".to_owned(), 0.3);
        robot
    };
    let zero = [0.0; 3];
    let at = |t: f64| {
        let place = |j: usize| STATE[0][j] + STATE[1][j] * t + 0.5 * STATE[2][j] * t * t;
        let rate = |j: usize| STATE[1][j] + STATE[2][j] * t;
        ([0, 1, 2].map(place), [0, 1, 2].map(rate))
    };
    // Kinetic energy is half of dq M dq, where M dq are the torques of the accelerations dq less those of rest.
    let kinetic = |t: f64| {
        let (q, dq) = at(t);
        let [moving, resting] = [dq, zero].map(|ddq| torques(&robot, [&q, &zero, &ddq]));
        0.5 * (0..3).map(|j| dq[j] * (moving[j] - resting[j])).sum::<f64>()
    };
    let power = |t: f64| {
        let (q, dq) = at(t);
        let [all, weight] = [torques(&robot, [&q, &dq, &STATE[2]]), torques(&robot, [&q, &zero, &zero])];
        (0..3).map(|j| dq[j] * (all[j] - weight[j])).sum::<f64>()
    };
    let step = 1e-4;
    let change = (kinetic(step) - kinetic(-step)) / (2.0 * step);
    assert!((change - power(0.0)).abs() < 1e-5 * power(0.0).abs(), "{change} {}", power(0.0));
}

/// Exact slopes of the entries of `phi` against central differences.
#[test]
fn slopes_of_the_regressor_are_those_of_differences() {
    let robot = with_drive();
    let model = Model::new(&robot);
    let all: Vec<usize> = (0..model.parameter_table().len()).collect();
    let regressor = Regressor::new(&model, &all);
    let weights: Vec<f64> = (0..3 * all.len()).map(|i| (i as f64).sin()).collect();
    let value = |state: &[[f64; 3]; 3]| {
        let [q, dq, ddq] = state.map(|values| Series::from_values(3, values.to_vec()).unwrap());
        let phi = regressor.evaluate_series(&model, &q, &dq, &ddq, SMOOTH);
        let weight = |entry: &crate::regressor::Entry| weights[entry.joint * all.len() + entry.column];
        phi.values().iter().zip(regressor.entries()).map(|(value, entry)| value * weight(entry)).sum::<f64>()
    };
    let [q, dq, ddq] = STATE.map(|values| Series::from_values(3, values.to_vec()).unwrap());
    let slopes = regressor.weighted_slopes(&model, [&q, &dq, &ddq], &weights, SMOOTH);
    let step = 1e-5;
    for order in 0..3 {
        for c in 0..3 {
            let moved = |by: f64| {
                let mut state = STATE;
                state[order][c] += by;
                value(&state)
            };
            let expected = (moved(step) - moved(-step)) / (2.0 * step);
            let found = slopes[order].sample(0)[c];
            assert!((found - expected).abs() < 1e-6 * expected.abs().max(1.0), "{order} {c}: {found} {expected}");
        }
    }
}

/// Where one of the joints is locked, the others are left, and its share is part of the offset.
#[test]
fn a_locked_joint_leaves_the_others_of_the_sum() {
    let locks = crate::robot::Locks { locked: [("a".to_owned(), 0.4)].into(), until: Vec::new() };
    let locked = sum_and_steps()[0].with_locks(&locks).unwrap();
    let joint = locked.joints.last().unwrap();
    let mimic = joint.mimic.unwrap();
    assert!(joint.also_follows.is_empty() && (mimic.ratio, mimic.of) == (-1.7, 0));
    assert!((mimic.offset - 25f64.to_radians() - 0.3 * 0.4).abs() < 1e-15);
    let [free, rest] = [[0.4, -1.1, 0.3], [0.0, -0.8, 0.5]];
    let whole = torques(&sum_and_steps()[0], [&free, &rest, &[0.0, 5.0, -1.0]]);
    assert_near(&torques(&locked, [&free[1..], &rest[1..], &[5.0, -1.0]]), &whole[1..], 1e-12);
}
