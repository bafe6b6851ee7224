//! What the numbers that are taken say of themselves.

use super::{
    judged::{judged_runs, nominal_runs},
    reason::{ReasonText, reason},
};
use thetahat_estimation::checks::{Finding, Severity};
use thetahat_ground::number::significant;
use thetahat_report::results::{
    Explained, HiddenError, JointResidual, ReasonCode, ReasonSubject, Results, RunResult, Verdict, VerdictReason,
};

/// Relative error of a joint, percent, from which its torque is not explained where there are no rows to test. Clean: 54 (KUKA).
const UNEXPLAINED_PERCENT: f64 = 95.0;
/// The same from which much of it is left. Clean: 12 (TX40), 6 (UR10); the KUKA has 54 at its last joint, and care.
const POORLY_PERCENT: f64 = 50.0;
/// What to do where rows are too few.
const RECORD_LONGER: &str = "record longer, or estimate fewer parameters";
/// The error of what was left out over that of the fit, from which it is much above it. Clean: 1.5 (EMPS), 1.2 (TX40); the KUKA
/// has 4.5, and care.
const CROSS_VALIDATION: f64 = 2.0;
/// The same from which what was left out contradicts the fit. Clean: 18 (KUKA by IV, each of two recordings left out).
const CROSS_VALIDATION_FAR: f64 = 30.0;
/// The error of what was left out, percent of the torque, from which an estimate that fits twice as well is not to be used.
const USELESS_PERCENT: f64 = 50.0;
/// Change of an estimate without one part of the recording, in its deviations with correlated errors, from which that part decides.
/// Clean: 2.2 (UR10), 1.6 (TX40); the KUKA has 34, and care.
const INFLUENCE: f64 = 4.0;
/// Correlation of neighbouring rows of white noise after the parallel filter, and how many deviations of it, one over the root of
/// the rows of a joint, a residual may have more. Twins of the model have 0.1 to 0.25 where 0.28 to 0.33 is the limit; every
/// recorded robot has 0.65 to 0.97, and care.
const WHITE: f64 = 0.23;
const MORE_DEVIATIONS: f64 = 2.0;
/// Standard deviations by which a simulated error moves an estimate, from which it is reported: half of its 95 % interval.
const MORE_THAN_INTERVAL: f64 = 2.0;

pub(super) fn reasons(results: &Results) -> Vec<VerdictReason> {
    let mut reasons: Vec<VerdictReason> = Vec::new();
    for run in judged_runs(results) {
        let mut of_run = not_explained(results, run);
        of_run.extend(poorly_explained(results, run, &of_run));
        of_run.extend(cross_validation(results, run));
        of_run.extend(not_physical(results, run));
        of_run.extend(influence(run));
        of_run.extend(correlated_residual(results, run));
        add(&mut reasons, of_run);
    }
    let worse = nominal_runs(results).flat_map(|run| run.findings.iter().filter_map(|f| no_predictive_power(run, f)));
    add(&mut reasons, worse.collect());
    reasons
}

/// Adds reasons; what is said of one method is not said of the next one too.
fn add(reasons: &mut Vec<VerdictReason>, more: Vec<VerdictReason>) {
    for reason in more {
        let about = |r: &VerdictReason| (r.code, r.subject.joint.clone(), r.subject.parameter.clone());
        if reasons.iter().all(|r| about(r) != about(&reason)) {
            reasons.push(reason);
        }
    }
}

fn of_method(run: &RunResult) -> ReasonSubject {
    ReasonSubject { method: Some(run.method), ..ReasonSubject::default() }
}

/// The name of a coordinate's joint, from one.
fn joint_name(results: &Results, joint: usize) -> String {
    results.robot_joints.get(joint - 1).map_or_else(|| joint.to_string(), |j| j.name.clone())
}

/// A joint whose torque the model explains no better than a constant.
struct NotExplained {
    joint: usize,
    error_percent: Option<f64>,
    /// None if there are no rows to test.
    test: Option<Explained>,
}

impl NotExplained {
    fn numbers(&self) -> [(&'static str, Option<f64>); 4] {
        let limit = self.test.map_or(UNEXPLAINED_PERCENT, |_| Explained::LIMIT);
        [
            ("relative_error_percent", self.error_percent),
            ("p_value", self.test.map(|t| t.test.p_value)),
            ("deviations_above_shifted", self.test.and_then(|t| t.deviations_above_shifted)),
            ("limit", Some(limit)),
        ]
    }
}

fn not_explained(results: &Results, run: &RunResult) -> Vec<VerdictReason> {
    let (joints, tested) = match &run.residual {
        Some(residual) => (by_test(run, &residual.joints), residual.joints.len()),
        None => (by_error(run), run.joint_relative_error_percent.len()),
    };
    match joints.as_slice() {
        [] => Vec::new(),
        [first, ..] if joints.len() == tested => vec![nothing_explained(run, first)],
        some => some.iter().map(|j| joint_not_explained(results, run, j)).collect(),
    }
}

fn by_test(run: &RunResult, joints: &[JointResidual]) -> Vec<NotExplained> {
    let by_chance = |joint: &JointResidual| {
        let test = joint.explained.filter(Explained::is_by_chance)?;
        let error_percent = run.joint_relative_error_percent.get(joint.joint - 1).copied().flatten();
        Some(NotExplained { joint: joint.joint, error_percent, test: Some(test) })
    };
    joints.iter().filter_map(by_chance).collect()
}

/// Estimates from triangular factors, whose rows are not in time order.
fn by_error(run: &RunResult) -> Vec<NotExplained> {
    let errors = run.joint_relative_error_percent.iter().enumerate();
    let large = |(j, error): (usize, &Option<f64>)| {
        let error_percent = error.filter(|e| *e > UNEXPLAINED_PERCENT)?;
        Some(NotExplained { joint: j + 1, error_percent: Some(error_percent), test: None })
    };
    errors.filter_map(large).collect()
}

/// Whether little is left, and the rows are too few to exclude that so many parameters do that by chance.
fn is_too_short(error_percent: Option<f64>) -> bool {
    error_percent.is_some_and(|error| error < POORLY_PERCENT)
}

fn nothing_explained(run: &RunResult, first: &NotExplained) -> VerdictReason {
    let error = run.relative_error_percent;
    let said = if is_too_short(error) {
        let seen =
            format!("The rows are too few to distinguish what {} explains of the torques from chance", run.method);
        ReasonText::new(seen, RECORD_LONGER)
    } else {
        let seen = format!(
            "The model explains no torque better than a constant does, {} leaves {:.0} % of them",
            run.method,
            error.unwrap_or(f64::NAN)
        );
        ReasonText::new(seen, "check that the torques belong to this motion and this robot")
    };
    reason(ReasonCode::NothingExplained, Verdict::DoNotUse, &first.numbers(), of_method(run), said)
}

fn joint_not_explained(results: &Results, run: &RunResult, found: &NotExplained) -> VerdictReason {
    let (name, label) = (joint_name(results, found.joint), results.joint_label(found.joint - 1));
    let said = if is_too_short(found.error_percent) {
        let seen = format!(
            "The rows of {label} are too few to distinguish what {} explains of its torque from chance",
            run.method
        );
        ReasonText::new(seen, RECORD_LONGER)
    } else {
        let seen = format!(
            "{} explains the torque of {label} no better than a constant does, and leaves {:.0} % of it",
            run.method,
            found.error_percent.unwrap_or(f64::NAN)
        );
        ReasonText::new(seen, format!("check the torque column of {label}"))
    };
    let concerned = ReasonSubject { joint: Some(name), ..of_method(run) };
    reason(ReasonCode::JointNotExplained, Verdict::DoNotUse, &found.numbers(), concerned, said)
}

/// The joint with the largest error, where much of its torque is left and nothing worse is said of any joint.
fn poorly_explained(results: &Results, run: &RunResult, not_explained: &[VerdictReason]) -> Option<VerdictReason> {
    let errors = run.joint_relative_error_percent.iter().enumerate().filter_map(|(j, e)| Some((j, (*e)?)));
    let (joint, error) = errors.max_by(|a, b| a.1.total_cmp(&b.1))?;
    if error <= POORLY_PERCENT || !not_explained.is_empty() {
        return None;
    }
    let label = results.joint_label(joint);
    let whole = run.relative_error_percent.filter(|_| run.joint_relative_error_percent.len() > 1);
    let where_all = whole.map(|e| format!(", and {e:.1} % of all torques")).unwrap_or_default();
    let seen = format!("{} leaves {error:.0} % of the torque of {label} unexplained{where_all}", run.method);
    let said = ReasonText::new(
        seen,
        format!("look at the residual of {label}: friction, noise or a torque that is too small to measure"),
    );
    let concerned = ReasonSubject { joint: Some(joint_name(results, joint + 1)), ..of_method(run) };
    let numbers = [("relative_error_percent", Some(error)), ("limit", Some(POORLY_PERCENT))];
    Some(reason(ReasonCode::JointPoorlyExplained, Verdict::Care, &numbers, concerned, said))
}

/// The run's own finding about joints that it predicts worse than zero.
fn no_predictive_power(run: &RunResult, finding: &Finding) -> Option<VerdictReason> {
    let verdict = match finding.severity {
        Severity::Problem => Verdict::DoNotUse,
        Severity::Warning => Verdict::Care,
        Severity::Note => return None,
    };
    Some(of_finding(ReasonCode::JointNotExplained, verdict, run, finding))
}

fn of_finding(code: ReasonCode, verdict: Verdict, run: &RunResult, finding: &Finding) -> VerdictReason {
    let concerned = ReasonSubject {
        joint: finding.joint_name.clone(),
        parameter: finding.parameters.first().cloned(),
        finding: Some(finding.code),
        ..of_method(run)
    };
    let said = ReasonText::new(format!("{}: {}", run.method, finding.message), &finding.remedy);
    reason(code, verdict, &[("value", Some(finding.value)), ("limit", finding.limit)], concerned, said)
}

fn cross_validation(results: &Results, run: &RunResult) -> Option<VerdictReason> {
    let (unseen, fit) = (run.cross_validation_relative_error_percent?, run.relative_error_percent?);
    let ratio = unseen / fit;
    let is_far = ratio > CROSS_VALIDATION_FAR || unseen > USELESS_PERCENT;
    let verdict = if is_far { Verdict::DoNotUse } else { Verdict::Care };
    let numbers = [("unseen_percent", Some(unseen)), ("fit_percent", Some(fit)), ("limit", Some(CROSS_VALIDATION))];
    let seen = format!(
        "{} fits too closely: its unseen error is {} %, {ratio:.1} times the {} % of its fit",
        run.method,
        significant(unseen, 3),
        significant(fit, 3)
    );
    let remedy = match &results.elimination {
        Some(_) => "record more motion",
        None => "estimate fewer parameters (estimate = \"essential\" in [parameters]), or record more motion",
    };
    let said = ReasonText::new(seen, remedy);
    (ratio > CROSS_VALIDATION).then(|| reason(ReasonCode::CrossValidation, verdict, &numbers, of_method(run), said))
}

/// What is physically impossible: one reason for parameters that are negative alike, and one for links.
fn not_physical(results: &Results, run: &RunResult) -> Vec<VerdictReason> {
    let findings = run.physical.iter().flat_map(|p| &p.findings);
    let mut groups: Vec<(Verdict, Vec<&Finding>)> = Vec::new();
    for (verdict, finding) in findings.filter_map(|f| Some((demanded(results, run, f)?, f))) {
        match groups.iter_mut().find(|(v, same)| *v == verdict && are_alike(same[0], finding)) {
            Some((_, same)) => same.push(finding),
            None => groups.push((verdict, vec![finding])),
        }
    }
    groups.iter().map(|(verdict, same)| of_negative(*verdict, run, same)).collect()
}

/// Whether two findings about joints are as grave, and have remedies that differ in names alone.
fn are_alike(one: &Finding, other: &Finding) -> bool {
    let nameless = |f: &Finding| {
        let names = f.parameters.iter().chain(&f.joint_name);
        names.fold(f.remedy.clone(), |text, name| text.replace(name.as_str(), ""))
    };
    one.joint.is_some() && one.severity == other.severity && nameless(one) == nameless(other)
}

/// The reason of the first finding, which names the parameters of the others.
fn of_negative(verdict: Verdict, run: &RunResult, same: &[&Finding]) -> VerdictReason {
    let mut reason = of_finding(ReasonCode::NotPhysical, verdict, run, same[0]);
    let named = |f: &&Finding| f.message.split(';').next().unwrap_or_default().to_owned();
    let others: Vec<String> = same[1..].iter().map(named).collect();
    if !others.is_empty() {
        let names: Vec<&str> = same[1..].iter().flat_map(|f| &f.parameters).map(String::as_str).collect();
        let seen = format!("{}; also {}", reason.seen(), others.join(", "));
        reason.remedy = format!("{}; also for {}", reason.remedy, names.join(", "));
        reason.text = format!("{seen}; {}.", reason.remedy);
    }
    reason
}

/// An interval that excludes zero says that noise does not explain a negative inertia or friction. It says nothing where the
/// residual of the joint is no noise: what the model lacks may explain it, and the model is judged apart. Positions alone have no other
/// model.
fn demanded(results: &Results, run: &RunResult, finding: &Finding) -> Option<Verdict> {
    let named = |joint: &&JointResidual| Some(joint_name(results, joint.joint)) == finding.joint_name;
    let of_joint = run.residual.iter().flat_map(|r| &r.joints).find(named);
    let limit = correlated_from(results, run);
    let interval_holds = of_joint.is_none_or(|joint| joint.autocorrelation <= limit);
    match finding.severity {
        Severity::Problem if interval_holds || run.is_of_positions() => Some(Verdict::DoNotUse),
        Severity::Problem | Severity::Warning => Some(Verdict::Care),
        Severity::Note => None,
    }
}

fn influence(run: &RunResult) -> Option<VerdictReason> {
    let found = run.influence.as_ref().filter(|i| i.change.abs() > INFLUENCE)?;
    let concerned =
        ReasonSubject { parameter: Some(found.parameter.clone()), part: Some(found.part.clone()), ..of_method(run) };
    let numbers = [("change_deviations", Some(found.change)), ("limit", Some(INFLUENCE))];
    let said = ReasonText::new(
        format!(
            "{} of {} changes by {:.1} standard deviations without {}",
            found.parameter, run.method, found.change, found.part
        ),
        format!("look at {}, and record more like it", found.part),
    );
    Some(reason(ReasonCode::Influence, Verdict::Care, &numbers, concerned, said))
}

/// The correlation of neighbouring rows from which a residual is no noise.
pub(super) fn correlated_from(results: &Results, run: &RunResult) -> f64 {
    let rows = results.decimated_rows as f64 / run.joint_relative_error_percent.len().max(1) as f64;
    WHITE + MORE_DEVIATIONS / rows.sqrt()
}

fn correlated_residual(results: &Results, run: &RunResult) -> Option<VerdictReason> {
    let joints = run.residual.iter().flat_map(|r| &r.joints);
    let worst = joints.max_by(|a, b| a.autocorrelation.abs().total_cmp(&b.autocorrelation.abs()))?;
    let (r1, limit) = (worst.autocorrelation, correlated_from(results, run));
    let (name, label) = (joint_name(results, worst.joint), results.joint_label(worst.joint - 1));
    let seen = format!(
        "The residual of {label} is not noise ({}): the model lacks something (a law of friction, elasticity, a length), or the \
         processing does (friction's sign near rest). True values may lie outside their intervals{}",
        run.method,
        largest_hidden_bias(results, run).unwrap_or_default()
    );
    let said = ReasonText::new(seen, missing_remedy(results));
    let concerned = ReasonSubject { joint: Some(name), ..of_method(run) };
    let numbers = [("autocorrelation", Some(r1)), ("limit", Some(limit))];
    (r1 > limit).then(|| reason(ReasonCode::CorrelatedResidual, Verdict::Care, &numbers, concerned, said))
}

/// Of the simulated errors that the residual shows, the one that may have moved an estimate furthest, where that is more than its
/// interval says.
fn largest_hidden_bias(results: &Results, run: &RunResult) -> Option<String> {
    let biases = run.hidden_bias.iter().filter(|b| b.is_seen() && b.deviations.abs() > MORE_THAN_INTERVAL);
    let largest = biases.max_by(|a, b| a.deviations.abs().total_cmp(&b.deviations.abs()))?;
    let error = match (largest.error, largest.joint) {
        (HiddenError::FrictionNearRest, Some(joint)) => {
            format!("friction near rest of {}", results.joint_label(joint - 1))
        }
        (HiddenError::FrictionNearRest, None) => "friction near rest".to_owned(),
        (HiddenError::LateTorque, _) => "a delay of the torques".to_owned(),
    };
    let parameter = run.parameter(&largest.parameter)?;
    let shift = significant(largest.deviations.abs() * parameter.deviation()?, 2);
    let of_it = 100.0 * largest.deviations.abs() * parameter.deviation()? / parameter.estimate.abs();
    Some(format!(": {error} alone may have moved {} by {shift} {} ({of_it:.0} %)", parameter.name, parameter.unit))
}

/// What finds out what the model lacks, by what was tried already. Torques that are held show by their lag.
fn missing_remedy(results: &Results) -> String {
    let look = "look at the residual over velocity, position and load in the report";
    let Some(comparison) = &results.term_comparison else {
        return format!("compare laws of friction by compare_terms = true in [estimation]; {look}");
    };
    let laws =
        comparison.joints.iter().flat_map(|j| j.laws.iter().filter(|l| l.recommended).map(|l| (&j.joint, &l.law)));
    let laws: Vec<String> = laws.map(|(joint, law)| format!("{law} at {joint}")).collect();
    if laws.is_empty() {
        return format!("no law of friction that was compared helps: {look}");
    }
    format!("accept what the comparison of laws recommends ({})", laws.join(", "))
}
