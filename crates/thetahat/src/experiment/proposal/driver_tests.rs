//! A small log in the format of each driver, of the arm in `examples`, and the experiment that is proposed for it.

use std::path::Path;

use super::*;
use crate::experiment::{Driver, Experiment};
use thetahat_data::recording::{Side, inspect_with_time};
use thetahat_model::robot::RobotSource;
use thetahat_testing::{Folder, project};

const SAMPLES: usize = 400;
const JOINTS: [&str; 3] = ["waist", "shoulder", "elbow"];
/// Torque at the joint per ampere, per turn of a count, or at 100 %, which the test fills in.
const FILLED_IN: f64 = 12.5;

/// What a driver writes: `#` in a name is the number of the joint, `@` its name.
struct Format {
    preset: &'static str,
    time: &'static str,
    first: usize,
    position: &'static str,
    /// Counts, degrees or radians per radian.
    per_radian: f64,
    torque: &'static str,
    /// Newton metres, or milliamperes, or steps per newton metre, and per ampere where that is what is written.
    per_torque: f64,
    reference: &'static str,
    units: [&'static str; 2],
    /// The gain of the torque in the file; empty for one to fill in.
    gain: &'static str,
}

const DEGREES: f64 = 180.0 / std::f64::consts::PI;
const COUNTS: f64 = 4096.0 / std::f64::consts::TAU;

const fn format(preset: &'static str, position: &'static str, torque: &'static str, reference: &'static str) -> Format {
    let units = ["rad", "N m"];
    Format {
        preset,
        time: "t",
        first: 0,
        position,
        per_radian: 1.0,
        torque,
        per_torque: 1.0,
        reference,
        units,
        gain: "none",
    }
}

/// The formats, with factors that are written down here anew.
fn formats() -> Vec<Format> {
    let current = |of: Format, unit, per_torque, gain| Format { units: [of.units[0], unit], per_torque, gain, ..of };
    let degrees = |of: Format| Format { per_radian: DEGREES, units: ["deg", of.units[1]], ..of };
    let servo = |preset, steps| {
        let of = format(preset, "present_position_#", "present_current_#", "goal_position_#");
        current(Format { per_radian: COUNTS, first: 1, units: ["rev", ""], ..of }, "mA", 1e3 / steps, "")
    };
    vec![
        current(
            Format { time: "timestamp", ..format("ur-rtde", "actual_q_#", "actual_current_#", "target_q_#") },
            "A",
            1.0,
            "",
        ),
        current(format("ur-ros2", "@.position", "@.effort", ""), "A", 1.0, ""),
        format("franka", "q_#", "tau_J_#", "q_d_#"),
        format(
            "franka",
            "@.measured_joint_state.position",
            "@.measured_joint_state.effort",
            "@.desired_joint_state.position",
        ),
        Format {
            per_torque: -1.0,
            gain: "-1",
            ..format("kuka-fri", "measuredJointPosition[#]", "measuredTorque[#]", "commandedJointPosition[#]")
        },
        Format { per_torque: -1.0, gain: "-1", ..format("kuka-ros2", "@.position", "@.effort", "") },
        Format { per_torque: -1.0, gain: "-1", ..format("kinova-ros2", "@.position", "@.effort", "") },
        degrees(Format {
            per_torque: -1.0,
            gain: "-1",
            ..format("kinova", "actuators[#].position", "actuators[#].torque", "")
        }),
        degrees(format("doosan", "actual_joint_position[#]", "actual_motor_torque[#]", "target_joint_position[#]")),
        format("flexiv", "q[#]", "tau[#]", ""),
        current(
            degrees(Format {
                first: 1,
                ..format("fairino", "actual_joint_pos_#", "actual_joint_current_#", "target_joint_pos_#")
            }),
            "A",
            1.0,
            "",
        ),
        current(
            degrees(Format { first: 1, ..format("realman", "joint_position_#", "joint_current_#", "") }),
            "mA",
            1e3,
            "",
        ),
        current(format("interbotix", "@.position", "@.effort", ""), "mA", 1e3, ""),
        servo("dynamixel-x", 2.69),
        servo("dynamixel-330", 1.0),
        format("unitree-go2", "motor_state[#].q", "motor_state[#].tau_est", "motor_cmd[#].q"),
        format("unitree-g1", "motor_state[#].q", "motor_state[#].tau_est", ""),
        current(
            Format {
                first: 1,
                per_radian: COUNTS,
                ..format("cia402", "Position actual value #", "Torque actual value #", "")
            },
            "%",
            1e3,
            "",
        ),
        format("ros-joint-states", "@.position", "@.effort", ""),
    ]
}

/// Positions within the limits, rad, and torques, N m, or A where the driver writes a current.
fn motion(k: usize, joint: usize) -> [f64; 2] {
    let phase = 0.03 * k as f64 + joint as f64;
    [0.8 * phase.sin(), 2.0 * (1.7 * phase).cos()]
}

impl Format {
    fn name(&self, pattern: &str, joint: usize) -> String {
        pattern.replace('#', &(self.first + joint).to_string()).replace('@', JOINTS[joint])
    }

    fn log(&self) -> String {
        self.log_with_step(0.001)
    }

    fn log_with_step(&self, step: f64) -> String {
        let patterns = || [self.position, self.torque, self.reference].into_iter().filter(|p| !p.is_empty());
        let names = patterns().flat_map(|pattern| (0..3).map(|j| self.name(pattern, j)).collect::<Vec<_>>());
        let header: Vec<String> = [self.time.to_owned()].into_iter().chain(names).collect();
        let value = |k: usize, pattern: &str, j: usize| {
            let [q, tau] = motion(k, j);
            if pattern == self.torque { tau * self.per_torque } else { q * self.per_radian }
        };
        let row = |k: usize| {
            let values = patterns().flat_map(|pattern| (0..3).map(|j| value(k, pattern, j)).collect::<Vec<_>>());
            let row: Vec<String> = [step * k as f64].into_iter().chain(values).map(|v| v.to_string()).collect();
            row.join(";") + "\n"
        };
        format!("{}\n{}", header.join(";"), (0..SAMPLES).map(row).collect::<String>())
    }
}

fn arm() -> RobotSource {
    RobotSource::read(&project("examples/arm/arm.urdf")).unwrap()
}

fn proposed(folder: &Folder, driver: &str, robot: &RobotSource) -> Result<Proposal, ProposalError> {
    let request = ProposalRequest {
        robot_file: "arm.urdf".into(),
        recording_files: vec!["log.csv".into()],
        driver: Some(Driver::find(driver).unwrap()),
        ..ProposalRequest::default()
    };
    propose(&request, robot, &[inspect_with_time(&folder.at("log.csv"), None).unwrap()])
}

fn experiment(text: &str, robot: &RobotSource) -> Experiment {
    Experiment::from_texts(Path::new("e.toml"), text.to_owned(), robot.to_text())
        .unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// Columns, units and sides are the driver's, and the reading of `identify` gives the motion and the torques again.
#[test]
fn each_preset_reads_the_log_of_its_driver() {
    let robot = arm();
    for format in formats() {
        let folder = Folder::new();
        folder.write("log.csv", format.log());
        let proposal = proposed(&folder, format.preset, &robot).unwrap_or_else(|e| panic!("{}: {e}", format.preset));
        let text = proposal.text();
        for (number, (signal, pattern)) in
            [("position", format.position), ("torque", format.torque)].into_iter().enumerate()
        {
            let channels = &proposal.recordings[0].channels.iter().find(|(name, _)| *name == signal).unwrap().1;
            assert_eq!(channels.columns, (0..3).map(|j| format.name(pattern, j)).collect::<Vec<_>>(), "{text}");
            let is_counted = format.preset == "cia402" && signal == "position";
            let unit = if is_counted { "rad" } else { format.units[number] };
            let side = if format.preset.starts_with("dynamixel") { Side::Motor } else { Side::Joint };
            assert_eq!((channels.unit.of(0).symbol(), channels.side), (unit, side), "{text}");
        }
        let torque = &proposal.recordings[0].channels[1].1;
        match format.gain {
            "none" => assert!(torque.gain.is_none() && torque.factor.is_none(), "{text}"),
            "" => assert!(
                torque.gain.as_ref().is_some_and(|gain| gain.contains("per A") || gain.contains("100 %")),
                "{text}"
            ),
            gain => assert!(text.contains(&format!("unit = \"N m\", gain = {gain} }}")), "{text}"),
        }
        assert_eq!(format.reference.is_empty(), !text.contains("\nreference = {"), "{text}");
        assert!(proposal.of_driver().iter().all(|line| !line.contains("contradicts")), "{:?}", proposal.of_driver());
        let text = filled_in(&text, &format);
        let recording =
            &experiment(&text, &robot).recordings(folder.path()).unwrap_or_else(|e| panic!("{e}\n{text}"))[0];
        for k in [0, 57, SAMPLES - 1] {
            let scale = if format.gain.is_empty() { FILLED_IN } else { 1.0 };
            for j in 0..3 {
                let [q, tau] = motion(k, j);
                let found = [recording.position.sample(k)[j], recording.torque.as_ref().unwrap().sample(k)[j]];
                assert!((found[0] - q).abs() < 1e-9, "{}: position {} {q}", format.preset, found[0]);
                assert!((found[1] - scale * tau).abs() < 1e-9, "{}: torque {} {tau}", format.preset, found[1]);
            }
        }
    }
}

/// The gains to fill in, as the sentences ask for them.
fn filled_in(text: &str, format: &Format) -> String {
    let steps = match format.preset {
        "dynamixel-x" => 2.69,
        "cia402" => 0.1,
        _ => 1.0,
    };
    let text = if format.preset == "cia402" {
        text.replacen("gain = []", &format!("gain = {}", 1.0 / COUNTS), 1)
    } else {
        text.to_owned()
    };
    text.replace("gain = []", &format!("gain = [{0}, {0}, {0}]", steps * FILLED_IN))
}

/// The rate and the meaning of torque are said; a rate that is another one, too.
#[test]
fn the_driver_is_said_and_what_contradicts_it() {
    let folder = Folder::new();
    let franka = format("franka", "q_#", "tau_J_#", "q_d_#");
    folder.write("log.csv", franka.log_with_step(0.002));
    let said = proposed(&folder, "franka", &arm()).unwrap().of_driver().join("\n");
    assert!(
        said.contains("torque at the joint, N m") && said.contains("its rate is 500.00 Hz, the driver's 1000 Hz"),
        "{said}"
    );
    folder.write(
        "log.csv",
        franka.log().lines().map(|line| line.split_once(';').unwrap().1.to_owned() + "\n").collect::<String>(),
    );
    let proposal = proposed(&folder, "franka", &arm()).unwrap();
    assert!(proposal.text().contains("sample_rate_hz = 1000\n"), "{}", proposal.text());
    assert!(proposal.of_driver().join("\n").contains("no times; the driver's rate of 1000 Hz is assumed"));
}

/// Degrees in a log of radians, and a unit in the names of columns.
#[test]
fn values_and_names_that_contradict_the_driver_are_said() {
    let folder = Folder::new();
    let degrees = Format { per_radian: DEGREES, ..format("franka", "q_#", "tau_J_#", "") };
    folder.write("log.csv", degrees.log());
    let said = proposed(&folder, "franka", &arm()).unwrap().of_driver().join("\n");
    assert!(
        said.contains("contradicts the driver: position of log.csv: joint `waist` goes from -45.84 to 45.84 rad"),
        "{said}"
    );
    let named = Format { position: "q_# [deg]", ..degrees };
    folder.write("log.csv", named.log());
    let proposal = proposed(&folder, "franka", &arm()).unwrap();
    assert!(proposal.text().contains("\"q_2 [deg]\"], unit = \"deg\" }"), "{}", proposal.text());
    assert!(
        proposal
            .of_driver()
            .join("\n")
            .contains("the columns are named in deg, the driver franka has rad: deg is taken")
    );
    folder.write("log.csv", format("franka", "position_#", "effort_#", "").log());
    let error = proposed(&folder, "franka", &arm()).unwrap_err().to_string();
    assert!(error.contains("none of the columns of the driver franka (q_*"), "{error}");
}

/// Positions of a servo whose zero is in the middle of the turn are outside of the limits of the arm.
#[test]
fn a_zero_that_is_another_one_is_said() {
    let folder = Folder::new();
    let servo = Format { per_radian: COUNTS, first: 1, ..format("", "present_position_#", "present_current_#", "") };
    let shifted = |line: &str| {
        let shift = |(n, cell): (usize, &str)| match cell.parse::<f64>() {
            Ok(value) if (1..4).contains(&n) => (value + 2048.0).to_string(),
            Ok(_) | Err(_) => cell.to_owned(),
        };
        line.split(';').enumerate().map(shift).collect::<Vec<_>>().join(";") + "\n"
    };
    folder.write("log.csv", servo.log().lines().map(shifted).collect::<String>());
    let said = proposed(&folder, "dynamixel-x", &arm()).unwrap().of_driver().join("\n");
    assert!(said.contains("its limits are -2.80 and 2.80: unit, sign or zero may be others"), "{said}");
    assert!(said.contains("offset_deg = [-180, ...]"), "{said}");
}

/// What the driver says of the zero acts: with the offset positions lie within the limits.
#[test]
fn an_offset_of_the_transmission_sets_the_zero_of_servos() {
    let folder = Folder::new();
    let servo = Format { per_radian: COUNTS, first: 1, ..format("", "present_position_#", "present_current_#", "") };
    folder.write("log.csv", servo.log());
    let offset = "urdf = \"arm.urdf\"\n[transmission]\noffset_deg = [-180, -180, -180]\n";
    folder.write("arm.toml", offset);
    folder.write("arm.urdf", std::fs::read(project("examples/arm/arm.urdf")).unwrap());
    let robot = RobotSource::read(&folder.at("arm.toml")).unwrap();
    let proposal = proposed(&folder, "dynamixel-x", &robot).unwrap();
    assert!(proposal.of_driver().iter().any(|line| line.contains("contradicts")), "{:?}", proposal.of_driver());
    let text = proposal.text().replace("gain = []", "gain = [1, 1, 1]");
    let experiment = Experiment::from_texts(Path::new("e.toml"), text, robot.to_text()).unwrap();
    let positions = &experiment.recordings(folder.path()).unwrap()[0].position;
    let [q, _] = motion(57, 0);
    assert!((positions.sample(57)[0] - (q - std::f64::consts::PI)).abs() < 1e-9, "{}", positions.sample(57)[0]);
}

/// The motors of a quadruped are numbered in another order than the joints of a description of one leg.
#[test]
fn numbered_columns_are_of_the_driver_s_joints() {
    let leg = arm().to_text().replace("\"waist\"", "\"FL_hip_joint\"").replace("\"shoulder\"", "\"FL_thigh_joint\"");
    let leg = leg.replace("\"elbow\"", "\"FL_calf_joint\"");
    let robot = RobotSource::from_text(leg, Path::new("leg.urdf")).unwrap();
    let folder = Folder::new();
    let header: Vec<String> = (0..20).map(|n| format!("motor_state[{n}].q;motor_state[{n}].tau_est")).collect();
    let row = |k: usize| {
        let values = (0..20).map(|n| format!("{};{}", (0.02 * k as f64 + n as f64).sin(), n));
        format!("{};{}\n", 0.002 * k as f64, values.collect::<Vec<_>>().join(";"))
    };
    folder.write("log.csv", format!("t;{}\n{}", header.join(";"), (0..SAMPLES).map(row).collect::<String>()));
    let proposal = proposed(&folder, "unitree-go2", &robot).unwrap();
    let columns = &proposal.recordings[0].channels[1].1.columns;
    assert_eq!(columns, &["motor_state[3].tau_est", "motor_state[4].tau_est", "motor_state[5].tau_est"]);
    assert_eq!(proposal.locks, []);
}

/// A joint that the log lacks is locked; `first_number` of a preset keeps numbers from being shifted.
#[test]
fn joints_without_a_column_of_the_driver_are_locked() {
    let names = arm()
        .to_text()
        .replace("\"waist\"", "\"shoulder_pan_joint\"")
        .replace("\"shoulder\"", "\"shoulder_lift_joint\"");
    let robot = RobotSource::from_text(names.replace("\"elbow\"", "\"gripper\""), Path::new("arm.urdf")).unwrap();
    let folder = Folder::new();
    folder.write("log.csv", format("", "actual_q_#", "actual_current_#", "").log());
    let proposal = proposed(&folder, "ur-rtde", &robot).unwrap();
    assert_eq!(proposal.recordings[0].channels[0].1.columns, ["actual_q_0", "actual_q_1"]);
    assert_eq!(proposal.locks.iter().map(|lock| lock.joint.as_str()).collect::<Vec<_>>(), ["gripper"]);
}

/// A file of one's own: torque constants by joint, and a controller for a log without torques.
#[test]
fn a_driver_of_one_s_own_has_gains_and_a_controller() {
    let folder = Folder::new();
    let text = "title = 'mine'\neffort = 'motor current, A'\njoints = ['elbow', 'shoulder', 'waist']\n\
                [position]\ncolumns = ['axis_*_pv']\nunit = 'mrad'\n[torque]\ncolumns = ['axis_*_i']\nunit = 'A'\nscale = -0.01\n\
                gain = [10, 20, 30]\nside = 'joint'\n[reference]\ncolumns = ['axis_*_sp']\nunit = 'mrad'\n\
                [controller]\nposition_gain = 60\nvelocity_gain = [1, 2, 3]\n";
    folder.write("mine.toml", text);
    let mine = folder.at("mine.toml").display().to_string();
    folder.write("log.csv", Format { first: 1, ..format("", "axis_#_pv", "axis_#_i", "axis_#_sp") }.log());
    let text = proposed(&folder, &mine, &arm()).unwrap().text();
    assert!(
        text.contains(r#"columns = ["axis_3_i", "axis_2_i", "axis_1_i"], unit = "A", gain = [-0.3, -0.2, -0.1] }"#),
        "{text}"
    );
    assert!(text.contains(r#"["axis_3_sp", "axis_2_sp", "axis_1_sp"], unit = "mrad" }"#), "{text}");
    folder.write("log.csv", Format { first: 1, ..format("", "axis_#_pv", "axis_#_sp", "") }.log());
    let text = proposed(&folder, &mine, &arm()).unwrap().text();
    assert!(text.contains("position_gain = 60\n") && text.contains("velocity_gain = [1, 2, 3]"), "{text}");
}
