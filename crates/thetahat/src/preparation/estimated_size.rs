//! Sizes in a description that are known from nothing but the recordings.

use std::fmt::{self, Display, Formatter};

use serde::Deserialize;
use thetahat_model::robot::Robot;

/// A size in the description that was estimated from the recordings; joints by their numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(try_from = "String")]
pub enum EstimatedSize {
    /// The gear ratio of a joint.
    GearRatio(usize),
    /// The factor on the positions of a joint.
    PositionScale(usize),
    /// The drive gain of a joint.
    DriveGain(usize),
    /// The direction of gravity.
    GravityDirection,
    /// The delay of the torques, of all joints or one.
    Lag(Option<usize>),
    /// The time constant of the filter of the torques.
    TorqueFilter,
}

impl EstimatedSize {
    /// Whether a robot has its joint.
    pub(super) fn is_of(self, robot: &Robot) -> bool {
        match self {
            Self::GearRatio(joint) | Self::PositionScale(joint) | Self::DriveGain(joint) | Self::Lag(Some(joint)) => {
                robot.coordinate_of_number(joint).is_some()
            }
            Self::GravityDirection | Self::TorqueFilter | Self::Lag(None) => true,
        }
    }
}

impl Display for EstimatedSize {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::GearRatio(joint) => write!(f, "gear-ratio-{joint}"),
            Self::PositionScale(joint) => write!(f, "position-scale-{joint}"),
            Self::DriveGain(joint) => write!(f, "drive-gain-{joint}"),
            Self::GravityDirection => f.write_str("gravity-direction"),
            Self::TorqueFilter => f.write_str("torque-filter"),
            Self::Lag(None) => f.write_str("lag"),
            Self::Lag(Some(joint)) => write!(f, "lag-{joint}"),
        }
    }
}

impl TryFrom<String> for EstimatedSize {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let of_joint = || {
            let (kind, number) = text.rsplit_once('-')?;
            let joint = number.parse().ok()?;
            match kind {
                "gear-ratio" => Some(Self::GearRatio(joint)),
                "position-scale" => Some(Self::PositionScale(joint)),
                "drive-gain" => Some(Self::DriveGain(joint)),
                "lag" => Some(Self::Lag(Some(joint))),
                _ => None,
            }
        };
        let found = match text.as_str() {
            "gravity-direction" => Some(Self::GravityDirection),
            "torque-filter" => Some(Self::TorqueFilter),
            "lag" => Some(Self::Lag(None)),
            _ => of_joint(),
        };
        found.ok_or_else(|| {
            format!(
                "expected gravity-direction, torque-filter, lag, or gear-ratio-2, position-scale-2, drive-gain-2, lag-2 (of joint 2), found {text:?}"
            )
        })
    }
}
