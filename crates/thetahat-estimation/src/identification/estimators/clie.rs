//! Closed-loop input error: least squares between measured and simulated torques.

use super::{
    didim::DIDIM,
    estimator::{Estimator, Needs},
};

/// One step of CLIE (11) to (13) with exact sensitivities (14), (15): least squares of `y - tau_s + J theta` on J.
pub(super) static CLIE: Estimator = Estimator { name: "clie", equation: "(13)", needs: Needs::Sensitivities, ..DIDIM };
