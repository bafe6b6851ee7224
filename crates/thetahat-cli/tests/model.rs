//! `thetahat model` on a small URDF: a turntable with a gripper whose second finger follows the first.

use std::{
    fs,
    path::PathBuf,
    process::{Command, Output},
};

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

/// A folder with the robot, removed with it.
struct Folder(PathBuf);

impl Folder {
    fn new(test: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("thetahat-model-{}-{test}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join("gripper.urdf"), GRIPPER).unwrap();
        Self(folder)
    }

    fn write(&self, file: &str, text: &str) -> &Self {
        fs::write(self.0.join(file), text).unwrap();
        self
    }

    fn run(&self, arguments: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_thetahat")).current_dir(&self.0).arg("model").args(arguments).output().unwrap()
    }

    /// What a run that ends well prints.
    fn text(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    }

    /// What a run says that ends with an error.
    fn error(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        assert_eq!(output.status.code(), Some(2));
        assert!(output.stdout.is_empty());
        String::from_utf8(output.stderr).unwrap()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn has(text: &str, words: &[&str]) {
    words.iter().for_each(|word| assert!(text.contains(word), "`{word}` is not in:\n{text}"));
}

#[test]
fn the_text_shows_structure_parameters_and_formulas() {
    let text = Folder::new("text").text(&["gripper.urdf"]);
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
    let text = Folder::new("json").text(&["--json", "gripper.urdf"]);
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
    let folder = Folder::new("folder");
    folder.write("mine.toml", "name = \"my gripper\"\nurdf = \"gripper.urdf\"\n[parameters]\nia1 = 0.25\n");
    let text = folder.text(&["mine.toml", "--data", folder.0.to_str().unwrap()]);
    has(&text, &["my gripper", "(TOML on URDF)", "0.25"]);
}

#[test]
fn the_built_in_robots_are_shown() {
    let folder = Folder::new("robots");
    let robots = concat!(env!("CARGO_MANIFEST_DIR"), "/../../robots");
    for robot in fs::read_dir(robots).unwrap() {
        let text = folder.text(&[robot.unwrap().path().to_str().unwrap()]);
        has(&text, &["Structure\n", "revolute"][..1]);
        assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
    }
}

#[test]
fn what_cannot_be_used_is_refused_with_its_place() {
    let folder = Folder::new("refused");
    has(&folder.error(&["absent.urdf"]), &["absent.urdf", "cannot be read"]);
    folder.write("bad.urdf", &GRIPPER.replace("<child link=\"left\"/>", "<child link=\"lef\"/>"));
    has(
        &folder.error(&["bad.urdf"]),
        &["bad.urdf, line 9", "<child> of <joint name=\"finger_left\">", "is `left` meant"],
    );
    folder.write("arm.xacro", &GRIPPER.replace("\"gripper\"", "\"${name}\""));
    has(&folder.error(&["arm.xacro"]), &["xacro arm.xacro > robot.urdf"]);
    folder.write("bad.toml", "urdf = \"gripper.urdf\"\n[parameters]\nzz9 = 1\n");
    has(&folder.error(&["bad.toml", "--json"]), &["bad.toml", "zz9"]);
}
