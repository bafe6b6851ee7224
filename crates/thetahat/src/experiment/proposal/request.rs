use std::{collections::BTreeMap, path::PathBuf};

use crate::experiment::driver::Driver;
use thetahat_data::recording::{Side, Unit};
use thetahat_estimation::identification::Method;
use thetahat_ground::one_or_each::OneOrEach;

/// The files of a proposal, and what the user has stated.
#[derive(Debug, Clone, Default)]
pub struct ProposalRequest {
    /// The robot description, as the experiment file is to name it.
    pub robot_file: PathBuf,
    /// The recordings, as the experiment file is to name them.
    pub recording_files: Vec<PathBuf>,
    /// The driver that wrote the recordings.
    pub driver: Option<Driver>,
    /// Columns of the positions, as `NAME`, `FILE` (all its columns) or `FILE:NAME`; if empty, they are found by their names.
    pub position: Vec<String>,
    /// Columns of the torques, likewise.
    pub torque: Vec<String>,
    /// The joints of the columns, in the robot's order, if the names do not show them: the others are locked.
    pub joints: Vec<String>,
    /// The time column, likewise.
    pub time: Option<String>,
    /// Samples per second, where there is no time column.
    pub sample_rate_hz: Option<f64>,
    /// The unit of the positions, or that of each joint; `None` to find it from the names or the range.
    pub position_unit: Option<OneOrEach<Unit>>,
    /// The unit of the torques, likewise; `None` to find it from the names.
    pub torque_unit: Option<OneOrEach<Unit>>,
    /// The side of the gears on which positions and torques were measured; `None` to find it from the names or the range.
    pub side: Option<Side>,
    /// Gains of the position controller, one for all motors or one for each, N m/rad: for a log without torques.
    pub position_gain: Vec<f64>,
    /// Gains of its velocity, N m s/rad, likewise. In a log with torques both describe the simulated loop.
    pub velocity_gain: Vec<f64>,
    /// Gains of the torques, one for all channels or one for each: N m for 1 A, 1 V or 100 %, where the unit is no torque.
    pub torque_gain: Vec<f64>,
    /// The methods of a log with torques; if empty, the usual ones.
    pub methods: Vec<Method>,
    /// Start and end of the window, s; `None` for the moving part.
    pub window_s: [Option<f64>; 2],
    /// Joints that do not move, by name, and their coordinates, rad or m, in addition to those without torques in the log.
    pub locked: BTreeMap<String, f64>,
}

/// Whether an argument names a column: by itself, after a file, or one channel of it.
pub(super) fn is_named(argument: &str, column: &str) -> bool {
    argument == column
        || argument.strip_suffix(column).is_some_and(|file| file.ends_with(':'))
        || argument.strip_prefix(column).is_some_and(|index| index.starts_with('['))
}
