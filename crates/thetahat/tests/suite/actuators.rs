//! Drives that were identified from positions and commands, in the files of PACE, Isaac Lab and BAM.

use std::{path::Path, sync::OnceLock};

use serde_json::Value;
use thetahat::{
    Experiment, Method, Results, Robot, Series,
    experiment::EstimateRequest,
    export::{Export, ExportError, ExportFormat, IdentifiedModel, export_robot},
    robot::RobotSource,
};
use thetahat_testing::project;

const ZERO_DEG: f64 = 12.0;
const DELAY_S: f64 = 0.006;
const STEP_S: f64 = 0.002;

/// A pendulum under gravity whose encoder is at zero where the joint is at twelve degrees.
const ROBOT: &str = "name = 'pendulum'\nfriction = 'symmetric'\n[[joint]]\nname = 'pivot.1'\nkind = 'revolute'\nalpha_deg = 90\n\
    [transmission]\nmatrix = [[1]]\noffset_deg = [12]\n\
    [parameters]\nm1 = 2\nmx1 = 0.2\nxx1 = 0.01\nyy1 = 0.05\nzz1 = 0.05\nia1 = 0.05\nfv1 = 0.3\nfc1 = 0.4\noff1 = 0.1";

const EXPERIMENT: &str = "title = 'servo'\nrobot = 'pendulum.toml'\n[twin]\nsample_rate_hz = 500\nunlisted = 'a-priori'\n\
    points = [[0], [40], [-30], [50], [0]]\nmax_velocity = [300]\nacceleration_time_s = 0.08\nsmoothing_time_s = 0.02\nrest_s = 0.1\n\
    [twin.sensors]\nencoder_counts_per_turn = 16384\ntorque_noise = [0.01]\ntorque_ripple = [0.0]\nripple_per_turn = 6\nseed = 1\n\
    [signal]\ncutoff_hz = 40\ndecimation = 1\n[parameters]\nestimate = 'drives'\n[estimation]\nmethods = ['cloe']\n\
    [controller]\nlaw = 'pd'\nposition_gain = 60\nvelocity_gain = 2\nsaturation = 20\nsample_time_s = 0.002\ndelay_s = 0.006";

fn identified() -> &'static (Results, IdentifiedModel) {
    static IDENTIFIED: OnceLock<(Results, IdentifiedModel)> = OnceLock::new();
    IDENTIFIED.get_or_init(|| {
        let path = Path::new("servo.toml");
        let experiment = Experiment::from_texts(path, EXPERIMENT.to_owned(), ROBOT.to_owned()).unwrap();
        let results = experiment.run(Path::new("."), &mut |_| {}).unwrap();
        let request = EstimateRequest { method: Some(Method::CLOE), untrusted: true, ..EstimateRequest::default() };
        let model = IdentifiedModel::of_results(Path::new("results.json"), &results, &request).unwrap();
        (results, model)
    })
}

fn exported(format: ExportFormat) -> (Export, Value) {
    let export = identified().1.export(format).unwrap();
    let file = serde_json::from_str(&export.text).unwrap();
    (export, file)
}

fn estimate(name: &str) -> f64 {
    let run = identified().0.run("nominal", Method::CLOE).unwrap();
    run.parameter(name).unwrap().estimate
}

fn near(found: &Value, expected: f64) {
    let found = found.as_f64().unwrap();
    assert!((found - expected).abs() <= 1e-9 * expected.abs().max(1e-3), "{found} for {expected}");
}

#[test]
fn the_twin_is_found() {
    for (name, truth) in [("ia1", 0.05), ("fv1", 0.3), ("fc1", 0.4)] {
        assert!((estimate(name) / truth - 1.0).abs() < 0.1, "{name} {}", estimate(name));
    }
}

#[test]
fn pace_has_four_numbers_of_a_joint_and_a_delay() {
    let (export, file) = exported(ExportFormat::Pace);
    assert_eq!(file["joint_order"], serde_json::json!(["pivot.1"]));
    assert_eq!((file["delay_mode"].as_str(), file["step_s"].as_f64()), (Some("command"), Some(STEP_S)));
    let params = file["params"].as_array().unwrap();
    let expected = [estimate("ia1"), estimate("fv1"), estimate("fc1"), ZERO_DEG.to_radians(), DELAY_S / STEP_S];
    assert_eq!(params.len(), expected.len());
    params.iter().zip(expected).for_each(|(found, expected)| near(found, expected));
    // PACE's encoders are at q - bias where the joint is at q.
    let encoder = Series::from_channels(&[vec![0.3]]).unwrap();
    let joint = identified().1.identified.robot.transmission.joint_positions(&encoder);
    near(&params[3], joint.sample(0)[0] - 0.3);
    let lost = export.not_represented.concat();
    assert!(lost.contains("constant torque") && lost.contains("no links") && !lost.contains("zero"), "{lost}");
    assert!(export.check().unwrap() < 1e-12);
}

#[test]
fn isaac_has_the_arguments_of_a_delayed_controller() {
    let (export, file) = exported(ExportFormat::Isaac);
    assert_eq!(file["class"], "DelayedPDActuatorCfg");
    let (settings, joint) = (&file["settings"], "pivot\\.1");
    assert_eq!(settings["joint_names_expr"], serde_json::json!([joint]));
    let expected = [
        ("stiffness", 60.0),
        ("damping", 2.0),
        ("armature", estimate("ia1")),
        ("friction", estimate("fc1")),
        ("dynamic_friction", estimate("fc1")),
        ("viscous_friction", estimate("fv1")),
        ("effort_limit", 20.0),
    ];
    for (key, value) in expected {
        near(&settings[key][joint], value);
    }
    assert_eq!((settings["min_delay"].as_u64(), settings["max_delay"].as_u64()), (Some(3), Some(3)));
    assert!(export.not_represented.concat().contains("joint positions at the motors' zero"));
    assert!(export.check().unwrap() < 1e-12);
}

#[test]
fn bam_has_the_parameters_of_an_actuator_that_it_knows() {
    let (export, file) = exported(ExportFormat::Bam);
    assert_eq!((file["model"].as_str(), file["actuator"].as_str()), (Some("m1"), Some("unitree_go1")));
    let expected = [
        ("ratio", 1.0),
        ("max_torque", 20.0),
        ("armature", estimate("ia1")),
        ("friction_base", estimate("fc1")),
        ("friction_viscous", estimate("fv1")),
        // BAM's gravity acts at the logged position plus this.
        ("q_offset", ZERO_DEG.to_radians()),
        ("command_delay", DELAY_S),
    ];
    for (key, value) in expected {
        near(&file[key], value);
    }
    assert!(export.notes.concat().contains("kp 60 N m/rad"), "{:?}", export.notes);
    assert!(export.check().unwrap() < 1e-12);
}

#[test]
fn a_changed_number_is_found() {
    for (format, key) in [
        (ExportFormat::Pace, "\"params\": [\n"),
        (ExportFormat::Isaac, "pivot\\\\.1\": "),
        (ExportFormat::Bam, "armature\": "),
    ] {
        let (mut export, _) = exported(format);
        let at = export.text.find("\"armature\"").or(export.text.find(key)).unwrap();
        let digit = at + export.text[at..].find("0.").unwrap() + 2;
        export.text.insert(digit, '9');
        assert!(matches!(export.check(), Err(ExportError::RoundTrip { .. })), "{format}");
    }
    let (mut export, _) = exported(ExportFormat::Bam);
    export.text = export.text.replace("friction_viscous", "viscous");
    assert!(matches!(export.check(), Err(ExportError::ReadBack { .. })));
}

#[test]
fn mujoco_has_the_constant_torque_and_the_delay() {
    let export = identified().1.export(ExportFormat::Mjcf).unwrap();
    let constant = estimate("off1");
    assert!(
        constant.abs() > 0.01 && export.text.contains(&format!("biasprm=\"{} -60 -2\"", -constant)),
        "{}",
        export.text
    );
    for written in
        ["delay=\"0.006\" nsample=\"8\"", "integrator=\"RK4\"", "solreffriction=\"0.002 1\"", "needs MuJoCo 3.5"]
    {
        assert!(export.text.contains(written), "{written}: {}", export.text);
    }
    assert!(!export.not_represented.concat().contains("constant torque"));
    assert!(export.check().unwrap() < 1e-9);
}

/// With a thousand times the damping, RK4 would diverge at a step of 1 ms.
#[test]
fn fast_damping_gets_an_implicit_integrator() {
    let mut model = identified().1.clone();
    let viscous = model.identified.robot.parameter_table().index_of("fv1").unwrap();
    model.standard[viscous] *= 1000.0;
    let text = model.export(ExportFormat::Mjcf).unwrap().text;
    assert!(text.contains("integrator=\"implicitfast\"") && text.contains("too fast for RK4"), "{text}");
}

/// Without a controller, of several joints, with coupled motors, with joints that follow others.
#[test]
fn what_a_format_of_drives_cannot_hold_is_refused() {
    let of = |robot: &Robot, format| export_robot(robot, None, &robot.a_priori_parameters(), format, &[]);
    let read = |file: &str| RobotSource::read(&project("robots").join(file)).unwrap();
    let (coupled, follower) = (read("tx40.toml").robot().unwrap(), read("mobile_manipulator.urdf"));
    let follower = follower.robot_without_transmission().unwrap();
    for format in [ExportFormat::Pace, ExportFormat::Isaac, ExportFormat::Bam] {
        assert!(matches!(of(&coupled, format), Err(ExportError::CoupledActuators { motor: 6, .. })));
        assert!(matches!(of(&follower, format), Err(ExportError::FollowerInActuators { .. })));
    }
    let plain = read("two_joint.toml").robot().unwrap();
    assert!(of(&plain, ExportFormat::Pace).unwrap().check().unwrap() < 1e-12);
    for format in [ExportFormat::Isaac, ExportFormat::Bam] {
        let error = of(&plain, format).unwrap_err().to_string();
        assert!(error.contains("holds a controller, and none was identified"), "{error}");
    }
}
