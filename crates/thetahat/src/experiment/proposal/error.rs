use std::path::PathBuf;

use crate::experiment::column_names;

/// Why no experiment can be proposed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProposalError {
    /// The base floats: its columns and contacts are not guessed.
    #[error(
        "the base of {robot} floats, and its pose and contacts are not guessed: propose for the URDF or MJCF without floating_base, then \
         name the TOML as robot and add [recording.base]"
    )]
    FloatingBase {
        /// The robot.
        robot: String,
    },
    /// The columns of a signal are not clear.
    #[error(
        "{}: the columns of the {signal} are not clear: {problem}; expected one for each joint, {joints} in all; \
         the columns are: {}{}{}",
        file.display(), columns.join(" "), without_torques(signal, columns), rearranged(columns)
    )]
    UnclearColumns {
        /// The recording.
        file: PathBuf,
        /// `position` or `torque`.
        signal: &'static str,
        /// What was found instead.
        problem: String,
        /// Number of joints.
        joints: usize,
        /// The columns of the recording.
        columns: Vec<String>,
    },
    /// Neither columns nor name of a file say what it holds.
    #[error(
        "{}: neither its name nor its columns say which signal it holds; the columns are: {}",
        file.display(), columns.join(" ")
    )]
    UnclearFile {
        /// The file.
        file: PathBuf,
        /// Its columns.
        columns: Vec<String>,
    },
    /// A unit stands in the name of a column, and is none of the signal or of the joint.
    #[error("{}: column {column:?} is {problem}", file.display())]
    UnclearUnit {
        /// The recording.
        file: PathBuf,
        /// The column.
        column: String,
        /// What it is written in, and why that cannot be.
        problem: String,
        /// `position` or `torque`.
        signal: &'static str,
        /// Whether the unit is none of this joint, though it is one of the signal.
        is_of_a_joint: bool,
    },
    /// The columns that were named for a signal are more or fewer than the joints.
    #[error(
        "{found} columns are named for the {signal}; {robot} has {joints} joints, and one is needed for each of them"
    )]
    ColumnCount {
        /// `position` or `torque`.
        signal: &'static str,
        /// The columns named.
        found: usize,
        /// Name of the robot.
        robot: String,
        /// Its joints.
        joints: usize,
    },
    /// Positions and torques are the same column.
    #[error("{}: column {column:?} is taken for the positions and for the torques", file.display())]
    SameColumn {
        /// The file.
        file: PathBuf,
        /// The column.
        column: String,
    },
    /// The joints that were named are not those of the robot, or in another order.
    #[error("joints {}: expected joints of the robot, in its order: {}", found.join(","), known.join(","))]
    Joints {
        /// The names.
        found: Vec<String>,
        /// The joints of the robot that follow no other.
        known: Vec<String>,
    },
    /// A joint that was locked is not one of the robot.
    #[error("joint `{joint}` cannot be locked: the robot has no such joint that follows no other; it has {}", known.join(", "))]
    NoSuchJoint {
        /// The name.
        joint: String,
        /// The joints of the robot that follow no other.
        known: Vec<String>,
    },
    /// A joint was locked, and named as one of the log.
    #[error("joint `{joint}` is locked, and named as one whose columns are in the log; expected one of both")]
    LockedAndNamed {
        /// The joint.
        joint: String,
    },
    /// A joint moves whose torques are not in the log.
    #[error(
        "joint `{joint}` moves from {least:.4} to {most:.4} {unit}, and the log has no torque of it: locked, it would falsify the \
         dynamics of the joints before it; record it with its torque, or with a column of zeros if \
         nothing drives it, or cut the log to a part in which it rests"
    )]
    MovesWithoutTorque {
        /// The joint.
        joint: String,
        /// Its least position.
        least: f64,
        /// Its largest position.
        most: f64,
        /// `rad` or `m`.
        unit: &'static str,
    },
    /// The robot cannot be read.
    #[error("{problem}")]
    Robot {
        /// Why.
        problem: String,
    },
    /// No file has the columns of the driver.
    #[error(
        "{}: it has none of the columns of the driver {driver} ({}); the columns are: {}",
        file.display(), expected.join(" "), columns.join(" ")
    )]
    NotOfDriver {
        /// The first recording.
        file: PathBuf,
        /// The driver.
        driver: String,
        /// The names of its columns.
        expected: Vec<String>,
        /// The columns of the recording.
        columns: Vec<String>,
    },
    /// There is no time column and no rate.
    #[error("{}: no time column is found and no sample rate is stated; the columns are: {}",
        file.display(), columns.join(" "))]
    NoTime {
        /// The recording.
        file: PathBuf,
        /// The columns of the recording.
        columns: Vec<String>,
    },
    /// A column that was named as the time never rises.
    #[error("{}: column {column:?} is no time: {problem}", file.display())]
    NotATime {
        /// The file.
        file: PathBuf,
        /// The column.
        column: String,
        /// What it is.
        problem: &'static str,
    },
    /// The times start again: a file of two recordings.
    #[error(
        "{}: the times in column {column:?} start again at sample {sample} counted from 0: these are two recordings; write the samples \
         from there on into a file of their own, and name both: --recording FIRST --recording SECOND", file.display()
    )]
    TimeRestarts {
        /// The file.
        file: PathBuf,
        /// The column.
        column: String,
        /// The first sample of the second recording.
        sample: usize,
    },
    /// As many units were stated as the signal has no channels.
    #[error("{found} units are stated for the {signal}; expected one for all, or one for each of {joints} joints")]
    UnitCount {
        /// `position` or `torque`.
        signal: &'static str,
        /// The units stated.
        found: usize,
        /// Number of joints.
        joints: usize,
    },
    /// The rate that was stated is not that of the times.
    #[error("{}: a rate of {stated} Hz is stated, but the times in column {column:?} say {found:.6} Hz", file.display())]
    RateContradictsTimes {
        /// The file of the times.
        file: PathBuf,
        /// Their column.
        column: String,
        /// The rate that was stated, Hz.
        stated: f64,
        /// The rate of the times, Hz.
        found: f64,
    },
    /// A column that was named is not there, or holds no numbers.
    #[error("{}: there is no column {name:?} of numbers; the columns are: {}", file.display(), columns.join(" "))]
    NoSuchColumn {
        /// The recording.
        file: PathBuf,
        /// The name.
        name: String,
        /// The columns of the recording.
        columns: Vec<String>,
    },
    /// It is not clear which files belong together.
    #[error(
        "{}: it holds {holds}, and the names do not show which of the other files belong to the same recording; \
         give the files of one recording at a time", file.display()
    )]
    NoPartner {
        /// The file.
        file: PathBuf,
        /// The signal that it holds.
        holds: &'static str,
    },
    /// Files of one recording have different numbers of samples.
    #[error("{} has {samples} samples, {} has {other_samples}: they are not of one recording", file.display(), other.display())]
    DifferentLengths {
        /// A file.
        file: PathBuf,
        /// Its samples.
        samples: usize,
        /// The other.
        other: PathBuf,
        /// Its samples.
        other_samples: usize,
    },
}

/// What to do about a table that has a line for each joint, or columns whose compression is not read.
fn rearranged(columns: &[String]) -> &'static str {
    let names_joints = |column: &String| {
        let name = column.strip_prefix('`').and_then(|rest| rest.split_once("` (text"));
        name.is_some_and(|(name, _)| matches!(name, "joint" | "joint_name" | "axis" | "name" | "id" | "motor"))
    };
    if columns.iter().any(names_joints) {
        return "; the table has a line for each joint: a line for each time is expected, in pandas \
                table.pivot(index=\"time\", columns=\"joint\")";
    }
    if columns.iter().any(|column| column.contains("(a column compressed by ")) {
        return "; write the file with a compression that is read, in pandas \
                pandas.read_parquet(FILE).to_parquet(OTHER, compression=\"zstd\")";
    }
    ""
}

/// What to do about a log that may have no torques.
fn without_torques(signal: &str, columns: &[String]) -> String {
    let desired: Vec<&str> =
        columns.iter().map(String::as_str).filter(|c| column_names::says_desired_torque(c)).collect();
    match (signal, &desired[..]) {
        ("torque", []) => {
            "; where no torque is recorded, a log of the commanded positions is needed too: cloe estimates from both"
                .to_owned()
        }
        ("torque", desired) => format!(
            "; {} hold desired torques, which the controller computed: name them with --torque to take them for measured ones",
            desired.join(" ")
        ),
        _ => String::new(),
    }
}
