use crate::preparation::PreparationError;
use thetahat_estimation::{identification::EstimationError, signal::SignalError};

/// Why no filter can be chosen.
#[derive(Debug, Clone, thiserror::Error)]
#[non_exhaustive]
pub enum FilterChoiceError {
    /// The recording cannot be used.
    #[error("{source}")]
    Preparation {
        /// Why.
        #[from]
        source: PreparationError,
    },
    /// The recording cannot be filtered.
    #[error("{source}")]
    Signal {
        /// Why.
        #[from]
        source: SignalError,
    },
    /// No estimate.
    #[error("{source}")]
    Estimation {
        /// Why.
        #[from]
        source: EstimationError,
    },
    /// Torque terms take recorded channels, which twins do not have.
    #[error("torque terms use recorded channels, which a twin does not have; choose the filter without these terms")]
    Channels,
    /// The base floats, and twins of the recording have a loop that moves joints alone.
    #[error(
        "the base of the robot floats, and a filter is chosen on copies of a closed loop, which none moves; keep the stated one"
    )]
    FloatingBase,
    /// There is no recording with torques.
    #[error("no recording has torques: a filter is chosen from what it does to the estimates")]
    NoTorque,
    /// The comparison would take minutes.
    #[error(
        "comparing filters on simulated copies with {parameters} parameters of {joints} joints takes too long; where the estimates \
         matter, compare two or three values of [signal] cutoff_hz by their error on data not used"
    )]
    TooLarge {
        /// Base parameters.
        parameters: usize,
        /// Coordinates of the robot.
        joints: usize,
    },
}
