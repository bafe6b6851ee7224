//! Closed-loop output error: least squares between measured and simulated positions.

use super::{
    clie::CLIE,
    estimator::{Estimator, Response},
};

/// One step of CLOE (11) to (13) with exact sensitivities (14), (15): least squares of `y - q_s + J theta` on J.
pub(super) static CLOE: Estimator = Estimator { name: "cloe", response: Response::Position, ..CLIE };
