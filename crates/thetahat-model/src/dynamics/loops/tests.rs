//! Mechanisms that close, against Lagrange's equations with positions in closed form.

use std::path::Path;

use super::super::{DynamicParameters, Model, Sign, State, Workspace};
use crate::{
    base_parameters::BaseParameters,
    dynamics::DynamicsError,
    regressor::Regressor,
    robot::{Robot, RobotError},
};
use thetahat_ground::series::Series;

const GRAVITY: f64 = 9.81;
const SIGN: Sign = Sign::smooth(0.1);
/// Nested differences of fourth order over 1e-2: errors of 1e-8 of torques near 10 N m.
const DIFFERENCES: f64 = 1e-6;
const STEP: f64 = 1e-2;

/// Lengths of the base, crank, coupler and rocker, m.
const BARS: [f64; 4] = [0.5, 0.15, 0.45, 0.35];
/// Lengths of a five-bar arm: base, upper bars, lower bars.
const ARMS: [f64; 3] = [0.3, 0.25, 0.4];

/// Link parameters m, mx, my, zz of each link.
const LINKS: [[f64; 4]; 4] =
    [[1.2, 0.1, 0.02, 0.03], [0.8, 0.16, -0.03, 0.06], [1.5, 0.2, 0.05, 0.09], [0.7, 0.15, 0.01, 0.05]];

fn parameters_of(links: usize) -> String {
    let line = |(k, [m, mx, my, zz]): (usize, &[f64; 4])| {
        let k = k + 1;
        format!("m{k} = {m}\nmx{k} = {mx}\nmy{k} = {my}\nzz{k} = {zz}\n")
    };
    LINKS.iter().take(links).enumerate().map(line).collect()
}

fn four_bar() -> String {
    let [base, crank, coupler, rocker] = BARS;
    format!(
        "name = 'four bars'\ngravity = [0, -{GRAVITY}, 0]\n[[joint]]\nname = 'crank'\nkind = 'revolute'\n[[joint]]\n\
         name = 'coupler'\nkind = 'revolute'\nparent = 'crank'\na_m = {crank}\n[[joint]]\nname = 'rocker'\nkind = 'revolute'\n\
         a_m = {base}\n[[loop]]\nname = 'pin'\nkind = 'point'\npassive = ['coupler', 'rocker']\n\
         from = {{ link_of = 'coupler', point_m = [{coupler}, 0, 0] }}\nto = {{ link_of = 'rocker', point_m = [{rocker}, 0, 0] }}\n\
         near_deg = {{ crank = 60, coupler = -40, rocker = 80 }}\n[parameters]\n{}",
        parameters_of(3)
    )
}

fn five_bar() -> String {
    let [base, upper, lower] = ARMS;
    format!(
        "name = 'five bars'\ngravity = [0, -{GRAVITY}, 0]\n[[joint]]\nname = 'left'\nkind = 'revolute'\n[[joint]]\n\
         name = 'left elbow'\nkind = 'revolute'\nparent = 'left'\na_m = {upper}\n[[joint]]\nname = 'right'\n\
         kind = 'revolute'\na_m = {base}\n[[joint]]\nname = 'right elbow'\nkind = 'revolute'\nparent = 'right'\na_m = {upper}\n\
         [[loop]]\nname = 'hand'\nkind = 'point'\npassive = ['left elbow', 'right elbow']\n\
         from = {{ link_of = 'left elbow', point_m = [{lower}, 0, 0] }}\n\
         to = {{ link_of = 'right elbow', point_m = [{lower}, 0, 0] }}\n\
         near_deg = {{ left = 120, 'left elbow' = -60, right = 60, 'right elbow' = 60 }}\n[parameters]\n{}",
        parameters_of(4)
    )
}

/// Where circles about two points meet, to the left of the way from the first to the second.
fn meeting([ax, ay]: [f64; 2], a: f64, [bx, by]: [f64; 2], b: f64) -> [f64; 2] {
    let (dx, dy) = (bx - ax, by - ay);
    let d = dx.hypot(dy);
    let along = (d * d + a * a - b * b) / (2.0 * d);
    let across = (a * a - along * along).sqrt();
    [ax + (along * dx - across * dy) / d, ay + (along * dy + across * dx) / d]
}

/// The origin and the angle of each link.
type Links = Vec<[f64; 3]>;

fn bar([x, y]: [f64; 2], to: [f64; 2]) -> [f64; 3] {
    [x, y, (to[1] - y).atan2(to[0] - x)]
}

fn four_bar_links(q: &[f64]) -> Links {
    let [base, crank, coupler, rocker] = BARS;
    let pin = [crank * q[0].cos(), crank * q[0].sin()];
    let end = meeting(pin, coupler, [base, 0.0], rocker);
    vec![[0.0, 0.0, q[0]], bar(pin, end), bar([base, 0.0], end)]
}

fn five_bar_links(q: &[f64]) -> Links {
    let [base, upper, lower] = ARMS;
    let elbows = [[upper * q[0].cos(), upper * q[0].sin()], [base + upper * q[1].cos(), upper * q[1].sin()]];
    let hand = meeting(elbows[0], lower, elbows[1], lower);
    vec![[0.0, 0.0, q[0]], bar(elbows[0], hand), [base, 0.0, q[1]], bar(elbows[1], hand)]
}

/// The derivative of a function along a coordinate, of fourth order.
fn slope(f: &dyn Fn(&[f64]) -> Vec<f64>, q: &[f64], along: usize) -> Vec<f64> {
    let at = |steps: f64| {
        let mut q = q.to_vec();
        q[along] += steps * STEP;
        f(&q)
    };
    let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(at);
    (0..a.len()).map(|i| (a[i] - 8.0 * b[i] + 8.0 * c[i] - d[i]) / (12.0 * STEP)).collect()
}

/// The mass matrix and the potential energy of links whose places are a function of the coordinates.
fn energies(links: &dyn Fn(&[f64]) -> Links, q: &[f64]) -> (Vec<f64>, f64) {
    let n = q.len();
    let flat = |q: &[f64]| links(q).concat();
    let slopes: Vec<Vec<f64>> = (0..n).map(|i| slope(&flat, q, i)).collect();
    let (mut mass, mut potential) = (vec![0.0; n * n], 0.0);
    for (k, [_, y, angle]) in links(q).into_iter().enumerate() {
        let [m, mx, my, zz] = LINKS[k];
        let (s, c) = angle.sin_cos();
        let moments = [c * mx - s * my, s * mx + c * my];
        potential += GRAVITY * (m * y + moments[1]);
        for i in 0..n {
            for j in 0..n {
                let [a, b] = [i, j].map(|i| [slopes[i][3 * k], slopes[i][3 * k + 1], slopes[i][3 * k + 2]]);
                let mixed = |a: [f64; 3], b: [f64; 3]| a[2] * (b[1] * moments[0] - b[0] * moments[1]);
                mass[i * n + j] += m * (a[0] * b[0] + a[1] * b[1]) + zz * a[2] * b[2] + mixed(a, b) + mixed(b, a);
            }
        }
    }
    (mass, potential)
}

/// Lagrange's equations.
fn lagrange(links: &dyn Fn(&[f64]) -> Links, [q, dq, ddq]: [&[f64]; 3]) -> Vec<f64> {
    let n = q.len();
    let mass = |q: &[f64]| energies(links, q).0;
    let slopes: Vec<Vec<f64>> = (0..n).map(|k| slope(&mass, q, k)).collect();
    let weight = |q: &[f64]| vec![energies(links, q).1];
    let torque = |i: usize| {
        let mut tau = slope(&weight, q, i)[0];
        for j in 0..n {
            tau += mass(q)[i * n + j] * ddq[j];
            for k in 0..n {
                tau += (slopes[k][i * n + j] - 0.5 * slopes[i][j * n + k]) * dq[j] * dq[k];
            }
        }
        tau
    };
    (0..n).map(torque).collect()
}

struct Case {
    robot: Robot,
    links: fn(&[f64]) -> Links,
    states: Vec<[Vec<f64>; 3]>,
}

fn cases() -> [Case; 2] {
    let parse = |text: &str| Robot::parse(text, Path::new("loop.toml")).unwrap();
    let turns = (0..24).map(|k| {
        let k = f64::from(k);
        [vec![0.5 * k - 4.0], vec![(1.3 * k).sin() * 4.0], vec![(0.7 * k).cos() * 20.0]]
    });
    let moves = (0..24).map(|k| {
        let k = f64::from(k);
        let q = vec![2.0 + 0.5 * (1.1 * k).sin(), 1.0 + 0.5 * (0.6 * k).cos()];
        [q, vec![(1.3 * k).sin() * 3.0, (2.1 * k).cos() * 3.0], vec![(0.7 * k).cos() * 15.0, (0.3 * k).sin() * 15.0]]
    });
    [
        Case { robot: parse(&four_bar()), links: four_bar_links, states: turns.collect() },
        Case { robot: parse(&five_bar()), links: five_bar_links, states: moves.collect() },
    ]
}

/// Inverse dynamics, mass matrix, the regressor, and the way back by forward dynamics; a crank makes several turns.
#[test]
fn four_bars_and_five_bars_obey_lagrange() {
    for Case { robot, links, states } in cases() {
        let model = Model::new(&robot);
        model.check_loops().unwrap();
        let n = model.coordinate_count();
        let theta = robot.a_priori_parameters();
        let parameters = DynamicParameters::new(&model, &theta).unwrap();
        let mut workspace = Workspace::new(&model);
        let all: Vec<usize> = (0..theta.len()).collect();
        let regressor = Regressor::new(&model, &all);
        for [q, dq, ddq] in &states {
            let [mut tau, mut back] = [(); 2].map(|()| vec![0.0; n]);
            model.inverse_dynamics(&parameters, State::new(q, dq), ddq, SIGN, &mut workspace, &mut tau);
            let expected = lagrange(&links, [q, dq, ddq]);
            let close = |a: &[f64], b: &[f64], tolerance: f64| {
                let largest = b.iter().fold(1.0, |largest: f64, b| largest.max(b.abs()));
                let near = a.iter().zip(b).all(|(a, b)| (a - b).abs() < tolerance * largest);
                assert!(near, "{} {q:?}: {a:?} {b:?}", robot.name);
            };
            close(&tau, &expected, DIFFERENCES);
            let mut mass = vec![0.0; n * n];
            model.mass_matrix(&parameters, q, &mut workspace, &mut mass);
            close(&mass, &energies(&links, q).0, DIFFERENCES);
            let mut phi = vec![0.0; regressor.entries().len()];
            regressor.evaluate(&model, State::new(q, dq), ddq, SIGN, &mut workspace, &mut phi);
            let mut sums = vec![0.0; n];
            regressor.entries().iter().zip(&phi).for_each(|(e, value)| sums[e.joint] += value * theta[e.column]);
            close(&sums, &tau, 1e-12);
            model.forward_dynamics(&parameters, State::new(q, dq), &tau, SIGN, &mut workspace, &mut back).unwrap();
            close(&back, ddq, 1e-10);
        }
    }
}

/// Every vector of standard parameters gives the torques of its base parameters. Their numbers: mass, two moments and inertia of each
/// link act, but for masses on the base; a mass at a pin can belong to either link. Each bearing has two kinds of friction, each drive
/// an offset, and the inertia of a drive is that of its link.
#[test]
fn base_parameters_give_the_same_torques() {
    for (Case { robot, states, .. }, expected) in cases().into_iter().zip([8 + 6 + 1, 11 + 8 + 2]) {
        let model = Model::new(&robot);
        let base = BaseParameters::of(&model, &[]).unwrap();
        assert_eq!(base.len(), expected, "{}: {:?}", robot.name, base.parameters());
        let all: Vec<usize> = (0..model.parameter_table().len()).collect();
        let theta: Vec<f64> = all.iter().map(|&i| (1.7 * i as f64).sin()).collect();
        let of_base = base.to_standard(&base.from_standard(&theta));
        let series = |order: usize| {
            Series::shaped(model.coordinate_count(), states.iter().flat_map(|state| state[order].clone()).collect())
        };
        let [q, dq, ddq] = [series(0), series(1), series(2)];
        let torques = |theta: &[f64]| Regressor::new(&model, &all).torques(&model, [&q, &dq, &ddq], Sign::Exact, theta);
        let (whole, reduced) = (torques(&theta), torques(&of_base));
        let worst = whole.values().iter().zip(reduced.values()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-8, "{}: {worst:.1e}", robot.name);
    }
}

#[test]
fn loops_that_cannot_be_closed_are_refused() {
    let problem = |from: &str, to: &str| {
        let text = five_bar().replace(from, to);
        Robot::parse(&text, Path::new("loop.toml")).map(|robot| Model::new(&robot).check_loops())
    };
    let open = problem("left = 120", "left = 180").unwrap();
    assert!(matches!(open, Err(DynamicsError::LoopSingular { .. } | DynamicsError::LoopOpen { .. })), "{open:?}");
    let held = problem("passive = ['left elbow', 'right elbow']", "passive = ['left elbow']").unwrap();
    assert!(matches!(held, Err(DynamicsError::LoopHolds { .. } | DynamicsError::LoopOpen { .. })), "{held:?}");
    let rod = problem("kind = 'point'", "kind = 'distance'\nlength_m = 0.1").unwrap();
    assert_eq!(rod, Err(DynamicsError::LoopConditions { equations: 1, passive: 2 }));
    for (from, to, part) in [
        ("passive = ['left elbow', 'right elbow']", "passive = ['wrist']", "unknown joint `wrist`"),
        ("passive = ['left elbow', 'right elbow']", "", "names no passive joint"),
        ("link_of = 'left elbow'", "link_of = 'right elbow'", "joins a link to itself"),
        ("kind = 'point'", "kind = 'distance'", "needs length_m"),
    ] {
        let Err(RobotError::Loop { name, problem, .. }) = problem(from, to) else { panic!("{to}") };
        assert!(name == "hand" && problem.contains(part), "{problem}");
    }
    // Both lower bars in one line: they do not determine the elbows.
    let Case { robot, .. } = &cases()[1];
    let out = Series::shaped(2, vec![2.0, 1.0, std::f64::consts::PI, 0.0]);
    let found = Model::new(robot).check_positions(&out);
    assert!(matches!(found, Err((1, DynamicsError::LoopSingular { joint: 2 | 4 }))), "{found:?}");
}
