//! The positions of a robot's joints during a motion.

use serde::Serialize;

use crate::{
    dynamics::Model,
    robot::{JointKind, Robot},
};
use thetahat_ground::series::Series;

/// The joints of a robot in space at several moments of a motion, in the frame of the base.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MovingFrames {
    /// The moving joints.
    pub joints: Vec<FrameJoint>,
    /// Gravity, m/s^2.
    pub gravity: [f64; 3],
    /// The sample number of each moment.
    pub samples: Vec<usize>,
    /// The origin of each joint at each moment, m.
    pub origins: Vec<Vec<[f64; 3]>>,
}

/// A joint whose origin moves.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FrameJoint {
    /// Its name.
    pub name: String,
    /// How it moves.
    pub kind: JointKind,
    /// The joint that carries it, from zero; none for one on the base.
    pub parent: Option<usize>,
}

impl MovingFrames {
    /// The frames at no more than `most` equally spaced samples of positions, one channel for each coordinate, rad or m.
    #[must_use]
    pub fn of(robot: &Robot, position: &Series, most: usize) -> Self {
        let model = Model::new(robot);
        let joint = |(j, joint): (usize, &crate::robot::Joint)| FrameJoint {
            name: joint.name.clone(),
            kind: joint.kind,
            parent: model.carrier(j),
        };
        let step = position.len().div_ceil(most.max(1)).max(1);
        let samples: Vec<usize> = (0..position.len()).step_by(step).collect();
        let at = |k: &usize| (0..model.link_count()).map(|j| model.frame(j, position.sample(*k)).0).collect();
        Self {
            joints: robot.joints.iter().enumerate().map(joint).collect(),
            gravity: robot.gravity,
            origins: samples.iter().map(at).collect(),
            samples,
        }
    }
}
