//! Exported robots read back: the torques of the file are those of the robot.

use std::path::Path;

use thetahat::{
    Robot,
    export::{Format, export_robot},
    robot::RobotSource,
};
use thetahat_testing::project;

/// The URDF of a robot with its a-priori parameters, edited where it has one, read back.
fn round_trip(file: &Path) -> f64 {
    let source = RobotSource::read(file).unwrap();
    let robot: Robot = source.robot().unwrap();
    let parameters = thetahat::consistency::completed_a_priori(&robot, None);
    let export = export_robot(&robot, source.urdf_text(), &parameters, Format::Urdf, &[]).unwrap();
    export.check().unwrap()
}

#[test]
fn urdf_of_the_robots_of_the_checkout_comes_back() {
    for name in ["two_joint.toml", "tx40.toml", "ur10.toml", "scara.toml", "emps.toml", "branching.urdf", "seven_axes.urdf"] {
        let worst = round_trip(&project("robots").join(name));
        println!("{name}: {worst:.1e}");
    }
}
