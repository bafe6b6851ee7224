//! What the checks say of the recordings.

use super::{
    judged::judged_runs,
    reason::{ReasonText, reason},
};
use crate::diagnosis::problems::place;
use thetahat_estimation::checks::{Code, Finding, Severity};
use thetahat_report::results::{
    DriveGainResult, ReasonCode, ReasonSubject, RecordingFindings, Results, Verdict, VerdictReason,
};

/// Rows for each parameter below which chance decides much of the estimates: filters are chosen with as many.
const FEWEST_ROWS: f64 = 10.0;

/// Lag, in samples, that is not the half of one by which a torque that is held is early; the check raises none that it is not sure of
/// by six deviations. Clean: 0.8 (EMPS).
const ONE_SAMPLE: f64 = 1.0;

pub(super) fn reasons(results: &Results) -> Vec<VerdictReason> {
    let mut reasons: Vec<VerdictReason> =
        results.findings.iter().flat_map(|recording| of_recording(results, recording)).collect();
    let disagree = reasons.iter().any(|r| r.code == ReasonCode::RecordingsDisagree && r.verdict == Verdict::DoNotUse);
    // A gain that load-dependent friction can cause is said where recordings contradict each other.
    let is_said = |gain: &&DriveGainResult| gain.contradicts() || disagree && gain.can_make_recordings_disagree();
    reasons.extend(results.drive_gains.iter().filter(is_said).map(|gain| drive_gain(gain, disagree)));
    reasons.extend(few_rows(results));
    reasons
}

/// One reason for each code, with the finding of the largest evidence in words.
fn of_recording(results: &Results, recording: &RecordingFindings) -> Vec<VerdictReason> {
    let mut all: Vec<(ReasonCode, Verdict, Vec<&Finding>)> = Vec::new();
    for finding in &recording.findings {
        // What the motion does not excite the model takes from its belief, and says so.
        if finding.code == Code::NotExcited && results.model.is_some() {
            continue;
        }
        let Some((code, verdict)) = demanded(finding, recording.held_back) else { continue };
        match all.iter_mut().find(|(_, v, same)| *v == verdict && same[0].code == finding.code) {
            Some((.., same)) => same.push(finding),
            None => all.push((code, verdict, vec![finding])),
        }
    }
    let reason =
        |(code, verdict, same): &(_, _, Vec<_>)| of_findings(results, &recording.recording, (*code, *verdict), same);
    all.iter().map(reason).collect()
}

/// The rule of a finding, and what it demands; none if it does not concern the estimate.
fn demanded(finding: &Finding, held_back: bool) -> Option<(ReasonCode, Verdict)> {
    let disagree = finding.code == Code::RecordingsContradict;
    let is_lag = finding.code == Code::Lag;
    match finding.severity {
        Severity::Problem if disagree => Some((ReasonCode::RecordingsDisagree, Verdict::DoNotUse)),
        Severity::Warning if disagree => Some((ReasonCode::RecordingsDisagree, Verdict::Care)),
        Severity::Problem | Severity::Warning if held_back => None,
        Severity::Problem => Some((ReasonCode::CheckProblem, Verdict::DoNotUse)),
        Severity::Warning | Severity::Note if is_lag && !held_back && finding.value.abs() >= ONE_SAMPLE => {
            Some((ReasonCode::Lag, Verdict::Care))
        }
        Severity::Warning => Some((ReasonCode::CheckWarning, Verdict::Care)),
        Severity::Note => None,
    }
}

fn of_findings(
    results: &Results,
    recording: &str,
    (code, verdict): (ReasonCode, Verdict),
    same: &[&Finding],
) -> VerdictReason {
    let worst = same.iter().max_by(|a, b| a.value.abs().total_cmp(&b.value.abs())).unwrap_or(&same[0]);
    let joints = same.iter().filter_map(|f| f.joint).map(|joint| results.joint_label(joint - 1));
    let recording_of_several = (results.findings.len() > 1).then(|| place(recording));
    let places: Vec<String> = recording_of_several.into_iter().chain(joints).collect();
    let at = if places.is_empty() { String::new() } else { format!("; seen at {}", places.join(", ")) };
    let seen = format!("{}{at}", worst.message);
    let said = ReasonText::new(seen, &worst.remedy);
    let concerned = ReasonSubject {
        joint: worst.joint_name.clone(),
        recording: Some(recording.to_owned()),
        finding: Some(worst.code),
        ..ReasonSubject::default()
    };
    reason(code, verdict, &[("value", Some(worst.value)), ("limit", worst.limit)], concerned, said)
}

fn drive_gain(gain: &DriveGainResult, disagree: bool) -> VerdictReason {
    let factor = gain.factor.unwrap_or(f64::NAN);
    let consequence = if disagree { "; that alone makes the recordings contradict each other" } else { "" };
    let said = ReasonText::new(
        format!(
            "The known payload says that the torque of {} is {factor:.3} times what was recorded{consequence}",
            gain.joint
        ),
        format!("correct the drive's gain of {}, or the payload's mass", gain.joint),
    );
    let concerned = ReasonSubject { joint: Some(gain.joint.clone()), ..ReasonSubject::default() };
    let [low, high] = gain.interval_95.map_or([None; 2], |interval| interval.map(Some));
    let numbers = [("factor", gain.factor), ("low", low), ("high", high)];
    reason(ReasonCode::DriveGain, Verdict::DoNotUse, &numbers, concerned, said)
}

fn few_rows(results: &Results) -> Option<VerdictReason> {
    let parameters = judged_runs(results).iter().map(|r| r.parameters.len()).max().filter(|n| *n > 0)?;
    let each = results.decimated_rows as f64 / parameters as f64;
    let numbers = [("rows_per_parameter", Some(each)), ("limit", Some(FEWEST_ROWS))];
    let seen = format!(
        "{} rows after decimation are {each:.1} for each of {parameters} parameters, where {FEWEST_ROWS:.0} are few",
        results.decimated_rows
    );
    let said = ReasonText::new(seen, "record longer, or lower [signal] decimation");
    (each < FEWEST_ROWS).then(|| reason(ReasonCode::FewRows, Verdict::Care, &numbers, ReasonSubject::default(), said))
}
