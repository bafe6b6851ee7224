use crate::robot::TermError;

/// Why joints cannot be locked.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LockError {
    /// A joint is named that the robot does not have.
    #[error("{key}: the robot has no moving joint `{name}`; its moving joints are {}", known.join(" "))]
    UnknownJoint {
        /// `locked` or `until`.
        key: &'static str,
        /// The name.
        name: String,
        /// The existing names.
        known: Vec<String>,
    },
    /// A joint that follows another has no value of its own.
    #[error("locked: joint `{joint}` follows `{leader}` (mimic) and is locked with it; lock `{leader}` instead")]
    Follower {
        /// The joint.
        joint: String,
        /// The joint that it follows.
        leader: String,
    },
    /// A value that is impossible for the coordinate of a joint.
    #[error("locked: joint `{joint}` at {value} {unit}: {expected}")]
    Value {
        /// The joint.
        joint: String,
        /// Its value.
        value: f64,
        /// `rad` or `m`.
        unit: &'static str,
        /// What is allowed, and what to do.
        expected: String,
    },
    /// A robot with loops of links: which joint is passive depends on those that move.
    #[error("locked: the robot has loops of links, whose joints cannot be locked yet; leave out `locked` and `until`")]
    Loops,
    /// No moving joint is left.
    #[error("locked: no joint is left that moves; leave out one that was recorded")]
    NothingMoves,
    /// A torque term that needs a locked joint.
    #[error("locked: {source}")]
    Term {
        /// Why.
        source: Box<TermError>,
    },
    /// A motor turns with both locked and moving joints.
    #[error(
        "locked: motor {motor} turns with `{locked}`, which is locked, and with `{moving}`, which moves; lock both or none of \
         them, or give the robot a [transmission] matrix that does not couple the two"
    )]
    Coupled {
        /// Number of the motor, from one, among those of the whole robot.
        motor: usize,
        /// A locked joint.
        locked: String,
        /// A moving joint.
        moving: String,
    },
}
