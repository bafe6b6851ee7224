use std::path::PathBuf;

use crate::experiment::ExperimentError;
use thetahat_estimation::identification::Method;
use thetahat_model::{consistency::ConsistencyError, robot::RobotError};

use super::{format::ExportFormat, mjcf::MjcfError};

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
    /// A MuJoCo model of the user's own cannot be edited.
    #[error(transparent)]
    Mjcf(Box<MjcfError>),
    /// No consistent parameters lie within the intervals.
    #[error(
        "{}: no robot made of bodies has base parameters within the 95 % intervals of {method}{}; conditions in conflict: {}. \
         `physical = true` in [parameters] of the experiment gives the nearest consistent estimate, and says whether the data \
         reject it",
        path.display(),
        deviations.map_or_else(String::new, |d| format!(" (the estimate is {d:.1} standard deviations outside)")),
        conflicting.join(", ")
    )]
    NotConsistent {
        /// The results.
        path: PathBuf,
        /// The method.
        method: Method,
        /// How far outside the estimate is.
        deviations: Option<f64>,
        /// What cannot hold together.
        conflicting: Vec<String>,
    },
    /// The results do not say how sure the estimates are.
    #[error("{}: holds no standard deviations of {method}; identify again with this version", path.display())]
    NoDeviations {
        /// The results.
        path: PathBuf,
        /// The method.
        method: Method,
    },
    /// The covariance of the estimates is singular.
    #[error(
        "{}: the covariance of the estimates by {method} is singular, so that nothing can be measured in it or drawn from it; \
         estimate fewer parameters (`estimate = \"essential\"` in `[parameters]`), or record more",
        path.display()
    )]
    SingularCovariance {
        /// The results.
        path: PathBuf,
        /// The method.
        method: Method,
    },
    /// The consistent set cannot be used.
    #[error("{}: {source}", path.display())]
    Consistency {
        /// The results.
        path: PathBuf,
        /// Why.
        source: ConsistencyError,
    },
    /// Something has no form in JSON.
    #[error("the export cannot be written as JSON: {0}")]
    Unwritable(#[from] serde_json::Error),
    /// A joint follows several others, which the format has not.
    #[error(
        "joint `{joint}` follows several others, and {} has no such joint: another program would take it to follow one; JSON \
         has it, and so has the URDF that the robot was read from", format.title()
    )]
    FollowsSeveral {
        /// The joint.
        joint: String,
        /// The format.
        format: ExportFormat,
    },
    /// Loops of links, which the format has not.
    #[error(
        "the robot has loops of links, and {} has trees of joints alone; MJCF and JSON have loops, and a MuJoCo model of your own \
         keeps them",
        format.title()
    )]
    Loops {
        /// The format.
        format: ExportFormat,
    },
    /// A base that floats, which a format does not have.
    #[error(
        "the base of the robot floats, and {} without a floating base or coupled motors on it; URDF, SDF, MJCF and JSON have the robot",
        match format {
            Some(format) => format!("{} is written", format.title()),
            None => "a MuJoCo model of your own is edited".to_owned(),
        }
    )]
    FloatingBase {
        /// The format; none for a model of the user's own.
        format: Option<ExportFormat>,
    },
    /// A format of drives has those of single joints.
    #[error("{} has a drive for each joint, and motor {motor} turns several; JSON and MJCF have such motors", format.title())]
    CoupledActuators {
        /// The format.
        format: ExportFormat,
        /// The motor, from one.
        motor: usize,
    },
    /// A format of drives has none of joints that follow others.
    #[error("joint `{joint}` follows another, and {} has drives of single joints; JSON and MJCF have such joints", format.title())]
    FollowerInActuators {
        /// The joint.
        joint: String,
        /// The format.
        format: ExportFormat,
    },
    /// A format of drives holds a controller.
    #[error(
        "{} holds a controller, and none was identified: it takes estimates from positions under a PD controller of known \
         gains, by cloe or clie", format.title()
    )]
    NoController {
        /// The format.
        format: ExportFormat,
    },
    /// A format of one actuator.
    #[error("{} holds one actuator, and the robot has {joints} joints: lock the others (`locked`) and identify each", format.title())]
    SeveralActuators {
        /// Those of the robot.
        joints: usize,
        /// The format.
        format: ExportFormat,
    },
    /// No reader for a check.
    #[error("{} is not read back: it holds the parameters as they are, and nothing is to be checked", format.title())]
    NoReader {
        /// The format.
        format: ExportFormat,
    },
    /// What was read back lacks something.
    #[error("the export read back has no {missing}; please report this with the robot description")]
    ReadBack {
        /// What it lacks.
        missing: String,
    },
    /// What was read back has other joints.
    #[error(
        "the export read back has the joints {}, and the robot {}; please report this with the robot description",
        found.join(", "), expected.join(", ")
    )]
    OtherJoints {
        /// Those of the export.
        found: Vec<String>,
        /// Those of the robot.
        expected: Vec<String>,
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

impl From<MjcfError> for ExportError {
    fn from(error: MjcfError) -> Self {
        Self::Mjcf(Box::new(error))
    }
}
