//! A joint that follows a sum of joints, as a chain of joints that follow one each, tested by a closed form.

use std::path::Path;

use super::{DynamicParameters, Model, Sign, State, Workspace};
use crate::robot::Robot;

/// Torques near 50 N m from sums of some hundred products.
const ROUNDING: f64 = 1e-11;
const GRAVITY: f64 = 9.81;
const UPPER: f64 = 0.5;
const LOWER: f64 = 0.4;

/// A planar arm whose tool keeps its direction, as by a parallelogram: the tool's joint is `-a - b`, in two steps.
fn palletiser(tool_mass: f64) -> Robot {
    let joint =
        |name: &str, a: f64, more: &str| format!("[[joint]]\nname = '{name}'\nkind = 'revolute'\na_m = {a}\n{more}\n");
    let follows = |leader: &str| format!("mimic = {{ joint = '{leader}', ratio = -1 }}");
    let joints = [
        joint("a", 0.0, ""),
        joint("b", UPPER, ""),
        joint("step", LOWER, &follows("a")),
        joint("tool", 0.0, &follows("b")),
    ];
    let links = format!("m4 = {tool_mass}\nmx4 = {}\nmy4 = {}\nzz4 = 0.7", 0.3 * tool_mass, -0.1 * tool_mass);
    let text =
        format!("name = 'p'\ngravity = [0, -{GRAVITY}, 0]\n{}[parameters]\nzz1 = 0.2\n{links}\n", joints.concat());
    Robot::parse(&text, Path::new("p.toml")).unwrap()
}

fn torques(robot: &Robot, [q, dq, ddq]: [[f64; 2]; 3]) -> [f64; 2] {
    let model = Model::new(robot);
    let parameters = DynamicParameters::new(&model, &robot.a_priori_parameters()).unwrap();
    let (mut tau, mut workspace) = ([0.0; 2], Workspace::new(&model));
    let sign = Sign::smooth(0.1);
    model.inverse_dynamics(&parameters, State::new(&q, &dq), &ddq, sign, &mut workspace, &mut tau);
    tau
}

/// The tool does not turn: its torques are those of its mass as a point at the joint, whatever its inertia and centre.
#[test]
fn a_tool_that_keeps_its_direction_acts_as_a_point_mass() {
    let mass = 3.0;
    let state = [[0.4, -1.1], [1.3, -0.8], [2.0, 5.0]];
    let [with, without] = [mass, 0.0].map(|mass| torques(&palletiser(mass), state));
    let [q, dq, ddq] = state;
    let angles = [q[0], q[0] + q[1]];
    let [rates, accelerations] = [dq, ddq].map(|v| [v[0], v[0] + v[1]]);
    // Jacobian and acceleration of the joint at the end of two bars.
    let bars = [UPPER, LOWER].into_iter().zip(angles).map(|(l, angle)| [-l * angle.sin(), l * angle.cos()]);
    let bars: Vec<[f64; 2]> = bars.collect();
    let turning = |k: usize, i: usize| {
        let inward = [-bars[k][1], bars[k][0]][i];
        accelerations[k] * bars[k][i] + rates[k] * rates[k] * inward
    };
    let force = [0, 1].map(|i| mass * (turning(0, i) + turning(1, i) + [0.0, GRAVITY][i]));
    let along = |bar: [f64; 2]| bar[0] * force[0] + bar[1] * force[1];
    let expected = [along(bars[0]) + along(bars[1]), along(bars[1])];
    for ((with, without), expected) in with.iter().zip(without).zip(expected) {
        assert!((with - without - expected).abs() < ROUNDING, "{} {expected}", with - without);
    }
}

/// Steps of 0.3 and 0.4 of one joint are one of 0.7.
#[test]
fn steps_that_follow_one_joint_are_one_follower() {
    let text = |followers: &str, number: usize| {
        let leader = "[[joint]]\nname = 'a'\nkind = 'revolute'\n[[joint]]\nname = 'b'\nkind = 'revolute'\na_m = 0.5\n";
        let link = format!("m{number} = 2\nmx{number} = 0.3\nzz{number} = 0.2\n");
        format!(
            "name = 'r'\ngravity = [0, -9.81, 0]\n{leader}{followers}[parameters]\nm1 = 1\nmx1 = 0.2\nzz1 = 0.1\n{link}"
        )
    };
    let follower = |name: &str, a: f64, ratio: f64| {
        let mimic = format!("mimic = {{ joint = 'b', ratio = {ratio} }}");
        format!("[[joint]]\nname = '{name}'\nkind = 'revolute'\na_m = {a}\n{mimic}\n")
    };
    let one = text(&follower("c", 0.3, 0.7), 3);
    let steps = text(&(follower("s", 0.3, 0.3) + &follower("c", 0.0, 0.4)), 4);
    let state = [[0.3, -0.9], [0.7, 1.9], [-3.0, 4.0]];
    let [one, steps] = [one, steps].map(|text| torques(&Robot::parse(&text, Path::new("r.toml")).unwrap(), state));
    assert!(one.iter().zip(steps).all(|(a, b)| (a - b).abs() < ROUNDING), "{one:?} {steps:?}");
}
