//! The robot in space.

use serde::Serialize;
use thetahat::{
    Recording, Robot, Series,
    robot::{FrameJoint, MovingFrames},
};

use super::ellipsoid::LinkBody;

/// Largest number of instants of a motion.
const MOST: usize = 300;

/// Positions of the joints and axes of their links at some instants, and the a-priori bodies of the links.
#[derive(Serialize)]
pub(super) struct Skeleton {
    joints: Vec<FrameJoint>,
    gravity: [f64; 3],
    /// The origin of each joint at each instant, m.
    frames: Vec<Vec<[f64; 3]>>,
    /// The axes of each joint's link at each instant, as columns.
    rotations: Vec<Vec<[[f32; 3]; 3]>>,
    time_s: Vec<f64>,
    bodies: Vec<LinkBody>,
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
        let MovingFrames { joints, gravity, samples, origins, rotations } = MovingFrames::of(robot, position, MOST);
        let short = |rotation: [[f64; 3]; 3]| rotation.map(|row| row.map(|entry| entry as f32));
        let time_s = samples.iter().map(|k| *k as f64 / rate_hz).collect();
        Self {
            joints,
            gravity,
            frames: origins,
            rotations: rotations.into_iter().map(|links| links.into_iter().map(short).collect()).collect(),
            time_s,
            bodies: LinkBody::all_of(robot, &robot.a_priori_parameters()),
        }
    }
}
