//! The joints and links of a robot in space during a motion.

use serde::Serialize;

use crate::{
    dynamics::Model,
    robot::{JointKind, Robot},
};
use thetahat_ground::{
    series::Series,
    vector::{IDENTITY, Mat3, Vec3, product},
};

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
    /// The axes of each joint's link at each moment, as columns: the link's own axes, to which its inertial parameters refer.
    pub rotations: Vec<Vec<[[f64; 3]; 3]>>,
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
    /// Its axis in the axes of its link.
    pub axis: [f64; 3],
}

impl MovingFrames {
    /// The frames at no more than `most` equally spaced samples of positions, one channel for each coordinate, rad or m.
    #[must_use]
    pub fn of(robot: &Robot, position: &Series, most: usize) -> Self {
        let model = Model::new(robot);
        let axes: Vec<Mat3> = robot.joints.iter().map(|joint| joint.link_axes.unwrap_or(IDENTITY)).collect();
        let joint = |(j, joint): (usize, &crate::robot::Joint)| FrameJoint {
            name: joint.name.clone(),
            kind: joint.kind,
            parent: model.carrier(j),
            axis: axes[j][2],
        };
        let step = position.len().div_ceil(most.max(1)).max(1);
        let samples: Vec<usize> = (0..position.len()).step_by(step).collect();
        let at = |k: &usize| -> (Vec<Vec3>, Vec<Mat3>) {
            let frames = model.frames(position.sample(*k));
            frames.iter().zip(&axes).map(|(frame, own)| (frame.origin, product(&frame.rotation, own))).unzip()
        };
        let (origins, rotations) = samples.iter().map(at).unzip();
        Self {
            joints: robot.joints.iter().enumerate().map(joint).collect(),
            gravity: robot.gravity,
            samples,
            origins,
            rotations,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::robot::RobotError;
    use thetahat_ground::vector::{norm, sub, times, transpose};

    /// Rounding of six products of rotations.
    const ROUNDING: f64 = 1e-14;

    /// The axes of links are those along which the chain of joints, followed from each joint to the base, has its joint axes.
    #[test]
    fn links_turn_with_their_joints() -> Result<(), RobotError> {
        let arm = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/arm/arm.urdf");
        let robot = Robot::read(&arm)?;
        let coordinates = robot.coordinate_count();
        let values = (0..20 * coordinates).map(|k| (0.7 * k as f64).sin()).collect();
        let position = Series::from_values(coordinates, values).expect("whole samples");
        let moving = MovingFrames::of(&robot, &position, 7);
        assert_eq!(moving.samples, [0, 3, 6, 9, 12, 15, 18]);
        let model = Model::new(&robot);
        for (at, k) in moving.samples.iter().enumerate() {
            for (j, joint) in moving.joints.iter().enumerate() {
                let (origin, axis) = model.frame(j, position.sample(*k));
                let rotation = moving.rotations[at][j];
                assert!(norm(sub(moving.origins[at][j], origin)) < ROUNDING);
                assert!(norm(sub(times(&rotation, joint.axis), axis)) < ROUNDING);
                let unit = product(&rotation, &transpose(&rotation));
                let off = unit.as_flattened().iter().zip(IDENTITY.as_flattened()).map(|(a, b)| (a - b).abs());
                assert!(off.fold(0.0, f64::max) < ROUNDING);
            }
        }
        Ok(())
    }
}
