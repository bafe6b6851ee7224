use serde::{Deserialize, Serialize};

use thetahat_model::robot::{JointKind, Robot};

/// Longest prefix of a numbered name that says no more than "joint".
const LONGEST_PREFIX: usize = 6;

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

    /// The joint's number from one, with its name if that says more than the number: "joint 7 (wrist)".
    #[must_use]
    pub fn label(&self, number: usize) -> String {
        let bare = self.name.trim_end_matches(|c: char| c.is_ascii_digit());
        let says_number = bare.len() <= LONGEST_PREFIX && self.name.ends_with(&number.to_string());
        if self.name.is_empty() || says_number {
            return format!("joint {number}");
        }
        format!("joint {number} ({})", self.name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_label_has_the_name_where_it_says_more_than_the_number() {
        let joint = |name: &str| JointResult {
            name: name.to_owned(),
            kind: JointKind::Revolute,
            position_unit: "rad".to_owned(),
            torque_unit: "N m".to_owned(),
        };
        let labels = ["joint_3", "j3", "", "elbow", "joint_2", "lwr_3_joint"].map(|name| joint(name).label(3));
        let expected =
            ["joint 3", "joint 3", "joint 3", "joint 3 (elbow)", "joint 3 (joint_2)", "joint 3 (lwr_3_joint)"];
        assert_eq!(labels, expected);
    }
}
