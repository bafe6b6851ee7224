//! Loops of links: joints are cut so that the rest is a tree, and closed again by conditions between two links.

use thetahat_ground::vector::{IDENTITY, Mat3, Vec3, add, transpose};

/// A condition that closes a loop of links: where a joint was cut, or a rod connects two links.
#[derive(Debug, Clone, PartialEq)]
pub struct Loop {
    /// Its name.
    pub name: String,
    /// What the two frames have in common.
    pub kind: LoopKind,
    /// A frame on one link.
    pub from: LoopFrame,
    /// A frame on the other.
    pub to: LoopFrame,
    /// Joints, from zero, and their positions near which the loop is closed, rad or m; zero for joints that are not listed.
    pub near: Vec<(usize, f64)>,
}

/// What two frames of a loop have in common.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LoopKind {
    /// Their origins: a ball joint was cut, or in a planar mechanism a revolute joint.
    Point,
    /// Their origins and z axes: a revolute joint was cut.
    Axis,
    /// All: a rigid connection was cut.
    Pose,
    /// The distance of their origins: a rod with a ball joint at each end.
    Distance {
        /// The length of the rod, m.
        length: f64,
    },
}

/// A frame on a link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopFrame {
    /// Index of the link's joint; none for the base.
    pub joint: Option<usize>,
    /// The frame's axes as columns, in the link's own axes.
    pub rotation: Mat3,
    /// Its origin in the link's own axes, from the origin of the joint's frame, m.
    pub origin: Vec3,
}

impl LoopFrame {
    /// A point of a link.
    #[must_use]
    pub fn of_point(joint: Option<usize>, origin: Vec3) -> Self {
        Self { joint, rotation: IDENTITY, origin }
    }

    /// A point at 1 m along an axis of the frame, in the link's own axes.
    fn along(&self, axis: usize) -> Vec3 {
        add(self.origin, transpose(&self.rotation)[axis])
    }
}

impl Loop {
    /// The joints that it names.
    pub(super) fn joints(&self) -> impl Iterator<Item = usize> + '_ {
        let near = self.near.iter().map(|(joint, _)| *joint);
        self.from.joint.into_iter().chain(self.to.joint).chain(near)
    }

    /// The points of the two links that coincide, or keep a distance, each in its link's own axes: `from`, `to`.
    #[must_use]
    pub fn points(&self) -> Vec<[Vec3; 2]> {
        let along = |axis: usize| [self.from.along(axis), self.to.along(axis)];
        let origins = [self.from.origin, self.to.origin];
        match self.kind {
            LoopKind::Point | LoopKind::Distance { .. } => vec![origins],
            LoopKind::Axis => vec![origins, along(2)],
            LoopKind::Pose => vec![origins, along(0), along(1)],
        }
    }
}

impl Loop {
    /// The same of a part of the robot, in which the joints have other places; none if it is not in this part.
    pub(super) fn renumbered(&self, place: &dyn Fn(usize) -> Option<usize>) -> Option<Self> {
        let frame = |frame: &LoopFrame| match frame.joint {
            None => Some(*frame),
            Some(joint) => Some(LoopFrame { joint: Some(place(joint)?), ..*frame }),
        };
        let near = self.near.iter().filter_map(|&(j, position)| Some((place(j)?, position))).collect();
        Some(Self { from: frame(&self.from)?, to: frame(&self.to)?, near, ..self.clone() })
    }
}
