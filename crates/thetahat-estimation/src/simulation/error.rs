use thetahat_model::dynamics::DynamicsError;

/// Why a simulation has no result.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// A joint ran away from its reference, or became infinite.
    #[error(
        "the simulated loop diverged: joint {joint} reached {velocity:.3e} at {time_s:.4} s; lower the bandwidth or check the start values"
    )]
    Diverged {
        /// The joint, from one.
        joint: usize,
        /// The time.
        time_s: f64,
        /// Its velocity there, rad/s or m/s; it may be NaN.
        velocity: f64,
    },
    /// The accelerations do not exist for these parameters.
    #[error("at {time_s:.4} s of the simulation: {source}")]
    Dynamics {
        /// The time.
        time_s: f64,
        /// Why.
        source: DynamicsError,
    },
    /// The integrator's step vanished.
    #[error(
        "the integration stopped at {time_s:.4} s: its step fell below the spacing of numbers; loosen the tolerance or widen sign_velocity_scale"
    )]
    StepTooSmall {
        /// The time.
        time_s: f64,
    },
    /// The simulated motion is too short for the filters of the recording.
    #[error("the simulated motion is too short for the filters; take a longer window")]
    TooShortToFilter,
    /// Adaptive steps so short that they would take more work than any recording needs.
    #[error(
        "the simulation took {steps:.1e} steps up to {time_s:.4} s: the loop is too stiff; lower the bandwidth, loosen the tolerance or widen sign_velocity_scale"
    )]
    TooStiff {
        /// Steps taken.
        steps: f64,
        /// The time reached.
        time_s: f64,
    },
    /// Fixed steps or a sample time that would take more work than any recording needs.
    #[error("the simulation would take {steps:.1e} steps of {step_s} s; use a longer step")]
    TooManySteps {
        /// Steps it would take.
        steps: f64,
        /// Their size.
        step_s: f64,
    },
}

impl SimulationError {
    /// The error of a part of the robot with these coordinates and joints, in the numbers of the whole.
    #[doc(hidden)]
    #[must_use]
    pub fn of_part(self, coordinates: &[usize], joints: &[usize]) -> Self {
        let whole = |of: &[usize], number: usize| of.get(number.wrapping_sub(1)).map_or(number, |place| place + 1);
        match self {
            Self::Diverged { joint, time_s, velocity } => {
                Self::Diverged { joint: whole(coordinates, joint), time_s, velocity }
            }
            Self::Dynamics { time_s, source: DynamicsError::MassMatrixNotPositiveDefinite { joint, pivot } } => {
                let source = DynamicsError::MassMatrixNotPositiveDefinite { joint: whole(joints, joint), pivot };
                Self::Dynamics { time_s, source }
            }
            Self::Dynamics { .. }
            | Self::StepTooSmall { .. }
            | Self::TooShortToFilter
            | Self::TooStiff { .. }
            | Self::TooManySteps { .. } => self,
        }
    }
}
