//! The commands of docs/manual/your_own_robot.md, run from a clean folder that holds a URDF and a log.

use std::process::Output;

use thetahat_testing::{Folder, project, refused, run, shown, succeeded};

const PROGRAM: &str = env!("CARGO_BIN_EXE_thetahat");

/// A folder with the arm's URDF and a log of the simulated arm.
struct Arm(Folder);

impl Arm {
    fn new() -> Self {
        let arm = Self(Folder::new());
        for file in ["arm.urdf", "twin.toml"] {
            arm.0.copy(&project("examples/arm").join(file));
        }
        succeeded(&arm.run("simulate twin.toml --out log.csv"));
        arm
    }

    fn run(&self, arguments: &str) -> Output {
        run(PROGRAM, self.0.path(), arguments.split(' '))
    }
}

/// From URDF and CSV to a report whose estimates are the truth of the simulated arm.
#[test]
#[ignore = "long, each night"]
fn urdf_and_log_give_a_report() {
    let arm = Arm::new();
    let shown = succeeded(&arm.run("inspect log.csv --robot arm.urdf"));
    assert!(shown.contains("1000") && shown.contains("position_1"), "{shown}");
    succeeded(&arm.run("init --robot arm.urdf --recording log.csv"));
    succeeded(&arm.run("check experiment.toml"));
    succeeded(&arm.run("identify experiment.toml --out results"));
    assert!(arm.0.text("results/report.html").contains("fv1"));
    let results = arm.0.json("results/results.json");
    let parameters = results["runs"][0]["parameters"].as_array().unwrap();
    for (name, truth) in [("fv1", 2.1), ("fc1", 1.6), ("fv2", 3.0), ("fc2", 2.2), ("fv3", 1.1), ("fc3", 0.9)] {
        let found = parameters.iter().find(|p| p["name"] == name).unwrap()["estimate"].as_f64().unwrap();
        assert!((found - truth).abs() < 0.05 * truth, "{name}: {found}, truth {truth}");
    }
}

/// The files at hand are never overwritten.
#[test]
fn init_does_not_overwrite() {
    let arm = Arm::new();
    arm.0.write("experiment.toml", "mine");
    let message = refused(&arm.run("init --robot arm.urdf --recording log.csv"));
    assert!(message.contains("experiment.toml") && arm.0.text("experiment.toml") == "mine");
}

/// A log in degrees whose unit is not told: the check finds it out, and says so.
#[test]
#[ignore = "long, each night"]
fn degrees_are_found_out() {
    let arm = Arm::new();
    succeeded(&arm.run("init --robot arm.urdf --recording log.csv"));
    let degrees = arm.0.text("experiment.toml").replace("unit = \"rad\"", "unit = \"deg\"");
    arm.0.write("experiment.toml", degrees);
    let output = arm.run("check experiment.toml");
    assert_eq!(output.status.code(), Some(1), "{}", shown(&output));
}

/// The driver is known by its name, or described by a file; an unknown one is refused with those that are known.
#[test]
#[ignore = "long, each night"]
fn the_driver_of_a_log_may_be_named() {
    let arm = Arm::new();
    let listed = succeeded(&arm.run("init --from list"));
    assert!(
        listed.contains("ur-rtde: Universal Robots, RTDE") && listed.contains("effort: motor current, A"),
        "{listed}"
    );
    let refusal = refused(&arm.run("init --from ur --robot arm.urdf --recording log.csv"));
    assert!(refusal.contains("there is no driver \"ur\"; say which of ur-ros2, ur-rtde it is"), "{refusal}");
    let refusal = refused(&arm.run("init --from franka --robot arm.urdf --recording log.csv"));
    assert!(
        refusal.contains("none of the columns of the driver franka") && refusal.contains("--from list"),
        "{refusal}"
    );
    assert!(refused(&arm.run("init --from franka")).contains("--robot FILE and --recording FILE are needed"));
    let mine = "title = 'arm'\neffort = 'torque, N m'\n[position]\ncolumns = ['position_*']\nunit = 'rad'\n\
                [torque]\ncolumns = ['torque_*']\nunit = 'N m'\n";
    arm.0.write("mine.toml", mine);
    let written = succeeded(&arm.run("init --from ./mine.toml --robot arm.urdf --recording log.csv"));
    assert!(written.contains("Driver ./mine.toml (arm). What it means by effort: torque, N m."), "{written}");
    succeeded(&arm.run("identify experiment.toml"));
}

/// Columns whose names tell nothing are not guessed: the message says how to name them, and that works.
#[test]
#[ignore = "long, each night"]
fn columns_without_telling_names_are_asked_for() {
    let arm = Arm::new();
    let log = arm.0.text("log.csv").replace("torque_", "channel_");
    arm.0.write("log.csv", log);
    let message = refused(&arm.run("init --robot arm.urdf --recording log.csv"));
    assert!(message.contains("--torque"), "{message}");
    succeeded(&arm.run("init --robot arm.urdf --recording log.csv --torque channel_1,channel_2,channel_3"));
    succeeded(&arm.run("identify experiment.toml"));
}
