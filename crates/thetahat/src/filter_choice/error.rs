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
    /// There is no recording with torques.
    #[error("no recording has torques: a filter is chosen from what it does to the estimates")]
    NoTorque,
}
