use serde::Deserialize;

/// How to integrate.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Solver {
    /// Steps chosen by the error estimate, as `ode45` does.
    Adaptive {
        /// Tolerance relative to the state.
        relative_tolerance: f64,
        /// Tolerance where the state is near zero, rad and rad/s.
        absolute_tolerance: f64,
    },
    /// Equal steps of the fifth-order formula.
    Fixed {
        /// Step in s.
        step_s: f64,
    },
}

impl Solver {
    /// The default tolerances of `ode45`.
    pub const ODE45: Self = Self::Adaptive { relative_tolerance: 1e-3, absolute_tolerance: 1e-6 };
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
