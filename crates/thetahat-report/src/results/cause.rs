//! Errors of the robot or of the recordings that the residual of the model shows.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use super::diagnosis::MovedParameter;
use thetahat_ground::number::significant;

/// Something that the model is wrong in, or that the recordings are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CauseKind {
    /// The torques are recorded late, or early if the delay is negative.
    LateTorque,
    /// The positions of a joint are turned or moved.
    EncoderZero,
    /// The positions of a joint are too large by a ratio, and its torques too small.
    GearRatio,
    /// The torques of a joint are too large by a ratio.
    DriveGain,
    /// The torque offset of joints changes with time, or from some instant on.
    OffsetDrift,
    /// A joint yields between its encoder and its link.
    Elasticity,
    /// A joint is not where the description has it.
    Length,
    /// A motor turns with two joints.
    Coupling,
    /// Coulomb friction grows with the load.
    LoadFriction,
    /// Friction has another law over the speed.
    SpeedFriction,
    /// Friction changes with time.
    FrictionDrift,
    /// The last link is another body from some instant on.
    Payload,
    /// Gravity has another direction in the base frame: the base is tilted.
    GravityDirection,
    /// The torque of a joint is also in that of another.
    Crosstalk,
    /// The recorded torque grows faster than the torque: the motor's constant falls with the current.
    FallingConstant,
    /// A spring acts on a joint.
    JointSpring,
    /// Viscous friction differs with the direction.
    AsymmetricFriction,
    /// The recorded torques grow or fall with time: a motor warms up, a battery empties.
    GainDrift,
    /// A torque repeats with the position of a joint: cogging, the teeth of a gear.
    TorqueRipple,
    /// The positions of a joint are turned or moved from some instant on: an encoder, a coupling or a belt slips.
    ZeroShift,
    /// The positions of a joint are recorded late, or early if the delay is negative.
    LatePosition,
    /// The torques are recorded through a low-pass filter; the size is the time constant of one of first order.
    TorqueFilter,
    /// The times are too long by a ratio: another sample rate than the stated one, a clock that is slow.
    TimeScale,
}

impl CauseKind {
    /// All kinds.
    pub const ALL: [Self; 23] = [
        Self::LateTorque,
        Self::EncoderZero,
        Self::GearRatio,
        Self::DriveGain,
        Self::OffsetDrift,
        Self::Elasticity,
        Self::Length,
        Self::Coupling,
        Self::LoadFriction,
        Self::SpeedFriction,
        Self::FrictionDrift,
        Self::Payload,
        Self::GravityDirection,
        Self::Crosstalk,
        Self::FallingConstant,
        Self::JointSpring,
        Self::AsymmetricFriction,
        Self::GainDrift,
        Self::TorqueRipple,
        Self::ZeroShift,
        Self::LatePosition,
        Self::TorqueFilter,
        Self::TimeScale,
    ];

    /// What it is, in words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::LateTorque => "torques that are late",
            Self::EncoderZero => "a wrong encoder zero",
            Self::GearRatio => "a wrong gear ratio",
            Self::DriveGain => "a wrong drive gain",
            Self::OffsetDrift => "torque offsets that change",
            Self::Elasticity => "an elastic joint",
            Self::Length => "a wrong length",
            Self::Coupling => "a coupling of motors",
            Self::LoadFriction => "friction that depends on the load",
            Self::SpeedFriction => "friction with another law over the speed",
            Self::FrictionDrift => "friction that changes with time",
            Self::Payload => "a payload that is picked up or put down",
            Self::GravityDirection => "a base that is tilted",
            Self::Crosstalk => "a torque that is also in another",
            Self::FallingConstant => "a motor constant that falls with the torque",
            Self::JointSpring => "a spring",
            Self::AsymmetricFriction => "viscous friction that differs with the direction",
            Self::GainDrift => "a drive gain that changes with time",
            Self::TorqueRipple => "torque ripple",
            Self::ZeroShift => "an encoder zero that changes",
            Self::LatePosition => "positions that are late",
            Self::TimeScale => "times on another scale",
            Self::TorqueFilter => "a low-pass filter in the recorded torques",
        }
    }

    /// The same with the joint, link or instant.
    #[must_use]
    pub fn with_subject(self, subject: &str) -> String {
        match self {
            _ if subject.is_empty() => self.words().to_owned(),
            Self::Payload | Self::OffsetDrift | Self::GravityDirection => format!("{} {subject}", self.words()),
            Self::Crosstalk => format!("{}: that of {subject}", self.words()),
            Self::ZeroShift => format!("{}: {subject}", self.words()),
            Self::LateTorque
            | Self::EncoderZero
            | Self::GearRatio
            | Self::DriveGain
            | Self::Elasticity
            | Self::Length
            | Self::Coupling
            | Self::LoadFriction
            | Self::SpeedFriction
            | Self::FrictionDrift
            | Self::FallingConstant
            | Self::JointSpring
            | Self::AsymmetricFriction
            | Self::GainDrift
            | Self::TorqueRipple
            | Self::LatePosition
            | Self::TorqueFilter
            | Self::TimeScale => format!("{} of {subject}", self.words()),
        }
    }
}

/// A cause that the residual shows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ModelCause {
    /// What it is.
    pub kind: CauseKind,
    /// Joint, link or instant; empty where it concerns all.
    pub subject: String,
    /// log10 of the probability of so much evidence by chance.
    pub log10_probability: f64,
    /// Its size, of a cause that is one number.
    pub size: Option<f64>,
    /// Standard deviation of the size.
    pub standard_deviation: Option<f64>,
    /// Unit of the size; empty for a ratio.
    pub unit: String,
    /// What it explains, percent of the torques where the joints weigh alike.
    pub error_percent: f64,
    /// Other causes that explain the same: the recordings do not separate them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rivals: Vec<String>,
    /// Base parameters that it moves by more than their standard deviation, the furthest first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub moved: Vec<MovedParameter>,
    /// Whether the model has a torque term for it: the description is wrong in it, the model is not.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub in_model: bool,
}

/// What torques that look early explain, percent of all torques, from which it is friction near rest that the model does not have, as of
/// Stribeck. Clean recordings look late if anything, by 0.3 % at most.
const EARLY_PERCENT: f64 = 0.3;

impl ModelCause {
    /// Whether the torques of all joints look early, which friction at reversals does and no recorder.
    #[must_use]
    pub fn looks_early(&self) -> bool {
        let is_early = self.kind == CauseKind::LateTorque && self.subject.is_empty() && self.size < Some(0.0);
        is_early && self.error_percent > EARLY_PERCENT
    }

    /// Its size with its deviation and unit: 0.46 ± 0.05 ms, 2.1 ± 0.3 %.
    #[must_use]
    pub fn size_in_words(&self) -> Option<String> {
        let (size, deviation) = (self.size?, self.standard_deviation?);
        let (factor, unit) = shown_in(self.kind, &self.unit);
        Some(format!("{} ± {} {unit}", significant(factor * size, 3), significant(factor * deviation, 2)))
    }
}

/// The smallest error of the description that the recordings would show.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SmallestShown {
    /// What it is.
    pub kind: CauseKind,
    /// Joint or link.
    pub subject: String,
    /// The size that is named in one of two such recordings, if it is the only error; left out where they can hide any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size: Option<f64>,
    /// The same if others of this kind may be wrong too; left out where they can hide any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size_with_others: Option<f64>,
    /// Unit of the size; empty for a ratio.
    pub unit: String,
}

impl SmallestShown {
    /// It with its unit: "a wrong gear ratio of joint 2: 0.8 % alone, 5.1 % with others".
    #[must_use]
    pub fn in_words(&self) -> String {
        let [alone, with_others] = [self.size, self.size_with_others].map(|size| self.sized(size));
        format!("{}: {alone} alone, {with_others} with others", self.kind.with_subject(&self.subject))
    }

    fn sized(&self, size: Option<f64>) -> String {
        let (factor, unit) = shown_in(self.kind, &self.unit);
        size.map_or_else(|| "any size".to_owned(), |size| format!("{} {unit}", significant(factor * size, 2)))
    }

    /// The largest error of each kind that can hide: "gear ratio 17 %", and "drive gain any" where one of any size can.
    pub(super) fn hidden(all: &[Self]) -> Vec<String> {
        let kinds = [
            (CauseKind::GearRatio, "gear ratio"),
            (CauseKind::DriveGain, "drive gain"),
            (CauseKind::EncoderZero, "encoder zero"),
            (CauseKind::Length, "length"),
            (CauseKind::GravityDirection, "tilt"),
        ];
        let largest = |(kind, noun): (CauseKind, &str)| {
            // What shows at no size counts as the largest.
            let size = |s: &&Self| s.size.unwrap_or(f64::INFINITY);
            let largest = all.iter().filter(|s| s.kind == kind).max_by(|a, b| size(a).total_cmp(&size(b)))?;
            Some(format!("{noun} {}", largest.size.map_or_else(|| "any".to_owned(), |size| largest.sized(Some(size)))))
        };
        kinds.into_iter().filter_map(largest).collect()
    }
}

/// Factor and unit in which a size is written.
fn shown_in(kind: CauseKind, unit: &str) -> (f64, &str) {
    match (kind, unit) {
        (CauseKind::LateTorque | CauseKind::LatePosition | CauseKind::TorqueFilter, _) => (1e3, "ms"),
        (
            CauseKind::GearRatio
            | CauseKind::DriveGain
            | CauseKind::Crosstalk
            | CauseKind::FallingConstant
            | CauseKind::GainDrift
            | CauseKind::TimeScale,
            _,
        ) => (100.0, "%"),
        (CauseKind::GravityDirection, _) => (180.0 / PI, "deg"),
        (CauseKind::Length, _) | (CauseKind::EncoderZero, "m") => (1e3, "mm"),
        (_, unit) => (1.0, unit),
    }
}
