use std::path::PathBuf;

use crate::{experiment::ExperimentError, preparation::PreparationError, reduction::ReductionError};
use thetahat_data::recording::RecordingError;
use thetahat_estimation::{identification::EstimationError, simulation::SimulationError};
use thetahat_model::{base_parameters::BaseParametersError, robot::RobotError};
use thetahat_report::results::ResultsError;

/// Why a design fails.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DesignError {
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
        /// The parser's message.
        message: String,
    },
    /// A limit is neither in the design nor in the robot's description.
    #[error(
        "{}: joint {joint} has no limit of {quantity}: give [limits] {quantity}, since {} states {states}",
        path.display(),
        robot.display()
    )]
    NoLimit {
        /// The design file.
        path: PathBuf,
        /// The robot's description.
        robot: PathBuf,
        /// The joint.
        joint: String,
        /// The quantity.
        quantity: &'static str,
        /// What the description states: `none`, or `0`, which is no limit.
        states: &'static str,
    },
    /// Limits of a joint exclude one another.
    #[error("{}: [limits] {quantity} of joint {joint} runs from {lower:.4} to {upper:.4} {unit}: {remedy}", path.display())]
    Contradiction {
        /// The design file.
        path: PathBuf,
        /// The joint.
        joint: String,
        /// The quantity.
        quantity: &'static str,
        /// Its lower limit.
        lower: f64,
        /// Its upper limit.
        upper: f64,
        /// Their unit, that of the file.
        unit: &'static str,
        /// What to do.
        remedy: &'static str,
    },
    /// A value of the design, or of the settings of the identification, cannot be used.
    #[error("{}: {source}", path.display())]
    Preparation {
        /// The design file.
        path: PathBuf,
        /// Why.
        source: PreparationError,
    },
    /// The base parameters of the robot are not clear.
    #[error("{}: {source}", path.display())]
    BaseParameters {
        /// The design file.
        path: PathBuf,
        /// Why.
        source: BaseParametersError,
    },
    /// No motion within the limits shows every parameter.
    #[error(
        "{}: no motion of {starts} starts shows all {parameters} parameters; give more [motion] harmonics, wider [limits], or \
         leave parameters out with [parameters] exclude",
        path.display()
    )]
    ShowsTooLittle {
        /// The design file.
        path: PathBuf,
        /// Searches made.
        starts: usize,
        /// Base parameters.
        parameters: usize,
    },
    /// A limit does not hold.
    #[error(
        "{}: [limits] {quantity} of joint {joint} cannot hold: it is {limit:.4} {unit} and the motion needs {needed:.4} {place}; \
         raise it, check the robot's a-priori parameters and friction, choose another [motion] start, or a shorter sweep_s in a sweep",
        path.display()
    )]
    Infeasible {
        /// The design file.
        path: PathBuf,
        /// The joint.
        joint: String,
        /// The quantity.
        quantity: &'static str,
        /// Its limit.
        limit: f64,
        /// What the best motion needs.
        needed: f64,
        /// Their unit, that of the file.
        unit: &'static str,
        /// When, or where in which sweep.
        place: String,
    },
    /// Shapes come too near to one another.
    #[error(
        "{}: [collision] {first} and {second} are {distance_mm:.1} mm apart {when}, margin {margin_mm} mm; choose another [motion] \
         start or home, give smaller capsules, or name the pair in [collision] ignore where they may touch",
        path.display()
    )]
    TooNear {
        /// The design file.
        path: PathBuf,
        /// A link.
        first: String,
        /// Another, or an obstacle.
        second: String,
        /// Their distance, mm.
        distance_mm: f64,
        /// The least distance, mm.
        margin_mm: f64,
        /// When.
        when: String,
    },
    /// No motion keeps two shapes apart.
    #[error(
        "{}: [collision] {first} and {second} are at most {furthest_mm:.1} mm apart at random postures within the limits, margin \
         {margin_mm} mm: no motion can keep it; give smaller capsules, or name the pair in [collision] ignore where they may touch",
        path.display()
    )]
    NeverApart {
        /// The design file.
        path: PathBuf,
        /// A link.
        first: String,
        /// Another, or an obstacle.
        second: String,
        /// Their largest distance, mm.
        furthest_mm: f64,
        /// The least distance, mm.
        margin_mm: f64,
    },
    /// A joint has no room for its sweeps.
    #[error(
        "{}: [motion] sweeps: joint {joint} starts at {start:.4} and has room from {from:.4} to {to:.4} {unit} alone, where {pair} \
         come nearer than [collision] margin; choose another [motion] start, or leave sweeps out",
        path.display()
    )]
    NoRoomToSweep {
        /// The design file.
        path: PathBuf,
        /// The joint.
        joint: String,
        /// Two links, or a link and an obstacle.
        pair: String,
        /// The coordinate of the joint at the start.
        start: f64,
        /// The least coordinate to which it can go.
        from: f64,
        /// The largest.
        to: f64,
        /// Their unit, that of the file.
        unit: &'static str,
    },
    /// The closed loop cannot follow the motion.
    #[error("{}: [controller] the simulated loop does not follow the motion: {source}", path.display())]
    Loop {
        /// The design file.
        path: PathBuf,
        /// Why.
        source: SimulationError,
    },
    /// The recording of the motion gives no estimate.
    #[error("{}: the designed recording gives no estimate: {source}", path.display())]
    NoEstimate {
        /// The design file.
        path: PathBuf,
        /// Why.
        source: EstimationError,
    },
    /// A reduction is of another robot.
    #[error(
        "{}: prior: the base parameters of the reductions or results are not those of the robot; take recordings of the same robot with \
         the same [parameters] exclude",
        path.display()
    )]
    OtherRobot {
        /// The design file.
        path: PathBuf,
    },
    /// Results named as `prior` have no model.
    #[error(
        "prior: {} has no model with a covariance; identify again with this version, or give a reduction of the recordings",
        file.display()
    )]
    NoModel {
        /// The results.
        file: PathBuf,
    },
    /// The motion whose torques are wanted cannot be read.
    #[error("{}: [wanted] motion: {source}", path.display())]
    WantedMotion {
        /// The design file.
        path: PathBuf,
        /// Why.
        source: Box<RecordingError>,
    },
    /// Results have no estimates, or of no parameter that is predicted.
    #[error(
        "{}: compare: {} has no estimate of a parameter that is predicted; give the results.json of the same robot",
        path.display(),
        file.display()
    )]
    NothingToCompare {
        /// The design file.
        path: PathBuf,
        /// The results.
        file: PathBuf,
    },
    /// Results have no residual of the robot's joints.
    #[error(
        "{}: [noise] results: {} has no residual of each of the robot's joints; give the results.json of an identification of this \
         robot, or [noise] torque",
        path.display(),
        file.display()
    )]
    NoNoise {
        /// The design file.
        path: PathBuf,
        /// The results.
        file: PathBuf,
    },
    /// The experiment to compare with cannot be identified.
    #[error(transparent)]
    Experiment(#[from] ExperimentError),
    /// Results cannot be read.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// The robot's description cannot be used.
    #[error(transparent)]
    Robot(#[from] RobotError),
    /// A reduction cannot be used.
    #[error(transparent)]
    Reduction(#[from] ReductionError),
}
