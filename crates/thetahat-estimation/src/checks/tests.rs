//! A robot whose first joint follows another: coordinate 0 is joint 2 and coordinate 1 is joint 3.

use std::{f64::consts::TAU, path::Path};

use super::{Code, Finding, Severity, SignalSettings, Subject, examine, measure};
use thetahat_ground::series::Series;
use thetahat_model::{
    base_parameters::BaseParameters, dynamics::Model, dynamics::Sign, regressor::Regressor, robot::Robot,
};
use thetahat_testing::noise;

/// A counterweight that follows the slide on an arm that turns. Kinds differ between a coordinate and the joint at its
/// index: coordinate 0 turns and joint 1 slides, coordinate 1 slides and joint 2 turns.
const CRANE: &str = r#"<robot name="crane">
  <link name="base"/>
  <link name="counterweight">
    <inertial><mass value="3"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
  </link>
  <link name="boom">
    <inertial>
      <origin xyz="0.2 0 0.05"/><mass value="4"/>
      <inertia ixx="0.2" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.3"/>
    </inertial>
  </link>
  <link name="carriage">
    <inertial>
      <origin xyz="0.1 0 0"/><mass value="2"/>
      <inertia ixx="0.05" ixy="0" ixz="0" iyy="0.05" iyz="0" izz="0.05"/>
    </inertial>
  </link>
  <joint name="follower" type="prismatic">
    <parent link="base"/><child link="counterweight"/><axis xyz="0 0 1"/>
    <mimic joint="slide" multiplier="-1"/><dynamics damping="2" friction="3"/>
  </joint>
  <joint name="turn" type="revolute">
    <parent link="base"/><child link="boom"/><origin xyz="0 0 1"/><axis xyz="0 1 0"/>
    <dynamics damping="1.5" friction="2.5"/>
  </joint>
  <joint name="slide" type="prismatic">
    <parent link="boom"/><child link="carriage"/><origin xyz="0.3 0 0"/><axis xyz="1 0 0"/>
    <dynamics damping="4" friction="5"/>
  </joint>
  <transmission name="turn_drive">
    <type>transmission_interface/SimpleTransmission</type>
    <joint name="turn"/><actuator name="turn_motor"><mechanicalReduction>40</mechanicalReduction></actuator>
  </transmission>
  <transmission name="slide_drive">
    <type>transmission_interface/SimpleTransmission</type>
    <joint name="slide"/><actuator name="slide_motor"><mechanicalReduction>90</mechanicalReduction></actuator>
  </transmission>
</robot>"#;

const RATE_HZ: f64 = 500.0;
const SAMPLES: usize = 6000;

/// Amplitude (rad or m), frequency (Hz) and phase (rad) of the sines of each coordinate.
const SINES: [[[f64; 3]; 2]; 2] = [[[0.8, 0.31, 0.0], [0.4, 0.83, 1.0]], [[0.25, 0.47, 0.5], [0.1, 1.13, 2.0]]];

/// The crane with a recording of its motion, to which a test adds a fault.
struct Crane {
    robot: Robot,
    position: Series,
    torque: Series,
    reconstructed_deviation: Vec<f64>,
}

impl Crane {
    /// A clean recording, with white noise of 0.2 % of the largest torques.
    fn recorded() -> Self {
        Self::moving([1.0, 1.0])
    }

    /// The same with each coordinate's motion times a factor.
    fn moving(factor: [f64; 2]) -> Self {
        let robot = Robot::parse(CRANE, Path::new("crane.urdf")).unwrap();
        let model = Model::new(&robot);
        let theta = robot.a_priori_parameters();
        let regressor = Regressor::new(&model, &(0..theta.len()).collect::<Vec<_>>());
        let [position, velocity, acceleration] = [0, 1, 2].map(|order| motion(order, factor));
        let phi = regressor.evaluate_series(&model, &position, &velocity, &acceleration, Sign::Exact);
        let mut torque = Series::zeros(SAMPLES, 2);
        for k in 0..SAMPLES {
            for (entry, value) in regressor.entries().iter().zip(phi.sample(k)) {
                torque.sample_mut(k)[entry.joint] += value * theta[entry.column];
            }
        }
        let mut noise = noise();
        torque.values_mut().iter_mut().for_each(|v| *v += 0.1 * noise());
        Self { robot, position, torque, reconstructed_deviation: vec![0.0; 2] }
    }

    fn with_subject<T>(&self, f: impl FnOnce(&Subject<'_>) -> T) -> T {
        let model = Model::new(&self.robot);
        let base = BaseParameters::of(&model, &[]).unwrap();
        f(&Subject {
            robot: &self.robot,
            model: &model,
            base: &base,
            all: &base,
            sample_rate_hz: RATE_HZ,
            time_s: None,
            position: &self.position,
            geared: true,
            velocity: None,
            torque: Some(&self.torque),
            reference: None,
            reconstructed_deviation: Some(&self.reconstructed_deviation),
            held_part_of_step: 0.0,
            left_out: &[],
            rests_left_out: false,
            contradicting_times: None,
            added_signal: false,
            signal: SignalSettings { filter_order: 4, cutoff_hz: 20.0, decimation: 10, window: 100..SAMPLES - 100 },
            controller: None,
        })
    }

    fn findings(&self) -> Vec<Finding> {
        self.with_subject(examine)
    }

    /// The first finding of a code that is not a note.
    fn found(&self, code: Code) -> Finding {
        let findings = self.findings();
        let found = findings.iter().find(|f| f.code == code && f.severity < Severity::Note);
        found.unwrap_or_else(|| panic!("{code} is not in {findings:#?}")).clone()
    }
}

/// A derivative of the positions of both coordinates.
fn motion(order: i32, factor: [f64; 2]) -> Series {
    let value = |coordinate: usize, k: usize| -> f64 {
        let quarter = 0.25 * TAU * f64::from(order);
        let sine = |[amplitude, hz, phase]: [f64; 3]| {
            let w = TAU * hz;
            amplitude * w.powi(order) * (w * k as f64 / RATE_HZ + phase + quarter).sin()
        };
        factor[coordinate] * SINES[coordinate].map(sine).iter().sum::<f64>()
    };
    Series::side_by_side(&[0, 1].map(|c| (0..SAMPLES).map(|k| value(c, k)).collect::<Vec<_>>()))
}

fn scale(series: &mut Series, coordinate: usize, factor: f64) {
    (0..series.len()).for_each(|k| series.sample_mut(k)[coordinate] *= factor);
}

/// Checks the joint, its name and the text of a finding about one coordinate.
fn is_about(finding: &Finding, joint: usize, name: &str, words: &str) {
    assert_eq!((finding.joint, finding.joint_name.as_deref()), (Some(joint), Some(name)), "{}", finding.message);
    assert!(finding.message.contains(words), "{}", finding.message);
}

#[test]
fn the_clean_recording_has_only_notes() {
    let findings = Crane::recorded().findings();
    assert!(findings.iter().all(|f| f.severity == Severity::Note), "{findings:#?}");
}

#[test]
fn degrees_are_considered_for_revolute_coordinates() {
    let mut crane = Crane::recorded();
    scale(&mut crane.position, 0, 1.0_f64.to_degrees());
    is_about(&crane.found(Code::PositionScale), 2, "turn", "joint 2's position is in degrees (or mm)");
}

#[test]
fn millimetres_are_considered_for_prismatic_coordinates() {
    let mut crane = Crane::recorded();
    scale(&mut crane.position, 1, 1e3);
    is_about(&crane.found(Code::PositionScale), 3, "slide", "joint 3's position is in degrees (or mm)");
}

#[test]
fn signs_and_ratios_name_the_coordinate_s_joint() {
    let mut crane = Crane::recorded();
    scale(&mut crane.torque, 0, -1.0);
    is_about(&crane.found(Code::TorqueSign), 2, "turn", "joint 2");
    let mut crane = Crane::recorded();
    scale(&mut crane.torque, 1, 1.3);
    is_about(&crane.found(Code::GearRatio), 3, "slide", "");
}

#[test]
fn a_still_coordinate_names_its_parameters_and_those_of_its_followers() {
    let turn = Crane::moving([0.0, 1.0]).found(Code::JointStill);
    is_about(&turn, 2, "turn", "joint 2 does not move");
    assert!(turn.parameters.contains(&"fv2".to_owned()), "{:?}", turn.parameters);
    assert!(turn.parameters.iter().all(|name| name.contains('2')), "{:?}", turn.parameters);
    let slide = Crane::moving([1.0, 0.0]).found(Code::JointStill);
    is_about(&slide, 3, "slide", "joint 3 does not move");
    assert!(!slide.parameters.is_empty());
    assert!(slide.parameters.iter().all(|name| !name.contains('2')), "{:?}", slide.parameters);
}

#[test]
fn a_deviation_from_the_reference_is_that_of_the_coordinate_s_joint() {
    let mut crane = Crane::recorded();
    crane.reconstructed_deviation[1] = 0.1;
    is_about(
        &crane.found(Code::ReferenceMismatch),
        3,
        "slide",
        "joint 3: the motion differs from the reconstructed reference by 1.000e-1 rad",
    );
}

/// Six joints with links of any parameters, recorded under usual gravity, with another gravity in the description.
fn six_axes(stated: [f64; 3]) -> Crane {
    let robot = Robot::parse(include_str!("../../../thetahat/demo/tx40.toml"), Path::new("tx40.toml")).unwrap();
    let model = Model::new(&robot);
    let all: Vec<usize> = (0..model.parameter_table().len()).collect();
    let sine = |order: i32, j: usize, k: usize| {
        let term = |frequency: f64, phase: f64| {
            let omega = TAU * frequency;
            omega.powi(order) * (omega * k as f64 / RATE_HZ + phase + TAU / 4.0 * f64::from(order)).sin()
        };
        0.6 * term(0.31 + 0.07 * j as f64, j as f64) + 0.3 * term(0.83 + 0.05 * j as f64, 2.0 * j as f64)
    };
    let [position, velocity, acceleration] = [0, 1, 2]
        .map(|order| Series::shaped(6, (0..SAMPLES).flat_map(|k| (0..6).map(move |j| sine(order, j, k))).collect()));
    let phi = Regressor::new(&model, &all);
    let values = phi.evaluate_series(&model, &position, &velocity, &acceleration, Sign::Exact);
    let mut noise = noise();
    let theta: Vec<f64> = all.iter().map(|_| 1.0 + 0.5 * noise()).collect();
    let mut torque = Series::zeros(SAMPLES, 6);
    for k in 0..SAMPLES {
        for (entry, value) in phi.entries().iter().zip(values.sample(k)) {
            torque.sample_mut(k)[entry.joint] += value * theta[entry.column];
        }
    }
    torque.values_mut().iter_mut().for_each(|v| *v += noise());
    let robot = Robot { gravity: stated, ..robot };
    Crane { robot, position, torque, reconstructed_deviation: vec![0.0; 6] }
}

#[test]
fn another_direction_of_gravity_is_found() {
    let tilt = 0.35_f64;
    let ceiling = ([0.0, 0.0, 9.81], "180 degrees");
    let wall = ([9.81, 0.0, 0.0], "90 degrees");
    let tilted = ([0.0, 9.81 * tilt.sin(), -9.81 * tilt.cos()], "20 degrees");
    for (stated, degrees) in [ceiling, wall, tilted] {
        let found = six_axes(stated).found(Code::GravityDirection);
        assert_eq!(found.severity, Severity::Problem);
        assert!(found.message.contains(degrees) && found.remedy.contains("-9.81]"), "{found:?}");
    }
    let right = six_axes([0.0, 0.0, -9.81]).findings();
    assert!(right.iter().all(|f| f.code != Code::GravityDirection), "{right:?}");
}

#[test]
fn measures_have_the_joint_s_number() {
    let measures = Crane::recorded().with_subject(measure);
    let of = |code| measures.iter().filter(|m| m.code == code).map(|m| m.joint).collect::<Vec<_>>();
    assert_eq!(of(Code::JointStill), [Some(2), Some(3)]);
    assert_eq!(of(Code::GearRatio), [Some(2), Some(3)]);
}
