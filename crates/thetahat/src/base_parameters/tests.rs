//! Joint by joint and all at once, the same base parameters of random robots.

use std::{fmt::Write, path::Path};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{
    BaseParameters, joint_by_joint,
    regrouping::{STATES, considered},
    whole,
};
use crate::{dynamics::Model, robot::Robot};

/// What a random robot is made of.
struct Kind {
    parents: f64,
    followers: f64,
    coupled: f64,
    right_angles: f64,
    excluded: f64,
}

const CHAIN: Kind = Kind { parents: 0.0, followers: 0.0, coupled: 0.0, right_angles: 0.0, excluded: 0.0 };

/// Chains or trees of revolute and prismatic joints, the gravity along an axis or not.
fn robot(joints: usize, kind: &Kind, rng: &mut ChaCha8Rng) -> Robot {
    let gravity = ["[0, 0, -9.81]", "[0, 9.81, 0]", "[1, -2, -9]", "[0, 0, 0]"][rng.random_range(0..4)];
    let friction = ["symmetric", "asymmetric"][rng.random_range(0..2)];
    let mut text = format!("name = \"random\"\ngravity = {gravity}\nfriction = \"{friction}\"\n");
    let mut leaders = Vec::new();
    for j in 0..joints {
        write_joint(&mut text, j, kind, rng);
        if j > 0 && rng.random_bool(kind.parents) {
            writeln!(text, "parent = \"j{}\"", rng.random_range(0..j)).unwrap();
        }
        if j > 1 && rng.random_bool(kind.followers) {
            let (leader, ratio) = (leaders[rng.random_range(0..leaders.len())], rng.random_range(-2..2) as f64 + 0.5);
            writeln!(text, "mimic = {{ joint = \"j{leader}\", ratio = {ratio} }}").unwrap();
        } else {
            leaders.push(j);
        }
    }
    write_transmission(&mut text, leaders.len(), kind, rng);
    Robot::parse(&text, Path::new("random.toml")).unwrap()
}

fn write_joint(text: &mut String, j: usize, kind: &Kind, rng: &mut ChaCha8Rng) {
    let sliding = if rng.random_bool(0.3) { "prismatic" } else { "revolute" };
    let mut special = |range: f64, values: [f64; 4]| match rng.random_bool(kind.right_angles) {
        true => values[rng.random_range(0..4)],
        false => rng.random_range(-range..range),
    };
    let (a, d) = (special(1.0, [0.0, 0.0, 0.2, -0.5]), special(1.0, [0.0, 0.0, 0.0, 0.3]));
    let (alpha, theta) = (special(180.0, [0.0, 90.0, -90.0, 180.0]), special(180.0, [0.0, 0.0, 90.0, 180.0]));
    writeln!(text, "[[joint]]\nname = \"j{j}\"\nkind = \"{sliding}\"\na_m = {a}\nd_m = {d}").unwrap();
    writeln!(text, "alpha_deg = {alpha}\ntheta_deg = {theta}").unwrap();
}

fn write_transmission(text: &mut String, n: usize, kind: &Kind, rng: &mut ChaCha8Rng) {
    let mut entry = |i: usize, j: usize| match i {
        _ if i == j => 10,
        _ if rng.random_bool(kind.coupled / n as f64) => 4,
        _ => 0,
    };
    let rows: Vec<String> = (0..n).map(|i| format!("{:?}", (0..n).map(|j| entry(i, j)).collect::<Vec<_>>())).collect();
    writeln!(text, "[transmission]\nmatrix = [{}]", rows.join(", ")).unwrap();
}

/// Whether the joints decide; where they do, the whole matrix must give the same.
fn compare(robot: &Robot, excluded: f64, rng: &mut ChaCha8Rng) -> bool {
    let model = Model::new(robot);
    let table = model.parameter_table();
    let names: Vec<String> = table.iter().map(|p| p.name()).filter(|_| rng.random_bool(excluded)).collect();
    let columns = considered(table, &names).unwrap();
    let Some(found) = STATES.iter().find_map(|&states| joint_by_joint::dependencies(&model, &columns, states)) else {
        return false;
    };
    let [found, expected] = [found, whole::dependencies(&model, &columns).unwrap()]
        .map(|dependencies| BaseParameters::from_dependencies(table, &columns, &dependencies));
    let kept = |base: &BaseParameters| base.parameters().iter().map(|p| p.name.clone()).collect::<Vec<_>>();
    assert_eq!(kept(&found), kept(&expected));
    for (found, expected) in found.parameters().iter().zip(expected.parameters()) {
        assert_eq!(found.regrouped.len(), expected.regrouped.len(), "{} and {}", found.expression, expected.expression);
        for (&(i, found), &(j, expected)) in found.regrouped.iter().zip(&expected.regrouped) {
            assert!(i == j && (found - expected).abs() < 1e-9 * expected.abs().max(1.0), "{found} and {expected}");
        }
    }
    true
}

fn decided(robots: usize, kind: &Kind, seed: u64) -> usize {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let decided = (0..robots).filter(|i| {
        let robot = robot(6 + i % 15, kind, &mut rng);
        compare(&robot, kind.excluded, &mut rng)
    });
    decided.count()
}

#[test]
fn trial() {
    let n = 30;
    let kinds = [
        ("chain", CHAIN),
        ("right", Kind { right_angles: 0.8, ..CHAIN }),
        ("all right", Kind { right_angles: 1.0, ..CHAIN }),
        ("trees", Kind { parents: 0.5, right_angles: 0.8, ..CHAIN }),
        ("coupled", Kind { parents: 0.2, coupled: 0.7, right_angles: 0.9, ..CHAIN }),
        ("followers", Kind { parents: 0.3, followers: 0.3, right_angles: 0.8, ..CHAIN }),
        ("excluded", Kind { right_angles: 0.7, parents: 0.3, excluded: 0.1, ..CHAIN }),
        ("all", Kind { right_angles: 0.7, parents: 0.3, excluded: 0.1, followers: 0.2, coupled: 0.7 }),
    ];
    for (name, kind) in kinds {
        let result = std::panic::catch_unwind(|| decided(n, &kind, 1));
        eprintln!("{name}: {result:?} of {n}");
    }
}
