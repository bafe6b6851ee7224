use serde::{Deserialize, Serialize};

/// Curves shared by all runs, per joint as in y.
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
    /// The recordings held back for validation.
    pub held_back: HeldBackPlots,
    /// The robot in its mean pose; none without a description.
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

/// Curves of the recordings held back for validation.
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
    /// The path of the last joint's origin in the recordings, m.
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
    /// Its z axis: the axis of the joint.
    pub axis: [f64; 3],
}

/// Curves of one run.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct RunPlots {
    /// `y_hat`, one vector per joint.
    pub predicted: Vec<Vec<f64>>,
    /// Simulated positions, one vector per joint; empty without a simulation.
    pub simulated_position: Vec<Vec<f64>>,
    /// `y_hat` of the recordings held back for validation, one vector per joint; empty without such recordings.
    pub held_back: Vec<Vec<f64>>,
    /// The residual over other quantities, per joint.
    pub residual: Vec<ResidualCurves>,
    /// Classical correlations of the estimation errors, a row for each parameter, in their order.
    pub correlation: Vec<Vec<f64>>,
    /// The number of the link, joint or motor of each parameter, from one.
    pub numbers: Vec<usize>,
    /// The a-priori value of each parameter; none if one of its standard parameters has no a-priori value.
    pub a_priori: Vec<Option<f64>>,
}

/// The residual of one joint over other quantities.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ResidualCurves {
    /// Correlation of rows that are 1, 2, 3, ... rows apart.
    pub autocorrelation: Vec<f64>,
    /// The 95 % bound of the correlations of white rows.
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

/// The residual in a range of another quantity.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Bin {
    /// Mean of the other quantity.
    pub at: f64,
    /// Mean of the residual.
    pub mean: f64,
    /// The 10 % and 90 % quantiles of the residual.
    pub spread: [f64; 2],
}
