//! The robot as a stick figure.

use serde::Serialize;
use thetahat::{
    Recording, Robot, Series,
    robot::{FrameJoint, MovingFrames},
};

/// Largest number of instants of a motion.
const MOST: usize = 300;

/// Positions of the joints at some instants.
#[derive(Serialize)]
pub(super) struct Skeleton {
    joints: Vec<FrameJoint>,
    gravity: [f64; 3],
    /// The origin of each joint at each instant, m.
    frames: Vec<Vec<[f64; 3]>>,
    time_s: Vec<f64>,
}

impl Skeleton {
    /// During a recording.
    pub(super) fn of(robot: &Robot, recording: &Recording) -> Self {
        Self::at(robot, &recording.position, recording.sample_rate_hz)
    }

    /// At rest, each joint at zero.
    pub(super) fn at_rest(robot: &Robot) -> Self {
        Self::at(robot, &Series::zeros(1, robot.coordinate_count()), 1.0)
    }

    fn at(robot: &Robot, position: &Series, rate_hz: f64) -> Self {
        let MovingFrames { joints, gravity, samples, origins } = MovingFrames::of(robot, position, MOST);
        let time_s = samples.iter().map(|k| *k as f64 / rate_hz).collect();
        Self { joints, gravity, frames: origins, time_s }
    }
}
