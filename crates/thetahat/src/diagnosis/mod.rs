//! What the runs of a case show together: tests of residuals, of LS against IV, of instruments, and of DIDIM against IV, as
//! verdicts with numbers, and the advice that follows from them (`docs/reference/verdict.md`).

mod advice;
mod approximation;
mod biased_simulator;
mod comparison;
mod endogeneity;
mod estimated;
mod evidence;
mod explained;
mod independent;
mod instruments;
mod problems;
mod residual;
mod sentences;
mod verdict;

use crate::{preparation::Case, preparation::Problem};
use thetahat_estimation::identification::Method;
use thetahat_report::results::CaseDiagnosis;

pub(crate) use advice::advise;
pub(crate) use biased_simulator::Simulate;
pub(crate) use estimated::MethodEstimate;
pub(crate) use independent::independent_rows;
pub(crate) use residual::residual;
pub(crate) use verdict::judge;

use approximation::approximation;
use biased_simulator::biased_simulator;
use endogeneity::endogeneity;
use estimated::{Whitened, converged};
use instruments::instruments;

/// Compares the methods of a case. `simulate` gives Z of the loop simulated with other biases.
pub(crate) fn diagnose(
    problem: &Problem,
    case: &Case,
    estimated: &[MethodEstimate],
    simulate: &Simulate<'_>,
) -> CaseDiagnosis {
    // Its tests need rows in time order.
    let iv = converged(estimated, Method::IDIM_IV).filter(|iv| iv.regression.is_in_time_order).and_then(Whitened::new);
    let didim = converged(estimated, Method::DIDIM);
    CaseDiagnosis {
        case: case.name.clone(),
        endogeneity: iv.as_ref().and_then(|w| endogeneity(problem, w)),
        instruments: iv.as_ref().map(|w| instruments(problem, w)),
        approximation: didim
            .zip(converged(estimated, Method::CLIE))
            .and_then(|(didim, clie)| approximation(problem, didim, clie)),
        biased_simulator: didim.and_then(|d| biased_simulator(problem, case, d, simulate)),
    }
}
