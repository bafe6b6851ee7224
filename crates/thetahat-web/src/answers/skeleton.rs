//! The robot as a stick figure.

use serde::Serialize;
use thetahat::{
    Recording, Robot, Series,
    robot::{FrameJoint, MovingFrames},
};

/// Most moments of a motion.
const MOST: usize = 300;

/// Places of the joints at some moments.
#[derive(Serialize)]
pub(super) struct Skeleton {
    joints: Vec<FrameJoint>,
    gravity: [f64; 3],
    /// Of each moment the origin of each joint, m.
    frames: Vec<Vec<[f64; 3]>>,
    time_s: Vec<f64>,
}

impl Skeleton {
    /// In the course of a recording.
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
