use serde::{Deserialize, Serialize};

/// Curves that all runs share; joint by joint as in y.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Plots {
    /// Time of each decimated row of a joint, s; the recordings follow one another.
    pub time_s: Vec<f64>,
    /// y, one vector per joint, N m or N.
    pub measured: Vec<Vec<f64>>,
    /// Filtered positions at the same times, one vector per joint, rad or m.
    pub position: Vec<Vec<f64>>,
    /// The recordings, in their order.
    pub recordings: Vec<RecordStart>,
    /// The recordings that were held back.
    pub held_back: HeldBackPlots,
    /// The robot in its mean pose; none where nothing is known of it.
    pub skeleton: Option<Skeleton>,
}

/// Where a recording begins in the curves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RecordStart {
    /// Its name.
    pub name: String,
    /// Its first row.
    pub row: usize,
}

/// Curves of the recordings that were held back.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct HeldBackPlots {
    /// Time of each decimated row of a joint, s; the recordings follow one another.
    pub time_s: Vec<f64>,
    /// Their y, one vector per joint, N m or N.
    pub measured: Vec<Vec<f64>>,
    /// The recordings, in their order.
    pub recordings: Vec<RecordStart>,
}

/// The frames of a robot, in the frame of its base.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Skeleton {
    /// One frame for each joint, in the order of the joints, at the mean of the recorded positions.
    pub frames: Vec<Frame>,
    /// The way of the last joint's origin in the recordings, m.
    pub tool_path: Vec<[f64; 3]>,
    /// Gravity, m/s^2.
    pub gravity: [f64; 3],
}

/// The frame of a joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// The joint that carries it; none for the base.
    pub parent: Option<usize>,
    /// Its origin, m.
    pub origin: [f64; 3],
    /// Its z axis, along which or about which the joint moves.
    pub axis: [f64; 3],
}

/// Curves of one run.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct RunPlots {
    /// `y_hat`, one vector per joint.
    pub predicted: Vec<Vec<f64>>,
    /// Simulated positions, one vector per joint; empty without a simulation.
    pub simulated_position: Vec<Vec<f64>>,
    /// `y_hat` of the recordings that were held back, one vector per joint; empty where none were.
    pub held_back: Vec<Vec<f64>>,
    /// What the residual depends on, joint by joint.
    pub residual: Vec<ResidualCurves>,
    /// Classical correlations of the estimates' errors, a row for each parameter, in their order.
    pub correlation: Vec<Vec<f64>>,
    /// The number of the link, joint or motor that each parameter is of, from one.
    pub numbers: Vec<usize>,
    /// The a-priori value of each parameter; none where one of those that it is made of is not known a priori.
    pub a_priori: Vec<Option<f64>>,
}

/// What the residual of one joint depends on.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ResidualCurves {
    /// Correlation of rows that are 1, 2, 3, ... rows apart.
    pub autocorrelation: Vec<f64>,
    /// What 95 % of the correlations of white rows do not exceed.
    pub band: f64,
    /// Frequency, Hz, and one-sided power spectral density, square of the torque's unit per Hz.
    pub spectrum: Vec<[f64; 2]>,
    /// The residual over the joint's velocity, rad/s or m/s.
    pub over_velocity: Vec<Bin>,
    /// The same over its position, rad or m.
    pub over_position: Vec<Bin>,
    /// The same over its predicted torque, N m or N.
    pub over_torque: Vec<Bin>,
}

/// The residual where another quantity lies within a range.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Bin {
    /// Mean of the other quantity.
    pub at: f64,
    /// Mean of the residual.
    pub mean: f64,
    /// Quantiles of 10 % and 90 % of the residual.
    pub spread: [f64; 2],
}
