//! The method that a simulation is integrated with.

use super::{
    dormand_prince::DormandPrince,
    rosenbrock_w::{Linearisation, RosenbrockW},
    solver::WorkCounts,
    step_control::{AcceptedStep, Next, StepTooSmall},
};

/// An integration by one of the methods.
#[derive(Debug, Clone)]
pub(super) enum Integrator {
    Explicit(DormandPrince),
    Implicit(RosenbrockW),
}

impl Integrator {
    pub(super) fn counts(&self) -> WorkCounts {
        match self {
            Self::Explicit(method) => method.counts(),
            Self::Implicit(method) => method.counts(),
        }
    }

    pub(super) fn state(&self) -> &[f64] {
        match self {
            Self::Explicit(method) => method.state(),
            Self::Implicit(method) => method.state(),
        }
    }

    pub(super) fn begin(&mut self, t0: f64, t1: f64) {
        match self {
            Self::Explicit(method) => method.begin(t0, t1),
            Self::Implicit(method) => method.begin(t0, t1),
        }
    }

    pub(super) fn wanted(&mut self) -> (f64, &[f64], &mut [f64]) {
        match self {
            Self::Explicit(method) => method.wanted(),
            Self::Implicit(method) => method.wanted(),
        }
    }

    pub(super) fn proceed(&mut self) -> Result<Next<'_>, StepTooSmall> {
        match self {
            Self::Explicit(method) => method.proceed(),
            Self::Implicit(method) => method.proceed(),
        }
    }

    /// The stage of the requested slope.
    pub(super) fn stage(&self) -> usize {
        match self {
            Self::Explicit(method) => method.stage(),
            Self::Implicit(method) => method.stage(),
        }
    }

    /// The step just accepted, until [`Self::proceed`].
    pub(super) fn accepted(&self) -> AcceptedStep<'_> {
        match self {
            Self::Explicit(method) => method.accepted(),
            Self::Implicit(method) => method.accepted(),
        }
    }

    /// Whether the mass matrix at the requested slope is needed as well.
    pub(super) fn needs_mass_matrix(&self) -> bool {
        match self {
            Self::Explicit(_) => false,
            Self::Implicit(method) => method.is_at_start(),
        }
    }

    /// Time, state and step at which to linearise the right-hand side; none for an explicit method.
    pub(super) fn wanted_linearisation(&mut self) -> Option<(f64, &[f64], f64, &mut Linearisation)> {
        match self {
            Self::Explicit(_) => None,
            Self::Implicit(method) => Some(method.wanted_linearisation()),
        }
    }
}
