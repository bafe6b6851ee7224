use std::{collections::BTreeMap, path::PathBuf};

use thetahat_data::recording::{Side, Unit};

/// What a proposal is made for, and what is known already.
#[derive(Debug, Clone, Default)]
pub struct ProposalRequest {
    /// The robot description, as the experiment file is to name it.
    pub robot_file: PathBuf,
    /// The recordings, as the experiment file is to name them.
    pub recording_files: Vec<PathBuf>,
    /// Columns of the positions, as `NAME`, `FILE` (all its columns) or `FILE:NAME`; none looks for them by their names.
    pub position: Vec<String>,
    /// Columns of the torques, likewise.
    pub torque: Vec<String>,
    /// The joints of the columns, in the robot's order, where names do not tell: the others are locked.
    pub joints: Vec<String>,
    /// The time column, likewise.
    pub time: Option<String>,
    /// Samples per second, where there is no time column.
    pub sample_rate_hz: Option<f64>,
    /// The unit of the positions; none takes it from the names or the range.
    pub position_unit: Option<Unit>,
    /// The unit of the torques; none takes it from the names.
    pub torque_unit: Option<Unit>,
    /// The side of the gears on which positions and torques were measured; none takes it from the names or the range.
    pub side: Option<Side>,
    /// Start and end of the window, s; none takes the moving part.
    pub window_s: [Option<f64>; 2],
    /// Joints that do not move, by name, and their coordinates, rad or m, beside those of which the log has no torques.
    pub locked: BTreeMap<String, f64>,
}

/// Whether an argument names a column: by itself, behind a file, or one channel of it.
pub(super) fn is_named(argument: &str, column: &str) -> bool {
    argument == column
        || argument.strip_suffix(column).is_some_and(|file| file.ends_with(':'))
        || argument.strip_prefix(column).is_some_and(|index| index.starts_with('['))
}
