//! Joints that turn, of which some are logged in degrees and others in rad.

use std::path::Path;

use super::*;
use thetahat_data::recording::inspect_with_time;
use thetahat_model::robot::RobotSource;

/// What is proposed for two joints whose angles have the amplitudes, in columns of these names.
fn proposed(names: &str, amplitudes: [f64; 2]) -> Result<Proposal, ProposalError> {
    let joint = |name: &str, parent: &str, child: &str| {
        format!("<joint name='{name}' type='continuous'><parent link='{parent}'/><child link='{child}'/></joint>")
    };
    let joints = joint("a", "l0", "l1") + &joint("b", "l1", "l2");
    let robot = format!("<robot name='arm'><link name='l0'/><link name='l1'/><link name='l2'/>{joints}</robot>");
    let row = |k: usize| {
        let wave = (0.1 * k as f64).sin();
        format!("{},{},{},{wave},{wave}\n", k as f64 * 1e-3, amplitudes[0] * wave, amplitudes[1] * wave)
    };
    let folder = thetahat_testing::Folder::new();
    folder.write("log.csv", format!("t,{names},tau1,tau2\n{}", (0..300).map(row).collect::<String>()));
    let contents = inspect_with_time(&folder.at("log.csv"), None).unwrap();
    let robot = RobotSource::from_text(robot, Path::new("arm.urdf")).unwrap();
    let request = ProposalRequest {
        robot_file: "arm.urdf".into(),
        recording_files: vec!["log.csv".into()],
        ..ProposalRequest::default()
    };
    propose(&request, &robot, &[contents])
}

/// The guess for the positions, where the names say no unit.
fn guess(amplitudes: [f64; 2]) -> String {
    proposed("q1,q2", amplitudes).unwrap().guesses().remove(0)
}

#[test]
fn a_joint_that_hardly_turns_in_degrees_may_be_in_rad() {
    assert!(guess([90.0, 1.5]).contains("b hardly turns in deg: in rad, write unit = [\"deg\", \"rad\"]"));
    let guesses_unit = |amplitudes| {
        let text = proposed("q1,q2", amplitudes).unwrap().text();
        text.lines().any(|line| line.starts_with("position") && line.contains("unit_guessed = true"))
    };
    assert!(guesses_unit([90.0, 1.5]));
    for all_in_one in [[90.0, 40.0], [90.0, 0.01], [1.5, 1.5]] {
        assert!(!guess(all_in_one).contains("hardly") && !guesses_unit(all_in_one), "{all_in_one:?}");
    }
}

#[test]
fn a_name_without_a_unit_is_refused_where_its_values_may_be_in_another() {
    for (names, amplitudes) in [("q1_deg,q2", [90.0, 1.5]), ("q1_rad,q2", [1.5, 90.0])] {
        let refused = proposed(names, amplitudes).unwrap_err();
        assert!(matches!(&refused, ProposalError::UnclearUnit { column, .. } if column == "q2"), "{refused}");
    }
    for (names, amplitudes) in [("q1_deg,q2", [90.0, 40.0]), ("q1_rad,q2", [1.5, 2.0]), ("q1_deg,q2_rad", [90.0, 1.5])]
    {
        assert!(proposed(names, amplitudes).is_ok(), "{names} {amplitudes:?}");
    }
}
