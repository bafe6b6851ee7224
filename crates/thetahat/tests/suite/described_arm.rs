//! What the checks say of logs of an arm whose description is right: which joints they count the other way, and that it is this arm.

use std::path::Path;

use thetahat::{
    Identification, Method, Recording, Results, Robot, Series, Settings,
    checks::{Code, Severity},
    dynamics::{DynamicParameters, Model, Sign, State, Workspace},
    results::Verdict,
    robot::RobotSource,
};
use thetahat_testing::noise;

const RATE_HZ: f64 = 200.0;
const SAMPLES: usize = 4000;
const JOINTS: usize = 3;
/// A yaw, a pitch, and a forearm that rolls.
const ARM: &str = r#"<robot name="arm">
<link name="base"/>
<link name="turret"><inertial><origin xyz="0 0.09 -0.06"/><mass value="5.8"/>
  <inertia ixx="0.035" iyy="0.03" izz="0.03" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="upper"><inertial><origin xyz="0.02 -0.12 0.02"/><mass value="7.5"/>
  <inertia ixx="0.057" iyy="0.07" izz="0.066" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="forearm"><inertial><origin xyz="-0.03 0.056 -0.05"/><mass value="5.4"/>
  <inertia ixx="0.045" iyy="0.04" izz="0.044" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="yaw" type="continuous"><parent link="base"/><child link="turret"/><origin xyz="0 0 0.33"/><axis xyz="0 0 1"/>
  <dynamics damping="3" friction="5"/></joint>
<joint name="pitch" type="continuous"><parent link="turret"/><child link="upper"/><origin rpy="-1.5708 0 0"/><axis xyz="0 0 1"/>
  <dynamics damping="4" friction="6"/></joint>
<joint name="roll" type="continuous"><parent link="upper"/><child link="forearm"/><origin xyz="0 -0.32 0" rpy="1.5708 0 0"/><axis xyz="0 0 1"/>
  <dynamics damping="2" friction="4"/></joint>
</robot>"#;
/// Coulomb friction of its joints, N m.
const FRICTION: [f64; JOINTS] = [5.0, 6.0, 4.0];

/// Positions with their derivatives, and the friction at rest.
struct Instant {
    q: [f64; JOINTS],
    dq: [f64; JOINTS],
    ddq: [f64; JOINTS],
    stiction: [f64; JOINTS],
}

fn robot() -> Robot {
    let source = RobotSource::from_text(ARM.to_owned(), Path::new("arm.urdf")).unwrap();
    source.robot_with_locks(&Default::default(), Path::new("arm.urdf")).unwrap()
}

/// Two waves of each joint.
fn waves(t: f64) -> Instant {
    let wave = |size: f64, w: f64, phase: f64| {
        let (sin, cos) = (w * t + phase).sin_cos();
        [size * sin, size * w * cos, -size * w * w * sin]
    };
    let of_joint: [[f64; 3]; JOINTS] = std::array::from_fn(|j| {
        let w = [1.3, 1.9, 2.7][j];
        let (slow, fast) = (wave(0.7, w, j as f64), wave(0.3, 2.9 * w, 2.0 * j as f64));
        std::array::from_fn(|d| slow[d] + fast[d])
    });
    let derivative = |d: usize| std::array::from_fn(|j| of_joint[j][d]);
    Instant { q: derivative(0), dq: derivative(1), ddq: derivative(2), stiction: [0.0; JOINTS] }
}

/// Moves of 0.8 s from pose to pose, and 0.8 s of rest after each, with a friction that the move left.
fn moves(t: f64) -> Instant {
    const LASTS_S: f64 = 0.8;
    let number = (t / (2.0 * LASTS_S)).floor();
    let u = ((t / LASTS_S) - 2.0 * number).min(1.0);
    let rests = u == 1.0;
    let pose = |number: f64, j: usize| 1.4 * (12.9898 * number + 78.233 * j as f64).sin();
    let way = |j: usize| pose(number + 1.0, j) - pose(number, j);
    let [s, ds, dds] = [
        u.powi(3) * (10.0 - 15.0 * u + 6.0 * u * u),
        30.0 * (u * (1.0 - u)).powi(2),
        60.0 * u * (1.0 - 3.0 * u + 2.0 * u * u),
    ];
    let left = |j: usize| 0.9 * (4.0 * number + 3.0 * j as f64).sin() * FRICTION[j];
    Instant {
        q: std::array::from_fn(|j| pose(number, j) + s * way(j)),
        dq: std::array::from_fn(|j| ds * way(j) / LASTS_S),
        ddq: std::array::from_fn(|j| dds * way(j) / LASTS_S.powi(2)),
        stiction: std::array::from_fn(|j| if rests { left(j) } else { 0.0 }),
    }
}

/// What is found in a log of a motion, with the signs that positions and torques are logged with.
fn results(motion: impl Fn(f64) -> Instant, signs: [f64; JOINTS]) -> Results {
    let robot = robot();
    let model = Model::new(&robot);
    let parameters = DynamicParameters::sorted(&model, &robot.a_priori_parameters());
    let (mut workspace, mut noise) = (Workspace::new(&model), noise());
    let (mut positions, mut torques) = (Vec::new(), Vec::new());
    for k in 0..SAMPLES {
        let Instant { q, dq, ddq, stiction } = motion(k as f64 / RATE_HZ);
        let mut tau = [0.0; JOINTS];
        model.inverse_dynamics(&parameters, State::new(&q, &dq), &ddq, Sign::smooth(0.01), &mut workspace, &mut tau);
        positions.extend((0..JOINTS).map(|j| signs[j] * (q[j] + 1e-5 * noise())));
        torques.extend((0..JOINTS).map(|j| signs[j] * (tau[j] + stiction[j] + 0.05 * noise())));
    }
    let recording = Recording::new(RATE_HZ, Series::shaped(JOINTS, positions), Series::shaped(JOINTS, torques));
    let settings = Settings::new(20.0, 4).with_methods([Method::IDIM_WLS]);
    Identification::new(&robot, vec![recording], settings).unwrap().run().unwrap()
}

fn found(results: &Results, code: Code) -> Vec<(Option<usize>, Severity)> {
    let findings = results.findings.iter().flat_map(|r| &r.findings);
    findings.filter(|f| f.code == code).map(|f| (f.joint, f.severity)).collect()
}

/// A log that counts a joint the other way is that of the mirrored arm, which fits as well.
#[test]
fn the_masses_of_the_description_say_which_joint_is_reversed() {
    assert_eq!(found(&results(waves, [1.0, 1.0, 1.0]), Code::PositionSign), []);
    assert_eq!(found(&results(waves, [1.0, -1.0, 1.0]), Code::PositionSign), [(Some(2), Severity::Warning)]);
}

/// At rest a joint's friction is anything between two values, which no geometry explains.
#[test]
fn an_arm_that_stands_half_of_the_time_is_this_arm() {
    let results = results(moves, [1.0, 1.0, 1.0]);
    assert_eq!(found(&results, Code::WrongRobot), []);
    assert_ne!(results.verdict, Some(Verdict::DoNotUse), "{:?}", results.verdict_reasons);
}
