use serde::Deserialize;

/// How to integrate.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Solver {
    /// [`Self::Adaptive`], or [`Self::Implicit`] where friction is stiff against the inertia: decided once for each simulation
    /// by [`super::ClosedLoop::stiffness`].
    Automatic {
        /// Tolerance relative to the state.
        #[serde(default = "relative")]
        relative_tolerance: f64,
        /// Tolerance where the state is near zero, rad and rad/s.
        #[serde(default = "absolute")]
        absolute_tolerance: f64,
    },
    /// The explicit method of Dormand and Prince, with steps chosen by the error estimate, as `ode45` does.
    Adaptive {
        /// Tolerance relative to the state.
        #[serde(default = "relative")]
        relative_tolerance: f64,
        /// Tolerance where the state is near zero, rad and rad/s.
        #[serde(default = "absolute")]
        absolute_tolerance: f64,
    },
    /// The linearly implicit method [`super::RosenbrockW`], with steps chosen by the error estimate: for friction that is stiff
    /// against the inertia.
    Implicit {
        /// Tolerance relative to the state.
        #[serde(default = "relative")]
        relative_tolerance: f64,
        /// Tolerance where the state is near zero, rad and rad/s.
        #[serde(default = "absolute")]
        absolute_tolerance: f64,
    },
    /// Equal steps of the fifth-order formula.
    Fixed {
        /// Step in s.
        step_s: f64,
    },
}

/// The default tolerances of `ode45`.
const ODE45: [f64; 2] = [1e-3, 1e-6];

fn relative() -> f64 {
    ODE45[0]
}

fn absolute() -> f64 {
    ODE45[1]
}

impl Solver {
    /// The explicit method with the default tolerances of `ode45`.
    pub const ODE45: Self = Self::Adaptive { relative_tolerance: ODE45[0], absolute_tolerance: ODE45[1] };

    /// The method with tolerances multiplied by `factor`; equal steps are unchanged.
    #[must_use]
    pub fn with_tolerances_times(self, factor: f64) -> Self {
        match self {
            Self::Automatic { relative_tolerance: r, absolute_tolerance: a } => {
                Self::Automatic { relative_tolerance: factor * r, absolute_tolerance: factor * a }
            }
            Self::Adaptive { relative_tolerance: r, absolute_tolerance: a } => {
                Self::Adaptive { relative_tolerance: factor * r, absolute_tolerance: factor * a }
            }
            Self::Implicit { relative_tolerance: r, absolute_tolerance: a } => {
                Self::Implicit { relative_tolerance: factor * r, absolute_tolerance: factor * a }
            }
            Self::Fixed { step_s } => Self::Fixed { step_s },
        }
    }
}

impl Solver {
    /// The method for a response that is fitted: the implicit one if the choice is automatic. While friction sticks, stability keeps the
    /// explicit method's steps at their limit, and beyond the limit its sensitivities grow.
    #[doc(hidden)]
    pub fn for_sensitivities(self) -> Self {
        match self {
            Self::Automatic { relative_tolerance, absolute_tolerance } => {
                Self::Implicit { relative_tolerance, absolute_tolerance }
            }
            Self::Adaptive { .. } | Self::Implicit { .. } | Self::Fixed { .. } => self,
        }
    }
}

impl Default for Solver {
    fn default() -> Self {
        Self::Automatic { relative_tolerance: ODE45[0], absolute_tolerance: ODE45[1] }
    }
}

/// Work done by an integrator.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct WorkCounts {
    /// Right-hand sides.
    pub evaluations: usize,
    /// Steps taken.
    pub steps: usize,
    /// Steps repeated with a smaller size.
    pub rejected: usize,
}
