//! A small bag in MCAP as the users of a driver record it, of the arm in `examples` or a leg, and the experiment that is proposed for it.

use std::path::Path;

use super::*;
use crate::experiment::{Driver, Experiment};
use thetahat_data::recording::inspect_with_time;
use thetahat_model::robot::RobotSource;
use thetahat_testing::{Cdr, Folder, mcap, project};

const SAMPLES: usize = 400;
const STEP_NS: u64 = 2_000_000;
const START_NS: u64 = 1_700_000_000_000_000_000;
const ARM: [&str; 3] = ["waist", "shoulder", "elbow"];
/// Legs of a quadruped in another order than its motors.
const LEG: [&str; 3] = ["FL_hip_joint", "FL_thigh_joint", "FL_calf_joint"];
/// The first motor of that leg, and the number of motors in a message.
const FIRST: usize = 3;
const MOTORS: usize = 20;
/// Torque at the joint per ampere, which the test fills in.
const FILLED_IN: f64 = 12.5;
/// Positions and torques of 32 bits.
const ROUNDING: f64 = 1e-6;

const LOW_STATE: &str = "uint8[2] head\nMotorState[20] motor_state\n\
    ================================================================================\n\
    MSG: unitree_go/MotorState\nuint8 mode\nfloat32 q\nfloat32 dq\nfloat32 tau_est\n";
const LBR_STATE: &str = "int8 session_state\nfloat64[3] measured_joint_position\nfloat64[3] commanded_joint_position\n\
    float64[3] measured_torque\n";

/// A driver, what it writes, and what the proposal has to say.
struct Bag {
    preset: &'static str,
    joints: [&'static str; 3],
    /// Type and definition of the messages.
    kind: [&'static str; 2],
    /// A message of positions, velocities and torques in N m, or A.
    message: fn(u64, [&[f64]; 3]) -> Cdr,
    /// The line of the torques.
    torque: &'static str,
    has_reference: bool,
}

fn joint_state(time_ns: u64, joints: &[&str], [q, dq, tau]: [&[f64]; 3], scale: f64) -> Cdr {
    let effort: Vec<f64> = tau.iter().map(|tau| scale * tau).collect();
    Cdr::default().joint_state(time_ns, joints, [q, dq, &effort])
}

fn low_state([q, dq, tau]: [&[f64]; 3]) -> Cdr {
    (0..MOTORS).fold(Cdr::default().u8(1).u8(2), |message, motor| {
        let of = |values: &[f64]| motor.checked_sub(FIRST).and_then(|j| values.get(j)).map_or(0.5, |v| *v as f32);
        message.u8(1).f32(of(q)).f32(of(dq)).f32(of(tau))
    })
}

fn bags() -> Vec<Bag> {
    let of_ros = |preset, message, torque| Bag {
        preset,
        joints: ARM,
        kind: ["sensor_msgs/msg/JointState", ""],
        message,
        torque,
        has_reference: false,
    };
    let negated = r#""elbow.effort"], unit = "N m", gain = -1 }"#;
    vec![
        of_ros("ur-ros2", |t, m| joint_state(t, &ARM, m, 1.0), r#""elbow.effort"], unit = "A", gain = [] }"#),
        of_ros("interbotix", |t, m| joint_state(t, &ARM, m, 1e3), r#""elbow.effort"], unit = "mA", gain = [] }"#),
        of_ros("ros-joint-states", |t, m| joint_state(t, &ARM, m, 1.0), r#""elbow.effort"], unit = "N m" }"#),
        of_ros("franka", |t, m| joint_state(t, &ARM, m, 1.0), r#""elbow.effort"], unit = "N m" }"#),
        of_ros("kinova-ros2", |t, m| joint_state(t, &ARM, m, -1.0), negated),
        of_ros("kuka-ros2", |t, m| joint_state(t, &ARM, m, -1.0), negated),
        Bag {
            preset: "unitree-go2",
            joints: LEG,
            kind: ["unitree_go/msg/LowState", LOW_STATE],
            message: |_, m| low_state(m),
            torque: r#""motor_state[5].tau_est"], unit = "N m" }"#,
            has_reference: false,
        },
        Bag {
            preset: "kuka-fri",
            joints: ARM,
            kind: ["lbr_fri_idl/msg/LBRState", LBR_STATE],
            message: |_, [q, _, tau]| {
                let negative: Vec<f64> = tau.iter().map(|tau| -tau).collect();
                Cdr::default().u8(4).f64s(q).f64s(q).f64s(&negative)
            },
            torque: r#""measured_torque[2]"], unit = "N m", gain = -1 }"#,
            has_reference: true,
        },
    ]
}

/// Positions within the limits, rad, their velocities, and torques, N m or A.
fn motion(k: usize, joint: usize) -> [f64; 3] {
    let phase = 0.03 * k as f64 + joint as f64;
    [0.8 * phase.sin(), 12.0 * phase.cos(), 2.0 * (1.7 * phase).cos()]
}

impl Bag {
    fn bytes(&self) -> Vec<u8> {
        let message = |k: usize| {
            let time_ns = START_NS + STEP_NS * k as u64;
            let of = |signal: usize| (0..3).map(|j| motion(k, j)[signal]).collect::<Vec<_>>();
            (time_ns, (self.message)(time_ns, [&of(0), &of(1), &of(2)]).bytes())
        };
        mcap("/states", self.kind[0], self.kind[1], &(0..SAMPLES).map(message).collect::<Vec<_>>())
    }

    fn robot(&self) -> RobotSource {
        let renamed =
            |text: String, (from, to): (&&str, &&str)| text.replace(&format!("\"{from}\""), &format!("\"{to}\""));
        let arm = std::fs::read_to_string(project("examples/arm/arm.urdf")).unwrap();
        let text = ARM.iter().zip(&self.joints).fold(arm, renamed);
        RobotSource::from_text(text, Path::new("arm.urdf")).unwrap()
    }
}

/// Columns, units, signs, rate and reference are the driver's, and the reading of `identify` gives the motion and the torques again.
#[test]
fn each_preset_reads_the_bag_of_its_driver() {
    for bag in bags() {
        let folder = Folder::new();
        folder.write("log.mcap", bag.bytes());
        let robot = bag.robot();
        let request = ProposalRequest {
            robot_file: "arm.urdf".into(),
            recording_files: vec!["log.mcap".into()],
            driver: Some(Driver::find(bag.preset).unwrap()),
            ..ProposalRequest::default()
        };
        let contents = [inspect_with_time(&folder.at("log.mcap"), None).unwrap()];
        let proposal = propose(&request, &robot, &contents).unwrap_or_else(|e| panic!("{}: {e}", bag.preset));
        let text = proposal.text();
        assert!(text.contains(bag.torque), "{}: {text}", bag.preset);
        assert_eq!(bag.has_reference, text.contains("\nreference = {"), "{text}");
        let scale = if text.contains("gain = []") { FILLED_IN } else { 1.0 };
        let text = text.replace("gain = []", &format!("gain = [{FILLED_IN}, {FILLED_IN}, {FILLED_IN}]"));
        let experiment = Experiment::from_texts(Path::new("e.toml"), text.clone(), robot.to_text());
        let recordings = experiment.unwrap_or_else(|e| panic!("{e}\n{text}")).recordings(folder.path());
        let recording = &recordings.unwrap_or_else(|e| panic!("{e}\n{text}"))[0];
        assert!((recording.sample_rate_hz - 500.0).abs() < ROUNDING, "{}", recording.sample_rate_hz);
        for k in [0, 57, SAMPLES - 1] {
            for j in 0..3 {
                let [q, _, tau] = motion(k, j);
                let found = [recording.position.sample(k)[j], recording.torque.as_ref().unwrap().sample(k)[j]];
                assert!((found[0] - q).abs() < ROUNDING, "{}: position {} {q}", bag.preset, found[0]);
                assert!((found[1] - scale * tau).abs() < ROUNDING, "{}: torque {} {tau}", bag.preset, found[1]);
            }
        }
    }
}
