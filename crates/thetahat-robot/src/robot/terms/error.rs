use crate::robot::MOST_JOINTS;

/// Why a torque term cannot be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TermError {
    /// A joint that the robot does not have.
    #[error("{term}: the robot has no joint `{joint}`; its joints are {}", known.join(", "))]
    UnknownJoint {
        /// The term.
        term: String,
        /// The name found.
        joint: String,
        /// The names of the joints.
        known: Vec<String>,
    },
    /// A joint that follows several others.
    #[error(
        "{term}: joint `{joint}` follows several others, and takes no terms; give the term to the joints that it follows"
    )]
    FollowsSeveral {
        /// The term.
        term: String,
        /// The joint.
        joint: String,
    },
    /// A value that cannot be used.
    #[error("{term}: {key} is {found}, expected {expected}")]
    Value {
        /// The term.
        term: String,
        /// The key.
        key: String,
        /// What is allowed.
        expected: String,
        /// What was found.
        found: String,
    },
    /// Two parameters with the same name.
    #[error("{term}: its parameter {parameter} exists already; {remedy}")]
    Twice {
        /// The term.
        term: String,
        /// The name.
        parameter: String,
        /// What to do.
        remedy: String,
    },
    /// An expression that cannot be read.
    #[error("{term}: expression `{expression}`: {reason}")]
    Expression {
        /// The term.
        term: String,
        /// The text.
        expression: String,
        /// Why, and what to do.
        reason: String,
    },
    /// A term of a robot with loops that depends on more than its own joint, or two points.
    #[error(
        "{term}: the robot has loops of links, with which this kind of term is not supported yet; springs between points, springs of \
         joints and friction laws are"
    )]
    WithLoops {
        /// The term.
        term: String,
    },
    /// Too many columns.
    #[error("the terms have more than {limit} parameters, the most that is read")]
    TooMany {
        /// The limit.
        limit: usize,
    },
}

/// Most parameters of terms.
pub(super) const MOST_COLUMNS: usize = 20 * MOST_JOINTS;
