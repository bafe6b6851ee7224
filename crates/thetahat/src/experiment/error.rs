use std::path::PathBuf;

use crate::{filter_choice::FilterChoiceError, preparation::PreparationError};
use thetahat_data::recording::{RecordingError, Unit};
use thetahat_estimation::{simulation::SimulationError, trajectory::TrajectoryError};
use thetahat_ground::number::significant;
use thetahat_model::robot::RobotError;
use thetahat_report::results::{NoEstimate, ResultsError};

/// Why an experiment cannot be read or run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExperimentError {
    /// A file cannot be read.
    #[error("{}: cannot be read: {reason}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        reason: String,
    },
    /// The file is not TOML of the expected form; the message names line and column.
    #[error("{}: {message}", path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// The parser's message, with line, column and the expected keys.
        message: String,
    },
    /// The experiment does not fit its robot or recordings.
    #[error("{}: {source}", path.display())]
    Preparation {
        /// The experiment file.
        path: PathBuf,
        /// Why.
        source: PreparationError,
    },
    /// A motion to predict is too short for the filter of the identification.
    #[error(
        "{}: lasts {} s with its time in {unit}, as in the experiment, which is too short; is it in another unit? Then state it: \
         time_unit", path.display(), significant(*duration_s, 3)
    )]
    ShortMotion {
        /// The file of the time.
        path: PathBuf,
        /// Its length in that unit, s.
        duration_s: f64,
        /// The unit.
        unit: Unit,
    },
    /// A file that the experiment names lies outside its folder.
    #[error(
        "{}: {key} is {}, expected a file in the folder of the experiment or the one above{}", path.display(), found.display(),
        if *key == "robot" { ", or in the folder of the data" } else { "" }
    )]
    OutsideFolder {
        /// The experiment file.
        path: PathBuf,
        /// The key that names the file.
        key: String,
        /// The file as it is named.
        found: PathBuf,
    },
    /// No filter can be chosen.
    #[error("{}: no filter can be chosen from the recordings: {source}", path.display())]
    Filter {
        /// The experiment file.
        path: PathBuf,
        /// Why.
        source: FilterChoiceError,
    },
    /// The robot description is not usable.
    #[error(transparent)]
    Robot(#[from] RobotError),
    /// The recording is not usable.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// The twin's moves cannot be planned.
    #[error("{}: [twin] {source}", path.display())]
    Plan {
        /// The experiment file.
        path: PathBuf,
        /// Why.
        source: TrajectoryError,
    },
    /// The twin's recording cannot be simulated.
    #[error("{}: [twin] {source}", path.display())]
    Twin {
        /// The experiment file.
        path: PathBuf,
        /// Why.
        source: SimulationError,
    },
    /// The results cannot be read.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// The results miss what a prediction needs.
    #[error("{}: {problem}", path.display())]
    ResultsFile {
        /// The file.
        path: PathBuf,
        /// What is wrong and what to do.
        problem: String,
    },
    /// The results have no robot description.
    #[error("{}: holds no robot description; identify again with this version", path.display())]
    NoRobot {
        /// The results.
        path: PathBuf,
    },
    /// The results do not say which file the robot was read from.
    #[error("{}: does not say which file its robot was read from; name that file", path.display())]
    UnknownRobotFile {
        /// The results.
        path: PathBuf,
    },
    /// The results are not to be used.
    #[error(
        "{}: the verdict on these results is do-not-use: {}; put that right and identify again",
        path.display(), reasons.join("; ")
    )]
    NotTrusted {
        /// The results.
        path: PathBuf,
        /// Why.
        reasons: Vec<String>,
    },
    /// No remedy has this code.
    #[error(
        "{}: no remedy has the code {code}; {}", path.display(),
        if known.is_empty() {
            "no finding of this experiment has a remedy that is a setting".to_owned()
        } else {
            format!("these can be applied: {}", known.join(", "))
        }
    )]
    UnknownRemedy {
        /// The experiment.
        path: PathBuf,
        /// The code.
        code: String,
        /// The codes that there are, with what they do.
        known: Vec<String>,
    },
    /// A remedy cannot be written into this file.
    #[error("{}: the remedy {code} ({label}) cannot be written into this file; apply it in a run of its own, or change the file by hand", path.display())]
    NoRemedy {
        /// The experiment.
        path: PathBuf,
        /// The code.
        code: String,
        /// What it does.
        label: String,
    },
    /// A motion moves a joint that the identification locked.
    #[error(
        "{}: joint `{joint}` is locked at {value:.4} {unit} in the results, and goes from {least:.4} to {most:.4} {unit} here (column \
         {column:?}): the parameters hold for the locked joint alone; identify from recordings in which it moves", file.display()
    )]
    LockedMoves {
        /// The file of the motion.
        file: PathBuf,
        /// The joint.
        joint: String,
        /// Where it is locked.
        value: f64,
        /// The column of its positions.
        column: String,
        /// Its least position.
        least: f64,
        /// Its largest position.
        most: f64,
        /// `rad` or `m`, of all three.
        unit: &'static str,
    },
    /// The results have no such estimate.
    #[error("{}: {source}", path.display())]
    NoEstimate {
        /// The results.
        path: PathBuf,
        /// What there is.
        source: NoEstimate,
    },
    /// The results are of arrays.
    #[error(
        "{}: is of arrays and holds no experiment, which would describe the channels of a recording; predict in Python, with \
         the robot and the estimates",
        path.display()
    )]
    OfArrays {
        /// The results.
        path: PathBuf,
    },
    /// The robot description is not the one that was identified, and of another robot.
    #[error(
        "{}: is not the robot of these results: its joints are {}, and those identified were {}; give the description of \
         `{robot}`",
        path.display(), found.join(", "), identified.join(", ")
    )]
    AnotherRobot {
        /// The description.
        path: PathBuf,
        /// Name of the robot that was identified.
        robot: String,
        /// Its joints.
        found: Vec<String>,
        /// Those of the results.
        identified: Vec<String>,
    },
    /// The robot description has changed since the identification.
    #[error(
        "{}: has changed since the identification (SHA-256 {found}, then {identified}); identify again with it, or take \
         the description of then, which is in the results",
        path.display()
    )]
    RobotChanged {
        /// The file.
        path: PathBuf,
        /// Its hash.
        found: String,
        /// The hash in the results.
        identified: String,
    },
}
