//! Units of joints that slide, where the log says none.

use std::path::Path;

use super::*;
use thetahat_data::recording::{Unit, inspect_with_time};
use thetahat_model::robot::RobotSource;

const LIMITS: &str = "<limit lower='-0.1' upper='0.1' effort='9' velocity='9'/>";
const NO_LIMITS: &str = "<limit effort='9' velocity='9'/>";

/// The units of a turn of 1.5 rad or deg and a stroke, with limits of the slide or none.
fn units(turn: f64, stroke: f64, limits: &str) -> Vec<Unit> {
    let joint = |name: &str, kind: &str, links: [&str; 2], limit: &str| {
        let [parent, child] = links;
        format!("<joint name='{name}' type='{kind}'><parent link='{parent}'/><child link='{child}'/>{limit}</joint>")
    };
    let joints = joint("a", "continuous", ["l0", "l1"], "") + &joint("b", "prismatic", ["l1", "l2"], limits);
    let robot = format!("<robot name='scara'><link name='l0'/><link name='l1'/><link name='l2'/>{joints}</robot>");
    let row = |k: usize| {
        let wave = (0.1 * k as f64).sin();
        format!("{},{},{},{wave},{wave}\n", k as f64 * 1e-3, turn * wave, 0.5 * stroke * wave)
    };
    let folder = thetahat_testing::Folder::new();
    folder.write("log.csv", format!("t,q1,q2,tau1,tau2\n{}", (0..300).map(row).collect::<String>()));
    let contents = inspect_with_time(&folder.at("log.csv"), None).unwrap();
    let robot = RobotSource::from_text(robot, Path::new("scara.urdf")).unwrap();
    let request = ProposalRequest {
        robot_file: "scara.urdf".into(),
        recording_files: vec!["log.csv".into()],
        ..ProposalRequest::default()
    };
    propose(&request, &robot, &[contents]).unwrap().recordings[0].channels[0].1.unit.given().to_vec()
}

#[test]
fn a_stroke_too_large_for_metres_is_in_millimetres() {
    assert_eq!(units(1.5, 180.0, LIMITS), [Unit::Radian, Unit::Millimetre]);
    assert_eq!(units(90.0, 180.0, LIMITS), [Unit::Degree, Unit::Millimetre]);
    assert_eq!(units(90.0, 180.0, NO_LIMITS), [Unit::Degree, Unit::Millimetre]);
    assert_eq!(units(90.0, 0.18, LIMITS), [Unit::Degree, Unit::Metre]);
    assert_eq!(units(1.5, 2.0, NO_LIMITS), [Unit::Radian, Unit::Metre]);
}

/// Counts of an encoder are neither.
#[test]
fn a_stroke_too_large_for_millimetres_stays_in_metres() {
    assert_eq!(units(1.5, 1e6, LIMITS), [Unit::Radian, Unit::Metre]);
}
