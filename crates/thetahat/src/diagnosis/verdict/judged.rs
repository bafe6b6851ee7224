use thetahat_estimation::identification::Status;
use thetahat_report::results::{Advice, CaseDiagnosis, NOMINAL, Results, RunResult};

/// The advice for the case without errors of the simulator.
pub(super) fn nominal_advice(results: &Results) -> Option<&Advice> {
    results.advice.iter().find(|a| a.case == NOMINAL)
}

/// The comparison of the methods of that case.
pub(super) fn nominal_diagnosis(results: &Results) -> Option<&CaseDiagnosis> {
    results.diagnostics.iter().find(|d| d.case == NOMINAL)
}

/// The runs of that case.
pub(super) fn nominal_runs(results: &Results) -> impl Iterator<Item = &RunResult> {
    results.runs.iter().filter(|r| r.case == NOMINAL)
}

/// The runs whose numbers are judged: that of the method which the advice takes, or else all that converged.
pub(super) fn judged_runs(results: &Results) -> Vec<&RunResult> {
    let taken = nominal_advice(results).and_then(|a| a.recommended);
    let is_judged = |r: &&RunResult| taken.map_or(r.status == Status::Converged, |method| r.method == method);
    nominal_runs(results).filter(is_judged).collect()
}
