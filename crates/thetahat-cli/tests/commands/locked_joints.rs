//! A mobile manipulator with twelve joints and a log of eight: from `init` to estimates that are the truth of the twin.

use std::{fmt::Write, process::Output, sync::OnceLock};

use thetahat_testing::{Folder, project, refused, run, succeeded};

const PROGRAM: &str = env!("CARGO_BIN_EXE_thetahat");

/// The lift and the arm of `robots/mobile_manipulator.urdf` move, as in the log; head and gripper are at rest.
const TWIN: &str = r#"
title = "mobile manipulator: simulated"
robot = "mobile_manipulator.urdf"
locked = { head_1_joint = 0.0, head_2_joint = 0.5, left_finger_joint = 0.01 }
[twin]
sample_rate_hz = 250
points = [POINTS]
max_velocity = [300, 120, 120, 150, 150, 180, 180, 200]
acceleration_time_s = 0.25
smoothing_time_s = 0.05
rest_s = 0.3
unlisted = "a-priori"
[twin.parameters]
fv1 = 80
fc1 = 30
FRICTION
[twin.sensors]
encoder_counts_per_turn = 16777216
torque_noise = [2, 0.2, 0.2, 0.1, 0.1, 0.05, 0.05, 0.05]
torque_ripple = 0
ripple_per_turn = 1
seed = 5
[simulation]
sign_velocity_scale = 0.0005
[signal]
cutoff_hz = 30
decimation = 5
[controller]
law = "pd"
bandwidth_hz = 10
velocity_feed_forward = 1.0
acceleration_feed_forward = 1.0
"#;

const LIMITS_DEG: [[f64; 2]; 8] = [
    [20.0, 330.0],
    [-60.0, 150.0],
    [-85.0, 60.0],
    [-180.0, 85.0],
    [-20.0, 125.0],
    [-115.0, 115.0],
    [-75.0, 75.0],
    [-115.0, 115.0],
];

/// Moves between points that a low-discrepancy sequence spreads over the ranges of the joints.
fn points() -> String {
    let at = |k: usize, j: usize| {
        let part = (0.5
            + k as f64 * [0.618_034, 0.754_878, 0.569_840, 0.819_173, 0.671_044, 0.549_700, 0.450_500, 0.856_675][j])
            .fract();
        let [low, high] = LIMITS_DEG[j];
        format!("{:.1}", low + part * (high - low))
    };
    let point = |k: usize| format!("[{}]", (0..8).map(|j| at(k, j)).collect::<Vec<_>>().join(", "));
    (0..14).map(point).collect::<Vec<_>>().join(",\n")
}

struct Manipulator(Folder);

impl Manipulator {
    /// A folder with the URDF and a log with the names of the joints: positions and torques of lift and arm, the head's
    /// positions without torques, and a wheel that the URDF does not have.
    fn new() -> Self {
        let folder = Folder::new();
        folder.copy(&project("robots/mobile_manipulator.urdf"));
        let mut friction = String::new();
        (2..=8).for_each(|j| _ = writeln!(friction, "fv{j} = {}\nfc{j} = {}", 3.0 / j as f64, 2.0 / j as f64));
        folder.write("twin.toml", TWIN.replace("POINTS", &points()).replace("FRICTION", &friction));
        let manipulator = Self(folder);
        manipulator.0.write("twin.csv", manipulator.simulated());
        manipulator.0.write("log.csv", manipulator.log("0.0", "0.5"));
        manipulator
    }

    /// The twin's record, which is the same in each folder.
    fn simulated(&self) -> &'static str {
        static SIMULATED: OnceLock<String> = OnceLock::new();
        SIMULATED.get_or_init(|| {
            succeeded(&self.run("simulate twin.toml --out simulated.csv"));
            self.0.text("simulated.csv")
        })
    }

    /// What `init` proposes for the log, which is written into the folder.
    fn proposed(&self) -> &'static str {
        static PROPOSED: OnceLock<String> = OnceLock::new();
        let text = PROPOSED.get_or_init(|| {
            succeeded(&self.run("init --robot mobile_manipulator.urdf --recording log.csv"));
            self.0.text("experiment.toml")
        });
        self.0.write("experiment.toml", text);
        text
    }

    /// The twin's record under the names of joints, in another order, with the head at these positions.
    fn log(&self, head_1: &str, head_2: &str) -> String {
        let names =
            ["torso_lift", "arm_1", "arm_2", "arm_3", "arm_4", "arm_5", "arm_6", "arm_7"].map(|n| format!("{n}_joint"));
        let order = [3, 0, 1, 2, 7, 6, 5, 4];
        let mut text = String::from("time");
        for kind in ["position", "effort"] {
            order.iter().for_each(|&j| _ = write!(text, ",{}.{kind}", names[j]));
        }
        text += ",head_1_joint.position,head_2_joint.position,wheel_left_joint.position\n";
        for (k, line) in self.0.text("twin.csv").lines().skip(1).enumerate() {
            let cells: Vec<&str> = line.split(',').collect();
            let picked = order.iter().map(|j| cells[1 + j]).chain(order.iter().map(|j| cells[9 + j]));
            let row: Vec<&str> = std::iter::once(cells[0]).chain(picked).collect();
            let head_1 = head_1.replace("k", &format!("{}", 1e-3 * k as f64));
            _ = writeln!(text, "{},{head_1},{head_2},{}", row.join(","), 0.01 * k as f64);
        }
        text
    }

    fn run(&self, arguments: &str) -> Output {
        run(PROGRAM, self.0.path(), arguments.split(' '))
    }
}

#[test]
fn a_log_of_eight_joints_of_twelve_is_identified_with_the_others_locked() {
    let manipulator = Manipulator::new();
    let text = manipulator.proposed();
    for line in [
        "[locked]\n",
        "head_1_joint = 0.0  # in the log from 0.0000 to 0.0000, without a torque that changes",
        "head_2_joint = 0.5  # in the log from 0.5000 to 0.5000",
        "left_finger_joint = 0.0  # not in the log, so a guess: 0\n",
        "columns = [\"torso_lift_joint.position\", \"arm_1_joint.position\", \"arm_2_joint.position\"",
        "unit = [\"m\", \"rad\", \"rad\", \"rad\", \"rad\", \"rad\", \"rad\", \"rad\"]",
        "unit = [\"N\", \"N m\"",
        "Not used, as no signal of a joint that is identified: head_1_joint.position head_2_joint.position wheel_left_joint.position.",
    ] {
        assert!(text.contains(line), "`{line}` is not in\n{text}");
    }
    let shown = succeeded(&manipulator.run("identify experiment.toml --out results"));
    assert!(shown.contains("locked") && shown.contains("head_2_joint"), "{shown}");
    let results = manipulator.0.json("results/results.json");
    assert_eq!(results["robot_locked"].as_array().unwrap().len(), 4);
    let parameters = results["runs"][0]["parameters"].as_array().unwrap();
    let number = |name: &str, key: &str| parameters.iter().find(|p| p["name"] == name).unwrap()[key].as_f64().unwrap();
    let found = |name: &str| number(name, "estimate");
    for j in 1..=8 {
        let (fv, fc) = if j == 1 { (80.0, 30.0) } else { (3.0 / f64::from(j), 2.0 / f64::from(j)) };
        for (name, truth) in [(format!("fv{j}"), fv), (format!("fc{j}"), fc)] {
            // The lift is slow: what its friction has of both kinds is told apart to 12 %.
            let tolerance = (0.15 * truth).max(4.0 * number(&name, "standard_deviation"));
            assert!((found(&name) - truth).abs() < tolerance, "{name}: {} truth {truth}", found(&name));
        }
    }
    // All that the lift carries, head and gripper included: the masses of the URDF.
    let carried = 14.0 + 2.3 + 2.0 + 1.9 + 1.6 + 1.5 + 0.9 + 0.5 + 0.6 + 2.0 * 0.07 + 0.8 + 1.1;
    assert!((found("m1r") - carried).abs() < 0.02 * carried, "m1r: {}", found("m1r"));
    assert!(results["runs"][0]["relative_error_percent"].as_f64().unwrap() < 10.0, "{shown}");
}

#[test]
#[ignore = "long, each night"]
fn what_cannot_be_told_or_locked_is_said() {
    let manipulator = Manipulator::new();
    manipulator.0.write("moving.csv", manipulator.log("k", "0.5"));
    let message = refused(&manipulator.run("init --robot mobile_manipulator.urdf --recording moving.csv"));
    assert!(
        message.contains("joint `head_1_joint` moves from 0.0000 to") && message.contains("has no torque of it"),
        "{message}"
    );
    // Numbers instead of names: the joints are asked for, and that works.
    let message = refused(&manipulator.run("init --robot mobile_manipulator.urdf --recording twin.csv"));
    assert!(message.contains("8 columns look like it") && message.contains("--joints NAME,NAME,..."), "{message}");
    let joints = "torso_lift_joint,arm_1_joint,arm_2_joint,arm_3_joint,arm_4_joint,arm_5_joint,arm_6_joint,arm_7_joint";
    succeeded(
        &manipulator.run(&format!("init --robot mobile_manipulator.urdf --recording twin.csv --joints {joints}")),
    );
    assert!(
        manipulator.0.text("experiment.toml").contains("head_2_joint = 0.5  # not in the log, so a guess: the middle")
    );
    let two =
        "init --robot mobile_manipulator.urdf --recording twin.csv --joints arm_2_joint,arm_1_joint --out two.toml";
    let message = refused(&manipulator.run(two));
    assert!(
        message
            .contains("joints arm_2_joint,arm_1_joint: expected joints of the robot, in its order: torso_lift_joint"),
        "{message}"
    );
}

/// The head is locked in the identification: a motion that turns it is not predicted, and one without torques is.
#[test]
#[ignore = "long, each night"]
fn predictions_are_of_the_joints_as_they_were_locked() {
    let manipulator = Manipulator::new();
    let text = manipulator.proposed();
    manipulator.0.write("fast.toml", text.replace("\"idim-wls\", \"idim-iv\"", "\"idim-ls\""));
    succeeded(&manipulator.run("identify fast.toml --out results"));
    manipulator.0.write("moving.csv", manipulator.log("k", "0.5"));
    let message = refused(&manipulator.run("predict results/results.json --recording moving.csv"));
    assert!(
        message.contains(
            "moving.csv: joint `head_1_joint` is locked at 0.0000 rad in the results, and goes from 0.0000 to"
        ),
        "{message}"
    );
    let log = manipulator.log("0.0", "0.5");
    let is_torque = |name: &str| name.ends_with(".effort");
    let torques: Vec<bool> = log.lines().next().unwrap().split(',').map(is_torque).collect();
    let planned = |line: &str| {
        let cells = line.split(',').zip(&torques).filter(|(_, is_torque)| !**is_torque).map(|(cell, _)| cell);
        cells.collect::<Vec<_>>().join(",") + "\n"
    };
    manipulator.0.write("planned.csv", log.lines().map(planned).collect::<String>());
    let shown = succeeded(&manipulator.run("predict results/results.json --recording planned.csv --out predicted.csv"));
    assert!(shown.contains("not measured"), "{shown}");
    assert!(manipulator.0.text("predicted.csv").starts_with("time_s,predicted_1,"));
    // A file with some of the torques is none of a planned motion.
    manipulator.0.write("some.csv", log.replacen("arm_3_joint.effort", "arm_3_joint.load", 1));
    let message = refused(&manipulator.run("predict results/results.json --recording some.csv"));
    assert!(message.contains("there is no column \"arm_3_joint.effort\""), "{message}");
}
