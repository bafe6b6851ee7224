//! Changes of settings that remove the cause of a finding, as values that a program can apply.

use serde::{Deserialize, Serialize};

/// The signals of a recording that a step changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RemedySignal {
    /// The positions.
    Position,
    /// The torques.
    Torque,
    /// Both.
    Both,
}

impl RemedySignal {
    /// Whether the positions are among them.
    #[must_use]
    pub fn has_position(self) -> bool {
        matches!(self, Self::Position | Self::Both)
    }

    /// Whether the torques are among them.
    #[must_use]
    pub fn has_torque(self) -> bool {
        matches!(self, Self::Torque | Self::Both)
    }
}

/// One change of the settings. Joints are coordinates of the robot, counted from one, and lists have a value for each.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum RemedyStep {
    /// Takes the channels in another order: two of them exchanged, for instance.
    OrderJoints {
        /// Of what.
        signal: RemedySignal,
        /// For each joint the one, from one, as whose its channel is taken today.
        order: Vec<usize>,
    },
    /// Multiplies channels by a factor for each joint; a list that is empty leaves its signal alone.
    Scale {
        /// Factors of the positions.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        position: Vec<f64>,
        /// Factors of the torques.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        torque: Vec<f64>,
    },
    /// States the side of the gears.
    Side {
        /// The signal.
        signal: RemedySignal,
        /// Whether it was measured at the motors.
        at_motor: bool,
    },
    /// States that the torques are later than was stated by so much, s.
    Delay {
        /// The additional delay.
        delay_s: f64,
        /// The joints whose torques are; all if none is named.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        joints: Vec<usize>,
    },
    /// States that the torques hold until the next sample.
    Hold,
    /// States that the torques were recorded through a low-pass filter of first order. The delay of filter and signal together stays.
    LowPass {
        /// Its time constant, s.
        time_constant_s: f64,
    },
    /// Sets the cut-off of the position filter.
    Cutoff {
        /// The cut-off.
        cutoff_hz: f64,
    },
    /// Takes the samples as equally spaced, whatever their times.
    EqualSteps {
        /// Samples per second.
        sample_rate_hz: f64,
    },
    /// Leaves samples near rest out.
    LeaveOutRests,
    /// Leaves intervals of a recording out.
    LeaveOutTimes {
        /// From and to, s from its start.
        times: Vec<[f64; 2]>,
    },
    /// Leaves the parameters out that are not essential.
    Essential {
        /// How many.
        left_out: usize,
    },
    /// Corrects the recorded reference.
    CorrectReference {
        /// How much later it is, s.
        delay_s: Vec<f64>,
        /// Factors.
        scale: Vec<f64>,
        /// What is added, rad or m.
        offset: Vec<f64>,
    },
    /// Locks a joint that does not move, and leaves its channels out.
    LockJoint {
        /// The joint.
        joint: usize,
        /// Its name.
        name: String,
        /// Where it is, rad or m.
        value: f64,
    },
    /// Adds a torque term.
    AddTerm {
        /// Its kind, as in a `[[term]]`.
        term: String,
        /// The names of the joints that have it; all if none is named.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        joints: Vec<String>,
    },
    /// States gravity in the base frame.
    Gravity {
        /// Its acceleration, m/s^2.
        gravity: [f64; 3],
    },
    /// States that the size of another step was estimated from the recordings themselves: intervals count its deviation.
    Estimated {
        /// The size, as in `[model] estimated`.
        size: String,
    },
}

impl RemedyStep {
    /// The joints that another order moves, from one; none of other steps.
    #[must_use]
    pub fn moved_joints(&self) -> Vec<usize> {
        let Self::OrderJoints { order, .. } = self else { return Vec::new() };
        (1..).zip(order).filter(|(joint, channel)| joint != *channel).map(|(joint, _)| joint).collect()
    }
}

/// A step, and the number of findings before it in the same recording: a step holds for the recording that the earlier ones have
/// corrected.
#[derive(Debug, Clone, PartialEq)]
pub struct OrderedStep {
    /// Findings before it.
    pub order: usize,
    /// The change.
    pub step: RemedyStep,
}
