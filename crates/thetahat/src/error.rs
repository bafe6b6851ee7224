//! One error over those of the modules.

use crate::{
    experiment::{ExperimentError, ProposalError},
    filter_choice::FilterChoiceError,
    preparation::PreparationError,
    reduction::ReductionError,
};
use thetahat_data::recording::{RecordingError, UnknownUnit};
use thetahat_estimation::{
    control::ControllerError,
    identification::{EstimationError, UnknownMethod},
    signal::SignalError,
    simulation::SimulationError,
    trajectory::TrajectoryError,
};
use thetahat_ground::{output::OutputError, series::SeriesError};
use thetahat_model::{
    base_parameters::BaseParametersError,
    consistency::ConsistencyError,
    dynamics::DynamicsError,
    robot::{LockError, RobotError},
};
use thetahat_report::{
    report::ReportError,
    results::{ResultsError, SideBySideError},
};
use thetahat_symbolic::symbolic::SymbolicError;

/// Any error of the library, for functions that use several modules. Its message and its source are those of the module's error.
///
/// ```
/// use thetahat::{Error, Identification, Recording, Robot, Series, Settings};
///
/// fn identify(robot: &Robot, recording: Recording) -> Result<(), Error> {
///     Identification::new(robot, vec![recording], Settings::new(20.0, 10))?.run()?;
///     Ok(())
/// }
/// # let text = "name = 'r'\n[[joint]]\nname = 'a'\nkind = 'revolute'\n";
/// let robot = Robot::parse(text, "r.toml".as_ref())?;
/// let two_channels = Recording::new(1000.0, Series::zeros(500, 2), Series::zeros(500, 2));
/// assert!(matches!(identify(&robot, two_channels), Err(Error::Preparation(_))));
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
#[non_exhaustive]
pub enum Error {
    /// A robot's description cannot be used.
    Robot(#[from] RobotError),
    /// Joints cannot be locked as described.
    Lock(#[from] LockError),
    /// A recording cannot be read.
    Recording(#[from] RecordingError),
    /// Values are no series.
    Series(#[from] SeriesError),
    /// A unit is not known.
    Unit(#[from] UnknownUnit),
    /// A robot has no dynamics, or another number of parameters.
    Dynamics(#[from] DynamicsError),
    /// Base parameters were not found.
    BaseParameters(#[from] BaseParametersError),
    /// Parameters are not physically consistent, or no consistent ones were found.
    Consistency(#[from] ConsistencyError),
    /// No code can be generated as asked.
    Symbolic(#[from] SymbolicError),
    /// A signal cannot be filtered.
    Signal(#[from] SignalError),
    /// A motion cannot be planned.
    Trajectory(#[from] TrajectoryError),
    /// A controller's description cannot be used.
    Controller(#[from] ControllerError),
    /// A loop cannot be simulated.
    Simulation(#[from] SimulationError),
    /// There is no estimate.
    Estimation(#[from] EstimationError),
    /// A method is not known.
    Method(#[from] UnknownMethod),
    /// Settings or recordings cannot be used.
    Preparation(#[from] PreparationError),
    /// No filter was chosen.
    FilterChoice(#[from] FilterChoiceError),
    /// An experiment cannot be read or run.
    Experiment(#[from] ExperimentError),
    /// No experiment can be proposed.
    Proposal(#[from] ProposalError),
    /// A campaign cannot be read or run.
    #[cfg(feature = "campaign")]
    Campaign(#[from] crate::campaign::CampaignError),
    /// A recording cannot be reduced, or a reduction not solved.
    Reduction(#[from] ReductionError),
    /// No motion can be designed.
    #[cfg(feature = "design")]
    Design(#[from] crate::design::DesignError),
    /// A robot cannot be exported.
    #[cfg(feature = "export")]
    Export(#[from] crate::export::ExportError),
    /// Results cannot be read or written.
    Results(#[from] ResultsError),
    /// Results cannot be compared.
    Comparison(#[from] SideBySideError),
    /// A report cannot be written.
    Report(#[from] ReportError),
    /// A file may not be replaced.
    Output(#[from] OutputError),
}
