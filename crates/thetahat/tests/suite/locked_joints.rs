//! Robots with locked joints: the dynamics of the whole robot with these joints at rest, whatever the robot.

use std::{fmt::Write, path::Path};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use thetahat::{
    Robot,
    base_parameters::BaseParameters,
    dynamics::{DynamicParameters, Model, Sign, State, Workspace},
    robot::{Joint, LockError, Locks, RobotError, RobotSource},
};

const STATES: usize = 20;
/// Of the largest torque of a state: rounding of sums over a dozen links.
const ROUNDING: f64 = 1e-12;

/// As `robots/mobile_manipulator.urdf`, where the checkout is there: twelve joints, whose head has a coupled transmission.
fn mobile_manipulator() -> RobotSource {
    RobotSource::read(&thetahat_testing::root().join("robots/mobile_manipulator.urdf")).unwrap()
}

fn locks(locked: &[(&str, f64)], until: &[&str]) -> Locks {
    Locks {
        locked: locked.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect(),
        until: until.iter().map(|name| (*name).to_owned()).collect(),
    }
}

/// A robot with its a-priori parameters, ready to compute torques.
struct Dynamics {
    robot: Robot,
    model: Model,
    parameters: DynamicParameters,
}

impl Dynamics {
    fn new(robot: Robot) -> Self {
        let model = Model::new(&robot);
        let parameters = DynamicParameters::sorted(&model, &robot.a_priori_parameters());
        Self { robot, model, parameters }
    }

    fn torques(&self, [q, dq, ddq]: &[Vec<f64>; 3]) -> Vec<f64> {
        let mut tau = vec![0.0; q.len()];
        let mut workspace = Workspace::new(&self.model);
        let sign = Sign::smooth(0.3);
        self.model.inverse_dynamics(&self.parameters, State::new(q, dq), ddq, sign, &mut workspace, &mut tau);
        tau
    }
}

/// The state of the whole robot, coordinate by coordinate, at a random state of the one with locked joints.
fn whole_state(whole: &Robot, rest: &Robot, of_rest: &[Vec<f64>; 3]) -> [Vec<f64>; 3] {
    let value = |joint: &Joint, kind: usize| {
        let moving = rest.coordinates().position(|j| j.name == joint.name);
        let locked = || rest.locked.iter().find(|l| l.name == joint.name).map_or(0.0, |l| l.value);
        moving.map_or_else(|| if kind == 0 { locked() } else { 0.0 }, |c| of_rest[kind][c])
    };
    [0, 1, 2].map(|kind| whole.coordinates().map(|joint| value(joint, kind)).collect())
}

/// The torques of the moving joints are those of the whole robot with the locked ones at rest.
fn assert_same_dynamics(whole: &Robot, rest: &Robot, rng: &mut ChaCha8Rng) {
    let (whole, rest) = (Dynamics::new(whole.clone()), Dynamics::new(rest.clone()));
    let n = rest.robot.coordinate_count();
    for _ in 0..STATES {
        let state = [2.0, 3.0, 5.0].map(|r| (0..n).map(|_| rng.random_range(-r..r)).collect::<Vec<f64>>());
        let found = rest.torques(&state);
        let all = whole.torques(&whole_state(&whole.robot, &rest.robot, &state));
        let largest = all.iter().fold(1.0, |m: f64, t| m.max(t.abs()));
        for (joint, tau) in whole.robot.coordinates().zip(&all) {
            let Some(c) = rest.robot.coordinates().position(|j| j.name == joint.name) else { continue };
            assert!((found[c] - tau).abs() < ROUNDING * largest, "{}: {} {tau}", joint.name, found[c]);
        }
    }
}

/// A tree of random joints with all kinds of parameters, followers and some coupled motors.
fn random_tree(joints: usize, rng: &mut ChaCha8Rng) -> Robot {
    let mut text = "name = \"random\"\ngravity = [1.0, -2.0, -9.0]\n".to_owned();
    let mut leaders = Vec::new();
    for j in 0..joints {
        let kind = if rng.random_bool(0.3) { "prismatic" } else { "revolute" };
        let mut three = |scale: f64| [0; 3].map(|_| scale * rng.random_range(-1.0..1.0));
        let ([a, d, b], [alpha, theta, gamma]) = (three(1.0), three(180.0));
        writeln!(text, "[[joint]]\nname = \"j{j}\"\nkind = \"{kind}\"\na_m = {a}\nd_m = {d}\nb_m = {b}").unwrap();
        writeln!(text, "alpha_deg = {alpha}\ntheta_deg = {theta}\ngamma_deg = {gamma}").unwrap();
        if j > 0 {
            writeln!(text, "parent = \"j{}\"", rng.random_range(0..j)).unwrap();
        }
        if j > 1 && rng.random_bool(0.3) {
            let (leader, ratio) = (leaders[rng.random_range(0..leaders.len())], rng.random_range(-2.0..2.0));
            writeln!(text, "mimic = {{ joint = \"j{leader}\", ratio = {ratio} }}").unwrap();
        } else {
            leaders.push(j);
        }
    }
    let n = leaders.len();
    // The last two motors turn together.
    let entry = |i: usize, c: usize| if i == c { 10.0 + c as f64 } else { f64::from(i + 1 == n && c + 2 == n) * 4.0 };
    let row = |i: usize| format!("{:?}", (0..n).map(|c| entry(i, c)).collect::<Vec<_>>());
    writeln!(text, "[transmission]\nmatrix = [{}]", (0..n).map(row).collect::<Vec<_>>().join(", ")).unwrap();
    let mut robot = Robot::parse(&text, Path::new("random.toml")).unwrap();
    robot.a_priori = robot.parameter_table().iter().map(|p| (p.name(), rng.random_range(0.1..1.0))).collect();
    robot
}

#[test]
fn locked_trees_move_as_the_whole_ones_do() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    for k in 0..40 {
        let whole = random_tree(3 + k % 6, &mut rng);
        let mut locked = Locks::default();
        for joint in whole.coordinates() {
            if rng.random_bool(0.4) {
                locked.locked.insert(joint.name.clone(), rng.random_range(-2.0..2.0));
            }
        }
        match whole.with_locks(&locked) {
            Ok(rest) => assert_same_dynamics(&whole, &rest, &mut rng),
            Err(LockError::Coupled { .. } | LockError::NothingMoves) => {}
            Err(other) => panic!("{other}"),
        }
    }
}

#[test]
fn torque_terms_stay_on_the_joints_that_are_left() {
    let text = r#"
name = "sprung"
[[joint]]
name = "a"
kind = "revolute"
alpha_deg = 90
[[joint]]
name = "b"
kind = "revolute"
a_m = 0.3
alpha_deg = 30
[[joint]]
name = "c"
kind = "revolute"
a_m = 0.2
[[joint]]
name = "d"
kind = "prismatic"
alpha_deg = 50
a_m = 0.1
[[term]]
kind = "joint-spring"
rest_deg = 10
joints = ["b", "c"]
[[term]]
kind = "stribeck"
velocity = 0.2
[[term]]
kind = "spring"
name = "balancer"
from = { link_of = "d", point_m = [0.1, 0.05, 0.02] }
to = { point_m = [0.3, 0.2, 0.1] }
free_length_m = 0.1
[[term]]
kind = "spring"
name = "inner"
from = { link_of = "b", point_m = [0.1, 0.05, 0.02] }
to = { link_of = "a", point_m = [0.3, 0.2, 0.1] }
free_length_m = 0.1
"#;
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let mut whole = Robot::parse(text, Path::new("sprung.toml")).unwrap();
    whole.a_priori = whole.parameter_table().iter().map(|p| (p.name(), rng.random_range(0.1..1.0))).collect();
    let rest = whole.with_locks(&locks(&[("b", 0.4), ("d", 0.3)], &[])).unwrap();
    assert_eq!((rest.coordinate_count(), rest.term_descriptions.len()), (2, 3));
    assert_same_dynamics(&whole, &rest, &mut rng);
}

#[test]
fn a_mobile_manipulator_is_locked_to_its_lift_and_arm() {
    let source = mobile_manipulator();
    let head_and_gripper = [("head_1_joint", 0.3), ("head_2_joint", 0.5), ("left_finger_joint", 0.02)];
    let rest = source.robot_with_locks(&locks(&head_and_gripper, &[]), Path::new("experiment.toml")).unwrap();
    assert_eq!((rest.link_count(), rest.coordinate_count(), rest.locked.len()), (8, 8, 4));
    let follower = rest.locked.iter().find(|l| l.name == "right_finger_joint").unwrap();
    assert!((follower.value - 0.021).abs() < 1e-15, "{follower:?}");
    // The transmissions of the arm stay.
    assert_eq!(rest.transmission.matrix().at(1, 1), 100.0);
    // The differential of the head is that of the whole robot.
    let path = source.path();
    let text = std::fs::read_to_string(path).unwrap();
    let coupled = source.robot().unwrap().transmission;
    assert_eq!(coupled.coupled_motors().len(), 2);
    let bare = format!("{}</robot>", &text[..text.find("  <transmission").unwrap()]);
    let whole = Robot::parse(&bare, path).unwrap();
    assert_eq!(whole.link_count(), 12);
    assert_same_dynamics(&whole, &rest, &mut ChaCha8Rng::seed_from_u64(2));
    let base = |robot: &Robot| BaseParameters::of(&Model::new(robot), &[]).unwrap().len();
    assert!(base(&rest) < base(&whole));
}

#[test]
fn until_leaves_the_way_from_the_base_and_locks_the_rest_at_neutral_values() {
    let rest = mobile_manipulator().robot_with_locks(&locks(&[], &["arm_7_joint"]), Path::new("--until")).unwrap();
    assert_eq!(rest.coordinate_count(), 8);
    let value = |name: &str| rest.locked.iter().find(|l| l.name == name).unwrap().value;
    // 0, and the middle of the limits where 0 is outside of them.
    assert_eq!((value("head_1_joint"), value("head_2_joint"), value("left_finger_joint")), (0.0, 0.5, 0.0));
    let both = locks(&[("arm_1_joint", 0.4)], &["arm_7_joint"]);
    let rest = mobile_manipulator().robot_with_locks(&both, Path::new("--until")).unwrap();
    assert_eq!((rest.coordinate_count(), rest.locked[0].value), (7, 0.4));
}

#[test]
fn the_robot_file_and_the_experiment_both_lock() {
    let path = thetahat_testing::root().join("robots/own.toml");
    let text = "urdf = \"mobile_manipulator.urdf\"\nuntil = \"arm_7_joint\"\nlocked = { head_1_joint = 0.2 }\n";
    let source = RobotSource::from_text(text.to_owned(), &path).unwrap();
    assert_eq!(source.robot().unwrap().coordinate_count(), 8);
    let rest = source.robot_with_locks(&locks(&[("arm_7_joint", 0.0)], &[]), Path::new("e.toml")).unwrap();
    assert_eq!((rest.coordinate_count(), rest.locked.len()), (7, 5));
    // What the results keep makes the same robot.
    assert_eq!(Robot::parse(&source.to_text(), &path).unwrap(), source.robot().unwrap());
}

#[test]
fn what_cannot_be_locked_is_named_with_its_remedy() {
    let message = |locked: &[(&str, f64)], until: &[&str]| {
        let error = mobile_manipulator().robot_with_locks(&locks(locked, until), Path::new("e.toml")).unwrap_err();
        error.to_string()
    };
    let head = [("head_1_joint", 0.0), ("head_2_joint", 0.5)];
    let with = |name: &'static str, value: f64| [head[0], head[1], (name, value)];
    for (found, expected) in [
        (
            message(&with("arm_8_joint", 0.0), &[]),
            "e.toml: locked: the robot has no moving joint `arm_8_joint`; its moving joints are torso_lift",
        ),
        (message(&[], &["wrist"]), "e.toml: until: the robot has no moving joint `wrist`; its"),
        (
            message(&with("right_finger_joint", 0.0), &[]),
            "locked: joint `right_finger_joint` follows `left_finger_joint` (mimic) and is locked with it; lock `left_finger_joint` instead",
        ),
        (
            message(&with("arm_1_joint", 30.0), &[]),
            "joint `arm_1_joint` at 30 rad: expected a finite number up to 12.5664; give rad, not degrees",
        ),
        (message(&with("arm_1_joint", f64::NAN), &[]), "joint `arm_1_joint` at NaN rad: expected a finite number"),
        (
            message(&with("torso_lift_joint", 10.0), &[]),
            "joint `torso_lift_joint` at 10 m: its limits are 0 to 0.35 m; give m, not mm, or put the limits right",
        ),
        (
            message(&head[..1], &[]),
            "couples `head_1_joint`, which is locked, with `head_2_joint`, which moves: lock both or none; lock all of its joints, or give [transmission] matrix",
        ),
    ] {
        assert!(found.contains(expected), "{found}");
    }
    let arm = "name = 'a'\n[[joint]]\nname = 'x'\nkind = 'revolute'\n[[joint]]\nname = 'y'\nkind = 'revolute'\n\
               [transmission]\nmatrix = [[10, 0], [5, 5]]\n";
    let robot = Robot::parse(arm, Path::new("a.toml")).unwrap();
    assert_eq!(
        robot.with_locks(&locks(&[("x", 0.0)], &[])).unwrap_err().to_string(),
        "locked: motor 2 turns with `x`, which is locked, and with `y`, which moves; lock both or none of them, or give the \
         robot a [transmission] matrix that does not couple the two"
    );
    assert_eq!(robot.with_locks(&locks(&[("x", 0.0), ("y", 0.0)], &[])), Err(LockError::NothingMoves));
    let both = Robot::parse(&format!("locked = {{ x = 0.0, y = 0 }}\n{arm}"), Path::new("a.toml"));
    assert!(matches!(both, Err(RobotError::Lock { source, .. }) if *source == LockError::NothingMoves));
}
