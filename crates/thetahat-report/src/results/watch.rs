//! What `watch` says of a robot while it works: events as they happen, and a summary.

use serde::Serialize;

use super::joints::JointResult;

/// An event, or the summary. As JSON an object with its `kind`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum WatchEvent {
    /// Watching begins: the residual's noise is known.
    Settled(WatchSettled),
    /// Where the robot is not the identified one at the beginning.
    Start(WatchDrift),
    /// A fast residual.
    Collision(WatchCollision),
    /// Friction, offset or payload changed.
    Drift(WatchDrift),
    /// The residual since the last such line.
    Residual(WatchResidual),
    /// The end.
    Summary(WatchSummary),
}

impl WatchEvent {
    /// Whether it is something found.
    #[must_use]
    pub fn is_alarm(&self) -> bool {
        match self {
            Self::Start(_) | Self::Collision(_) | Self::Drift(_) => true,
            Self::Settled(_) | Self::Residual(_) | Self::Summary(_) => false,
        }
    }
}

/// What was learned before watching began.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WatchSettled {
    /// Time stamp of the first sample, s: all other times count from it.
    pub first_s: f64,
    /// Time at which watching begins, s.
    pub time_s: f64,
    /// By how much events are late at least, s: filter, neighbours of rest, step.
    pub delay_s: f64,
    /// Standard deviation of each joint's residual in the steps of the collision test, N m or N; `null` of joints that did not move.
    pub deviation: Vec<Option<f64>>,
    /// Factor on the variance of each joint's residual by which its lasting errors exceed those of noise that is correlated between
    /// neighbouring blocks alone.
    pub inflation: Vec<Option<f64>>,
    /// False alarms per hour that were asked for.
    pub alarms_per_hour: f64,
}

/// A fast residual.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WatchCollision {
    /// Time at which it is said, s.
    pub time_s: f64,
    /// Time at which it began, s.
    pub began_s: f64,
    /// The joint that shows it most, from one.
    pub joint: usize,
    /// Its residual until then, N m or N.
    pub torque: f64,
    /// Unit of the residual.
    pub unit: String,
    /// The joint in words.
    pub label: String,
}

/// A change of friction, offset or payload.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WatchDrift {
    /// Time at which it is said, s.
    pub time_s: f64,
    /// Time at which it began by the data, s.
    pub began_s: f64,
    /// What explains the residual best: `friction of joint 2`, `offset of joint 2`, `payload`.
    pub cause: String,
    /// What explains it as well.
    pub rivals: Vec<String>,
    /// The changes of the cause's parameters.
    pub changes: Vec<WatchChange>,
    /// Logarithm of the likelihood ratio of the cause and no change.
    pub evidence: f64,
}

/// A parameter's change.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WatchChange {
    /// Name: `fv2`, `fc2`, `off2`, or `m`, `mx` ... `zz` of a payload in the frame of the last link.
    pub parameter: String,
    /// Unit.
    pub unit: String,
    /// The change.
    pub change: f64,
    /// 95 % interval for all parameters of the cause together.
    pub interval_95: [f64; 2],
    /// The change, percent of the identified value; `null` without one.
    pub percent: Option<f64>,
}

/// The residual of a stretch of time.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WatchResidual {
    /// Time of its end, s.
    pub time_s: f64,
    /// Root mean square of each joint's residual while it moves, N m or N; `null` where it did not.
    pub rms: Vec<Option<f64>>,
    /// The same as percent of the measured torque.
    pub percent: Vec<Option<f64>>,
}

/// What was watched and found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WatchSummary {
    /// Time of the last sample, s.
    pub time_s: f64,
    /// Time that was watched, s: without the seconds before [`WatchEvent::Settled`] and without gaps.
    pub watched_s: f64,
    /// Gaps in the samples.
    pub gaps: usize,
    /// Samples of another length or without a value, which were left out.
    pub incomplete: usize,
    /// Collision-like events.
    pub collisions: usize,
    /// Changes of friction, offset or payload, those at the start included.
    pub drifts: usize,
    /// The residual of the whole time.
    pub residual: WatchResidual,
    /// All changes since watching began, with intervals that hold all of them in 95 % of cases.
    pub changes: Vec<WatchChange>,
    /// The joints.
    pub joints: Vec<JointResult>,
}
