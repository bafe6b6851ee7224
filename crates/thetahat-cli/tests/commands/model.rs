//! `thetahat model` on a small URDF: a turntable with a gripper whose second finger follows the first.

use std::{fs, process::Output};

use thetahat_testing::{Folder, project, refused, run, succeeded};

const PROGRAM: &str = env!("CARGO_BIN_EXE_thetahat");

const GRIPPER: &str = r#"<robot name="gripper">
  <link name="base"/>
  <link name="table"><inertial><origin xyz="0.1 0 0"/><mass value="2"/>
    <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.2"/></inertial></link>
  <link name="left"/>
  <link name="right"/>
  <joint name="turn" type="revolute"><parent link="base"/><child link="table"/><axis xyz="0 0 1"/>
    <limit lower="-1.5" upper="1.5" velocity="2" effort="30"/></joint>
  <joint name="finger_left" type="prismatic"><parent link="table"/><child link="left"/><axis xyz="0 1 0"/></joint>
  <joint name="finger_right" type="prismatic"><parent link="table"/><child link="right"/><axis xyz="0 1 0"/>
    <mimic joint="finger_left" multiplier="-1" offset="0.05"/></joint>
  <transmission name="t"><joint name="turn"/><actuator name="m"><mechanicalReduction>80</mechanicalReduction></actuator>
  </transmission>
</robot>
"#;

/// A folder with the robot.
struct Gripper(Folder);

impl Gripper {
    fn new() -> Self {
        let folder = Folder::new();
        folder.write("gripper.urdf", GRIPPER);
        Self(folder)
    }

    fn run(&self, arguments: &[&str]) -> Output {
        run(PROGRAM, self.0.path(), [&["model"], arguments].concat())
    }

    /// What a run that ends well prints.
    fn text(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        succeeded(&output);
        String::from_utf8(output.stdout).unwrap()
    }

    /// What a run says that ends with an error.
    fn error(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        assert!(output.stdout.is_empty());
        refused(&output)
    }
}

fn has(text: &str, words: &[&str]) {
    words.iter().for_each(|word| assert!(text.contains(word), "`{word}` is not in:\n{text}"));
}

#[test]
fn the_text_shows_structure_parameters_and_formulas() {
    let text = Gripper::new().text(&["gripper.urdf"]);
    has(&text, &["gripper.urdf (URDF)", "2, 1 of 3 joints following others", "0 0 -9.81 m/s^2"]);
    has(&text, &["-85.94..85.94 deg", "114.6 deg/s", "30 N m", "-1 q2 + 0.05 m"]);
    has(&text, &["motor positions per joint positions: 80 1", "Standard parameters: 42"]);
    has(
        &text,
        &["Base parameters:", "zz1 + ia1", "m2 + m3", "ia2 + ia3", "off2 - off3", "Without effect on any torque: xx1"],
    );
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
}

#[test]
fn the_json_says_the_same() {
    let text = Gripper::new().text(&["--json", "gripper.urdf"]);
    let report: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!((&report["name"], &report["format"]), (&"gripper".into(), &"URDF".into()));
    let follower = &report["joints"][2];
    assert_eq!(
        (&follower["parent"], &follower["mimic"]["joint"], &follower["mimic"]["ratio"]),
        (&1.into(), &2.into(), &(-1.0).into())
    );
    assert!(follower["coordinate"].is_null());
    assert_eq!(report["joints"][0]["upper"], 1.5);
    assert_eq!(report["transmission"]["matrix"][0][0], 80.0);
    assert_eq!(report["standard_parameters"].as_array().unwrap().len(), 42);
    let counts = &report["counts"]["base"];
    let kinds = ["inertial", "motor_inertia", "friction", "offset"].map(|kind| counts[kind].as_u64().unwrap());
    assert_eq!(kinds.iter().sum::<u64>(), report["base_parameters"].as_array().unwrap().len() as u64);
    assert_eq!(report["base_parameters"][0]["kept"], "zz1");
}

#[test]
fn a_description_on_the_urdf_and_a_folder() {
    let gripper = Gripper::new();
    gripper.0.write("mine.toml", "name = \"my gripper\"\nurdf = \"gripper.urdf\"\n[parameters]\nia1 = 0.25\n");
    let text = gripper.text(&["mine.toml", "--data", gripper.0.path().to_str().unwrap()]);
    has(&text, &["my gripper", "(TOML on URDF)", "0.25"]);
}

#[test]
fn the_built_in_robots_are_shown() {
    let gripper = Gripper::new();
    for robot in fs::read_dir(project("robots")).unwrap() {
        let path = robot.unwrap().path();
        // The motors of its head are coupled by a transmission that only matters where the head moves.
        let is_coupled = path.ends_with("mobile_manipulator.urdf");
        let until: &[&str] = if is_coupled { &["--until", "arm_7_joint"] } else { &[] };
        let text = gripper.text(&[&[path.to_str().unwrap()], until].concat());
        has(&text, &["Structure\n", "revolute"][..1]);
        assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
    }
}

#[test]
fn what_cannot_be_used_is_refused_with_its_place() {
    let gripper = Gripper::new();
    has(&gripper.error(&["absent.urdf"]), &["absent.urdf", "cannot be read"]);
    gripper.0.write("bad.urdf", GRIPPER.replace("<child link=\"left\"/>", "<child link=\"lef\"/>"));
    has(
        &gripper.error(&["bad.urdf"]),
        &["bad.urdf, line 9", "<child> of <joint name=\"finger_left\">", "is `left` meant"],
    );
    let argument = "<xacro:arg name=\"name\" default=\"\"/><link name";
    let given = GRIPPER.replace("\"gripper\"", "\"$(arg name)\"").replacen("<link name", argument, 1);
    gripper.0.write("given.xacro", given.replacen("<robot", "<robot xmlns:xacro=\"http://www.ros.org/wiki/xacro\"", 1));
    gripper.0.write("arm.xacro", GRIPPER.replace("\"gripper\"", "\"${name}\""));
    has(&gripper.error(&["arm.xacro"]), &["arm.xacro", "no property `name` is defined here"]);
    let expanded = gripper.text(&["given.xacro", "--xacro-arg", "name:=gripper", "--expand", "expanded.urdf"]);
    has(&expanded, &["written: expanded.urdf"]);
    has(&gripper.text(&["expanded.urdf"]), &["robot         gripper"]);
    gripper.0.write("bad.toml", "urdf = \"gripper.urdf\"\n[parameters]\nzz9 = 1\n");
    has(&gripper.error(&["bad.toml", "--json"]), &["bad.toml", "zz9"]);
}

#[test]
fn locked_joints_are_none_of_the_structure() {
    let gripper = Gripper::new();
    let text = gripper.text(&["gripper.urdf", "--lock", "finger_left=0.01"]);
    has(&text, &["locked        finger_left at 0.01 m, finger_right at 0.04 m", "coordinates   1\n"]);
    let until = gripper.text(&["gripper.urdf", "--until", "turn"]);
    has(&until, &["locked        finger_left at 0 m, finger_right at 0.05 m"]);
    has(
        &gripper.error(&["gripper.urdf", "--until", "wrist"]),
        &[
            "the command line: until: the robot has no moving joint `wrist`; its moving joints are turn finger_left finger_right",
        ],
    );
    has(&gripper.error(&["gripper.urdf", "--lock", "turn"]), &["expected JOINT=VALUE with a number in rad or m"]);
}

#[test]
fn what_no_robot_has_is_a_finding_of_the_description() {
    let gripper = Gripper::new();
    gripper.0.write("light.urdf", GRIPPER.replace("<mass value=\"2\"/>", "<mass value=\"-2\"/>"));
    let text = gripper.text(&["light.urdf"]);
    has(&text, &["Findings in the description", "a mass of -2", "-> give the mass of the link"]);
}
