//! A log that counts a joint the other way than the description is that of the mirrored arm, which fits as well.

use std::path::Path;

use thetahat::{
    Identification, Method, Recording, Robot, Series, Settings,
    checks::{Code, Severity},
    dynamics::{DynamicParameters, Model, Sign, State, Workspace},
    robot::RobotSource,
};
use thetahat_testing::noise;

const RATE_HZ: f64 = 200.0;
const SAMPLES: usize = 4000;
/// A yaw, a pitch, and a forearm that rolls.
const ARM: &str = r#"<robot name="arm">
<link name="base"/>
<link name="turret"><inertial><origin xyz="0 0.09 -0.06"/><mass value="5.8"/>
  <inertia ixx="0.035" iyy="0.03" izz="0.03" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="upper"><inertial><origin xyz="0.02 -0.12 0.02"/><mass value="7.5"/>
  <inertia ixx="0.057" iyy="0.07" izz="0.066" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="forearm"><inertial><origin xyz="-0.03 0.056 -0.05"/><mass value="5.4"/>
  <inertia ixx="0.045" iyy="0.04" izz="0.044" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="yaw" type="continuous"><parent link="base"/><child link="turret"/><origin xyz="0 0 0.33"/><axis xyz="0 0 1"/></joint>
<joint name="pitch" type="continuous"><parent link="turret"/><child link="upper"/><origin rpy="-1.5708 0 0"/><axis xyz="0 0 1"/></joint>
<joint name="roll" type="continuous"><parent link="upper"/><child link="forearm"/><origin xyz="0 -0.32 0" rpy="1.5708 0 0"/><axis xyz="0 0 1"/></joint>
</robot>"#;

fn robot() -> Robot {
    let source = RobotSource::from_text(ARM.to_owned(), Path::new("arm.urdf")).unwrap();
    source.robot_with_locks(&Default::default(), Path::new("arm.urdf")).unwrap()
}

/// Positions of three joints with their derivatives: two waves each.
fn motion(t: f64) -> [[f64; 3]; 3] {
    let wave = |size: f64, w: f64, phase: f64| {
        let (sin, cos) = (w * t + phase).sin_cos();
        [size * sin, size * w * cos, -size * w * w * sin]
    };
    let of = |j: usize| {
        let w = [1.3, 1.9, 2.7][j];
        let (slow, fast) = (wave(0.7, w, j as f64), wave(0.3, 2.9 * w, 2.0 * j as f64));
        std::array::from_fn(|d| slow[d] + fast[d])
    };
    let of: [[f64; 3]; 3] = [of(0), of(1), of(2)];
    std::array::from_fn(|d| [of[0][d], of[1][d], of[2][d]])
}

/// The recording, with the signs that positions and torques are logged with.
fn recording(robot: &Robot, signs: [f64; 3]) -> Recording {
    let model = Model::new(robot);
    let parameters = DynamicParameters::sorted(&model, &robot.a_priori_parameters());
    let (mut workspace, mut noise) = (Workspace::new(&model), noise());
    let (mut positions, mut torques) = (Vec::new(), Vec::new());
    for k in 0..SAMPLES {
        let [q, dq, ddq] = motion(k as f64 / RATE_HZ);
        let mut tau = [0.0; 3];
        model.inverse_dynamics(&parameters, State::new(&q, &dq), &ddq, Sign::smooth(0.01), &mut workspace, &mut tau);
        positions.extend((0..3).map(|j| signs[j] * (q[j] + 1e-5 * noise())));
        torques.extend((0..3).map(|j| signs[j] * (tau[j] + 0.05 * noise())));
    }
    Recording::new(RATE_HZ, Series::shaped(3, positions), Series::shaped(3, torques))
}

fn signs_found(signs: [f64; 3]) -> Vec<(Option<usize>, Severity)> {
    let robot = robot();
    let settings = Settings::new(20.0, 4).with_methods([Method::IDIM_WLS]);
    let results = Identification::new(&robot, vec![recording(&robot, signs)], settings).unwrap().run().unwrap();
    let findings = results.findings.iter().flat_map(|r| &r.findings);
    findings.filter(|f| f.code == Code::PositionSign).map(|f| (f.joint, f.severity)).collect()
}

#[test]
fn the_masses_of_the_description_say_which_joint_is_reversed() {
    assert_eq!(signs_found([1.0, 1.0, 1.0]), []);
    assert_eq!(signs_found([1.0, -1.0, 1.0]), [(Some(2), Severity::Warning)]);
}
