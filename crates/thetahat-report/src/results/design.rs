use serde::Serialize;

use super::{Grade, JointResult, Limited, ParameterResult, Skeleton};
use thetahat_estimation::trajectory::Moves;
use thetahat_ground::series::Series;

/// A designed motion, and the predicted intervals of its recording.
#[derive(Debug, Clone)]
pub struct DesignResults {
    /// The title of the design.
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
    /// The motion at the rate of `trajectory.yaml` and `trajectory.json`, and at that of `points.csv` and `points.script`.
    pub points: [TrajectoryPoints; 2],
    /// The moves, if the motion consists of moves: the last ends where the first starts.
    pub moves: Option<Moves>,
    /// How many of the last moves are sweeps of single joints.
    pub sweeps: usize,
    /// The robot where its shapes are closest, or otherwise at its start, and the path of its last joint.
    pub skeleton: Option<Skeleton>,
    /// The frequencies of the motion.
    pub spectrum: MotionSpectrum,
    /// Distances between shapes, if the design has collision shapes.
    pub collision: Option<CollisionResults>,
    /// The criterion if the last prior recording were repeated for the same time, nats.
    pub repeated: Option<f64>,
    /// Descents that had ended when the search was stopped, and all of them; none if it ran to its end.
    pub stopped_after: Option<[usize; 2]>,
    /// Title and method of the results used for comparison.
    pub compared: Option<[String; 2]>,
    /// The payload of the robot.
    pub payload: Option<PredictedPayload>,
    /// Number of random robots and the error of each of their parameters, percent: torque and power limits hold for all.
    pub uncertainty: Option<(usize, f64)>,
    /// Name of the criterion.
    pub criterion: String,
    /// The searches.
    pub starts: Vec<SearchResult>,
    /// The limits, each joint's in the order of [`Limited::ALL`].
    pub limits: Vec<LimitUse>,
    /// The limits in the simulated loop.
    pub executed: ExecutedMotion,
    /// By how many percent velocities of moves are assumed to overshoot, if no controller is described.
    pub assumed_overshoot: Option<f64>,
    /// Rated velocities and accelerations of the coordinates, SI, which the percentages of programs are of; none takes the limits.
    pub rated: [Vec<Option<f64>>; 2],
    /// Joints whose a-priori friction is zero: executed torques are larger than the designed ones.
    pub without_friction: Vec<String>,
    /// What is assumed in their place for torque limits: friction at the velocity limit, percent of the torque limit, and motor inertia,
    /// percent of the joint's inertia.
    pub assumed_percent: [f64; 2],
    /// Joints whose a-priori motor inertia is zero.
    pub without_motor_inertia: Vec<String>,
    /// The prediction for each parameter.
    pub predicted: Vec<PredictedParameter>,
    /// Name of the method of the prediction.
    pub method: String,
    /// Whether earlier recordings are known: times of recording then add to them.
    pub knows_earlier: bool,
    /// The torques that are wanted.
    pub wanted_torques: Option<PredictedTorques>,
    /// The rows from which the method estimates.
    pub rows: PredictedRows,
    /// Whether the prediction uses the simulated closed loop.
    pub is_closed_loop: bool,
    /// Requested half width of an interval, percent.
    pub half_width_percent: f64,
    /// The experiment file for the recording, without the robot's path.
    pub experiment: ExperimentText,
}

/// The error of the torques along the motion that a design is for.
#[derive(Debug, Clone, PartialEq)]
pub struct PredictedTorques {
    /// The file of the motion.
    pub file: String,
    /// Standard deviation of the predicted torques by what is known before, percent of the torques; absent if nothing is.
    pub before_percent: Option<f64>,
    /// The same after the recording of the designed motion.
    pub percent: f64,
    /// The wanted one.
    pub wanted_percent: f64,
    /// Recording time for it; none if a million repetitions do not bring it.
    pub seconds: Option<f64>,
}

/// A motion under a controller.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ExecutedMotion {
    /// Whether the controller is that of the design, or a usual one.
    pub is_stated: bool,
    /// The limits of velocity, torque and power, each joint's in that order; empty if the loop could not be simulated.
    pub uses: Vec<LimitUse>,
    /// Why it could not be.
    pub failure: Option<String>,
}

/// Points for a robot's controller.
#[derive(Debug, Clone)]
pub struct TrajectoryPoints {
    /// Points per second.
    pub rate_hz: f64,
    /// Positions, rad or m.
    pub q: Series,
    /// Velocities.
    pub dq: Series,
    /// Accelerations.
    pub ddq: Series,
}

/// The filtered rows that are expected of a recording.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PredictedRows {
    /// Their number, of all coordinates.
    pub count: usize,
    /// Root mean square of the residual of each coordinate's rows, N m or N.
    pub residual_rms: Vec<f64>,
    /// The same of the torques themselves.
    pub torque_rms: Vec<f64>,
}

/// The frequencies of a motion compared with those that its recording can contain.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MotionSpectrum {
    /// Equally spaced frequencies, Hz.
    pub frequency_hz: Vec<f64>,
    /// Root of the spectral density of each joint's acceleration, over its maximum.
    pub of_joints: Vec<Vec<f64>>,
    /// The frequency below which 99 % of the variance of each joint's acceleration lies, Hz.
    pub end_hz: Vec<f64>,
    /// The bandwidths of filters and loops.
    pub bounds: Vec<SpectrumBound>,
    /// The cut-off of the position filter, Hz.
    pub position_cutoff_hz: f64,
}

/// A filter or a loop, and its bandwidth.
#[derive(Debug, Clone, PartialEq)]
pub struct SpectrumBound {
    /// Its name.
    pub name: &'static str,
    /// Its bandwidth, Hz.
    pub frequency_hz: f64,
}

/// One search.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SearchResult {
    /// The criterion of the random motion at its start, nats.
    pub first: f64,
    /// The criterion of the motion at its end, nats.
    pub found: f64,
    /// Its steps.
    pub steps: usize,
}

/// Smallest distances between shapes, at 1 kHz.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CollisionResults {
    /// The smallest distance allowed, m.
    pub margin: f64,
    /// The smallest distance of any pair over the motion: time in s, distance in m.
    pub least: Vec<[f64; 2]>,
    /// Every pair that must stay apart, the closest first.
    pub pairs: Vec<PairDistance>,
    /// Links whose shape is not known: a mesh, and no capsule is given.
    pub uncovered: Vec<String>,
    /// Whether the path from home is covered.
    pub has_way: bool,
}

/// The smallest distance of two shapes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PairDistance {
    /// A link.
    pub first: String,
    /// Another, or an obstacle.
    pub second: String,
    /// Their smallest distance, m.
    pub distance: f64,
    /// When, s; none on the path from home.
    pub at_s: Option<f64>,
}

/// How much of a limit a motion uses, SI.
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
    /// When the motion is closest to the limit, s.
    pub at_s: f64,
    /// The largest share of the limit that is used, from the middle of its range.
    pub part: f64,
}

/// The prediction for a base parameter.
#[derive(Debug, Clone, Serialize)]
pub struct PredictedParameter {
    /// Name.
    pub name: String,
    /// Unit.
    pub unit: String,
    /// Regrouping formula.
    pub expression: String,
    /// Number of the first joint whose torque depends on it, from one.
    pub joint: usize,
    /// The coordinate of that joint, from zero; none of a joint that is locked or follows others.
    pub coordinate: Option<usize>,
    /// Its a-priori value.
    pub a_priori: f64,
    /// Predicted standard deviation.
    pub standard_deviation: f64,
    /// Predicted half width of the 95 % interval.
    pub half_width_95: f64,
    /// Recording time for the requested half width, s, by repeating the motion; none if the a-priori value is zero.
    pub seconds: Option<f64>,
    /// If its interval contains zero: how many times narrower its interval is with a motion designed for such parameters alone.
    pub narrower_by_own_motion: Option<f64>,
    /// Its estimate in the results used for comparison.
    pub compared: Option<ParameterResult>,
}

impl PredictedParameter {
    /// How many times smaller the predicted interval is than that of the results used for comparison.
    #[must_use]
    pub fn times_smaller(&self) -> Option<f64> {
        let [low, high] = self.compared.as_ref()?.interval_95?;
        Some(0.5 * (high - low) / self.half_width_95).filter(|times| times.is_finite() && *times > 0.0)
    }
}

impl PredictedParameter {
    /// Its predicted grade, if the a-priori value is right.
    #[must_use]
    pub fn grade(&self) -> Grade {
        self.as_result().grade_of_interval()
    }

    /// The result of an estimate equal to its a-priori value.
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

/// A known payload, and the predicted drive gains from recordings with and without it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PredictedPayload {
    /// Its name.
    pub name: String,
    /// Its mass, kg.
    pub mass_kg: f64,
    /// The gains of the drives.
    pub gains: Vec<PredictedGain>,
}

/// The prediction for the gain of a drive.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PredictedGain {
    /// The joint.
    pub joint: String,
    /// Half of its predicted 95 % interval, percent; none if it is not identifiable.
    pub half_width_percent: Option<f64>,
}

/// The text of the experiment for a design, in parts; the path of the robot goes between them.
#[derive(Debug, Clone, PartialEq)]
pub struct ExperimentText {
    /// Path of the robot's description.
    pub robot: std::path::PathBuf,
    /// The title.
    pub title: String,
    /// The tables of the recording.
    pub recording: String,
    /// The tables of the simulated robot instead of the recording.
    pub twin: String,
    /// The tables of the settings.
    pub settings: String,
}
