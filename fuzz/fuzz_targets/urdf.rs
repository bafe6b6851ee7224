#![no_main]

use std::path::Path;

use thetahat_model::{dynamics::Model, robot::Robot};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    if let Ok(robot) = Robot::parse(text, Path::new("robot.urdf")) {
        let _ = Model::new(&robot);
    }
});
