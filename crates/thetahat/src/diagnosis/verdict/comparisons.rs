//! Which methods ended with an estimate, and whether one of them can be taken.

use super::{
    judged::{nominal_advice, nominal_diagnosis, nominal_runs},
    reason::{ReasonText, reason},
};
use crate::diagnosis::problems::refuse_all;
use thetahat_estimation::identification::{DesignMatrix, Method, Needs, Status};
use thetahat_report::results::{
    BiasedSimulatorResult, Comparison, ReasonCode, ReasonSubject, Results, RunResult, Verdict, VerdictReason,
};

pub(super) fn reasons(results: &Results) -> Vec<VerdictReason> {
    let taken = nominal_advice(results).and_then(|a| a.recommended);
    let failed = nominal_runs(results).filter(|r| r.status != Status::Converged);
    failed.map(|run| not_converged(run, taken)).chain(undecided(results)).chain(last_resort(taken)).collect()
}

fn not_converged(run: &RunResult, taken: Option<Method>) -> VerdictReason {
    let why = run.reason.clone().unwrap_or_else(|| "no reason is known".to_owned());
    let (verdict, then) = match taken.filter(|method| *method != run.method) {
        Some(method) => (
            Verdict::Care,
            format!(
                "the numbers of {method}, which the advice takes, hold: look at what is said of {}, or leave it \
                 out of methods",
                run.method
            ),
        ),
        None => (Verdict::DoNotUse, "take none of its numbers".to_owned()),
    };
    let concerned = ReasonSubject { method: Some(run.method), ..ReasonSubject::default() };
    let numbers = [
        ("iterations", Some(run.iterations as f64)),
        ("parameter_change_deviations", run.convergence.last().and_then(|i| i.parameter_change)),
    ];
    let said = ReasonText::new(format!("{} did not converge ({why})", run.method), then);
    reason(ReasonCode::NotConverged, verdict, &numbers, concerned, said)
}

/// What the methods of the nominal case say of a model: one run never condemns another, but values that differ between methods are
/// not to be quoted.
pub(super) fn of_model(results: &Results) -> Option<VerdictReason> {
    nominal_advice(results).filter(|a| a.recommended.is_none())?;
    let test = nominal_diagnosis(results)?.biased_simulator.as_ref();
    let differing = differing(test.filter(|t| t.verdict == Comparison::Undecided)?);
    Some(VerdictReason { verdict: Verdict::Care, ..differing })
}

/// No method to take, where it is not a problem of the recordings that says so.
fn undecided(results: &Results) -> Option<VerdictReason> {
    let advice = nominal_advice(results).filter(|a| a.recommended.is_none())?;
    let test = nominal_diagnosis(results).and_then(|d| d.biased_simulator.as_ref());
    let test = test.filter(|t| t.verdict == Comparison::Undecided);
    if let Some(test) = test {
        return Some(differing(test));
    }
    let said = ReasonText::new("No method has numbers to take", advice.text.trim_end_matches('.'));
    let is_said = refuse_all(results) || nominal_runs(results).all(|r| r.status != Status::Converged);
    (!is_said).then(|| reason(ReasonCode::Undecided, Verdict::DoNotUse, &[], ReasonSubject::default(), said))
}

fn differing(test: &BiasedSimulatorResult) -> VerdictReason {
    let numbers = [
        ("average_difference", Some(test.average_difference)),
        ("residual_ratio", Some(test.residual_ratio)),
        ("p_value", Some(test.p_value)),
    ];
    let most = test.parameters.first();
    let seen = format!(
        "idim-iv and didim differ by {:.2} standard deviations on average, most in {}, and didim leaves {:.2} times the residual \
         of idim-iv: the measured motion or the simulator is wrong",
        test.average_difference,
        most.map_or("no parameter", |p| &p.name),
        test.residual_ratio
    );
    let remedy = "say held = true where the torque is held from sample to sample, leave out more samples near rest by a larger \
                  velocity in [signal] mask, and compare again";
    let concerned = ReasonSubject { parameter: most.map(|p| p.name.clone()), ..ReasonSubject::default() };
    reason(ReasonCode::Undecided, Verdict::DoNotUse, &numbers, concerned, ReasonText::new(seen, remedy))
}

/// A method that fits the simulated loop is taken where no other can be: nothing tests its simulator.
fn last_resort(taken: Option<Method>) -> Option<VerdictReason> {
    let method = taken.filter(|m| m.needs() != Needs::Measurement && m.design() == DesignMatrix::Simulated)?;
    let concerned = ReasonSubject { method: Some(method), ..ReasonSubject::default() };
    let said = ReasonText::new(
        format!("Only {method} has numbers to take, and nothing tests the simulator that it believes"),
        "compare with a second recording, or record torques for idim-iv",
    );
    Some(reason(ReasonCode::LastResort, Verdict::Care, &[], concerned, said))
}
