//! A double pendulum of which only the elbow is driven: the shoulder's torque is zero, and right.

use std::path::Path;

use thetahat::{
    Identification, Method, Recording, Results, Robot, Series, Settings,
    dynamics::{DynamicParameters, Model, Sign, State, Workspace},
    results::Verdict,
    robot::RobotSource,
};
use thetahat_testing::noise;

const RATE_HZ: f64 = 200.0;
const SAMPLES: usize = 8000;
/// Steps of the integration in a sample.
const STEPS: usize = 10;
const SIGN: Sign = Sign::smooth(0.01);
const ARM: &str = r#"<robot name="acrobot">
<link name="base"/>
<link name="upper"><inertial><origin xyz="0 0 -0.25"/><mass value="1.2"/>
  <inertia ixx="0.02" iyy="0.02" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="lower"><inertial><origin xyz="0 0 -0.2"/><mass value="0.8"/>
  <inertia ixx="0.01" iyy="0.01" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
  <dynamics damping="0.05" friction="0"/></joint>
<joint name="elbow" type="continuous"><parent link="upper"/><child link="lower"/><origin xyz="0 0 -0.5"/><axis xyz="0 1 0"/>
  <dynamics damping="0.08" friction="0.1"/></joint>
</robot>"#;

fn robot() -> Robot {
    let source = RobotSource::from_text(ARM.to_owned(), Path::new("acrobot.urdf")).unwrap();
    source.robot_with_locks(&Default::default(), Path::new("acrobot.urdf")).unwrap()
}

/// The elbow's torque.
fn drive(t: f64) -> f64 {
    2.5 * (1.7 * t).sin() + 1.5 * (4.1 * t + 1.0).sin() + 0.8 * (7.3 * t).cos()
}

/// Positions and torques; the shoulder's drive, if it has one, holds it against part of the elbow's torque and is not recorded.
fn recording(robot: &Robot, unrecorded: f64) -> Recording {
    let model = Model::new(robot);
    let parameters = DynamicParameters::sorted(&model, &robot.a_priori_parameters());
    let mut workspace = Workspace::new(&model);
    let mut slope = |x: [f64; 4], t: f64| {
        let mut ddq = [0.0; 2];
        let tau = [unrecorded * drive(0.7 * t), drive(t)];
        let state = State::new(&x[..2], &x[2..]);
        model.forward_dynamics(&parameters, state, &tau, SIGN, &mut workspace, &mut ddq).unwrap();
        [x[2], x[3], ddq[0], ddq[1]]
    };
    let (mut x, h) = ([0.3, -0.4, 0.0, 0.0], 1.0 / (RATE_HZ * STEPS as f64));
    let (mut positions, mut torques, mut noise) = (Vec::new(), Vec::new(), noise());
    for k in 0..SAMPLES * STEPS {
        let t = k as f64 * h;
        if k % STEPS == 0 {
            positions.extend(x[..2].iter().map(|q| q + 2e-5 * noise()));
            torques.extend([0.0, drive(t) + 0.02 * noise()]);
        }
        // The classical method of fourth order.
        let along = |slope: [f64; 4], by: f64| std::array::from_fn(|i| x[i] + by * h * slope[i]);
        let k1 = slope(x, t);
        let k2 = slope(along(k1, 0.5), t + 0.5 * h);
        let k3 = slope(along(k2, 0.5), t + 0.5 * h);
        let k4 = slope(along(k3, 1.0), t + h);
        x = std::array::from_fn(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
    }
    Recording::new(RATE_HZ, Series::shaped(2, positions), Series::shaped(2, torques))
}

fn results(unrecorded: f64) -> Results {
    let robot = robot();
    let settings = Settings::new(20.0, 5).with_methods([Method::IDIM_WLS]);
    Identification::new(&robot, vec![recording(&robot, unrecorded)], settings).unwrap().run().unwrap()
}

#[test]
fn a_joint_that_nothing_drives_has_a_torque_of_zero() {
    let results = results(0.0);
    let text = results.to_json().unwrap();
    assert!(text.contains("nothing drives it"), "{:?}", results.verdict_reasons);
    assert_eq!(results.verdict, Some(Verdict::Good), "{:?}", results.verdict_reasons);
}

#[test]
fn a_torque_that_was_not_recorded_is_a_problem() {
    assert_eq!(results(0.5).verdict, Some(Verdict::DoNotUse));
}
