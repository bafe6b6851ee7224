use serde::{Deserialize, Serialize};

use crate::robot::{JointKind, Robot};

/// A joint whose position is one of the robot's coordinates.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct JointResult {
    /// Its name.
    pub name: String,
    /// How it moves.
    pub kind: JointKind,
    /// Unit of its position: rad or m.
    pub position_unit: String,
    /// Unit of its torque or force: N m or N.
    pub torque_unit: String,
}

impl JointResult {
    /// The joints of a robot, one for each coordinate and in their order.
    #[must_use]
    pub fn of_coordinates(robot: &Robot) -> Vec<Self> {
        let result = |name: &str, kind: JointKind| {
            let position_unit = match kind {
                JointKind::Revolute => "rad",
                JointKind::Prismatic => "m",
            };
            let [position_unit, torque_unit] = [position_unit, kind.torque_unit()].map(str::to_owned);
            Self { name: name.to_owned(), kind, position_unit, torque_unit }
        };
        robot.coordinates().map(|joint| result(&joint.name, joint.kind)).collect()
    }
}
