use std::fmt;

use serde::{Deserialize, Serialize};

use super::remedy_step::OrderedStep;

/// How much a finding matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Severity {
    /// Do not trust the estimate.
    Problem,
    /// The estimate is less accurate; check it.
    Warning,
    /// Worth knowing.
    Note,
}

impl Severity {
    /// Its name, lower case.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Problem => "problem",
            Self::Warning => "warning",
            Self::Note => "note",
        }
    }
}

impl fmt::Display for Severity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The kind of a finding. Findings of one severity are sorted in this order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Code {
    /// Positions are in another unit, or on the other side of the gears.
    PositionScale,
    /// Positions have the opposite sign.
    PositionSign,
    /// Positions have another zero.
    PositionZero,
    /// Torques are in another unit, or on the other side of the gears.
    TorqueScale,
    /// Torques have the opposite sign.
    TorqueSign,
    /// Two joints are exchanged.
    JointsSwapped,
    /// A gear ratio, or the scale of a position or torque, is wrong by some percent.
    GearRatio,
    /// Torques are later or earlier than positions.
    Lag,
    /// Samples are missing.
    DroppedSamples,
    /// Samples are repeated.
    RepeatedSamples,
    /// The time stamps are not equally spaced.
    ClockJitter,
    /// The stated sample rate differs from that of the time stamps.
    RateContradicted,
    /// The torques fit much better with times on another scale.
    TimeScale,
    /// A torque stays at its limit.
    TorqueSaturated,
    /// A torque does not change.
    TorqueConstant,
    /// The torques of two joints are the same column.
    TorqueCopied,
    /// The torque's steps are coarse.
    TorqueQuantised,
    /// The torque has outliers.
    TorqueSpikes,
    /// The position's steps are coarse.
    PositionQuantised,
    /// The position has outliers.
    PositionSpikes,
    /// The position jumps and stays.
    PositionJump,
    /// The recorded velocity differs from the derivative of the position.
    VelocityMismatch,
    /// A joint does not move.
    JointStill,
    /// No joint moves for a part of the window.
    StillPeriod,
    /// The position filter removes motion.
    CutoffLow,
    /// The position filter lets noise through.
    CutoffHigh,
    /// Friction comes out negative.
    NegativeFriction,
    /// The model does not explain the torques.
    PoorFit,
    /// The motion does not excite parameters.
    NotExcited,
    /// The motion does not follow the reference.
    ReferenceMismatch,
    /// The controller does not give the drive signals.
    ControllerMismatch,
    /// The torque is one value for much of the time.
    TorqueIdle,
    /// The torque is noise.
    TorqueNoise,
    /// A joint only vibrates in place.
    JointDither,
    /// Torques differ much from those of the description's masses.
    APrioriScale,
    /// The model predicts a joint's torque no better than its mean does.
    WorseThanMean,
    /// The recording is not of this robot.
    WrongRobot,
    /// Gravity has another direction than in the description.
    GravityDirection,
    /// The scale of a torque changes over the recording.
    GainDrift,
    /// The friction of a joint changes over the recording.
    FrictionDrift,
    /// Two recordings share samples.
    SameRecording,
    /// Separate fits explain the recordings, a common fit does not.
    RecordingsContradict,
    /// The estimates are physically impossible.
    NotPhysical,
    /// The robot's description has physically impossible values.
    RobotDescription,
    /// Which equations of a robot on a base that floats are used.
    EquationsUsed,
    /// Something else acts on the robot for some time.
    ExternalForce,
}

impl Code {
    /// Whether it is about the fit as a whole or about parameters, and so may come from a fault that another finding names.
    #[doc(hidden)]
    #[must_use]
    pub fn is_consequence(self) -> bool {
        matches!(
            self,
            Self::PoorFit
                | Self::WrongRobot
                | Self::WorseThanMean
                | Self::NotExcited
                | Self::NotPhysical
                | Self::NegativeFriction
                | Self::FrictionDrift
        )
    }

    /// All codes, in order.
    pub const ALL: [Self; 46] = [
        Self::PositionScale,
        Self::PositionSign,
        Self::PositionZero,
        Self::TorqueScale,
        Self::TorqueSign,
        Self::JointsSwapped,
        Self::GearRatio,
        Self::Lag,
        Self::DroppedSamples,
        Self::RepeatedSamples,
        Self::ClockJitter,
        Self::RateContradicted,
        Self::TimeScale,
        Self::TorqueSaturated,
        Self::TorqueConstant,
        Self::TorqueCopied,
        Self::TorqueQuantised,
        Self::TorqueSpikes,
        Self::PositionQuantised,
        Self::PositionSpikes,
        Self::PositionJump,
        Self::VelocityMismatch,
        Self::JointStill,
        Self::StillPeriod,
        Self::CutoffLow,
        Self::CutoffHigh,
        Self::NegativeFriction,
        Self::PoorFit,
        Self::NotExcited,
        Self::ReferenceMismatch,
        Self::ControllerMismatch,
        Self::TorqueIdle,
        Self::TorqueNoise,
        Self::JointDither,
        Self::APrioriScale,
        Self::WorseThanMean,
        Self::WrongRobot,
        Self::GravityDirection,
        Self::GainDrift,
        Self::FrictionDrift,
        Self::SameRecording,
        Self::RecordingsContradict,
        Self::NotPhysical,
        Self::RobotDescription,
        Self::EquationsUsed,
        Self::ExternalForce,
    ];

    /// Its stable name, lower case with hyphens.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::PositionScale => "position-scale",
            Self::PositionSign => "position-sign",
            Self::PositionZero => "position-zero",
            Self::TorqueScale => "torque-scale",
            Self::TorqueSign => "torque-sign",
            Self::JointsSwapped => "joints-swapped",
            Self::GearRatio => "gear-ratio",
            Self::Lag => "lag",
            Self::DroppedSamples => "dropped-samples",
            Self::RepeatedSamples => "repeated-samples",
            Self::ClockJitter => "clock-jitter",
            Self::RateContradicted => "rate-contradicted",
            Self::TimeScale => "time-scale",
            Self::TorqueSaturated => "torque-saturated",
            Self::TorqueConstant => "torque-constant",
            Self::TorqueCopied => "torque-copied",
            Self::TorqueQuantised => "torque-quantised",
            Self::TorqueSpikes => "torque-spikes",
            Self::PositionQuantised => "position-quantised",
            Self::PositionSpikes => "position-spikes",
            Self::PositionJump => "position-jump",
            Self::VelocityMismatch => "velocity-mismatch",
            Self::JointStill => "joint-still",
            Self::StillPeriod => "still-period",
            Self::CutoffLow => "cutoff-low",
            Self::CutoffHigh => "cutoff-high",
            Self::NegativeFriction => "negative-friction",
            Self::PoorFit => "poor-fit",
            Self::NotExcited => "not-excited",
            Self::ReferenceMismatch => "reference-mismatch",
            Self::ControllerMismatch => "controller-mismatch",
            Self::TorqueIdle => "torque-idle",
            Self::TorqueNoise => "torque-noise",
            Self::JointDither => "joint-dither",
            Self::APrioriScale => "a-priori-scale",
            Self::WorseThanMean => "worse-than-mean",
            Self::WrongRobot => "wrong-robot",
            Self::GravityDirection => "gravity-direction",
            Self::GainDrift => "gain-drift",
            Self::FrictionDrift => "friction-drift",
            Self::SameRecording => "same-recording",
            Self::RecordingsContradict => "recordings-contradict",
            Self::NotPhysical => "not-physical",
            Self::RobotDescription => "robot-description",
            Self::EquationsUsed => "equations-used",
            Self::ExternalForce => "external-force",
        }
    }
}

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Something found in a recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// Its kind.
    pub code: Code,
    /// How much it matters.
    pub severity: Severity,
    /// The joint's number, from one, as in the names of its parameters; none if the finding is about all joints. Mimic joints
    /// before it make it larger than the number of its channel.
    pub joint: Option<usize>,
    /// The joint's name.
    pub joint_name: Option<String>,
    /// The evidence.
    pub value: f64,
    /// The unit of the evidence and of its limit.
    pub unit: String,
    /// The limit of the evidence.
    pub limit: Option<f64>,
    /// What was found, in a sentence with the number.
    pub message: String,
    /// What to do, in a sentence.
    pub remedy: String,
    /// The parameters it is about.
    pub parameters: Vec<String>,
    /// The change of the settings that removes its cause, where there is one; files hold it among the remedies of the results.
    #[doc(hidden)]
    #[serde(skip)]
    pub step: Option<OrderedStep>,
}

/// A number that was compared with a limit, whether or not it led to a finding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measure {
    /// The kind of finding that it is evidence for.
    pub code: Code,
    /// The joint's number, as in [`Finding`].
    pub joint: Option<usize>,
    /// The evidence.
    pub value: f64,
    /// Evidence above this limit makes a finding.
    pub limit: f64,
}
