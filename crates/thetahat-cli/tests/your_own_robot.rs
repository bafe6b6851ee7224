//! The commands of docs/your_own_robot.md, run from a clean folder that holds a URDF and a log.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
};

const ARM: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/arm");

/// A folder of its own for each test, removed at its end.
struct Folder(PathBuf);

impl Folder {
    /// The arm's URDF, and a log of the simulated arm.
    fn new(name: &str) -> Self {
        let folder = Self(std::env::temp_dir().join(format!("thetahat-own-robot-{name}-{}", std::process::id())));
        fs::create_dir_all(&folder.0).unwrap();
        for file in ["arm.urdf", "twin.toml"] {
            fs::copy(Path::new(ARM).join(file), folder.0.join(file)).unwrap();
        }
        succeeded(&folder.run("simulate twin.toml --out log.csv"));
        folder
    }

    fn run(&self, arguments: &str) -> Output {
        let arguments: Vec<&str> = arguments.split(' ').collect();
        Command::new(env!("CARGO_BIN_EXE_thetahat")).current_dir(&self.0).args(arguments).output().unwrap()
    }

    fn read(&self, file: &str) -> String {
        fs::read_to_string(self.0.join(file)).unwrap()
    }

    fn replace(&self, file: &str, from: &str, to: &str) {
        let text = self.read(file);
        assert!(text.contains(from), "{file} holds no {from:?}");
        fs::write(self.0.join(file), text.replace(from, to)).unwrap();
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn text(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr)
}

fn succeeded(output: &Output) -> String {
    let text = text(output);
    assert_eq!(output.status.code(), Some(0), "{text}");
    text
}

/// From URDF and CSV to a report whose estimates are the truth of the simulated arm.
#[test]
fn urdf_and_log_give_a_report() {
    let folder = Folder::new("report");
    let shown = succeeded(&folder.run("inspect log.csv --robot arm.urdf"));
    assert!(shown.contains("1000") && shown.contains("position_1"), "{shown}");
    succeeded(&folder.run("init --robot arm.urdf --recording log.csv"));
    succeeded(&folder.run("check experiment.toml"));
    succeeded(&folder.run("identify experiment.toml --out results"));
    assert!(folder.read("results/report.html").contains("fv1"));
    let results: serde_json::Value = serde_json::from_str(&folder.read("results/results.json")).unwrap();
    let parameters = results["runs"][0]["parameters"].as_array().unwrap();
    for (name, truth) in [("fv1", 2.1), ("fc1", 1.6), ("fv2", 3.0), ("fc2", 2.2), ("fv3", 1.1), ("fc3", 0.9)] {
        let found = parameters.iter().find(|p| p["name"] == name).unwrap()["estimate"].as_f64().unwrap();
        assert!((found - truth).abs() < 0.05 * truth, "{name}: {found}, truth {truth}");
    }
}

/// The files at hand are never overwritten.
#[test]
fn init_does_not_overwrite() {
    let folder = Folder::new("overwrite");
    fs::write(folder.0.join("experiment.toml"), "mine").unwrap();
    let output = folder.run("init --robot arm.urdf --recording log.csv");
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output).contains("experiment.toml") && folder.read("experiment.toml") == "mine");
}

/// A log in degrees whose unit is not told: the check finds it out, and says so.
#[test]
fn degrees_are_found_out() {
    let folder = Folder::new("degrees");
    succeeded(&folder.run("init --robot arm.urdf --recording log.csv"));
    folder.replace("experiment.toml", "unit = \"rad\"", "unit = \"deg\"");
    let output = folder.run("check experiment.toml");
    assert_eq!(output.status.code(), Some(1), "{}", text(&output));
}

/// Columns whose names tell nothing are not guessed: the message says how to name them, and that works.
#[test]
fn columns_without_telling_names_are_asked_for() {
    let folder = Folder::new("columns");
    folder.replace("log.csv", "torque_", "channel_");
    let output = folder.run("init --robot arm.urdf --recording log.csv");
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output).contains("--torque"), "{}", text(&output));
    succeeded(&folder.run("init --robot arm.urdf --recording log.csv --torque channel_1,channel_2,channel_3"));
    succeeded(&folder.run("identify experiment.toml"));
}
