use crate::dynamics::DynamicsError;

/// Why base parameters cannot be found.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BaseParametersError {
    /// A name that is not a standard parameter of the robot.
    #[error("there is no standard parameter `{name}` to exclude; names are like zz1, ia2, fcm6")]
    UnknownStandardParameter {
        /// The name.
        name: String,
    },
    /// A name that is not a base parameter of the robot.
    #[error("`{name}` is not a base parameter of this robot{hint}; they are: {}", known.join(" "))]
    UnknownBaseParameter {
        /// The name.
        name: String,
        /// The base parameters that contain it, if it is a standard parameter.
        hint: String,
        /// The base parameters.
        known: Vec<String>,
    },
    /// The loops of links cannot be closed.
    #[error("[[loop]]: {source}")]
    Loops {
        /// What is wrong with them.
        source: DynamicsError,
    },
    /// No parameter acts on any torque: all that do are excluded.
    #[error("`exclude` leaves no parameter that acts on any torque; exclude fewer")]
    NoneLeft,
    /// Two ways to count the base parameters disagree: the geometry is close to a special one.
    #[error(
        "the number of base parameters is not clear: {kept} columns are independent from left to right, but the rank \
         is {rank}; a length or angle of the robot is nearly, but not exactly, zero or a right angle"
    )]
    AmbiguousRank {
        /// Columns kept from left to right.
        kept: usize,
        /// Rank by pivoted QR.
        rank: usize,
    },
}
