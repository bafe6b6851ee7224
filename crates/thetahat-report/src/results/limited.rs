use serde::Serialize;

use thetahat_model::robot::JointKind;

/// A quantity that a joint's limits bound.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Limited {
    /// Position.
    Position,
    /// Velocity.
    Velocity,
    /// Acceleration.
    Acceleration,
    /// Jerk.
    Jerk,
    /// Torque.
    Torque,
    /// Product of torque and velocity.
    Power,
}

impl Limited {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Position, Self::Velocity, Self::Acceleration, Self::Jerk, Self::Torque, Self::Power];

    /// Its name, as in a design file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Jerk => "jerk",
            Self::Torque => "torque",
            Self::Power => "power",
        }
    }

    /// Its order as a derivative of the position; none for quantities that depend on dynamics.
    #[must_use]
    pub fn order(self) -> Option<usize> {
        match self {
            Self::Position => Some(0),
            Self::Velocity => Some(1),
            Self::Acceleration => Some(2),
            Self::Jerk => Some(3),
            Self::Torque | Self::Power => None,
        }
    }

    /// A value in SI converted to the units of a design file: degrees or mm, N m or N, W.
    #[must_use]
    pub fn to_file(self, kind: JointKind, value: f64) -> f64 {
        if self.order().is_some() { kind.to_file(value) } else { value }
    }

    /// The unit of such a value.
    #[must_use]
    pub fn file_unit(self, kind: JointKind) -> &'static str {
        let of = |turning: &'static str, sliding: &'static str| match kind {
            JointKind::Revolute => turning,
            JointKind::Prismatic => sliding,
        };
        match self {
            Self::Position => kind.file_unit(),
            Self::Velocity => of("degrees/s", "mm/s"),
            Self::Acceleration => of("degrees/s^2", "mm/s^2"),
            Self::Jerk => of("degrees/s^3", "mm/s^3"),
            Self::Torque => kind.torque_unit(),
            Self::Power => "W",
        }
    }
}
