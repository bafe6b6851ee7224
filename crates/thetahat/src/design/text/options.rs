//! The tables of a design file.

use std::path::PathBuf;

use serde::Deserialize;

use crate::design::search::criterion::CriterionName;
use thetahat_data::recording::ChannelSource;
use thetahat_ground::one_or_each::OneOrEach;

/// What a design minimises.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DesignObjective {
    /// The criterion.
    pub criterion: CriterionName,
    /// The base parameters of the criterion `chosen`.
    pub parameters: Vec<String>,
    /// Half width of the wanted intervals, percent of the parameter: the table gives the recording time that each needs.
    pub half_width_percent: f64,
    /// Positions of the motion whose torques are to be predicted, as `[recording] position` of an experiment: at `sample_rate_hz`, and
    /// filtered as the recording will be.
    pub motion: Option<ChannelSource>,
    /// Wanted error of its torques, percent of them.
    pub torque_percent: f64,
}

impl Default for DesignObjective {
    fn default() -> Self {
        Self {
            criterion: CriterionName::default(),
            parameters: Vec::new(),
            half_width_percent: 10.0,
            motion: None,
            torque_percent: 1.0,
        }
    }
}

/// The kind of motion, and the search.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct MotionOptions {
    /// Fourier series, B-splines or point-to-point moves.
    pub kind: MotionKind,
    /// Harmonics of the Fourier series: by default one for every 4 s of a period, from 5 to 15.
    pub harmonics: Option<usize>,
    /// Times that a motion of Fourier series or splines is repeated in the duration: by default such that a period has at most 60 s, or
    /// 20 s of splines.
    pub periods: Option<usize>,
    /// B-splines of each joint, 10 by default.
    pub splines: Option<usize>,
    /// Number of the moves, 12 by default.
    pub moves: Option<usize>,
    /// Time over which the acceleration of a move rises and falls at least, s: 0.05 by default, or a twentieth of the time that a move has
    /// where that is shorter. A limit of the jerk makes it longer.
    pub smoothing_s: Option<f64>,
    /// Rest after each move, s: none by default.
    pub rest_s: Option<f64>,
    /// Velocities at which each joint sweeps there and back after the moves: none by default.
    pub sweeps: Option<usize>,
    /// The slowest of them as a part of the fastest, 0.05 by default; those between are spaced geometrically.
    pub sweep_slowest: Option<f64>,
    /// The longest time at constant velocity, s: 1 by default.
    pub sweep_s: Option<f64>,
    /// Posture in which the motion starts and ends; chosen by the design if absent.
    pub start: Option<Vec<f64>>,
    /// Searches from random motions.
    pub starts: usize,
    /// Seed of the random motions.
    pub seed: u64,
}

/// Kinds of motions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(try_from = "String")]
pub enum MotionKind {
    /// Fourier series of each joint.
    #[default]
    Fourier,
    /// B-splines of each joint.
    Splines,
    /// Point-to-point moves, synchronised over the joints.
    Moves,
}

impl MotionKind {
    /// Its name, as in a design file.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Fourier => "fourier",
            Self::Splines => "splines",
            Self::Moves => "moves",
        }
    }
}

impl TryFrom<String> for MotionKind {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        let all = [Self::Fourier, Self::Splines, Self::Moves];
        let known = all.into_iter().find(|kind| kind.name() == name);
        known.ok_or_else(|| match name.as_str() {
            "postures" => POSTURES.to_owned(),
            other => format!("there is no kind of motion {other}: expected fourier, splines or moves"),
        })
    }
}

/// Why static postures are no kind of motion, and what to use for gravity instead.
const POSTURES: &str = "rests give no information, since dry friction at rest has either sign: for gravity take kind = \"moves\" with its \
                        parameters listed in [wanted] parameters and criterion = \"chosen\", or add sweeps";

impl Default for MotionOptions {
    fn default() -> Self {
        Self {
            kind: MotionKind::Fourier,
            harmonics: None,
            periods: None,
            splines: None,
            moves: None,
            smoothing_s: None,
            rest_s: None,
            sweeps: None,
            sweep_slowest: None,
            sweep_s: None,
            start: None,
            starts: 6,
            seed: 1,
        }
    }
}

/// As long as accelerations of industrial robots rise.
const SMOOTHING_S: f64 = 0.05;
const PART_OF_MOVE: f64 = 0.05;
const SECONDS_PER_HARMONIC: f64 = 4.0;
const SECONDS_PER_SPLINE: f64 = 2.0;
const FEWEST_HARMONICS: usize = 5;
/// More take minutes to search.
const MOST_HARMONICS: usize = 15;

impl MotionOptions {
    /// As many harmonics as keep the highest frequency of a motion of 20 s: with a fixed number a longer motion is a slower one, and
    /// its intervals are wider.
    pub(in crate::design) fn harmonics(&self, duration_s: f64) -> usize {
        let of_period = (duration_s / self.periods(duration_s) as f64 / SECONDS_PER_HARMONIC).round() as usize;
        self.harmonics.unwrap_or(of_period.clamp(FEWEST_HARMONICS, MOST_HARMONICS))
    }

    /// As many periods as keep the frequencies where harmonics or splines are as many as they are by default or in the file.
    pub(in crate::design) fn periods(&self, duration_s: f64) -> usize {
        let seconds_per_function = match self.kind {
            MotionKind::Fourier => SECONDS_PER_HARMONIC * self.harmonics.unwrap_or(MOST_HARMONICS) as f64,
            MotionKind::Splines => SECONDS_PER_SPLINE * self.splines() as f64,
            MotionKind::Moves => f64::INFINITY,
        };
        self.periods.unwrap_or((duration_s / seconds_per_function).ceil() as usize).max(1)
    }

    pub(in crate::design) fn splines(&self) -> usize {
        self.splines.unwrap_or(10)
    }

    pub(in crate::design) fn moves(&self) -> usize {
        self.moves.unwrap_or(12)
    }

    pub(in crate::design) fn smoothing_s(&self, duration_s: f64) -> f64 {
        let part_of_move = PART_OF_MOVE * duration_s / self.moves().max(1) as f64;
        self.smoothing_s.unwrap_or(SMOOTHING_S.min(part_of_move))
    }

    pub(in crate::design) fn rest_s(&self) -> f64 {
        self.rest_s.unwrap_or(0.0)
    }

    pub(in crate::design) fn sweeps(&self) -> usize {
        self.sweeps.unwrap_or(0)
    }

    pub(in crate::design) fn sweep_slowest(&self) -> f64 {
        self.sweep_slowest.unwrap_or(0.05)
    }

    pub(in crate::design) fn sweep_s(&self) -> f64 {
        self.sweep_s.unwrap_or(1.0)
    }
}

/// Limits of the joints, one for all or one for each: degrees or mm, N m or N, W.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LimitOptions {
    /// Smallest and largest position of each joint.
    pub position: Option<Vec<[f64; 2]>>,
    /// Largest velocity.
    pub velocity: Option<OneOrEach<f64>>,
    /// Largest acceleration.
    pub acceleration: Option<OneOrEach<f64>>,
    /// Largest jerk.
    pub jerk: Option<OneOrEach<f64>>,
    /// Largest torque, friction included.
    pub torque: Option<OneOrEach<f64>>,
    /// Largest power.
    pub power: Option<OneOrEach<f64>>,
    /// Part of every range that the motion leaves unused.
    pub margin: f64,
}

impl Default for LimitOptions {
    fn default() -> Self {
        Self { position: None, velocity: None, acceleration: None, jerk: None, torque: None, power: None, margin: 0.02 }
    }
}

/// What the percentages of programs are of, one for all or one for each: degrees or mm. A robot's controller takes them of its own rated
/// values, which may be above `[limits]`.
#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RatedOptions {
    /// Rated velocity; where it is not given that of the URDF, or else of `[limits]`.
    pub velocity: Option<OneOrEach<f64>>,
    /// Rated acceleration; where it is not given that of `[limits]`.
    pub acceleration: Option<OneOrEach<f64>>,
}

/// How far the robot may be from its a-priori parameters: the limits of torque and power hold for random robots in that range.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct UncertaintyOptions {
    /// Robots that are drawn.
    pub draws: usize,
    /// How far each parameter is off, percent.
    pub percent: f64,
    /// Friction at the velocity limit of a joint whose a-priori friction is zero, percent of its torque limit: half of it Coulomb friction.
    pub friction_percent: f64,
    /// Motor inertia of a joint whose a-priori motor inertia is zero, percent of the joint's inertia in the middle posture.
    pub motor_inertia_percent: f64,
    /// By how much the velocity of moves overshoots under a controller that is not described, percent.
    pub overshoot_percent: f64,
}

impl Default for UncertaintyOptions {
    fn default() -> Self {
        Self { draws: 0, percent: 0.0, friction_percent: 30.0, motor_inertia_percent: 50.0, overshoot_percent: 12.0 }
    }
}

/// The noise of a recording, per sample.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NoiseOptions {
    /// Standard deviation of the white noise on each joint's torque, N m or N.
    pub torque: Option<OneOrEach<f64>>,
    /// Results of an identification instead, whose residual is the noise of the torques.
    pub results: Option<PathBuf>,
    /// Standard deviation of the white noise on each joint's position, degrees or mm.
    #[serde(default = "no_noise")]
    pub position: OneOrEach<f64>,
}

fn no_noise() -> OneOrEach<f64> {
    OneOrEach::One(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The highest frequency of a motion does not fall as it becomes longer, until searches take minutes.
    #[test]
    fn harmonics_grow_with_the_duration() {
        let chosen = |duration_s: f64| MotionOptions::default().harmonics(duration_s);
        assert_eq!([4.0, 20.0, 40.0, 60.0, 120.0].map(chosen), [5, 5, 10, 15, 15]);
        let periods = |duration_s: f64| MotionOptions::default().periods(duration_s);
        assert_eq!([4.0, 20.0, 60.0, 61.0, 120.0].map(periods), [1, 1, 1, 2, 2]);
        let given = MotionOptions { harmonics: Some(5), ..MotionOptions::default() };
        assert_eq!([20.0, 40.0, 120.0].map(|s| (given.harmonics(s), given.periods(s))), [(5, 1), (5, 2), (5, 6)]);
    }
}
