//! Joint by joint and all at once give the same base parameters for random robots.

use std::{fmt::Write, path::Path};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{
    BaseParameters, BaseParametersError,
    dependencies::Dependencies,
    joint_by_joint,
    regrouping::{STATES, considered},
    whole,
};
use crate::{dynamics::Model, robot::Robot};

/// Largest difference of coefficients, relative for those above 1.
const SAME: f64 = 1e-9;

/// Probabilities of the features of a random robot.
struct Kind {
    /// A parent that is any earlier link, not the last.
    parents: f64,
    /// A joint that follows another.
    followers: f64,
    /// Mean number of further joints that a motor drives.
    coupled: f64,
    /// A length or angle with a special value.
    right_angles: f64,
    /// A parameter that is excluded.
    excluded: f64,
    /// Not a probability: the spread of each alpha.
    skew_deg: f64,
}

const CHAIN: Kind =
    Kind { parents: 0.0, followers: 0.0, coupled: 0.0, right_angles: 0.0, excluded: 0.0, skew_deg: 0.0 };

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
    writeln!(text, "alpha_deg = {}\ntheta_deg = {theta}", alpha + kind.skew_deg).unwrap();
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

/// The dependencies found joint by joint, which must agree with the whole matrix; none if joint by joint is undecided.
fn compared(robot: &Robot, excluded: f64, rng: &mut ChaCha8Rng) -> Option<Dependencies> {
    let model = Model::new(robot);
    let table = model.parameter_table();
    let names: Vec<String> = table.iter().map(|p| p.name()).filter(|_| rng.random_bool(excluded)).collect();
    let columns = considered(table, &names).unwrap();
    let found = STATES.iter().find_map(|&states| joint_by_joint::dependencies(&model, &columns, states))?;
    let expected = whole::dependencies(&model, &columns).unwrap();
    assert_eq!((&found.kept, &found.spanned), (&expected.kept, &expected.spanned));
    for k in 0..found.spanned.len() {
        let (found, expected) = (found.coefficients.column(k), expected.coefficients.column(k));
        let largest = expected.iter().fold(1.0, |a: f64, c| a.max(c.abs()));
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < SAME * largest, "{found} and {expected}, largest {largest}");
        }
    }
    Some(found)
}

/// Two robots of each size from 6 to 20 joints: joint by joint decides all.
fn the_same_of(kind: &Kind) {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    for joints in (6..=20).chain(6..=20) {
        let robot = robot(joints, kind, &mut rng);
        assert!(compared(&robot, kind.excluded, &mut rng).is_some(), "{joints} joints");
    }
}

#[test]
fn of_chains() {
    the_same_of(&CHAIN);
    the_same_of(&Kind { right_angles: 0.8, ..CHAIN });
    the_same_of(&Kind { right_angles: 1.0, ..CHAIN });
}

#[test]
fn of_trees_with_coupled_motors() {
    the_same_of(&Kind { parents: 0.5, right_angles: 0.8, ..CHAIN });
    the_same_of(&Kind { parents: 0.2, right_angles: 0.9, coupled: 0.7, ..CHAIN });
}

#[test]
fn of_trees_with_followers() {
    the_same_of(&Kind { parents: 0.3, right_angles: 0.8, followers: 0.3, ..CHAIN });
}

#[test]
fn with_parameters_excluded() {
    the_same_of(&Kind { parents: 0.3, right_angles: 0.7, excluded: 0.1, ..CHAIN });
    the_same_of(&Kind { parents: 0.3, right_angles: 0.7, excluded: 0.3, followers: 0.2, coupled: 0.7, ..CHAIN });
}

/// Ten links that one joint moves, which require more states.
#[test]
fn with_many_followers() {
    let follower = |j: usize| {
        let mimic = "mimic = { joint = \"j3\", ratio = 0.5 }";
        format!("[[joint]]\nname = \"j{j}\"\nkind = \"revolute\"\nalpha_deg = 90\na_m = 0.1\n{mimic}\n")
    };
    let mut rng = ChaCha8Rng::seed_from_u64(2);
    let mut text = "name = \"fingers\"\n".to_owned();
    (0..4).for_each(|j| write_joint(&mut text, j, &CHAIN, &mut rng));
    let robot = Robot::parse(&(text + &(4..13).map(follower).collect::<String>()), Path::new("fingers.toml")).unwrap();
    let model = Model::new(&robot);
    let all = considered(model.parameter_table(), &[]).unwrap();
    assert!(joint_by_joint::dependencies(&model, &all, STATES[0]).is_none());
    assert!(compared(&robot, 0.0, &mut rng).is_some());
}

/// Axes that are nearly at right angles: joint by joint gives the same, or is undecided and leaves the decision to the whole
/// matrix.
#[test]
fn with_nearly_special_axes() {
    let mut undecided = 0;
    for exponent in [-1, -4, -5, -9, -10, -12] {
        let kind = Kind { right_angles: 0.95, skew_deg: 10f64.powi(exponent), ..CHAIN };
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        for joints in 6..12 {
            undecided += usize::from(compared(&robot(joints, &kind, &mut rng), 0.0, &mut rng).is_none());
        }
    }
    assert!(undecided > 0);
}

#[test]
fn a_rank_that_is_not_clear_is_refused() {
    let kind = Kind { right_angles: 0.95, parents: 0.1, skew_deg: 1e-6, ..CHAIN };
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let refused = |joints| {
        let result = BaseParameters::of(&Model::new(&robot(joints, &kind, &mut rng)), &[]);
        matches!(result, Err(BaseParametersError::AmbiguousRank { .. }))
    };
    assert!((6..12).any(refused));
}
