use std::path::PathBuf;

use crate::{consistency::ConsistencyError, experiment::ExperimentError, identification::Method, robot::RobotError};

use super::format::Format;

/// Why a robot is not exported.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// The experiment in the results cannot be used.
    #[error(transparent)]
    Experiment(Box<ExperimentError>),
    /// A robot description cannot be used.
    #[error(transparent)]
    Robot(Box<RobotError>),
    /// The results have no robot description.
    #[error("{}: holds no robot description; identify again with this version", path.display())]
    NoRobot {
        /// The results.
        path: PathBuf,
    },
    /// The results do not say which file the robot was read from.
    #[error("{}: does not say which file its robot was read from; name it with --robot instead of --data", path.display())]
    UnknownFile {
        /// The results.
        path: PathBuf,
    },
    /// The results are not to be used.
    #[error(
        "{}: the verdict on these results is do-not-use: {}; put that right and identify again, or export them all the \
         same with --force",
        path.display(), reasons.join("; ")
    )]
    NotTrusted {
        /// The results.
        path: PathBuf,
        /// Why.
        reasons: Vec<String>,
    },
    /// The nominal case has no estimate by the method.
    #[error(
        "{}: holds no nominal estimate by {}; those it holds: {}",
        path.display(), method.map_or("any method", Method::name), if found.is_empty() { "none".to_owned() } else { found.join(", ") }
    )]
    NoEstimate {
        /// The results.
        path: PathBuf,
        /// The method asked for.
        method: Option<Method>,
        /// The methods that have one.
        found: Vec<String>,
    },
    /// The parameters of the results are not those of the robot in them.
    #[error("{}: {problem}", path.display())]
    OtherParameters {
        /// The results.
        path: PathBuf,
        /// What does not fit.
        problem: String,
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
        "{}: has changed since the identification (SHA-256 {found}, then {identified}); identify again with it, or leave \
         out --robot and --data: the description of then is in the results",
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
    /// No consistent parameters lie within the intervals.
    #[error(
        "no robot made of bodies has base parameters within the 95 % intervals of {method}{}; conditions in conflict: {}. \
         `physical = true` in [parameters] of the experiment gives the nearest consistent estimate, and says whether the data \
         reject it",
        deviations.map_or_else(String::new, |d| format!(" (the estimate is {d:.1} standard deviations outside)")),
        conflicting.join(", ")
    )]
    NotConsistent {
        /// The method.
        method: Method,
        /// How far outside the estimate is.
        deviations: Option<f64>,
        /// What cannot hold together.
        conflicting: Vec<String>,
    },
    /// The results do not say how sure the estimates are.
    #[error("the results hold no standard deviations of {method}; identify again with this version")]
    NoDeviations {
        /// The method.
        method: Method,
    },
    /// The consistent set cannot be used.
    #[error(transparent)]
    Consistency(#[from] ConsistencyError),
    /// Something has no form in JSON.
    #[error("the export cannot be written as JSON: {0}")]
    Unwritable(#[from] serde_json::Error),
    /// No reader for a check.
    #[error("{} cannot be read back: thetahat reads URDF alone; leave out --check", format.title())]
    NoReader {
        /// The format.
        format: Format,
    },
    /// What was read back has other torques.
    #[error(
        "the export read back has other torques: they differ by {difference:.2e} of the largest one at joint `{joint}`; \
         please report this with the robot description"
    )]
    RoundTrip {
        /// The joint with the largest difference.
        joint: String,
        /// The difference, relative.
        difference: f64,
    },
}

impl From<ExperimentError> for ExportError {
    fn from(error: ExperimentError) -> Self {
        Self::Experiment(Box::new(error))
    }
}

impl From<RobotError> for ExportError {
    fn from(error: RobotError) -> Self {
        Self::Robot(Box::new(error))
    }
}
