use serde::Serialize;

use super::{Grade, JointResult, Limited, ParameterResult, Skeleton};
use thetahat_estimation::trajectory::Moves;
use thetahat_ground::series::Series;

/// A designed motion, and what its record will tell.
#[derive(Debug, Clone)]
pub struct DesignResults {
    /// The design's line that says what it is.
    pub title: String,
    /// Name of the robot.
    pub robot: String,
    /// The joints.
    pub joints: Vec<JointResult>,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Positions, rad or m.
    pub q: Series,
    /// Velocities.
    pub dq: Series,
    /// Accelerations.
    pub ddq: Series,
    /// Torques with the a-priori parameters, N m or N.
    pub torque: Series,
    /// The moves, where the motion is made of such: the last ends where the first starts.
    pub moves: Option<Moves>,
    /// How many of them, the last ones, are sweeps of single joints.
    pub sweeps: usize,
    /// The robot where its shapes are nearest to one another, or else where it starts, and the way of its last joint.
    pub skeleton: Option<Skeleton>,
    /// What frequencies the motion has.
    pub spectrum: MotionSpectrum,
    /// Distances of shapes, where the design has some.
    pub collision: Option<CollisionResults>,
    /// The criterion if the last recording at hand were repeated for the same time, nats.
    pub repeated: Option<f64>,
    /// Title and method of the results that are compared with.
    pub compared: Option<[String; 2]>,
    /// The payload that the robot carries.
    pub payload: Option<PredictedPayload>,
    /// Robots that were drawn and how far off each parameter of them is, percent: torque and power hold for all.
    pub uncertainty: Option<(usize, f64)>,
    /// Name of the criterion.
    pub criterion: String,
    /// The searches.
    pub starts: Vec<SearchResult>,
    /// The limits, each joint's in the order of [`Limited::ALL`].
    pub limits: Vec<LimitUse>,
    /// What is predicted of each parameter.
    pub predicted: Vec<PredictedParameter>,
    /// Name of the method that is predicted.
    pub method: String,
    /// Whether the prediction is of the simulated closed loop.
    pub is_closed_loop: bool,
    /// Half of an interval that is wanted, percent.
    pub half_width_percent: f64,
    /// The experiment file for the record, without the robot's path.
    pub experiment: ExperimentText,
}

/// The frequencies of a motion beside those that its record can have.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MotionSpectrum {
    /// Frequencies at equal steps, Hz.
    pub frequency_hz: Vec<f64>,
    /// Root of the density of each joint's acceleration, over the largest of it.
    pub of_joints: Vec<Vec<f64>>,
    /// The frequency below which 99 % of the variance of each joint's acceleration lies, Hz.
    pub end_hz: Vec<f64>,
    /// What ends at a frequency: filters and loops.
    pub bounds: Vec<SpectrumBound>,
}

/// A filter or a loop, and the frequency where it ends.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectrumBound {
    /// What it is.
    pub name: &'static str,
    /// Where it ends, Hz.
    pub frequency_hz: f64,
}

/// One search.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SearchResult {
    /// The criterion of the random motion that it began with, nats.
    pub first: f64,
    /// The criterion of the motion that it found, nats.
    pub found: f64,
    /// Its steps.
    pub steps: usize,
}

/// How near shapes come to one another, at 1 kHz.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CollisionResults {
    /// The least distance that is allowed, m.
    pub margin: f64,
    /// The least distance of any pair at instants of the motion: time in s, distance in m.
    pub least: Vec<[f64; 2]>,
    /// Every pair that must stay apart, the nearest first.
    pub pairs: Vec<PairDistance>,
    /// Links whose shape is not known: a mesh, and no capsule is given.
    pub uncovered: Vec<String>,
    /// Whether the way from home is covered.
    pub has_way: bool,
}

/// The least distance of two shapes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PairDistance {
    /// A link.
    pub first: String,
    /// Another, or an obstacle.
    pub second: String,
    /// Their least distance, m.
    pub distance: f64,
    /// When, s; none where it is on the way from home.
    pub at_s: Option<f64>,
}

/// How far a motion uses a limit, SI.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LimitUse {
    /// Name of the joint.
    pub joint: String,
    /// Number of the coordinate, from zero.
    pub coordinate: usize,
    /// What is limited.
    pub quantity: Limited,
    /// Lower and upper limit.
    pub limit: [f64; 2],
    /// Smallest and largest value at 1 kHz.
    pub reached: [f64; 2],
    /// When the motion is nearest to the limit, s.
    pub at_s: f64,
    /// The largest part of the limit that is used, from the middle of its range.
    pub part: f64,
}

/// What is predicted of a base parameter.
#[derive(Debug, Clone, Serialize)]
pub struct PredictedParameter {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// Regrouping formula.
    pub expression: String,
    /// Number of the joint whose torque shows it first, from one.
    pub joint: usize,
    /// Its a-priori value.
    pub a_priori: f64,
    /// Expected standard deviation.
    pub standard_deviation: f64,
    /// Expected half of the interval of 95 %.
    pub half_width_95: f64,
    /// How long to record for the half width that is wanted, s: the motion is repeated. None where the a-priori value is zero.
    pub seconds: Option<f64>,
    /// Where it stays unknown: how many times as narrow its interval is by a motion that is made for such parameters alone.
    pub by_own_motion: Option<f64>,
    /// Its estimate in the results that are compared with.
    pub compared: Option<ParameterResult>,
}

impl PredictedParameter {
    /// How many times smaller the predicted interval is than that of the results that are compared with.
    #[must_use]
    pub fn times_smaller(&self) -> Option<f64> {
        let [low, high] = self.compared.as_ref()?.interval_95?;
        Some(0.5 * (high - low) / self.half_width_95).filter(|times| times.is_finite() && *times > 0.0)
    }
}

impl PredictedParameter {
    /// How sure it will be, if it is as large as the a-priori value says.
    #[must_use]
    pub fn grade(&self) -> Grade {
        self.as_result().grade_of_interval()
    }

    /// As if it had been estimated with its a-priori value.
    #[must_use]
    pub fn as_result(&self) -> ParameterResult {
        let (value, half) = (self.a_priori, self.half_width_95);
        let relative = (value != 0.0).then(|| 100.0 * self.standard_deviation / value.abs());
        ParameterResult {
            name: self.name.clone(),
            estimate: value,
            standard_deviation: Some(self.standard_deviation),
            relative_standard_deviation_percent: relative,
            true_value: None,
            unit: self.unit.clone(),
            expression: self.expression.clone(),
            shown: true,
            standard_deviation_robust: Some(self.standard_deviation),
            interval_95: Some([value - half, value + half]),
        }
    }
}

/// A known payload, and what a record with it tells beside one without it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PredictedPayload {
    /// Its name.
    pub name: String,
    /// Its mass, kg.
    pub mass_kg: f64,
    /// The gains of the drives.
    pub gains: Vec<PredictedGain>,
}

/// What is predicted of the gain of a drive.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PredictedGain {
    /// The joint.
    pub joint: String,
    /// Half of its expected interval of 95 %, percent; none where it is not told.
    pub half_width_percent: Option<f64>,
}

/// The text of the experiment that follows a design, in parts between which the path of the robot stands.
#[derive(Debug, Clone, PartialEq)]
pub struct ExperimentText {
    /// Where the robot's description is.
    pub robot: std::path::PathBuf,
    /// The title.
    pub title: String,
    /// The tables of the recording.
    pub recording: String,
    /// The tables of the simulated robot instead of it.
    pub twin: String,
    /// The tables of the settings.
    pub settings: String,
}
